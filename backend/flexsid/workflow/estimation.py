"""Estimation: a run from request to result.

``prepare`` reads everything a run needs, ``compute`` is a pure function that may
run in any process, ``keep`` stores what came out.
"""

from __future__ import annotations

import platform

import numpy as np
import scipy

from flexsid import __version__
from flexsid.errors import BadInput
from flexsid.records.aircraft import Aircraft
from flexsid.records.maneuver import Maneuver, Role
from flexsid.records.run import (
    EstimationRun,
    Fit,
    FitBlock,
    Iteration,
    ParameterEstimate,
    Pole,
    RunResult,
)
from flexsid.storage import queue
from flexsid.storage.store import Store
from flexsid.sysid.estimation.estimate import Estimate
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.derivatives import DerivativeTable, derivative_names
from flexsid.sysid.model.reduction import residualize
from flexsid.sysid.signals import FrequencyData
from flexsid.workflow.computation import RESIDUALIZED, Computed, Task, compute
from flexsid.workflow.models import (
    build_model,
    default_outputs,
    define_outputs,
    flight_condition,
    input_correction,
    output_instrument,
)
from flexsid.workflow.modes import AircraftModes, companion_modes, find_modal_tables, load_modes
from flexsid.workflow.predictions import best_prediction, predicted_modes, prediction_at
from flexsid.workflow.transforms import Lines, maneuver_lines, spectra_of

__all__ = ["compute", "keep", "prepare"]


def prepare(store: Store, run: EstimationRun) -> Task:
    """Read all that a run needs.

    Raises
    ------
    BadInput
        If the structure does not fit the maneuver: unknown modes, inputs or
        outputs, a band without lines, a sensor without mode shape.
    """
    maneuver = store.maneuvers.get(run.maneuver_id)
    aircraft = store.aircraft.get(maneuver.aircraft_id)
    structure = run.structure
    channels = {c.name: c.role for c in store.channels.find(maneuver_id=run.maneuver_id)}
    inputs = structure.inputs or tuple(n for n, role in channels.items() if role is Role.INPUT)
    _check_recorded(inputs, channels, Role.INPUT)
    outputs = define_outputs(aircraft, structure.outputs or default_outputs(aircraft, channels))
    all_modes, damping_warnings = _modes(store, run, maneuver)
    fuel = maneuver.condition.fuel_fraction
    lines = _owned_by(maneuver_lines(maneuver, run.settings.band_hz), inputs)
    companions = companion_modes(all_modes, fuel, structure.modes, lines.omega[-1], len(outputs))
    extended = build_model(
        aircraft,
        maneuver.condition,
        all_modes.table.at(fuel).select((*structure.modes, *companions)),
        inputs,
        outputs,
    )
    model = extended.with_modes(len(structure.modes))
    responses = [output_instrument(aircraft, o).response(lines.omega) for o in outputs]
    return Task(
        method=run.method,
        settings=run.settings,
        structure=structure,
        model=model,
        companions=extended,
        mode_names=tuple(all_modes.names[number] for number in structure.modes),
        instruments=np.stack(responses, axis=1),
        owner=lines.owner,
        inputs=_true_deflections(store, maneuver, aircraft, inputs, lines),
        outputs=spectra_of(store, maneuver, aircraft, model.outputs, lines),
        commands=_commands(store, maneuver, aircraft, inputs, channels, lines),
        predictions=_predictions(store, run, maneuver, aircraft, all_modes, inputs),
        warnings=(*damping_warnings, *_out_of_band(model, lines, all_modes)),
    )


def keep(store: Store, run_id: int, attempt: int, computed: Computed) -> EstimationRun:
    """Store a result, all of it or nothing, unless the attempt no longer counts."""
    estimate = computed.estimate
    with store.transaction():
        blocks = tuple(
            FitBlock(
                name=block.name,
                outputs=block.outputs,
                arrays={
                    "omega": store.arrays.put(block.omega, "rad/s"),
                    "measured": store.arrays.put(block.measured),
                    "fitted": store.arrays.put(block.fitted),
                },
            )
            for block in estimate.lines
        )
        result = RunResult(
            parameters=_parameter_rows(estimate),
            covariance=store.arrays.put(estimate.corrected_covariance),
            fit=_fit(computed),
            poles=tuple(
                Pole(
                    real=pole.value.real,
                    imag=pole.value.imag,
                    name=pole.name,
                    real_std=_finite(pole.real_std),
                    imag_std=_finite(pole.imag_std),
                )
                for pole in computed.poles
            ),
            blocks=blocks,
            residualized_prediction=computed.residualized,
            held=computed.held,
        )
        return queue.finish(store, run_id, attempt, result, versions())


def versions() -> dict[str, str]:
    """Software that made a result."""
    return {
        "flexsid": __version__,
        "python": platform.python_version(),
        "numpy": np.__version__,
        "scipy": scipy.__version__,
    }


