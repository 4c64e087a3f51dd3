"""Power of the residuals in a band of an output against the noise measured there.

The noise is the scatter of the residuals about a smooth response to the input that excites each
frequency, whatever the model: a correct model leaves residuals of this power, another one more.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from jaxtyping import Complex, Float
from scipy import optimize, special

from flexsid.sysid.spectra.residual_spectrum import build_local_fits

_BANDS = 4  # with equal numbers of frequencies, so that each has the degrees of freedom of a test
_LEAST_WINDOWS = 8  # local fits in a band; fewer do not measure its noise
_TAIL = 0.3  # probability below which two moments are not accurate
_ROUNDING = 1e-12  # of the largest eigenvalue


@dataclass(frozen=True, slots=True)
class BandPower:
    """Residual power of one output in one band.

    ``statistic`` is chi-square with ``degrees_of_freedom`` for a correct model and known noise,
    ``p`` the probability of a larger one in view of the degrees of freedom of the noise, and
    ``ratio`` the power over that of the noise.
    """

    output: int
    band_hz: tuple[float, float]
    statistic: float
    degrees_of_freedom: int
    ratio: float
    p: float


def compute_band_powers(
    omega: Float[np.ndarray, " n_omega"],
    inputs: Complex[np.ndarray, "n_omega n_u"],
    residuals: Complex[np.ndarray, "n_omega n_y"],
    leverage: Float[np.ndarray, "n_omega n_y"],
) -> Iterator[BandPower]:
    """Compare the power of residuals with that of their scatter about smooth responses.

    Parameters
    ----------
    omega
        Frequencies in order. [rad/s]
    inputs
        Of the model. [rad s]
    residuals
        Of equal variance at all frequencies of an output.
    leverage
        Share of the noise that the fit removes, by residual.

    Yields
    ------
    BandPower
        By band and output; none where the inputs share their frequencies, or have too few.

    Notes
    -----
    With local residuals D nu, of unit variance for white noise, the ratio is
    rho = (|nu|^2 / n) / (|D nu|^2 / m) over the n frequencies and m windows of a band. A correct
    model exceeds it with the probability of nu^H Q nu > 0, Q = (1 - h) I/n - rho D^H D/m with the
    mean leverage h. For complex normal nu this is a sum of exponential variables times the
    eigenvalues of Q: by the first two moments where it is large, else by a saddlepoint
    approximation. Numerator and denominator are of the same noise, which an F distribution
    would take as independent.
    Source: Lugannani and Rice (1980), Saddle point approximation for the distribution of the sum
    of independent random variables.
    """
    D, centre = build_local_fits(inputs)
    edges = np.round(np.linspace(0, omega.size, _BANDS + 1)).astype(int)
    for first, last in pairwise(edges.tolist()):
        own = D[(centre >= first) & (centre < last)]
        m, n = len(own), last - first
        if m < _LEAST_WINDOWS:
            continue
        R = own.conj().T @ own / m
        moments = 1.0 / n, -2.0 * np.trace(R[first:last, first:last]).real / n, _norm(R)
        unit = np.zeros(omega.size)
        unit[first:last] = 1.0 / n
        near = np.flatnonzero(unit + np.diag(R).real)
        unit, R = unit[near], R[np.ix_(near, near)]
        power = np.sum(np.abs(residuals[first:last]) ** 2, axis=0)
        noise = np.sum(np.abs(own @ residuals) ** 2, axis=0) / m
        free = n - leverage[first:last].sum(axis=0)
        for output in range(residuals.shape[1]):
            rho = float(power[output] / n / noise[output])
            share = float(free[output]) / n
            variance = moments[0] * share**2 + moments[1] * share * rho + moments[2] * rho**2
            p = float(special.ndtr((share - rho) / np.sqrt(variance)))
            if p < _TAIL:
                p = _compute_tail(np.linalg.eigvalsh(share * np.diag(unit) - rho * R))
            yield BandPower(
                output,
                (float(omega[first]) / (2.0 * np.pi), float(omega[last - 1]) / (2.0 * np.pi)),
                float(2.0 * power[output] / noise[output]),
                round(2.0 * float(free[output])),
                rho / share,
                p,
            )


def _norm(matrix: np.ndarray) -> float:
    return float(np.sum(np.abs(matrix) ** 2))


def _compute_tail(eigenvalues: Float[np.ndarray, " n"]) -> float:
    """Compute the probability of a positive sum of exponential variables times these."""
    small = _ROUNDING * np.abs(eigenvalues).max()
    values = eigenvalues[np.abs(eigenvalues) > small]
    if values.max() <= 0.0 or values.min() >= 0.0 or values.sum() >= 0.0:
        return float(values.max() > 0.0)

    s = optimize.brentq(
        _differentiate_cumulant, 0.0, (1.0 - _ROUNDING) / values.max(), args=(values,)
    )
    cumulant = -float(np.sum(np.log1p(-s * values)))
    w = np.sqrt(-2.0 * cumulant)
    v = s * np.sqrt(np.sum((values / (1.0 - s * values)) ** 2))
    density = np.exp(-0.5 * w**2) / np.sqrt(2.0 * np.pi)
    return float(np.clip(special.ndtr(-w) + density * (1.0 / v - 1.0 / w), 0.0, 1.0))


def _differentiate_cumulant(s: float, eigenvalues: np.ndarray) -> float:
    return float(np.sum(eigenvalues / (1.0 - s * eigenvalues)))
