"""Estimation: a run from request to result.

``prepare`` reads everything a run needs, ``compute_run`` is a pure function for any
process, ``store_result`` stores the result.
"""

from __future__ import annotations

import numpy as np

from flexsid.errors import BadInput
from flexsid.records.aircraft import Aircraft
from flexsid.records.axes import get_symmetry
from flexsid.records.finite import finite_or_none
from flexsid.records.maneuver import Maneuver, Role
from flexsid.records.model_structure import Structure
from flexsid.records.run import (
    EstimationRun,
    Fit,
    FitBlock,
    Iteration,
    OutputQuality,
    ParameterEstimate,
    Pole,
    RunResult,
    RunSettings,
    Start,
)
from flexsid.storage import queue
from flexsid.storage.arrays import describe_array
from flexsid.storage.store import Store
from flexsid.sysid.estimation.diagnostics import compute_output_fit, compute_parameter_quality
from flexsid.sysid.estimation.estimate import Estimate
from flexsid.sysid.estimation.parameters import select_parameters
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.derivatives import DerivativeTable
from flexsid.workflow.aircraft.aircraft_models import (
    OutputDefinition,
    build_model,
    define_outputs,
    list_default_outputs,
)
from flexsid.workflow.aircraft.derivative_predictions import select_prediction
from flexsid.workflow.aircraft.longitudinal import list_lateral_surfaces, require_longitudinal
from flexsid.workflow.measurements.maneuver_spectra import read_measurement
from flexsid.workflow.measurements.symmetric_motion import require_symmetric_motion
from flexsid.workflow.modal_data.aligned_modes import (
    AircraftModes,
    find_modal_tables,
    load_modes,
    select_out_of_band_modes,
)
from flexsid.workflow.model_structures.model_structures import resolve_structure
from flexsid.workflow.runs.computation import ComputedRun, EstimationTask, ManeuverTask, compute_run
from flexsid.workflow.runs.run_identity import hash_provenance
from flexsid.workflow.runs.run_warnings import check_extras, list_request_warnings
from flexsid.workflow.runs.starts import (
    build_predicted_tables,
    collect_priors,
    is_residualized,
    select_starting_tables,
)

__all__ = ["compute_run", "prepare", "store_result"]


def prepare(store: Store, run: EstimationRun) -> EstimationTask:
    """Read everything that a run needs.

    Raises
    ------
    BadInput
        If the model structure does not fit the maneuver: unknown modes, inputs or
        outputs, a band without frequencies, a sensor without mode shape.
    """
    with store.reading():
        return _prepare(store, run)


def _prepare(store: Store, run: EstimationRun) -> EstimationTask:
    settings = run.settings
    ids = tuple(dict.fromkeys((run.maneuver_id, *settings.additional_maneuver_ids)))
    maneuvers = [store.maneuvers.get(number) for number in ids]
    first = maneuvers[0]
    for maneuver in maneuvers:
        require_longitudinal(maneuver)
    aircraft = store.aircraft.get(first.aircraft_id)
    for other in maneuvers[1:]:
        if other.aircraft_id != first.aircraft_id:
            raise BadInput(
                f"maneuver {other.id} is of another aircraft than maneuver {first.id}",
                code="wrong-aircraft",
            )
    structure, aircraft = resolve_structure(store, run.structure, aircraft, first)
    modal, damping = find_modal_tables(
        store, first.aircraft_id, run.modal_table_id, run.damping_table_id
    )
    modes = load_modes(store, modal, damping)
    inputs, outputs = select_inputs_and_outputs(store, first, aircraft, structure)
    data = tuple(
        _prepare_maneuver(store, maneuver, aircraft, structure, modes, inputs, outputs, settings)
        for maneuver in maneuvers
    )
    prediction = select_prediction(
        store, first.aircraft_id, run.prediction_id, structure.modes, inputs
    )
    predicted = build_predicted_tables(store, prediction, run, first, aircraft, modes, inputs)
    starts = select_starting_tables(store, run, predicted, inputs)
    check_extras(run.method, structure.extra_parameters)
    free = _check_names(data[0].model, starts, structure, settings)
    assumed = modes.warnings if structure.modes else ()
    request_warnings = list_request_warnings(
        run, first, data[0].model, data[0].measurement.max_omega, modes.names, modes.symmetric
    )
    return EstimationTask(
        method=run.method,
        settings=settings,
        structure=structure,
        maneuver_tasks=data,
        mode_names=tuple(modes.names[number] for number in structure.modes),
        starts=starts,
        predicted=next(iter(predicted.values()), None),
        priors=collect_priors(predicted, free, settings),
        try_equation_error=settings.start in (Start.BEST, Start.EQUATION_ERROR),
        residualized=next((t.named() for n, t in predicted.items() if is_residualized(n)), None),
        prediction_id=None if prediction is None else prediction.id,
        warnings=(*assumed, *request_warnings),
        provenance=hash_provenance(
            store,
            run,
            first.aircraft_id,
            {
                "modal table": (modal.id, None if damping is None else damping.id),
                "prediction": (None if prediction is None else prediction.id,),
            },
        ),
    )


