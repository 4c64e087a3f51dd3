"""Samples of a posterior by Hamiltonian Monte Carlo about its Gaussian approximation.

In coordinates in which the approximation is standard normal its motion is a rotation, which is
exact; only what the posterior differs by is integrated. A Gaussian posterior then accepts every
step, of any length.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

_ANGLES = (0.25 * np.pi, 0.75 * np.pi)  # of a trajectory: about a quarter turn, independent samples
_FIRST_STEP, _LEAST_STEP, _LARGEST_STEP = 0.4, 0.02, 0.25 * np.pi  # rad
_ACCEPTANCE = 0.8  # aimed at, optimal for leapfrog steps
_DISPERSION = 1.4  # of the first samples, in standard deviations: chains begin apart
_DIVERGENT = 1e3  # increase of the Hamiltonian at which a trajectory ends
_HALVINGS = 20  # of a first sample whose potential is infinite

Potential = Callable[[Float[np.ndarray, " n"]], tuple[float, Float[np.ndarray, " n"]]]
"""Negative log density and its gradient; infinite where the density is zero."""


@dataclass(frozen=True, slots=True)
class Samples:
    """Samples by chain, with the share of accepted trajectories after warm-up."""

    values: Float[np.ndarray, "n_chains n_samples n"]
    acceptance: float


def sample_density(
    potential: Potential,
    n: int,
    *,
    n_chains: int = 4,
    n_warm_up: int = 50,
    n_samples: int = 200,
    seed: int = 0,
    report: Callable[[float], None] = lambda fraction: None,
) -> Samples:
    """Sample a density that is about standard normal.

    Parameters
    ----------
    potential
        Negative log density and its gradient.
    n
        Dimension.
    n_chains, n_warm_up, n_samples
        Chains; samples of each that adapt the step and are not returned; samples of each.
    seed
        Of the random numbers.
    report
        Called with the fraction done; may raise to stop.

    Notes
    -----
    With the potential U and the momentum p the Hamiltonian U(x) + p^2/2 is split into
    (x^2 + p^2)/2, whose motion is a rotation of (x, p), and U - x^2/2, which changes p only.
    A step is half a rotation, the kick, half a rotation. Trajectories have random lengths; the step
    is adapted by Robbins and Monro's recursion.
    Sources: Neal (2011), MCMC using Hamiltonian dynamics, section 5.5.1; Shahbaba, Lan, Johnson and
    Neal (2014), Split Hamiltonian Monte Carlo, Statistics and Computing 24.
    """
    rng = np.random.default_rng(seed)
    values = np.empty((n_chains, n_samples, n))
    accepted, total = 0.0, n_chains * (n_warm_up + n_samples)
    for chain in range(n_chains):
        x = _DISPERSION * rng.normal(size=n)
        energy, _ = potential(x)
        for _ in range(_HALVINGS):
            if np.isfinite(energy):
                break
            x = 0.5 * x
            energy, _ = potential(x)
        step = _FIRST_STEP
        for k in range(n_warm_up + n_samples):
            report((chain * (n_warm_up + n_samples) + k) / total)
            p = rng.normal(size=n)
            angle = rng.uniform(*_ANGLES)
            count = int(np.ceil(angle / step))
            moved = _follow(potential, x, p, angle / count, count, energy + _DIVERGENT)
            probability = 0.0
            if moved is not None:
                trial, p_end, trial_energy = moved
                change = energy + 0.5 * p @ p - trial_energy - 0.5 * p_end @ p_end
                probability = float(np.exp(min(0.0, change)))
                if rng.uniform() < probability:
                    x, energy = trial, trial_energy
            if k < n_warm_up:
                rate = 1.0 / np.sqrt(k + 1.0)
                step = float(
                    np.clip(
                        step * np.exp(rate * (probability - _ACCEPTANCE)),
                        _LEAST_STEP,
                        _LARGEST_STEP,
                    )
                )
            else:
                accepted += probability
                values[chain, k - n_warm_up] = x
    return Samples(values, accepted / (n_chains * n_samples))


def _follow(
    potential: Potential, x: np.ndarray, p: np.ndarray, step: float, count: int, limit: float
) -> tuple[np.ndarray, np.ndarray, float] | None:
    """Follow a trajectory to its end; None where the potential exceeds a limit."""
    c, s = np.cos(0.5 * step), np.sin(0.5 * step)
    for _ in range(count):
        x, p = c * x + s * p, c * p - s * x
        energy, gradient = potential(x)
        if not energy < limit or not np.isfinite(gradient).all():
            return None
        p = p - step * (gradient - x)
        x, p = c * x + s * p, c * p - s * x
    energy, _ = potential(x)
    return (x, p, energy) if np.isfinite(energy) else None


def compute_scale_reduction(
    values: Float[np.ndarray, "n_chains n_samples n"],
) -> Float[np.ndarray, " n"]:
    """Compute the potential scale reduction R-hat of chains split in halves; 1 at convergence.

    Notes
    -----
    Source: Gelman et al. (2013), Bayesian Data Analysis, third edition, eq. 11.4.
    """
    halves = _split(values)
    length = halves.shape[1]
    within = halves.var(axis=1, ddof=1).mean(axis=0)
    between = halves.mean(axis=1).var(axis=0, ddof=1)
    ratio = np.divide(between, within, out=np.zeros_like(within), where=within > 0.0)
    return np.sqrt((length - 1) / length + ratio)


def compute_sample_size(
    values: Float[np.ndarray, "n_chains n_samples n"],
) -> Float[np.ndarray, " n"]:
    """Compute the effective number of independent samples, at most that of all samples.

    Notes
    -----
    From the autocorrelation over the chains up to the first negative sum of two (Geyer's initial
    positive sequence). Source: Gelman et al. (2013), section 11.5.
    """
    halves = _split(values)
    n_chains, length, n = halves.shape
    centred = halves - halves.mean(axis=1, keepdims=True)
    spectrum = np.fft.rfft(centred, 2 * length, axis=1)
    power = np.fft.irfft(np.abs(spectrum) ** 2, 2 * length, axis=1)[:, :length].mean(axis=0)
    variance = halves.var(axis=1, ddof=1).mean(axis=0) * (length - 1) / length
    variance = variance + halves.mean(axis=1).var(axis=0, ddof=1)
    own = power[0] / length
    with np.errstate(invalid="ignore", divide="ignore"):
        rho = 1.0 - (own - power / length) / variance
    rho = np.where(np.isfinite(rho), rho, 1.0)
    rho[0] = 1.0
    pairs = rho[: length // 2 * 2].reshape(-1, 2, n).sum(axis=1)
    time = 2.0 * np.sum(pairs * (np.minimum.accumulate(pairs, axis=0) > 0.0), axis=0) - 1.0
    return n_chains * length / np.maximum(time, 1.0)


def _split(values: np.ndarray) -> np.ndarray:
    half = values.shape[1] // 2
    return np.concatenate([values[:, :half], values[:, half : 2 * half]])
