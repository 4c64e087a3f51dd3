"""Estimate: what an estimator returns, whatever the method."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np
from jaxtyping import Bool, Complex, Float


class Outcome(StrEnum):
    """How a maximisation ended."""

    CONVERGED = "converged"
    ITERATION_LIMIT = "iteration limit"
    SINGULAR_INFORMATION = "singular information"
    DIVERGED = "diverged"
    CANCELLED = "cancelled"

    @property
    def is_optimum(self) -> bool:
        """Whether the values are those of an optimum, of which alone standard errors are known."""
        return self in (Outcome.CONVERGED, Outcome.SINGULAR_INFORMATION)


@dataclass(frozen=True, slots=True)
class IterationStep:
    """One accepted iteration: negative log likelihood and largest step in standard errors.

    The first step of a stage is where it starts. ``stage`` counts the fits to lines corrected
    anew; costs of different stages are of different data and cannot be compared.
    """

    iteration: int
    cost: float
    step: float
    stage: int = 0


def append_stage(
    before: Sequence[IterationStep], again: Sequence[IterationStep]
) -> tuple[IterationStep, ...]:
    """History of a fit followed by that of another fit, which starts where the first ended."""
    last = before[-1]
    return (
        *before,
        *(
            replace(step, iteration=last.iteration + step.iteration, stage=last.stage + 1)
            for step in again
        ),
    )


def count_iterations(count: int) -> str:
    """A number of iterations in words."""
    return f"{count} iteration" if count == 1 else f"{count} iterations"


@dataclass(frozen=True, slots=True)
class FittedLines:
    """Measured and modelled spectra of one group of lines.

    ``correlation`` is that of white noise in the record between these lines; None where the
    lines are independent, or nothing is known of the record.
    """

    name: str
    outputs: tuple[str, ...]
    omega: Float[np.ndarray, " n_omega"]
    measured: Complex[np.ndarray, "n_omega n_y"]
    fitted: Complex[np.ndarray, "n_omega n_y"]
    correlation: Complex[np.ndarray, "n_omega n_omega"] | None = None

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
    steps: tuple[IterationStep, ...]
    outcome: Outcome
    message: str

    def widened(self, factor: float) -> Estimate:
        """The same estimate with variances multiplied, as for lines closer than 1/T."""
        return replace(
            self,
            covariance=factor * self.covariance,
            corrected_covariance=factor * self.corrected_covariance,
        )

    def without_errors(self, which: Bool[np.ndarray, " n_theta"] | None = None) -> Estimate:
        """The same estimate with no standard errors (NaN) of these parameters, all by default."""
        unknown = np.ones(len(self.names), dtype=bool) if which is None else which
        either = unknown[:, None] | unknown
        return replace(
            self,
            covariance=np.where(either, np.nan, self.covariance),
            corrected_covariance=np.where(either, np.nan, self.corrected_covariance),
        )

    @property
    def std_errors(self) -> Float[np.ndarray, " n_theta"]:
        """Standard errors from the corrected covariance; NaN, never zero, where there is none."""
        return standard_errors(self.corrected_covariance)

    @property
    def correlation(self) -> Float[np.ndarray, "n_theta n_theta"]:
        """Correlation between parameters."""
        scale = self.std_errors
        safe = np.where(scale > 0.0, scale, 1.0)
        return self.corrected_covariance / np.outer(safe, safe)


def standard_errors(covariance: Float[np.ndarray, "n n"]) -> Float[np.ndarray, " n"]:
    """Roots of the variances; NaN where a variance is not a positive number.

    Nothing that is estimated from data is known exactly: a variance of zero is what rounding
    or an estimate of something else left there.
    """
    variance = np.diag(covariance)
    return np.sqrt(np.where(variance > 0.0, variance, np.nan))