def select_inputs_and_outputs(
    store: Store, maneuver: Maneuver, aircraft: Aircraft, structure: Structure
) -> tuple[tuple[str, ...], tuple[OutputDefinition, ...]]:
    """Select the inputs and outputs of the model structure, by default all longitudinal ones.

    Recorded antisymmetric surfaces are excluded by default.
    """
    channels = {c.name: c.role for c in store.channels.find(maneuver_id=maneuver.id)}
    recorded = tuple(name for name, role in channels.items() if role is Role.INPUT)
    symmetric = tuple(n for n in recorded if get_symmetry(aircraft, n) != "antisymmetric")
    inputs = structure.inputs or symmetric or recorded
    separated = bool(list_lateral_surfaces(maneuver, aircraft, inputs))
    names = structure.outputs or list_default_outputs(aircraft, channels, separated=separated)
    return inputs, define_outputs(aircraft, names)


def store_result(
    store: Store, run_id: int, attempt: int, computed: ComputedRun, worker: str = ""
) -> EstimationRun:
    """Store a result in one transaction, unless the attempt was superseded."""
    estimate = computed.estimate
    bulk = [describe_array(estimate.corrected_covariance)]
    for block in estimate.lines:
        bulk += [
            describe_array(block.omega, "rad/s"),
            describe_array(block.measured),
            describe_array(block.fitted),
        ]
    with store.transaction():
        covariance, *names = store.arrays.put_many(bulk)
        blocks = tuple(
            FitBlock(
                name=block.name,
                outputs=block.outputs,
                arrays=dict(
                    zip(("omega", "measured", "fitted"), names[3 * k : 3 * k + 3], strict=True)
                ),
            )
            for k, block in enumerate(estimate.lines)
        )
        result = RunResult(
            parameters=_build_parameters(computed),
            covariance=covariance,
            fit=_build_fit(computed),
            poles=tuple(
                Pole(
                    real=pole.value.real,
                    imag=pole.value.imag,
                    name=pole.name,
                    real_std=finite_or_none(pole.real_std),
                    imag_std=finite_or_none(pole.imag_std),
                    frequency=pole.frequency,
                    frequency_std=finite_or_none(pole.frequency_std),
                    damping=pole.damping,
                    damping_std=finite_or_none(pole.damping_std),
                )
                for pole in computed.poles
            ),
            blocks=blocks,
            residualized_prediction=computed.residualized,
            prediction_id=computed.prediction_id,
            held=computed.held,
        )
        return queue.finish(
            store, run_id, attempt, result, computed.versions, worker, computed.provenance
        )


