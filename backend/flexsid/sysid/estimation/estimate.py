"""Estimate: result of every estimator, with the causes of its errors and its diagnostics.

Estimates from one record share its noise, and those with one prior its error. The covariance
between two estimates is that of the causes that both have.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np
import scipy
from jaxtyping import Bool, Complex, Float

from flexsid.sysid.estimation.priors import name_priors

# --- Error components: errors of an estimate by their causes, which other estimates share ---------

_SAME_FREQUENCY = 1e-9  # relative difference by rounding


@dataclass(frozen=True, slots=True)
class ErrorComponents:
    """Standard deviation of every parameter by cause; different causes are independent.

    ``noise`` has one matrix for each maneuver, by its frequencies ``omega`` [rad/s]: the effect
    of the noise at this frequency. ``prior`` is the effect of the error of each prior mean, by
    ``prior_names``, in units of its standard deviation.
    """

    omega: tuple[Float[np.ndarray, " n_omega"], ...]
    noise: tuple[Float[np.ndarray, "n_theta n_omega"], ...]
    prior_names: tuple[str, ...]
    prior: Float[np.ndarray, "n_theta n_prior"]

    def select(self, index: Sequence[int]) -> ErrorComponents:
        """Return those of some parameters."""
        rows = list(index)
        return replace(self, noise=tuple(one[rows] for one in self.noise), prior=self.prior[rows])

    def transform(self, matrix: Float[np.ndarray, "n n_theta"]) -> ErrorComponents:
        """Return those of linear combinations of the parameters."""
        return replace(
            self, noise=tuple(matrix @ one for one in self.noise), prior=matrix @ self.prior
        )

    def scale(self, factor: float) -> ErrorComponents:
        """Return all errors times a factor."""
        noise = tuple(factor * one for one in self.noise)
        return replace(self, noise=noise, prior=factor * self.prior)

    def append_priors(
        self, names: Sequence[str], prior: Float[np.ndarray, "n_theta n"]
    ) -> ErrorComponents:
        """Add the errors of further priors."""
        return replace(
            self,
            prior_names=(*self.prior_names, *names),
            prior=np.concatenate([self.prior, prior], axis=1),
        )

    def compute_variances(self) -> Float[np.ndarray, " n_theta"]:
        """Compute the variance of every parameter due to all causes."""
        return np.sum(np.concatenate([*self.noise, self.prior], axis=1) ** 2, axis=1)


def add_components(first: ErrorComponents, second: ErrorComponents) -> ErrorComponents:
    """Add the errors of two parts of an estimate, from different maneuvers with the same priors."""
    return ErrorComponents(
        (*first.omega, *second.omega),
        (*first.noise, *second.noise),
        first.prior_names,
        first.prior + second.prior,
    )


def compute_shared_covariance(
    first: ErrorComponents,
    second: ErrorComponents,
    maneuvers: Sequence[tuple[int, int]],
) -> Float[np.ndarray, " n"]:
    """Compute the covariance of every parameter between two estimates.

    Parameters
    ----------
    first, second
        Components of the same parameters.
    maneuvers
        Positions in both of every maneuver that both have.

    Notes
    -----
    Each estimate is to first order its error-free value plus the sum of influences
    h_k = N^-1 Re J_k^H W nu_k of the noise at frequency k, plus N^-1 P times the error of the
    prior mean. The covariance is sum_k h_ak h_bk over the frequencies of the record.
    Source: Weesie (1999), Seemingly unrelated estimation and the cluster-adjusted sandwich
    estimator, Stata Technical Bulletin 52.
    """
    names = [name for name in first.prior_names if name in set(second.prior_names)]
    total = np.sum(
        first.prior[:, [first.prior_names.index(name) for name in names]]
        * second.prior[:, [second.prior_names.index(name) for name in names]],
        axis=1,
    )
    for i, j in maneuvers:
        own, other = _match_frequencies(first.omega[i], second.omega[j])
        total = total + np.sum(first.noise[i][:, own] * second.noise[j][:, other], axis=1)
    return total


def scale_rows(
    components: Float[np.ndarray, "n_theta n"], variances: Float[np.ndarray, " n_theta"]
) -> Float[np.ndarray, "n_theta n"]:
    """Scale the components of every parameter to a variance."""
    found = np.sum(components**2, axis=1)
    with np.errstate(invalid="ignore"):
        factor = np.sqrt(np.maximum(variances, 0.0) / np.where(found > 0.0, found, np.inf))
    return np.where(np.isfinite(factor), factor, 0.0)[:, None] * components


def _match_frequencies(
    first: Float[np.ndarray, " n"], second: Float[np.ndarray, " m"]
) -> tuple[np.ndarray, np.ndarray]:
    """Return the positions of the frequencies that both have."""
    at = np.clip(np.searchsorted(second, first * (1.0 - _SAME_FREQUENCY)), 0, second.size - 1)
    same = np.abs(second[at] - first) <= _SAME_FREQUENCY * first
    return np.flatnonzero(same), at[same]


# --- Estimate: result of every estimator ----------------------------------------------------------


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

    def append_held(
        self,
        names: Sequence[str],
        std: Float[np.ndarray, " n"],
        changes: Float[np.ndarray, "n_theta n"],
    ) -> Estimate:
        """Return the estimate with further nuisance parameters that were held at zero.

        Parameters
        ----------
        names, std
            The parameters, and the standard deviations of their independent true values.
        changes
            Change of every parameter with each of them, by its standard deviation.
        """
        through = np.concatenate([changes, np.diag(std)])
        added = through @ through.T
        zeros = np.zeros(len(names))

        def widen(covariance: np.ndarray) -> np.ndarray:
            total = added.copy()
            total[: len(covariance), : len(covariance)] += covariance
            return total

        components = self.components
        if components is not None:
            rows = np.eye(len(self.names) + zeros.size)[:, : len(self.names)]
            components = components.transform(rows)
            about_zero = name_priors(names, dict.fromkeys(names, (0.0, 1.0)))
            components = components.append_priors(about_zero, through)
        return replace(
            self,
            names=(*self.names, *names),
            values=np.append(self.values, zeros),
            start=np.append(self.start, zeros),
            covariance=widen(self.covariance),
            corrected_covariance=widen(self.corrected_covariance),
            nuisance=self.nuisance | frozenset(names),
            components=components,
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


# --- Diagnostics of an estimate: fit of outputs and quality of parameters -------------------------

_RIDGE = 1e-6  # of the residual power at one frequency


@dataclass(frozen=True, slots=True)
class PredictedOutput:
    """Prediction of one measured output: R2 and Theil's inequality coefficient. [1]

    ``theil`` is 0 where the prediction is perfect, and 1 where there is none.
    """

    output: str
    r_squared: float
    theil: float


@dataclass(frozen=True, slots=True)
class OutputFit(PredictedOutput):
    """Fit of one output.

    ``whiteness`` is the p-value of the Ljung-Box test of the residuals over frequency, after
    whitening by the known correlation between the frequencies of one record.
    """

    whiteness: float


@dataclass(frozen=True, slots=True)
class ParameterQuality:
    """Uncertainty of one parameter.

    ``cramer_rao`` is the bound for white independent residuals; ``insensitivity``
    the standard error if all other parameters were known. Both in the
    parameter's unit.
    """

    name: str
    std_error: float
    cramer_rao: float
    insensitivity: float


def compute_output_fit(lines: FittedSpectra) -> tuple[OutputFit, ...]:
    """Compute the fit of every output of a block of spectra."""
    residuals = lines.measured - lines.fitted
    white = whiten(residuals, lines.correlation)
    error = np.sqrt(np.mean(np.abs(residuals) ** 2, axis=0))
    size = np.sqrt(np.mean(np.abs(lines.measured) ** 2, axis=0)) + np.sqrt(
        np.mean(np.abs(lines.fitted) ** 2, axis=0)
    )
    return tuple(
        OutputFit(
            output=name,
            r_squared=float(r2),
            theil=float(e / s) if s > 0 else 0.0,
            whiteness=whiteness(white[:, column]),
        )
        for column, (name, r2, e, s) in enumerate(
            zip(lines.outputs, lines.r_squared(), error, size, strict=True)
        )
    )


def compute_parameter_quality(estimate: Estimate) -> tuple[ParameterQuality, ...]:
    """Compute standard error, Cramer-Rao bound and insensitivity by parameter, NaN for none."""
    bound = standard_errors(estimate.covariance)
    known = np.isfinite(bound)
    scale = bound[known]
    scaled = estimate.covariance[np.ix_(known, known)] / np.outer(scale, scale)
    alone = np.full(bound.size, np.nan)
    if known.any():
        information = np.linalg.pinv(scaled, hermitian=True)
        alone[known] = scale / np.sqrt(np.maximum(np.diag(information), 1.0))
    return tuple(
        ParameterQuality(name, float(error), float(b), float(a))
        for name, error, b, a in zip(estimate.names, estimate.std_errors, bound, alone, strict=True)
    )


def whiten(
    residuals: Complex[np.ndarray, "n_omega n_y"],
    correlation: Complex[np.ndarray, "n_omega n_omega"] | None,
) -> Complex[np.ndarray, "n_omega n_y"]:
    """Transform residuals so that white noise of the record is independent.

    Notes
    -----
    With the known correlation C = L L^H between frequencies the result is L^-1 nu, of unit
    correlation for white noise. A ridge regularises frequencies closer than the resolution
    of the record.
    """
    if correlation is None:
        return residuals
    factor = scipy.linalg.cholesky(correlation + _RIDGE * np.eye(len(correlation)), lower=True)
    return scipy.linalg.solve_triangular(factor, residuals, lower=True)


def whiteness(residual: Complex[np.ndarray, " n_omega"], lags: int = 10) -> float:
    """Compute the p-value of the Ljung-Box test of complex residuals over frequency.

    Notes
    -----
    For independent circular residuals M |r_l|^2 of lag l is exponential with mean one, so
    that twice their sum is chi-square with 2 degrees of freedom per lag.
    """
    n = residual.size
    lags = min(lags, n // 4)
    power = float(np.sum(np.abs(residual) ** 2))
    if lags < 1 or power == 0:
        return 1.0
    nu: Float[np.ndarray, " n_omega"] = residual
    statistic = 0.0
    for lag in range(1, lags + 1):
        r = np.vdot(nu[:-lag], nu[lag:]) / power
        statistic += 2.0 * n * (n + 2) / (n - lag) * float(np.abs(r) ** 2)
    return float(scipy.special.chdtrc(2 * lags, statistic))
