"""Equation-error estimate of a task, also as starting values of the iterative fits."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from flexsid.errors import BadInput, NotIdentifiable
from flexsid.records.run import Method, Progress, ReportProgress
from flexsid.sysid.estimation.estimate import Estimate
from flexsid.sysid.estimation.experiment import LONGEST_DELAY_S, Parameters
from flexsid.sysid.model.derivatives import DerivativeTable
from flexsid.sysid.regression.joint_equation_error import (
    EquationErrorFit,
    RetainedPrior,
    fit_free_maneuvers,
    fit_whole_maneuvers,
)
from flexsid.sysid.regression.reconstruction import ReconstructedMotion
from flexsid.sysid.regression.starting_values import (
    estimate_delays,
    regress_parts,
    regularise_start,
)
from flexsid.workflow.fits.estimation_task import (
    EstimationTask,
    ManeuverData,
    build_experiments,
    build_fit_settings,
    get_first_start,
    refit_until_consistent,
    select_free_parameters,
)

# --- Equation-error estimate of a task: reconstructed motion, and one regression per maneuver -----

_MAX_SCALE_STD = 0.005  # standard deviation of the sensors' scale factors that raises a warning


def fit_equation_error(task: EstimationTask, parameters: Parameters) -> EquationErrorFit:
    """Estimate all maneuvers by equation error.

    From records without an assumption about their ends the free motion from the states there is
    subtracted before, which output error estimates from these values; its errors are included.
    """
    if not any(data.measured.free_ends for data in task.maneuvers):
        return fit_whole_maneuvers(task.maneuvers, parameters, _build_prior(task))
    started = replace(parameters, start=estimate_starting_values(task, parameters))
    settings = build_fit_settings(replace(task, shape_errors={}))
    return fit_free_maneuvers(task.maneuvers, started, _build_prior(task), settings)


def fit_consistent_equation_error(
    task: EstimationTask, report: ReportProgress = lambda progress: None
) -> tuple[EstimationTask, Parameters, EquationErrorFit]:
    """Estimate all maneuvers by equation error with the spread of the prior that they show.

    Returns
    -------
    task, parameters, fit
        The task with that spread, the free parameters with their starting values, and the fit.
    """
    report(Progress(message="Reconstructing motion from the sensors"))
    parameters = select_free_parameters(task, get_first_start(task), ())
    fit = fit_equation_error(task, parameters)

    def fit_again(task: EstimationTask, estimate: Estimate) -> Estimate:
        nonlocal fit
        message = f"Reconstructing motion with a prior spread of {task.spread:.2g}"
        report(Progress(message=message))
        fit = fit_equation_error(task, replace(parameters, start=estimate.values))
        return replace(fit.estimate, start=parameters.start)

    task, estimate = refit_until_consistent(task, fit.estimate, fit_again)
    return task, parameters, replace(fit, estimate=estimate)


def _build_prior(task: EstimationTask) -> RetainedPrior | None:
    if task.nuisance is None:
        return None
    priors = task.list_priors().widen_to_independent()
    by_name = {name: priors[name] for name in task.nuisance_names}
    return RetainedPrior(by_name, len(task.structure.modes))


def estimate_starting_values(task: EstimationTask, parameters: Parameters) -> np.ndarray:
    """Estimate starting values of the derivatives by equation error."""
    experiments = build_experiments(task, Method.OE)
    if task.nuisance is None and all(one.free_ends for one in experiments):
        return regress_parts(experiments, parameters)
    return fit_whole_maneuvers(task.maneuvers, parameters, _build_prior(task)).estimate.values


def list_sensor_warnings(task: EstimationTask, fit: EquationErrorFit) -> tuple[str, ...]:
    """List the warnings of assumed sensor noise and inconsistent scale factors."""
    pairs = zip(task.maneuvers, fit.motions, strict=True)
    return tuple(text for data, motion in pairs for text in warn_of_sensor_noise(data, motion))


def warn_of_sensor_noise(data: ManeuverData, motion: ReconstructedMotion) -> list[str]:
    """Warn of assumed sensor noise and of inconsistent scale factors of a maneuver."""
    warnings = []
    if motion.assumed:
        known = np.isfinite(data.measured.output_noise).all()
        source = (
            "in the ratio that the aircraft record gives"
            if known
            else "in the ratio of the scatter about smooth responses (of the signals where inputs "
            "share their frequencies), because the aircraft record does not give it (noise_std)"
        )
        warnings.append(
            f"{data.label}: {len(motion.noise)} outputs are too few to estimate the noise of "
            f"{', '.join(motion.assumed)}. It was assumed {source}; the standard errors include a "
            "factor of two in it and may exceed small derivatives. Add sensors as outputs, or "
            "compare with OE."
        )
    if motion.scale_std > _MAX_SCALE_STD:
        warnings.append(
            f"{data.label}: the sensors disagree on the motion as if their scale factors were "
            f"wrong by {100.0 * motion.scale_std:.1f} % (standard deviation); the standard errors "
            "include it. Check their calibration and delays, and whether a mode is missing."
        )
    return warnings


# --- Starting values of the iterative fits: equation error, and delays from the sensors -----------

EQUATION_ERROR = "equation error"


def collect_starting_points(
    task: EstimationTask, report: ReportProgress, *, with_equation_error: bool = True
) -> dict[str, Parameters]:
    """Collect the start parameters by name.

    Parameters
    ----------
    with_equation_error
        Whether equation error is among them, if the task tries it.

    Raises
    ------
    BadInput
        If there are none.
    """
    tables = dict(task.starts)
    if task.try_equation_error and with_equation_error:
        report(Progress(message="Estimating starting values by equation error"))
        parameters = select_free_parameters(task, get_first_start(task), ())
        try:
            values = estimate_starting_values(task, parameters)
            name, table = _regularise_start(task, parameters, values)
            tables = {name: table, **tables}
        except NotIdentifiable:
            if not tables:
                raise
    if not tables:
        raise BadInput(
            "no starting values: the aircraft has no prediction for these derivatives; import "
            "one, or start from equation error or another run",
            code="no-start",
        )
    candidates = {
        name: select_free_parameters(task, table, task.extras) for name, table in tables.items()
    }
    delayed = [k for k, e in enumerate(next(iter(candidates.values())).extras) if e.kind == "delay"]
    if delayed:
        report(Progress(message="Estimating delays from the redundancy of the sensors"))
        candidates = _insert_start_delays(task, candidates, delayed)
    return candidates


def _regularise_start(
    task: EstimationTask, parameters: Parameters, values: np.ndarray
) -> tuple[str, DerivativeTable]:
    """Return name and table of the start by equation error, out-of-band modes regularised."""
    if not task.out_of_band:
        return EQUATION_ERROR, parameters.table(values)
    names = ", ".join(task.mode_names[k] for k in task.out_of_band)
    source = "in vacuo" if task.predicted is None else "predicted"
    table = regularise_start(parameters, values, task.out_of_band, task.predicted)
    return f"{EQUATION_ERROR}, {names} as {source}", table


def _insert_start_delays(
    task: EstimationTask, candidates: dict[str, Parameters], delayed: list[int]
) -> dict[str, Parameters]:
    """Start the free delays at values estimated from the redundancy of the sensors."""
    first = task.maneuvers[0]
    spectra = first.measured
    unknown = {f"{name}, delays from zero": one for name, one in candidates.items()}
    try:
        delays = estimate_delays(first.model, spectra.inputs, spectra.outputs, spectra.instruments)
    except NotIdentifiable:
        return unknown
    if np.max(np.abs(delays)) > LONGEST_DELAY_S:
        return unknown  # too few sensors to resolve delays from motion
    result = {}
    for name, parameters in candidates.items():
        start = parameters.start.copy()
        for k in delayed:
            start[parameters.rows.size + k] = delays[parameters.extras[k].output]
        result[name] = replace(parameters, start=start)
    return result
