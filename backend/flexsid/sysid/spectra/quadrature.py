"""End correction: from a sum of samples to the Fourier integral over the record."""

from __future__ import annotations

from functools import cache

import numpy as np
from jaxtyping import Complex, Float
from scipy.special import bernoulli, factorial

from flexsid.errors import BadInput

_DEGREE = 5  # of the polynomials through the samples at either end
_TERMS = 80  # of a series that shrinks like (theta / 2 pi)^r


def correct_ends(
    transform: Complex[np.ndarray, "n_omega n_channels"],
    samples: Float[np.ndarray, "n_samples n_channels"],
    rate_hz: float,
    omega: Float[np.ndarray, " n_omega"],
) -> Complex[np.ndarray, "n_omega n_channels"]:
    """Turn the plain sum over samples into the finite Fourier integral.

    Parameters
    ----------
    transform
        Sum of x exp(-j omega t) / rate, time counted from the first sample.
    samples
        The summed samples; at least twelve.
    rate_hz
        Samples per second. [Hz]
    omega
        Frequencies of the transform, none above half the rate. [rad/s]

    Raises
    ------
    BadInput
        If there are fewer than twelve samples.

    Notes
    -----
    The integral runs from the first sample to the last. Between, the sum is exact for
    any signal below half the rate, so that only the cut ends need weights; with the
    exponential integrated exactly and the samples there continued by a polynomial they
    follow from sum n^k z^n - integral t^k z^t = sum_r zeta(-k-r) (-j theta)^r / r!.
    Departure: the cubic rule of Press et al., Numerical Recipes, Sec. 13.9, also
    attenuates the sum, which is off by 11/720 theta^4 for a signal at the line itself.
    """
    count = _DEGREE + 1
    if samples.shape[0] < 2 * count:
        raise BadInput(
            f"a record of {samples.shape[0]} samples is too short to integrate; it needs at "
            f"least {2 * count}",
            code="record-too-short",
        )
    # Weights of the first samples at theta = omega / rate.
    weights = (-1j * (omega / rate_hz)[:, None]) ** np.arange(_TERMS) @ _series()
    turn = np.exp(-1j * omega * (samples.shape[0] - 1) / rate_hz)
    ends = weights @ samples[:count]
    ends += turn[:, None] * (weights.conj() @ samples[: -count - 1 : -1])
    return transform + ends / rate_hz


@cache
def _series() -> Float[np.ndarray, "n_terms n_end"]:
    """Coefficients of the weights' power series in -j theta."""
    order = np.arange(_DEGREE + 1 + _TERMS)
    # Zeta of 0, -1, -2 ..., with the sample at n = 0 counted in the first.
    zeta = -bernoulli(order.size)[1:] / (order + 1.0)
    moments = np.array([-zeta[k : k + _TERMS] for k in range(_DEGREE + 1)])
    places = np.vander(np.arange(_DEGREE + 1.0), increasing=True).T
    return np.linalg.solve(places, moments).T / factorial(np.arange(_TERMS))[:, None]
