"""Estimate: result of every estimator."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np
from jaxtyping import Bool, Complex, Float

from flexsid.sysid.estimation.error_components import ErrorComponents


class Outcome(StrEnum):
    """Outcome of a maximisation."""

    CONVERGED = "converged"
    ITERATION_LIMIT = "iteration limit"
    SINGULAR_INFORMATION = "singular information"
    DIVERGED = "diverged"
    CANCELLED = "cancelled"

    @property
    def is_optimum(self) -> bool:
        """Whether the values are those of an optimum; only then standard errors exist."""
        return self in (Outcome.CONVERGED, Outcome.SINGULAR_INFORMATION)


@dataclass(frozen=True, slots=True)
class IterationStep:
    """One accepted iteration: negative log likelihood and largest step in standard errors.

    The first step of a stage is its start. ``stage`` counts the fits after a new correction of
    leakage; costs of different stages belong to different data and cannot be compared.
    """

    iteration: int
    cost: float
    step: float
    stage: int = 0


def append_stage(
    before: Sequence[IterationStep], again: Sequence[IterationStep]
) -> tuple[IterationStep, ...]:
    """Append the history of a fit that starts at the end of another one."""
    last = before[-1]
    return (
        *before,
        *(
            replace(step, iteration=last.iteration + step.iteration, stage=last.stage + 1)
            for step in again
        ),
    )


def count_iterations(count: int) -> str:
    """Format a number of iterations."""
    return f"{count} iteration" if count == 1 else f"{count} iterations"


@dataclass(frozen=True, slots=True)
class NoiseEstimate:
    """Noise estimate behind the weights of a fit: its description and degrees of freedom.

    ``degrees_of_freedom`` is the number of complex data points in each estimate; ``converged``
    is False where the fit weighted with the noise spectrum did not converge.
    """

    description: str
    degrees_of_freedom: int
    converged: bool = True


@dataclass(frozen=True, slots=True)
class FittedSpectra:
    """Measured and modelled spectra of one group of frequencies.

    ``correlation`` is that of white noise of the record between these frequencies; None if
    they are independent or the record is unknown.
    """

    name: str
    outputs: tuple[str, ...]
    omega: Float[np.ndarray, " n_omega"]
    measured: Complex[np.ndarray, "n_omega n_y"]
    fitted: Complex[np.ndarray, "n_omega n_y"]
    correlation: Complex[np.ndarray, "n_omega n_omega"] | None = None

    def r_squared(self) -> Float[np.ndarray, " n_y"]:
        """Compute the share of the measured power that the model explains, by output."""
        power = np.sum(np.abs(self.measured) ** 2, axis=0)
        error = np.sum(np.abs(self.measured - self.fitted) ** 2, axis=0)
        return 1.0 - np.divide(error, power, out=np.full_like(power, np.inf), where=power > 0)


@dataclass(frozen=True, slots=True)
class Estimate:
    """Values with covariance, fitted spectra and outcome.

    ``covariance`` is valid for white residuals that are independent between outputs, or for
    noise of the estimated spectrum where the fit is weighted with it,
    ``corrected_covariance`` for coloured and correlated residuals. ``nuisance`` are the
    parameters that are no results. ``components`` are the errors by their causes, without those
    that no other estimate shares; None if they were not computed.
    """

    names: tuple[str, ...]
    values: Float[np.ndarray, " n_theta"]
    start: Float[np.ndarray, " n_theta"]
    covariance: Float[np.ndarray, "n_theta n_theta"]
    corrected_covariance: Float[np.ndarray, "n_theta n_theta"]
    lines: tuple[FittedSpectra, ...]
    steps: tuple[IterationStep, ...]
    outcome: Outcome
    message: str
    nuisance: frozenset[str] = frozenset()
    noise: NoiseEstimate | None = None
    components: ErrorComponents | None = None

    def select(self, names: Sequence[str]) -> Estimate:
        """Return the estimate of some parameters; the others are marginalised."""
        index = [self.names.index(name) for name in names]
        pick = np.ix_(index, index)
        return replace(
            self,
            names=tuple(names),
            values=self.values[index],
            start=self.start[index],
            covariance=self.covariance[pick],
            corrected_covariance=self.corrected_covariance[pick],
            nuisance=self.nuisance & frozenset(names),
            components=None if self.components is None else self.components.select(index),
        )

    def scale_covariance(self, factor: float) -> Estimate:
        """Return the estimate with variances multiplied, as for frequencies closer than 1/T."""
        return replace(
            self,
            covariance=factor * self.covariance,
            corrected_covariance=factor * self.corrected_covariance,
            components=None if self.components is None else self.components.scale(factor**0.5),
        )

    def without_std_errors(self, which: Bool[np.ndarray, " n_theta"] | None = None) -> Estimate:
        """Return the estimate without standard errors (NaN) of these parameters, or of all."""
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
    """Compute the roots of the variances; NaN where a variance is not positive.

    No estimate from data is exact: a variance of zero is due to rounding.
    """
    variance = np.diag(covariance)
    return np.sqrt(np.where(variance > 0.0, variance, np.nan))
