"""Equation-error estimate of a task, also as starting values of the iterative fits."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from flexsid.errors import BadInput, NotIdentifiable
from flexsid.records.run import Method, Progress, ReportProgress
from flexsid.sysid.estimation.agreement import fuse_estimates
from flexsid.sysid.estimation.equation_error import equation_error
from flexsid.sysid.estimation.estimate import Estimate, Outcome
from flexsid.sysid.estimation.experiment import LONGEST_DELAY_S, Parameters
from flexsid.sysid.estimation.flight_noise import AssignedCommands
from flexsid.sysid.estimation.leakage import add_errors, fit_free_motion
from flexsid.sysid.estimation.marginal_equation_error import marginal_equation_error
from flexsid.sysid.estimation.reconstruction import ReconstructedMotion, reconstruct_motion
from flexsid.sysid.estimation.starting_values import estimate_delays, regress_parts
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.derivatives import DerivativeTable
from flexsid.sysid.spectra.measured_spectra import MeasuredSpectra
from flexsid.workflow.fits.estimation_task import (
    EstimationTask,
    ManeuverData,
    build_experiments,
    build_fit_settings,
    get_first_start,
    regularise_start,
    select_free_parameters,
)

# --- Equation-error estimate of a task: reconstructed motion, and one regression per maneuver -----

_MAX_SCALE_STD = 0.005  # standard deviation of the sensors' scale factors that raises a warning


@dataclass(frozen=True, slots=True)
class EquationErrorFit:
    """Estimate by equation error; ``out_of_band`` are the modes reconstructed in any maneuver."""

    estimate: Estimate
    out_of_band: tuple[int, ...]
    warnings: tuple[str, ...]


def fit_equation_error(task: EstimationTask, parameters: Parameters) -> EquationErrorFit:
    """Estimate all maneuvers by equation error.

    From records without an assumption about their ends the free motion from the states there is
    subtracted before, which output error estimates from these values; its errors are included.
    """
    free = [data.measured.free_ends for data in task.maneuvers]
    if not any(free):
        return fit_whole_maneuvers(task, parameters)
    experiments = [one for one in build_experiments(task, Method.OE) if one.free_ends]
    started = replace(parameters, start=estimate_starting_values(task, parameters))
    settings = build_fit_settings(replace(task, shape_errors={}))
    motion = fit_free_motion(experiments, started, settings)

    def fit_without(
        outputs: Iterable[np.ndarray], parameters: Parameters = started
    ) -> EquationErrorFit:
        each = iter(outputs)
        data = tuple(
            _subtract_outputs(one, next(each)) if is_free else one
            for one, is_free in zip(task.maneuvers, free, strict=True)
        )
        return fit_whole_maneuvers(replace(task, corrected=data), parameters)

    found = fit_without(motion.outputs)
    estimate = found.estimate
    if not motion.converged:
        message = "The states at the ends of the record have not converged."
        estimate = replace(estimate, outcome=Outcome.ITERATION_LIMIT, message=message)
    near = replace(parameters, start=estimate.values)
    changes = [
        fit_without(map(np.add, motion.outputs, error), near).estimate.values - estimate.values
        for error in zip(*motion.errors, strict=True)
    ]
    changes = np.array(changes).reshape(-1, estimate.values.size)
    records = np.flatnonzero(free).tolist()
    return replace(found, estimate=add_errors(estimate, changes, motion.noise, records))


def estimate_starting_values(task: EstimationTask, parameters: Parameters) -> np.ndarray:
    """Estimate starting values of the derivatives by equation error."""
    experiments = build_experiments(task, Method.OE)
    if task.nuisance is None and all(one.free_ends for one in experiments):
        return regress_parts(experiments, parameters)
    return fit_whole_maneuvers(task, parameters).estimate.values


def _subtract_outputs(data: ManeuverData, outputs: np.ndarray) -> ManeuverData:
    """Subtract known motion from the spectra of a record; what remains ends at rest."""
    spectra = data.measured
    rest = replace(spectra.outputs, values=spectra.outputs.values - outputs)
    measured = replace(spectra, outputs=rest, free_ends=False, record_ends_s=())
    return replace(data, measured=measured)


def fit_whole_maneuvers(task: EstimationTask, parameters: Parameters) -> EquationErrorFit:
    """Estimate all maneuvers by equation error as if they began and ended at rest."""
    labels = [data.label for data in task.maneuvers]
    estimates, warnings = [], []
    if task.nuisance is None:
        out_of_band: dict[int, None] = {}
        for data in task.maneuvers:
            motion, added = reconstruct_with_out_of_band_modes(data)
            out_of_band |= dict.fromkeys(added)
            warnings += warn_of_sensor_noise(data, motion)
            spectra = data.measured
            estimates.append(
                equation_error(
                    data.model,
                    motion,
                    spectra.inputs,
                    parameters,
                    input_noise=spectra.input_noise,
                    commands=assign_commands(spectra),
                )
            )
        fused = fuse_estimates(estimates, labels)
        return EquationErrorFit(fused, tuple(out_of_band), tuple(warnings))
    # Every maneuver has its share of the prior, so that the fused estimate has all of it.
    priors = {
        name: (mean, std * np.sqrt(len(task.maneuvers)))
        for name, (mean, std) in task.nuisance.list_priors(task.nuisance_names, task.spread).items()
    }
    for data in task.maneuvers:
        spectra = data.measured
        estimate, motion = marginal_equation_error(
            data.model,
            spectra.outputs,
            spectra.instruments,
            spectra.inputs,
            parameters,
            priors,
            len(task.structure.modes),
            spectra.output_noise,
            spectra.input_noise,
        )
        warnings += warn_of_sensor_noise(data, motion)
        estimates.append(estimate)
    fused = replace(fuse_estimates(estimates, labels), nuisance=frozenset(task.nuisance_names))
    return EquationErrorFit(fused, (), tuple(warnings))


def assign_commands(spectra: MeasuredSpectra) -> AssignedCommands | None:
    """Return the command of every harmonic; None where some are not recorded."""
    excited = spectra.excited
    if excited.commands is None or (excited.assigned_input < 0).any():
        return None
    own = np.take_along_axis(excited.commands.values, excited.assigned_input[:, None], axis=1)
    return AssignedCommands(excited.assigned_input, own[:, 0])


def reconstruct_with_out_of_band_modes(
    data: ManeuverData,
) -> tuple[ReconstructedMotion, tuple[int, ...]]:
    """Reconstruct the model's modes with as many out-of-band modes as the sensors resolve.

    An out-of-band mode reduces redundancy: where the noise of a sensor is then not
    identifiable from the others, its noise would be attributed to motion.
    """
    own = len(data.model.modes.numbers)
    spectra = data.measured
    for count in range(len(data.extended_model.modes.numbers), own, -1):
        model = data.extended_model.with_modes(count)
        try:
            motion = _reconstruct(model, spectra)
        except NotIdentifiable:
            continue
        if not motion.assumed:
            return motion.select_motions(model.n_rigid + own), model.modes.numbers[own:]
    return _reconstruct(data.model, spectra), ()


def _reconstruct(model: AeroelasticModel, spectra: MeasuredSpectra) -> ReconstructedMotion:
    return reconstruct_motion(
        model,
        spectra.outputs,
        spectra.instruments,
        guess=spectra.output_noise,
        inputs=spectra.inputs,
    )


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
