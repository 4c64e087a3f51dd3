"""End correction: from a sum of samples to the Fourier integral over the record."""

from __future__ import annotations

from functools import cache

import numpy as np
from jaxtyping import Complex, Float
from scipy.special import bernoulli, factorial

from flexsid.errors import BadInput

_DEGREE = 5  # of the polynomials through the samples at either end
END_SAMPLES = _DEGREE + 2
"""Samples from a cut on that the integral of a record depends on besides their sum."""

_TERMS = 80  # of a series that shrinks like (theta / 2 pi)^r
_ROUNDING = 1e-9  # of a sample: a cut this close to one is at it
_NODES = 8  # of the Gauss rule over less than one sample: exact up to the Nyquist frequency


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
    weights = _compute_end_weights(omega / rate_hz)
    turn = np.exp(-1j * omega * (samples.shape[0] - 1) / rate_hz)
    ends = weights @ samples[:count]
    ends += turn[:, None] * (weights.conj() @ samples[: -count - 1 : -1])
    return transform + ends / rate_hz


def compute_cut_weights(
    theta: Float[np.ndarray, " n_omega"], cut: float, count: int
) -> Complex[np.ndarray, "n_omega n_count"]:
    """Compute weights of the first samples that turn their sum into an integral from a cut on.

    Parameters
    ----------
    theta
        Frequency over sampling rate, at most pi. [rad]
    cut
        Begin of the integral, in samples after the first; need not be an integer.
    count
        Number of weights, at least ``cut`` plus ``END_SAMPLES``.

    Raises
    ------
    BadInput
        If the cut lies before the first sample or beyond the reach of the weights.

    Notes
    -----
    Samples before the cut are subtracted, the first one after it is an end as in
    ``correct_ends``, and the part of a sample between them is the integral of the polynomial
    through the samples around it. For the end of a record: the conjugate, of samples counted
    backwards.
    """
    first = int(np.ceil(cut - _ROUNDING))
    if cut < -_ROUNDING or first + _DEGREE >= count:
        raise BadInput(
            f"a record can be cut from its first sample to {count - END_SAMPLES} samples after it, "
            f"not at {cut:g}",
            code="record-too-short",
        )
    weights = np.zeros((theta.size, count), dtype=complex)
    weights[:, :first] -= np.exp(-1j * np.outer(theta, np.arange(first)))
    end = np.exp(-1j * theta * first)[:, None] * _compute_end_weights(theta)
    weights[:, first : first + _DEGREE + 1] += end
    if first - cut > _ROUNDING:
        near = max(0, first - (_DEGREE + 1) // 2) + np.arange(_DEGREE + 1)
        node, share = np.polynomial.legendre.leggauss(_NODES)
        t = 0.5 * (cut + first) + 0.5 * (first - cut) * node
        # Lagrange polynomials of the samples around the cut, at the nodes.
        apart = near[:, None] - near + np.eye(near.size)
        factor = (t[:, None, None] - near) / apart
        factor[:, np.arange(near.size), np.arange(near.size)] = 1.0
        lagrange = factor.prod(axis=2)
        moved = np.exp(-1j * np.outer(theta, t)) * (0.5 * (first - cut) * share)
        weights[:, near] += moved @ lagrange
    return weights


def _compute_end_weights(theta: Float[np.ndarray, " n_omega"]) -> np.ndarray:
    """Weights of the samples at the begin of a sum; their conjugate at its end."""
    return (-1j * theta[:, None]) ** np.arange(_TERMS) @ _series()


@cache
def _series() -> Float[np.ndarray, "n_terms n_end"]:
    """Coefficients of the weights' power series in -j theta."""
    order = np.arange(_DEGREE + 1 + _TERMS)
    # Zeta of 0, -1, -2 ..., with the sample at n = 0 counted in the first.
    zeta = -bernoulli(order.size)[1:] / (order + 1.0)
    moments = np.array([-zeta[k : k + _TERMS] for k in range(_DEGREE + 1)])
    places = np.vander(np.arange(_DEGREE + 1.0), increasing=True).T
    return np.linalg.solve(places, moments).T / factorial(np.arange(_TERMS))[:, None]
