"""Diagnostics of an estimate: fit of outputs and quality of parameters."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float
from scipy import linalg, special

from flexsid.sysid.estimation.estimate import Estimate, FittedSpectra, standard_errors

_RIDGE = 1e-6  # of the residual power at one frequency


@dataclass(frozen=True, slots=True)
class OutputFit:
    """Fit of one output.

    ``theil`` is Theil's inequality coefficient (0 perfect, 1 none); ``whiteness`` is the
    p-value of the Ljung-Box test of the residuals over frequency, after whitening by the
    known correlation between the frequencies of one record.
    """

    output: str
    r_squared: float
    theil: float
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
    factor = linalg.cholesky(correlation + _RIDGE * np.eye(len(correlation)), lower=True)
    return linalg.solve_triangular(factor, residuals, lower=True)


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
    return float(special.chdtrc(2 * lags, statistic))
