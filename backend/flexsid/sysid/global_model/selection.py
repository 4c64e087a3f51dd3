"""Selection of the polynomials by the prediction of flights that were not fitted."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float
from scipy import linalg

from flexsid.sysid.global_model.basis import build_basis
from flexsid.sysid.global_model.fit import (
    GlobalFit,
    GlobalModel,
    RunEstimates,
    VarianceComponents,
    fit_global_model,
)

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
        [linalg.solve_triangular(half, e, lower=True) for half, e in zip(L, residual, strict=True)]
    )
    log_det = 2.0 * np.log(np.diagonal(L, axis1=1, axis2=2)).sum(axis=1)
    return -0.5 * (np.sum(whitened**2, axis=1) + log_det + counts * np.log(2.0 * np.pi))
