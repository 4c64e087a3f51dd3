"""Likelihood of frequencies that two models were not fitted to, and which of them it prefers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Complex, Float

from flexsid.sysid.estimation.noise import SMOOTHED_FREQUENCIES

LEAST_DIFFERENCE = 10.0
"""Of log likelihoods: e^10 to one. Shapes of different meshes differ by less near flutter."""

LEAST_SIGMAS = 3.0
"""Of the difference, in its own standard errors: by chance once in 740 comparisons."""


@dataclass(frozen=True, slots=True)
class LikelihoodDifference:
    """Log likelihood of held-out frequencies by one model less that by another.

    ``std_error`` is from the scatter between frequencies, ``per_frequency`` the log likelihoods of
    both models divided by the number of frequencies, without constants.
    """

    value: float
    std_error: float
    n_frequencies: int
    per_frequency: tuple[float, float]

    @property
    def is_decided(self) -> bool:
        """Whether the difference is beyond chance and ``LEAST_DIFFERENCE``."""
        return abs(self.value) > max(LEAST_DIFFERENCE, LEAST_SIGMAS * self.std_error)


def compute_held_out_likelihoods(
    omega: Float[np.ndarray, " n_omega"],
    residuals: Complex[np.ndarray, "n_omega n_y"],
    held_out: Bool[np.ndarray, " n_omega"],
) -> Float[np.ndarray, " n_held_out"]:
    """Compute the log likelihood of each held-out frequency, without constants.

    Parameters
    ----------
    omega
        Frequencies. [rad/s]
    residuals
        Of a model that was fitted to the other frequencies, at all of them.
    held_out
        Frequencies that it was not fitted to.

    Notes
    -----
    -sum_o (|nu_o|^2 / S_o + ln S_o), where S_o is the mean of |nu_o|^2 over the
    ``SMOOTHED_FREQUENCIES`` fitted frequencies that are nearest: complex normal residuals,
    independent between outputs. In turbulence and near flutter their spectrum is far from white.
    """
    power = np.abs(residuals) ** 2
    fitted = np.flatnonzero(~held_out)
    distance = np.abs(omega[held_out, None] - omega[fitted])
    nearest = np.argsort(distance, axis=1, kind="stable")[:, :SMOOTHED_FREQUENCIES]
    S = np.maximum(power[fitted[nearest]].mean(axis=1), np.finfo(float).tiny)
    return -np.sum(power[held_out] / S + np.log(S), axis=1)


def compare_likelihoods(
    first: Float[np.ndarray, " n"], second: Float[np.ndarray, " n"]
) -> LikelihoodDifference:
    """Compare the log likelihoods of the same held-out frequencies by two models.

    Notes
    -----
    Differences at the frequencies are independent: their sum has the standard error sqrt(n) s, with
    their sample standard deviation s.
    """
    difference = first - second
    n = difference.size
    std = float(np.sqrt(n) * difference.std(ddof=1)) if n > 1 else float("inf")
    per_frequency = (float(first.mean()), float(second.mean()))
    return LikelihoodDifference(float(difference.sum()), std, n, per_frequency)