def _check_recorded(names: tuple[str, ...], channels: dict[str, Role], role: Role) -> None:
    usable = [name for name, found in channels.items() if found is role]
    for name in names:
        if name not in usable:
            raise BadInput(
                f"'{name}' is not a recorded {role.value} of this maneuver; it has "
                f"{', '.join(usable) or 'none'}",
                code="unknown-channel",
                channel=name,
            )
    if not names:
        raise BadInput("the maneuver has no recorded input", code="no-input")


def _modes(
    store: Store, run: EstimationRun, maneuver: Maneuver
) -> tuple[AircraftModes, tuple[str, ...]]:
    modal, damping = find_modal_tables(
        store, maneuver.aircraft_id, run.modal_table_id, run.damping_table_id
    )
    modes = load_modes(store, modal, damping)
    return modes, modes.warnings if run.structure.modes else ()


def _out_of_band(model: AeroelasticModel, lines: Lines, modes: AircraftModes) -> tuple[str, ...]:
    highest = float(lines.omega[-1])
    return tuple(
        f"{modes.names[number]} ({omega / 2 / np.pi:.3g} Hz in vacuo) lies above the highest line "
        f"({highest / 2 / np.pi:.3g} Hz): the data hold little of its dynamics."
        for number, omega in zip(model.modes.numbers, model.modes.omega, strict=True)
        if omega > highest
    )


def _owned_by(lines: Lines, inputs: tuple[str, ...]) -> Lines:
    """Owners counted in the model's inputs; -1 for inputs that are not in the model."""
    index = [inputs.index(name) if name in inputs else -1 for name in lines.inputs]
    owner = np.array([index[k] if k >= 0 else -1 for k in lines.owner], dtype=int)
    return Lines(lines.omega, owner, inputs)


def _true_deflections(
    store: Store, maneuver: Maneuver, aircraft: Aircraft, inputs: tuple[str, ...], lines: Lines
) -> FrequencyData:
    recorded = spectra_of(store, maneuver, aircraft, inputs, lines)
    factors = [input_correction(aircraft, name, lines.omega) for name in inputs]
    return FrequencyData(lines.omega, recorded.values * np.stack(factors, axis=1), inputs)


def _commands(
    store: Store,
    maneuver: Maneuver,
    aircraft: Aircraft,
    inputs: tuple[str, ...],
    channels: dict[str, Role],
    lines: Lines,
) -> FrequencyData | None:
    names = tuple(f"{name}_command" for name in inputs)
    if any(channels.get(name) is not Role.COMMAND for name in names):
        return None
    recorded = spectra_of(store, maneuver, aircraft, names, lines)
    return FrequencyData(lines.omega, recorded.values, inputs)


def _predictions(
    store: Store,
    run: EstimationRun,
    maneuver: Maneuver,
    aircraft: Aircraft,
    modes: AircraftModes,
    inputs: tuple[str, ...],
) -> dict[str, DerivativeTable]:
    wanted = run.structure.modes
    prediction = best_prediction(store, maneuver.aircraft_id, run.prediction_id, wanted, inputs)
    if prediction is None:
        return {}
    fuel = maneuver.condition.fuel_fraction
    values = {name: value for name, (value, _) in prediction_at(store, prediction, fuel).items()}
    covered = predicted_modes(prediction, modes.table.numbers)
    plain = DerivativeTable.from_names(wanted, inputs, values)
    if not set(derivative_names(wanted, inputs)) <= set(values):
        return {prediction.source: plain} if set(wanted) <= set(covered) else {}
    full = DerivativeTable.from_names(covered, inputs, values)
    reduced = residualize(
        full,
        modes.table.at(fuel),
        flight_condition(aircraft, maneuver.condition),
        wanted,
    )
    return {f"{prediction.source}, {RESIDUALIZED}": reduced, prediction.source: plain}


def _parameter_rows(estimate: Estimate) -> tuple[ParameterEstimate, ...]:
    return tuple(
        ParameterEstimate(
            name=name, value=float(value), std_error=_finite(float(error)), start=float(start)
        )
        for name, value, error, start in zip(
            estimate.names, estimate.values, estimate.std_errors, estimate.start, strict=True
        )
    )


def _fit(computed: Computed) -> Fit:
    estimate = computed.estimate
    return Fit(
        outcome=estimate.outcome.value,
        message=estimate.message,
        iterations=tuple(
            Iteration(iteration=step.iteration, cost=step.cost, step=_finite(step.step) or 0.0)
            for step in estimate.steps
        ),
        cost=estimate.steps[-1].cost if estimate.steps else None,
        r_squared=_r_squared(estimate),
        n_lines=sum(block.omega.size for block in estimate.lines),
        n_parameters=len(estimate.names),
        seconds=computed.seconds,
        start=computed.start,
        warnings=computed.warnings,
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


def _finite(value: float) -> float | None:
    return value if np.isfinite(value) else None
