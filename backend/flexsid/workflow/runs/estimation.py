"""Estimation: a run from request to result.

``prepare`` reads everything a run needs, ``compute`` is a pure function that may
run in any process, ``keep`` stores what came out.
"""

from __future__ import annotations

import numpy as np

from flexsid.errors import BadInput
from flexsid.records.aircraft import Aircraft
from flexsid.records.axes import symmetry_of
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
from flexsid.storage.arrays import describe
from flexsid.storage.store import Store
from flexsid.sysid.estimation.diagnostics import output_quality, parameter_quality
from flexsid.sysid.estimation.estimate import Estimate
from flexsid.sysid.estimation.parameters import select_parameters
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.derivatives import DerivativeTable
from flexsid.workflow.aircraft.aircraft_models import (
    OutputDefinition,
    build_model,
    default_outputs,
    define_outputs,
)
from flexsid.workflow.aircraft.derivative_predictions import best_prediction
from flexsid.workflow.aircraft.longitudinal import lateral_surfaces, require_longitudinal
from flexsid.workflow.measurements.maneuver_spectra import read_measurement
from flexsid.workflow.measurements.symmetric_motion import require_symmetric_motion
from flexsid.workflow.modal_data.aligned_modes import (
    AircraftModes,
    companion_modes,
    find_modal_tables,
    load_modes,
)
from flexsid.workflow.model_structures.model_structures import brought_to
from flexsid.workflow.runs.computation import ComputedRun, EstimationTask, ManeuverTask, compute
from flexsid.workflow.runs.request_warnings import check_extras, doubts
from flexsid.workflow.runs.run_identity import provenance_of
from flexsid.workflow.runs.starts import (
    is_residualized,
    predicted_tables,
    priors_of,
    starting_tables,
)

__all__ = ["compute", "keep", "prepare"]


def prepare(store: Store, run: EstimationRun) -> EstimationTask:
    """Read all that a run needs.

    Raises
    ------
    BadInput
        If the structure does not fit the maneuver: unknown modes, inputs or
        outputs, a band without lines, a sensor without mode shape.
    """
    with store.reading():
        return _prepared(store, run)


def _prepared(store: Store, run: EstimationRun) -> EstimationTask:
    settings = run.settings
    ids = tuple(dict.fromkeys((run.maneuver_id, *settings.together_with)))
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
    structure, aircraft = brought_to(store, run.structure, aircraft, first)
    modal, damping = find_modal_tables(
        store, first.aircraft_id, run.modal_table_id, run.damping_table_id
    )
    modes = load_modes(store, modal, damping)
    inputs, outputs = inputs_and_outputs(store, first, aircraft, structure)
    data = tuple(
        _maneuver_data(store, maneuver, aircraft, structure, modes, inputs, outputs, settings)
        for maneuver in maneuvers
    )
    prediction = best_prediction(
        store, first.aircraft_id, run.prediction_id, structure.modes, inputs
    )
    predicted = predicted_tables(store, prediction, run, first, aircraft, modes, inputs)
    starts = starting_tables(store, run, predicted, inputs)
    check_extras(run.method, structure.also_free)
    free = _check_names(data[0].model, starts, structure, settings)
    assumed = modes.warnings if structure.modes else ()
    return EstimationTask(
        method=run.method,
        settings=settings,
        structure=structure,
        flown=data,
        mode_names=tuple(modes.names[number] for number in structure.modes),
        starts=starts,
        predicted=next(iter(predicted.values()), None),
        priors=priors_of(predicted, free, settings),
        try_equation_error=settings.start in (Start.BEST, Start.EQUATION_ERROR),
        residualized=next((t.named() for n, t in predicted.items() if is_residualized(n)), None),
        prediction_id=None if prediction is None else prediction.id,
        warnings=(*assumed, *doubts(run, first, data[0], modes)),
        provenance=provenance_of(
            store,
            run,
            first.aircraft_id,
            {
                "modal table": (modal.id, None if damping is None else damping.id),
                "prediction": (None if prediction is None else prediction.id,),
            },
        ),
    )


