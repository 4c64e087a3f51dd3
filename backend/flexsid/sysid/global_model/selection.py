"""Selection of polynomials and runs by prediction of flights, and the condition to fly next."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np
import scipy
from jaxtyping import Bool, Float

from flexsid.sysid.global_model.fit import (
    GlobalFit,
    GlobalModel,
    PolynomialBasis,
    RunEstimates,
    VarianceComponents,
    build_basis,
    combine_terms,
    fit_global_model,
)
from flexsid.sysid.model.derivatives import parse_derivative

# --- Selection of the polynomials by the prediction of flights that were not fitted ---------------

LEAST_RUNS = 4
"""A scatter between runs needs more of them than a line has terms."""

_DEGREES = (1, 2)  # highest degree without a penalty; terms above have a prior


@dataclass(frozen=True, slots=True)
class PredictiveScore:
    """Prediction of the runs of each flight by those of all others.

    ``degree`` is the highest degree without a penalty. ``log_density`` is the mean log density
    of an estimate, in its standard error; ``rms`` that of the residuals in predicted standard
    deviations, one if these are right; ``share_inside`` the share within two of them.
    """

    degree: int
    log_density: float
    rms: float
    share_inside: float


@dataclass(frozen=True, slots=True, eq=False)
class SelectedModel:
    """The model of the highest score, and the scores of all candidates by their place."""

    runs: RunEstimates
    fit: GlobalFit
    components: VarianceComponents
    model: GlobalModel
    candidate: int
    score: PredictiveScore
    scores: tuple[tuple[PredictiveScore, ...], ...]


def select_global_model(
    candidates: Sequence[RunEstimates], report: Callable[[float], None] = lambda share: None
) -> SelectedModel:
    """Fit polynomials of each unpenalised degree, and select those which predict flights best.

    Parameters
    ----------
    candidates
        The same runs with other known means, such as none and a prediction.
    report
        Called with the share that is done; may raise to stop.

    Notes
    -----
    The score is the log predictive density of each flight by the others. Terms above the
    degree that is selected remain in the model, with a prior of zero mean.
    Source: A. Gelman et al., Statistics and Computing 24, 997 (2014),
    doi:10.1007/s11222-013-9416-2.
    """
    best: SelectedModel | None = None
    scores: list[tuple[PredictiveScore, ...]] = []
    for number, runs in enumerate(candidates):
        own: list[PredictiveScore] = []
        basis = build_basis(runs.conditions)
        start: VarianceComponents | None = None
        for degree in (d for d in _DEGREES if d == _DEGREES[0] or (basis.degrees == d).any()):
            report((number + len(own) / len(_DEGREES)) / len(candidates))
            fit, start, model = fit_global_model(runs, basis, degree, start)
            score = _score(fit, start, degree)
            own.append(score)
            if best is None or score.log_density > best.score.log_density:
                best = SelectedModel(runs, fit, start, model, number, score, ())
        scores.append(tuple(own))
    assert best is not None
    return replace(best, scores=tuple(scores))


def _score(fit: GlobalFit, components: VarianceComponents, degree: int) -> PredictiveScore:
    residual, covariance = fit.predict_flights(components)
    present = fit.runs.is_estimated
    weights = np.repeat(fit.a[:, None], present.shape[1], axis=1)[present]
    sigma = np.sqrt(np.diagonal(covariance, axis1=1, axis2=2))
    z = (residual / sigma)[present]
    density = fit.a @ _compute_log_densities(residual, covariance, present.sum(axis=1))
    return PredictiveScore(
        degree=degree,
        log_density=float(density / weights.sum()),
        rms=float(np.sqrt(np.average(z**2, weights=weights))),
        share_inside=float(np.average(np.abs(z) <= 2.0, weights=weights)),
    )


def _compute_log_densities(
    residual: Float[np.ndarray, "n p"],
    covariance: Float[np.ndarray, "n p p"],
    counts: np.ndarray,
) -> Float[np.ndarray, " n"]:
    """Log density of each normal residual; places of absent derivatives have variance one."""
    L = np.linalg.cholesky(covariance)
    whitened = np.array(
        [
            scipy.linalg.solve_triangular(half, e, lower=True)
            for half, e in zip(L, residual, strict=True)
        ]
    )
    log_det = 2.0 * np.log(np.diagonal(L, axis1=1, axis2=2)).sum(axis=1)
    return -0.5 * (np.sum(whitened**2, axis=1) + log_det + counts * np.log(2.0 * np.pi))


# --- The flight condition at which one more run would reduce the uncertainty most -----------------

_GRID = {1: 25, 2: 9, 3: 5}  # values of each variable: at most 125 conditions
_FEWEST_VALUES = 3  # of each of more variables


def find_next_condition(selected: SelectedModel) -> tuple[Float[np.ndarray, " n_v"], float] | None:
    """Find where in the envelope one more run reduces the variance most.

    Returns
    -------
    condition, reduction
        The condition, and the relative reduction of the mean variance by a run with the median
        covariance of those flown [1]; None where no run has all derivatives.
    """
    runs, basis = selected.runs, selected.model.basis
    complete = np.flatnonzero(runs.is_estimated.all(axis=1))
    grid = _build_grid(basis.lowest, basis.highest)
    grid = grid[~basis.is_extrapolated(grid)]
    if complete.size == 0 or len(grid) == 0:
        return None
    sizes = np.diagonal(runs.covariances[complete], axis1=1, axis2=2) / selected.fit.scale**2
    median = complete[np.argsort(sizes.sum(axis=1))[complete.size // 2]]
    reductions = compute_variance_reductions(selected.model, runs.covariances[median], grid)
    best = int(np.argmax(reductions))
    return grid[best], float(reductions[best])


def _build_grid(
    lowest: Float[np.ndarray, " n_v"], highest: Float[np.ndarray, " n_v"]
) -> Float[np.ndarray, "n n_v"]:
    """Build a grid of conditions between two corners of the envelope."""
    count = _GRID.get(lowest.size, _FEWEST_VALUES)
    axes = [
        np.linspace(low, high, count if high > low else 1)
        for low, high in zip(lowest, highest, strict=True)
    ]
    return np.array(list(product(*axes)))


def compute_variance_reductions(
    model: GlobalModel,
    covariance: Float[np.ndarray, "p p"],
    conditions: Float[np.ndarray, "n n_v"],
) -> Float[np.ndarray, " n"]:
    """Compute by how much a run at each condition would reduce the variance over all of them.

    Parameters
    ----------
    model
        The global model.
    covariance
        Of the estimates of one more run, e.g. the median of those flown.
    conditions
        Where a run may be flown, and over which the variance counts. [any]

    Returns
    -------
    ndarray
        Reduction of the mean variance of all derivatives, each over its own mean. [1]

    Notes
    -----
    A run at c with covariance V of its estimates, scatter included, changes the covariance at
    g by -K(g, c) (V + C(c))^-1 K(c, g) with the covariance K between the two conditions: no
    data are needed.
    """
    terms = model.basis.evaluate(conditions)
    p, k = model.coefficients.shape
    blocks = model.covariance.reshape(p, k, p, k)
    variance = np.einsum("akal,nk,nl->na", blocks, terms, terms, optimize=True)
    scale = 1.0 / np.maximum(variance.mean(axis=0), np.finfo(float).tiny)
    V = covariance + np.diag(model.scatter**2)
    reductions = np.empty(len(conditions))
    for number, own in enumerate(terms):
        gain = np.einsum("akbl,l->akb", blocks, own, optimize=True)  # coefficients x derivatives
        C = np.einsum("akb,k->ab", gain, own)
        K = np.einsum("nk,akb->nab", terms, gain, optimize=True)
        L = np.linalg.cholesky(V + 0.5 * (C + C.T))
        whitened = np.linalg.solve(L, K.reshape(-1, p).T)
        lost = np.sum(whitened**2, axis=0).reshape(len(terms), p)
        reductions[number] = float((lost.mean(axis=0) * scale).mean())
    return reductions


# --- Outlying runs: those that the model of all others does not predict, with the likely cause

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
    whitened = scipy.linalg.solve_triangular(L, z, lower=True)
    chi_square = float(whitened @ whitened)
    groups = _list_groups(names)
    columns = np.array([own for _, own in groups]).T * direction[:, None]
    moved = scipy.linalg.solve_triangular(L, columns, lower=True)
    std = 1.0 / np.sqrt(np.maximum(np.sum(moved**2, axis=0), np.finfo(float).tiny))
    ratio = (moved.T @ whitened) * std
    best = int(np.argmax(np.abs(ratio)))
    of_factor = len(groups) * 2.0 * float(scipy.special.stdtr(freedom, -abs(ratio[best])))
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
    return float(scipy.special.gammaincc(mean**2 / variance, chi_square * mean / variance))
