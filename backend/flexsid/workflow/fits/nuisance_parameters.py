"""Nuisance parameters of an estimation: the spread of their prior, and their marginalisation."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from flexsid.records.run import VarianceShares
from flexsid.sysid.estimation.estimate import Estimate
from flexsid.sysid.estimation.nuisance import estimate_spread
from flexsid.workflow.fits.estimation_task import EstimationTask

_SPREAD_ROUNDS = 3
_SPREAD_CONVERGED = 0.1  # relative change of the spread of the nuisance prior


@dataclass(frozen=True, slots=True)
class ComputedRetainedModes:
    """Retained modes of an estimation: estimate of all parameters, their priors and its spread."""

    modes: tuple[int, ...]
    spread: float
    estimate: Estimate
    priors: dict[str, tuple[float, float]]
    noise_share: dict[str, float]


def refit_until_consistent(
    task: EstimationTask, estimate: Estimate, refit: Callable[[Estimate, float], Estimate]
) -> tuple[float, Estimate]:
    """Estimate the spread of the nuisance prior and fit again, until it is consistent.

    Parameters
    ----------
    task, estimate
        Task, and its estimate with the spread that it starts with.
    refit
        Fits again, from an estimate, with a spread.

    Returns
    -------
    spread, estimate
        That of the task and the estimate unchanged where it has no nuisance parameters.
    """
    spread = task.spread
    if task.nuisance is None:
        return spread, estimate
    for _ in range(_SPREAD_ROUNDS):
        if not estimate.outcome.is_optimum:
            break
        passing = estimate.nuisance.difference(task.nuisance_names)  # states at ends of records
        own = estimate.select([name for name in estimate.names if name not in passing])
        spread, before = estimate_spread(own, task.nuisance), spread
        if abs(np.log(spread / before)) < _SPREAD_CONVERGED:
            break
        estimate = refit(estimate, spread)
    return spread, estimate


def marginalise(
    task: EstimationTask,
    estimate: Estimate,
    spread: float,
    shares: Mapping[str, VarianceShares],
) -> ComputedRetainedModes | None:
    """Return the retained modes with the estimate of all parameters; None without them.

    ``shares`` are those of the variances by their causes.
    """
    if task.nuisance is None:
        return None
    reported = [name for name in estimate.names if name not in estimate.nuisance]
    priors = task.list_priors(spread)
    share = {name: one.noise for name, one in shares.items()}
    estimate = estimate.select([*reported, *task.nuisance_names])
    return ComputedRetainedModes(task.retained, spread, estimate, priors, share)
