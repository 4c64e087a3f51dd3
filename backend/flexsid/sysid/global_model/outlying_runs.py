"""Outlying runs: those that the model of all others does not predict, with the likely cause."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float
from scipy import linalg, special

from flexsid.sysid.global_model.basis import PolynomialBasis, build_basis
from flexsid.sysid.global_model.fit import (
    GlobalFit,
    GlobalModel,
    RunEstimates,
    VarianceComponents,
    combine_terms,
    fit_global_model,
)
from flexsid.sysid.model.derivatives import parse_derivative

_DEGREE = 1  # of the terms without a penalty
_LEVEL = 0.01  # probability of one false outlying run in a campaign
_LARGEST_SHARE = 0.25  # of the runs: with more, nobody knows which are right
_LEAST_FREEDOM = 5  # runs above the number of terms; the reference needs its variance
_EXPLAINED = 0.5  # share of the deviation that a cause explains at least
_WORST = 3  # derivatives named


@dataclass(frozen=True, slots=True)
class ScaleFactor:
    """A common factor on derivatives of an outlying run that explains its deviation.

    ``coefficient`` or ``variable`` names the derivatives of one row or column of the table;
    both are None where the factor is on all derivatives. ``explained`` is the share of the
    chi-square of the run.
    """

    coefficient: str | None
    variable: str | None
    factor: float
    std: float
    explained: float


@dataclass(frozen=True, slots=True)
class OutlyingRun:
    """A run that the others do not predict; ``index`` is its place.

    ``probability`` is that of a deviation at least as large, in view of the number of runs.
    ``worst`` are the derivatives that deviate most, in standard deviations.
    """

    index: int
    chi_square: float
    n_derivatives: int
    probability: float
    worst: tuple[tuple[str, float], ...]
    cause: ScaleFactor | None


@dataclass(frozen=True, slots=True, eq=False)
class _Deviation:
    """Deviation of one run from its prediction, with its probability for that run alone."""

    z: Float[np.ndarray, " p"]
    chi_square: float
    probability: float
    cause: ScaleFactor | None


def find_outlying_runs(runs: RunEstimates) -> tuple[OutlyingRun, ...]:
    """Find runs that the model of all others does not predict.

    Notes
    -----
    The run that deviates most is excluded and the model, with its variance components, fitted
    to the others: an outlying run must not widen the scatter by which it is measured.
    Probabilities are multiplied by the number of runs (Bonferroni). Repeated until no further
    run is outlying.
    Source: D. M. Hawkins, Identification of Outliers (1980), doi:10.1007/978-94-015-3994-4, ch. 5
    (sequential deletion).
    """
    included = np.ones(len(runs.values), dtype=bool)
    components: VarianceComponents | None = None
    found: list[OutlyingRun] = []
    while len(found) < _LARGEST_SHARE * included.size:
        own = runs.select(included)
        basis = build_basis(own.conditions)
        freedom = int(included.sum()) - 1 - int(np.sum(basis.degrees <= _DEGREE))
        if freedom < _LEAST_FREEDOM:
            break
        fit, components, model = fit_global_model(own, basis, _DEGREE, components)
        suspect = int(np.flatnonzero(included)[_find_suspect(fit, components, model, freedom)])
        included[suspect] = False
        deviation = _test(runs, suspect, included, basis, components, freedom)
        probability = min(1.0, len(runs.values) * deviation.probability)
        if probability >= _LEVEL:
            break
        present = np.flatnonzero(runs.is_estimated[suspect])
        order = np.argsort(-np.abs(deviation.z))[:_WORST]
        found.append(
            OutlyingRun(
                index=suspect,
                chi_square=deviation.chi_square,
                n_derivatives=present.size,
                probability=probability,
                worst=tuple((runs.names[present[k]], float(deviation.z[k])) for k in order),
                cause=deviation.cause,
            )
        )
    return tuple(found)


def _find_suspect(
    fit: GlobalFit, components: VarianceComponents, model: GlobalModel, freedom: int
) -> int:
    """Find the run that deviates most from its prediction by the others."""
    residuals, covariances = fit.predict_runs(components, model)
    ranks: list[tuple[float, float]] = []
    for number, (e, S) in enumerate(zip(residuals, covariances, strict=True)):
        own = np.flatnonzero(fit.runs.is_estimated[number])
        measured = fit.runs.values[number, own] / fit.scale[own]
        names = [fit.runs.names[k] for k in own]
        found = _compare(names, e[own], measured - e[own], S[np.ix_(own, own)], freedom)
        ranks.append((found.probability, -found.chi_square))
    return ranks.index(min(ranks))


def _test(
    runs: RunEstimates,
    suspect: int,
    others: Bool[np.ndarray, " n_runs"],
    basis: PolynomialBasis,
    start: VarianceComponents,
    freedom: int,
) -> _Deviation:
    """Compare a run with its prediction by others."""
    _, _, model = fit_global_model(runs.select(others), basis, _DEGREE, start)
    own = np.flatnonzero(runs.is_estimated[suspect])
    terms = basis.evaluate(runs.conditions[suspect : suspect + 1])
    predicted = (terms @ model.coefficients.T)[0] + runs.mean[suspect]
    S = runs.covariances[suspect] + np.diag(model.scatter**2)
    S = S + combine_terms(model.covariance, terms)[0]
    e = (runs.values[suspect] - predicted)[own]
    names = [runs.names[k] for k in own]
    return _compare(names, e, predicted[own], S[np.ix_(own, own)], freedom)


def _compare(
    names: list[str],
    e: Float[np.ndarray, " p"],
    predicted: Float[np.ndarray, " p"],
    S: Float[np.ndarray, "p p"],
    freedom: int,
) -> _Deviation:
    """Test the deviation e of a run from its prediction, with covariance S.

    Notes
    -----
    Two tests share the probability: chi-square of all derivatives against any deviation, and a
    common factor 1 + s on the derivatives of one row or column of the table against wrong
    signs, scales, masses and inertias. s is the weighted least-squares fit of e by s times the
    predicted derivatives. The scatter in S is estimated with nu degrees of freedom:
    s over its standard deviation is Student's t, and the chi-square, a sum of p variables
    F(1, nu), is compared with the gamma distribution of the same mean and variance.
    """
    sigma = np.sqrt(np.diag(S))
    z, direction = e / sigma, predicted / sigma
    L = np.linalg.cholesky(S / np.outer(sigma, sigma))
    whitened = linalg.solve_triangular(L, z, lower=True)
    chi_square = float(whitened @ whitened)
    groups = _list_groups(names)
    columns = np.array([own for _, own in groups]).T * direction[:, None]
    moved = linalg.solve_triangular(L, columns, lower=True)
    std = 1.0 / np.sqrt(np.maximum(np.sum(moved**2, axis=0), np.finfo(float).tiny))
    ratio = (moved.T @ whitened) * std
    best = int(np.argmax(np.abs(ratio)))
    of_factor = len(groups) * 2.0 * float(special.stdtr(freedom, -abs(ratio[best])))
    of_all = _compute_probability(chi_square, len(names), freedom)
    (row, variable), _ = groups[best]
    explained = float(ratio[best] ** 2 / chi_square)
    cause = ScaleFactor(
        row, variable, 1.0 + float(ratio[best] * std[best]), float(std[best]), explained
    )
    is_cause = explained > _EXPLAINED or of_factor < of_all
    return _Deviation(z, chi_square, 2.0 * min(of_factor, of_all), cause if is_cause else None)


def _list_groups(
    names: list[str],
) -> list[tuple[tuple[str | None, str | None], list[bool]]]:
    """List all derivatives, each row and each column of the table of two or more of them."""
    split = [parse_derivative(name) for name in names]
    labels: list[tuple[str | None, str | None]] = [(None, None)]
    labels += [(row, None) for row in dict.fromkeys(row for row, _ in split)]
    labels += [(None, column) for column in dict.fromkeys(column for _, column in split)]
    groups = [
        ((row, column), [row in (None, r) and column in (None, c) for r, c in split])
        for row, column in labels
    ]
    return [one for one in groups if sum(one[1]) > 1] or groups[:1]


def _compute_probability(chi_square: float, p: int, freedom: int) -> float:
    """Probability of a sum of p variables F(1, freedom) of at least ``chi_square``."""
    nu = float(freedom)
    mean = p * nu / (nu - 2.0)
    variance = 2.0 * p * nu**2 * (nu - 1.0) / ((nu - 2.0) ** 2 * (nu - 4.0))
    return float(special.gammaincc(mean**2 / variance, chi_square * mean / variance))