def inputs_and_outputs(
    store: Store, maneuver: Maneuver, aircraft: Aircraft, structure: Structure
) -> tuple[tuple[str, ...], tuple[OutputDefinition, ...]]:
    """Inputs and outputs as the structure names them, else all that a longitudinal model can use.

    Antisymmetric surfaces that were recorded besides are left out.
    """
    channels = {c.name: c.role for c in store.channels.find(maneuver_id=maneuver.id)}
    recorded = tuple(name for name, role in channels.items() if role is Role.INPUT)
    symmetric = tuple(n for n in recorded if symmetry_of(aircraft, n) != "antisymmetric")
    inputs = structure.inputs or symmetric or recorded
    separated = bool(lateral_surfaces(maneuver, aircraft, inputs))
    names = structure.outputs or default_outputs(aircraft, channels, separated=separated)
    return inputs, define_outputs(aircraft, names)


def keep(
    store: Store, run_id: int, attempt: int, computed: ComputedRun, worker: str = ""
) -> EstimationRun:
    """Store a result, all of it or nothing, unless the attempt no longer counts."""
    estimate = computed.estimate
    bulk = [describe(estimate.corrected_covariance)]
    for block in estimate.lines:
        bulk += [describe(block.omega, "rad/s"), describe(block.measured), describe(block.fitted)]
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
            parameters=_parameter_rows(computed),
            covariance=covariance,
            fit=_fit(computed),
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


def _maneuver_data(
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
    companions = companion_modes(modes, fuel, own, measurement.highest, len(outputs))
    shapes = modes.table.at(fuel).select((*own, *companions))
    extended = build_model(aircraft, maneuver.condition, shapes, inputs, outputs)
    return ManeuverTask(maneuver.label, extended.with_modes(len(own)), extended, measurement)


def _check_names(
    model: AeroelasticModel,
    starts: dict[str, DerivativeTable],
    structure: Structure,
    settings: RunSettings,
) -> tuple[str, ...]:
    """Free parameters by name; what does not fit is refused before a worker finds out."""
    empty = DerivativeTable.from_names(model.modes.numbers, model.inputs, {})
    delays = tuple(f"delay_{name}" for name in model.outputs) if structure.free_delays else ()
    extras = tuple(dict.fromkeys((*delays, *structure.also_free)))
    start = next(iter(starts.values()), empty)
    parameters = select_parameters(start, structure.free, model.outputs, extras, structure.fixed)
    for name in settings.priors:
        if name not in parameters.names:
            raise BadInput(
                f"the prior of '{name}' has no free parameter to act on",
                code="unknown-parameter",
                name=name,
            )
    return parameters.names


def _parameter_rows(computed: ComputedRun) -> tuple[ParameterEstimate, ...]:
    estimate = computed.estimate

    def why(name: str, error: float) -> str | None:
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
            no_error=why(quality.name, quality.std_error),
        )
        for quality, value, start in zip(
            parameter_quality(estimate), estimate.values, estimate.start, strict=True
        )
    )


def _fit(computed: ComputedRun) -> Fit:
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
        r_squared=_r_squared(estimate),
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
            for quality in output_quality(block)
        ),
    )


def _r_squared(estimate: Estimate) -> dict[str, float]:
    """Per output over all blocks: lines of several inputs count together."""
    error: dict[str, float] = {}
    power: dict[str, float] = {}
    for block in estimate.lines:
        for column, output in enumerate(block.outputs):
            z, y = block.measured[:, column], block.fitted[:, column]
            error[output] = error.get(output, 0.0) + float(np.sum(np.abs(z - y) ** 2))
            power[output] = power.get(output, 0.0) + float(np.sum(np.abs(z) ** 2))
    return {name: 1.0 - error[name] / power[name] for name in power if power[name] > 0}