def _prepare_maneuver(
    store: Store,
    maneuver: Maneuver,
    aircraft: Aircraft,
    structure: Structure,
    modes: AircraftModes,
    inputs: tuple[str, ...],
    outputs: tuple[OutputDefinition, ...],
    settings: RunSettings,
) -> ManeuverTask:
    require_symmetric_motion(store, maneuver, aircraft, inputs, outputs)
    measurement = read_measurement(store, maneuver, aircraft, inputs, outputs, settings.band_hz)
    fuel = maneuver.condition.fuel_fraction
    own = structure.modes
    out_of_band = select_out_of_band_modes(modes, fuel, own, measurement.max_omega, len(outputs))
    shapes = modes.table.at(fuel).select((*own, *out_of_band))
    extended = build_model(aircraft, maneuver.condition, shapes, inputs, outputs)
    return ManeuverTask(maneuver.label, extended.with_modes(len(own)), extended, measurement)


def _check_names(
    model: AeroelasticModel,
    starts: dict[str, DerivativeTable],
    structure: Structure,
    settings: RunSettings,
) -> tuple[str, ...]:
    """Return the names of the free parameters; a prior without a free parameter is refused."""
    empty = DerivativeTable.from_names(model.modes.numbers, model.inputs, {})
    delays = tuple(f"delay_{name}" for name in model.outputs) if structure.free_delays else ()
    extras = tuple(dict.fromkeys((*delays, *structure.extra_parameters)))
    start = next(iter(starts.values()), empty)
    parameters = select_parameters(start, structure.free, model.outputs, extras, structure.fixed)
    for name in settings.priors:
        if name not in parameters.names:
            raise BadInput(
                f"the prior of '{name}' has no free parameter; free it or remove the prior",
                code="unknown-parameter",
                name=name,
            )
    return parameters.names


def _build_parameters(computed: ComputedRun) -> tuple[ParameterEstimate, ...]:
    estimate = computed.estimate

    def explain_missing_error(name: str, error: float) -> str | None:
        if np.isfinite(error):
            return None
        if name in computed.at_limit:
            return "at its limit"
        return "not identifiable" if estimate.outcome.is_optimum else "not converged"

    return tuple(
        ParameterEstimate(
            name=quality.name,
            value=float(value),
            std_error=finite_or_none(quality.std_error),
            start=float(start),
            cramer_rao=finite_or_none(quality.cramer_rao),
            insensitivity=finite_or_none(quality.insensitivity),
            no_error=explain_missing_error(quality.name, quality.std_error),
        )
        for quality, value, start in zip(
            compute_parameter_quality(estimate), estimate.values, estimate.start, strict=True
        )
    )


def _build_fit(computed: ComputedRun) -> Fit:
    estimate = computed.estimate
    return Fit(
        outcome=estimate.outcome.value,
        message=estimate.message,
        iterations=tuple(
            Iteration(
                iteration=step.iteration,
                cost=step.cost,
                step=finite_or_none(step.step) or 0.0,
                stage=step.stage,
            )
            for step in estimate.steps
        ),
        cost=estimate.steps[-1].cost if estimate.steps else None,
        r_squared=_compute_r_squared(estimate),
        n_lines=sum(block.omega.size for block in estimate.lines),
        n_parameters=len(estimate.names),
        seconds=computed.seconds,
        start=computed.start,
        warnings=computed.warnings,
        quality=tuple(
            OutputQuality(
                block=block.name,
                output=quality.output,
                r_squared=quality.r_squared,
                theil=quality.theil,
                whiteness=quality.whiteness,
            )
            for block in estimate.lines
            for quality in compute_output_fit(block)
        ),
    )


def _compute_r_squared(estimate: Estimate) -> dict[str, float]:
    """Compute R^2 per output over the frequencies of all blocks."""
    error: dict[str, float] = {}
    power: dict[str, float] = {}
    for block in estimate.lines:
        for column, output in enumerate(block.outputs):
            z, y = block.measured[:, column], block.fitted[:, column]
            error[output] = error.get(output, 0.0) + float(np.sum(np.abs(z - y) ** 2))
            power[output] = power.get(output, 0.0) + float(np.sum(np.abs(z) ** 2))
    return {name: 1.0 - error[name] / power[name] for name in power if power[name] > 0}
