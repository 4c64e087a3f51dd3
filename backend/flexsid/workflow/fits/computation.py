"""Computation of a run from its task, without a database, in any process."""

from __future__ import annotations

import time
from dataclasses import dataclass

from flexsid.extensions import report_errors
from flexsid.records.run import ModelAdequacy, Provenance, ReportProgress, VarianceShares
from flexsid.sysid.estimation.estimate import Estimate
from flexsid.sysid.estimation.limits import find_parameters_at_limits
from flexsid.sysid.stability.poles import NamedPole
from flexsid.workflow.fits.estimation_task import (
    EstimationTask,
    compute_poles,
    select_moved_poles,
)
from flexsid.workflow.fits.estimators import find_estimator
from flexsid.workflow.fits.nuisance_parameters import (
    ComputedRetainedModes,
    marginalise,
)
from flexsid.workflow.fits.run_warnings import (
    list_result_warnings,
    warn_of_lag,
    warn_of_limits,
    warn_of_moved_poles,
    warn_of_poor_prediction,
    warn_of_priors,
    warn_of_reversed_surfaces,
)
from flexsid.workflow.fits.software_versions import read_versions
from flexsid.workflow.fits.variance_budget import compute_variance_budget


@dataclass(frozen=True, slots=True)
class ComputedRun:
    """Result of an estimation.

    ``held`` are the derivatives that were not free, ``at_limit`` the parameters that converged
    to a physical limit, ``versions`` is the software of the worker. ``modal_std`` are the
    standard deviations due to the modal table, ``condition_std`` those due to mass, inertia,
    airspeed and density, which the covariance does not include; ``shares`` those of the variances
    by their causes.
    """

    estimate: Estimate
    poles: tuple[NamedPole, ...]
    start: str
    warnings: tuple[str, ...]
    residualized: dict[str, float] | None
    prediction_id: int | None
    held: dict[str, float]
    seconds: float
    versions: dict[str, str]
    provenance: Provenance
    adequacy: ModelAdequacy
    symmetry: ModelAdequacy | None
    modal_std: dict[str, float]
    condition_std: dict[str, float]
    shares: dict[str, VarianceShares]
    at_limit: tuple[str, ...] = ()
    retained: ComputedRetainedModes | None = None


def compute_run(task: EstimationTask, report: ReportProgress) -> ComputedRun:
    """Compute one estimation.

    Parameters
    ----------
    task
        Task from ``prepare``.
    report
        Called at every iteration; an exception that it raises (``Cancelled``) ends the run.

    Raises
    ------
    ExtensionFailed
        If the estimator of another package fails.
    """
    began = time.perf_counter()
    estimator = find_estimator(task.method)
    with report_errors(estimator.package):
        fit = estimator.fit(task, report)
    parameters, estimate, spread = fit.parameters, fit.estimate, fit.spread
    overlap = max(maneuver.measured.resolution_overlap for maneuver in task.maneuvers)
    estimate = estimate.scale_covariance(overlap)
    at_limit = find_parameters_at_limits(parameters, estimate.values)
    estimate = estimate.without_std_errors(None if not estimate.outcome.is_optimum else at_limit)
    poles = compute_poles(task, parameters, estimate)
    warnings = [
        *task.warnings,
        *fit.warnings,
        *warn_of_lag(fit.adequacy, task.settings),
        *warn_of_limits(estimate, at_limit),
        *warn_of_priors(estimate, task.priors),
        *warn_of_moved_poles(select_moved_poles(task, poles), task.max_omega),
    ]
    table = parameters.table(estimate.values).named()
    condition_std, shares = compute_variance_budget(task, parameters, estimate, spread, overlap)
    retained = marginalise(task, estimate, spread, shares)
    limited = {name for name, out in zip(estimate.names, at_limit, strict=True) if out}
    if retained is not None:
        warnings += warn_of_poor_prediction(spread)
        of_retained = set(task.mode_names[len(task.structure.modes) :])
        poles = tuple(pole for pole in poles if pole.name not in of_retained)
    estimate = estimate.select([n for n in estimate.names if n not in estimate.nuisance])
    return ComputedRun(
        estimate=estimate,
        poles=poles,
        start=fit.start,
        warnings=(
            *warnings,
            *warn_of_reversed_surfaces(estimate, task.predicted),
            *list_result_warnings(estimate),
        ),
        residualized=task.residualized,
        prediction_id=task.prediction_id,
        held={
            name: value
            for name, value in table.items()
            if name not in estimate.names and name not in task.nuisance_names
        },
        retained=retained,
        at_limit=tuple(name for name in estimate.names if name in limited),
        seconds=time.perf_counter() - began,
        versions=read_versions(),
        provenance=task.provenance,
        adequacy=fit.adequacy,
        symmetry=fit.symmetry,
        modal_std=task.modal_std,
        condition_std=condition_std,
        shares=shares,
    )
