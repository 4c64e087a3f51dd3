"""Estimate: what an estimator returns, whatever the method."""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np
from jaxtyping import Complex, Float


class Outcome(StrEnum):
    """How a maximisation ended."""

    CONVERGED = "converged"
    ITERATION_LIMIT = "iteration limit"
    SINGULAR_INFORMATION = "singular information"
    DIVERGED = "diverged"
    CANCELLED = "cancelled"


@dataclass(frozen=True, slots=True)
class Step:
    """One accepted iteration: negative log likelihood and largest step in standard errors."""

    iteration: int
    cost: float
    step: float


@dataclass(frozen=True, slots=True)
class FittedLines:
    """Measured and modelled spectra of one group of lines."""

    name: str
    outputs: tuple[str, ...]
    omega: Float[np.ndarray, " n_omega"]
    measured: Complex[np.ndarray, "n_omega n_y"]
    fitted: Complex[np.ndarray, "n_omega n_y"]

    def r_squared(self) -> Float[np.ndarray, " n_y"]:
        """Share of the measured power that the model explains, per output."""
        power = np.sum(np.abs(self.measured) ** 2, axis=0)
        error = np.sum(np.abs(self.measured - self.fitted) ** 2, axis=0)
        return 1.0 - np.divide(error, power, out=np.full_like(power, np.inf), where=power > 0)


@dataclass(frozen=True, slots=True)
class Estimate:
    """Values with covariance, and everything needed to judge them.

    ``covariance`` holds for white residuals that are independent between
    outputs; ``corrected_covariance`` for the residuals as they are.
    """

    names: tuple[str, ...]
    values: Float[np.ndarray, " n_theta"]
    start: Float[np.ndarray, " n_theta"]
    covariance: Float[np.ndarray, "n_theta n_theta"]
    corrected_covariance: Float[np.ndarray, "n_theta n_theta"]
    lines: tuple[FittedLines, ...]
    steps: tuple[Step, ...]
    outcome: Outcome
    message: str

    def widened(self, factor: float) -> Estimate:
        """The same estimate with variances multiplied, as for lines closer than 1/T."""
        return replace(
            self,
            covariance=factor * self.covariance,
            corrected_covariance=factor * self.corrected_covariance,
        )

    @property
    def std_errors(self) -> Float[np.ndarray, " n_theta"]:
        """Standard errors from the corrected covariance."""
        return np.sqrt(np.maximum(np.diag(self.corrected_covariance), 0.0))

    @property
    def correlation(self) -> Float[np.ndarray, "n_theta n_theta"]:
        """Correlation between parameters."""
        scale = self.std_errors
        safe = np.where(scale > 0.0, scale, 1.0)
        return self.corrected_covariance / np.outer(safe, safe)
