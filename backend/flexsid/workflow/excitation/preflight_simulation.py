"""Rehearsal: a design flown in simulation with a run's model, kept as a maneuver, and estimated."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from flexsid.errors import BadInput
from flexsid.records.aircraft import Aircraft, Surface
from flexsid.records.excitation import ExcitationDesign
from flexsid.records.flight import Flight
from flexsid.records.maneuver import Channel, Excitation, Maneuver, Role
from flexsid.records.rehearsal import Rehearsal
from flexsid.records.run import EstimationRun, RunState
from flexsid.storage import queue
from flexsid.storage.store import Store
from flexsid.sysid.model.instruments import Instrument
from flexsid.sysid.model.laws import chain_of
from flexsid.sysid.simulation.recording import pass_instruments
from flexsid.sysid.simulation.rehearsal import Rehearsed, rehearse
from flexsid.workflow.aircraft.aircraft_models import define_outputs, output_instrument
from flexsid.workflow.excitation.excitation_designs import check_amplitudes, multisine_of
from flexsid.workflow.excitation.predicted_accuracy import (
    Circumstances,
    circumstances,
    expected_errors,
)
from flexsid.workflow.flutter.controllers import controller_at
from flexsid.workflow.importing.persistence import largest_correlation
from flexsid.workflow.model_structures.run_results import refuse_altered
from flexsid.workflow.runs.run_identity import identified

Report = Callable[[float, str], None]

_TRIM_S, _SETTLE_S = 2.0, 4.0
_RATE_HZ = 400.0  # at least this fast, in whole multiples of the design's rate
_NUMBER = 0  # of the flight under which rehearsals are kept
_LEVELS = ("low", "medium", "high")


@dataclass(frozen=True, slots=True, kw_only=True)
class RehearsedDerivative:
    """A derivative of the model that flew, what was estimated, and what had been expected."""

    name: str
    flown: float
    estimate: float
    std_error: float | None
    expected: float


@dataclass(frozen=True, slots=True, kw_only=True)
class RehearsalResult:
    """A rehearsal, how far its run is, and the derivatives once it has succeeded."""

    rehearsal: Rehearsal
    label: str
    state: RunState
    correlation: float | None
    derivatives: tuple[RehearsedDerivative, ...]


def rehearse_design(
    store: Store,
    design: ExcitationDesign,
    run_id: int,
    level: int = 1,
    controller_id: int | None = None,
    report: Report | None = None,
) -> Rehearsal:
    """Fly one amplitude of a design, keep what the recorder would, and queue its estimation.

    Model, condition, sensors, noise and what the model misses are the run's; surfaces
    follow through their servos, commands come from the design and, where one is chosen,
    from a controller.

    Raises
    ------
    BadInput
        If surfaces of the design are not of the model, or the aircraft diverges.
    """
    tell = report or (lambda fraction, message: None)
    at = circumstances(store, run_id)
    flown = store.maneuvers.get(at.run.maneuver_id)
    aircraft = store.aircraft.get(flown.aircraft_id)
    check_amplitudes(design.wish)
    made = multisine_of(design, level)
    rate = design.wish.rate_hz * int(np.ceil(_RATE_HZ / design.wish.rate_hz))
    excitation = _excitation(at, made.sample, made.inputs, made.period_s, rate)
    servos = {name: _servo(aircraft, name) for name in at.model.inputs}
    controller = None if controller_id is None else store.controllers.get(controller_id)
    if controller is not None and controller.aircraft_id != aircraft.id:
        raise BadInput("the controller is of another aircraft", code="wrong-aircraft")
    moved = rehearse(
        at.model.state_space(at.parameters.table(at.parameters.start)),
        chain_of([servos[name] for name in at.model.inputs], at.model.inputs),
        np.array([servos[name].delay_s for name in at.model.inputs]),
        excitation,
        rate,
        None if controller is None else controller_at(controller, flown.condition.airspeed_m_s),
        0.0 if controller is None else controller.delay_s,
        lambda share: tell(0.9 * share, "Flying"),
    )
    tell(0.9, "Recording")
    channels = _channels(at, aircraft, moved, excitation, rate)
    label = f"Rehearsal of {design.name}, {_LEVELS[level]}"
    with store.transaction():
        flight = _flight(store, aircraft)
        maneuver = store.maneuvers.add(
            Maneuver(
                aircraft_id=flown.aircraft_id,
                flight_id=flight.id or 0,
                label=label[:200],
                start_s=0.0,
                duration_s=excitation.shape[0] / rate,
                condition=flown.condition,
                fta=design.fta,
                axis=flown.axis,
                excitation=Excitation(
                    period_s=made.period_s, harmonics=made.harmonics(), start_s=_TRIM_S
                ),
                airspeed_ratio=flown.airspeed_ratio,
                max_input_correlation=largest_correlation(
                    [samples for _, _, role, samples in channels if role is Role.INPUT]
                ),
                note=f"Simulated with the model of run {run_id}, "
                + ("no controller" if controller is None else controller.name),
            )
        )
        for name, unit, role, samples in channels:
            kept = samples.astype(np.float32)
            store.channels.add(
                Channel(
                    maneuver_id=maneuver.id,
                    name=name,
                    unit=unit,
                    role=role,
                    rate_hz=rate,
                    start_s=0.0,
                    n_samples=kept.size,
                    array=store.arrays.put(kept, unit),
                )
            )
        run = queue.add(
            store,
            identified(
                store,
                EstimationRun(
                    maneuver_id=maneuver.id or 0,
                    method=at.run.method,
                    structure=replace(
                        at.run.structure, inputs=at.model.inputs, outputs=at.model.outputs
                    ),
                    settings=replace(at.run.settings, together_with=(), start_run_id=None),
                    modal_table_id=at.run.modal_table_id,
                    damping_table_id=at.run.damping_table_id,
                    prediction_id=at.run.prediction_id,
                ),
            ),
        )
        return store.rehearsals.add(
            Rehearsal(
                design_id=design.id or 0,
                level=level,
                model_run_id=run_id,
                controller_id=controller_id,
                maneuver_id=maneuver.id or 0,
                run_id=run.id or 0,
            )
        )


def rehearsal_results(store: Store, design: ExcitationDesign) -> tuple[RehearsalResult, ...]:
    """The rehearsals of a design, newest first, with what their runs made of them."""
    found = store.rehearsals.find(design_id=design.id)
    return tuple(_result(store, design, one) for one in reversed(found))


def _result(store: Store, design: ExcitationDesign, one: Rehearsal) -> RehearsalResult:
    run, model = store.runs.get(one.run_id), store.runs.get(one.model_run_id)
    maneuver = store.maneuvers.get(one.maneuver_id)
    rows: tuple[RehearsedDerivative, ...] = ()
    refuse_altered(run)
    refuse_altered(model)
    if run.result is not None and model.result is not None:
        truth = {row.name: row.value for row in model.result.parameters}
        expected = {
            row.name: row.std_error
            for row in expected_errors(store, design, one.model_run_id, one.level).items
        }
        rows = tuple(
            RehearsedDerivative(
                name=row.name,
                flown=truth[row.name],
                estimate=row.value,
                std_error=row.std_error,
                expected=expected[row.name],
            )
            for row in run.result.parameters
            if row.name in expected
        )
    return RehearsalResult(
        rehearsal=one,
        label=maneuver.label,
        state=run.state,
        correlation=maneuver.max_input_correlation,
        derivatives=rows,
    )


def _excitation(
    at: Circumstances,
    sample: Callable[[np.ndarray], np.ndarray],
    inputs: tuple[str, ...],
    period_s: float,
    rate: float,
) -> np.ndarray:
    """Commands of all the model's inputs from trim to rest, (n_samples, n_u)."""
    foreign = [name for name in inputs if name not in at.model.inputs]
    if foreign:
        raise BadInput(
            f"the model of run {at.run.id} has no input {', '.join(foreign)}; it has"
            f" {', '.join(at.model.inputs)}",
            code="unknown-input",
        )
    lead, during = round(_TRIM_S * rate), round(period_s * rate)
    excitation = np.zeros((lead + during + round(_SETTLE_S * rate), len(at.model.inputs)))
    columns = [at.model.inputs.index(name) for name in inputs]
    excitation[lead : lead + during, columns] = sample(np.arange(during) / rate)
    return excitation


def _channels(
    at: Circumstances, aircraft: Aircraft, moved: Rehearsed, excitation: np.ndarray, rate: float
) -> list[tuple[str, str, Role, np.ndarray]]:
    """What the recorder keeps: surfaces, noisy outputs, the excitation; in SI."""
    model, surfaces = at.model, {surface.name: surface for surface in aircraft.surfaces}
    true = np.stack(
        [
            moved.commands[:, k] if surfaces[name].actuator is not None else moved.deflections[:, k]
            for k, name in enumerate(model.inputs)
        ],
        axis=1,
    )
    sensed = [
        aircraft.instruments.get(surfaces[n].instrument or "", Instrument()) for n in model.inputs
    ]
    seen = pass_instruments(true, rate, sensed)
    outputs = define_outputs(aircraft, model.outputs)
    read = pass_instruments(moved.outputs, rate, [output_instrument(aircraft, o) for o in outputs])
    read += _missed(at, excitation, rate) + _noise(at, read.shape[0], rate)
    units = {"accelerometer": "m/s2", "gyro": "rad/s", "strain": "strain"}
    rows = [(name, "rad", Role.INPUT, seen[:, k]) for k, name in enumerate(model.inputs)]
    rows += [
        (o.name, units.get(o.kind.value, "rad"), Role.OUTPUT, read[:, k])
        for k, o in enumerate(outputs)
    ]
    rows += [
        (f"{name}_command", "rad", Role.COMMAND, excitation[:, k])
        for k, name in enumerate(model.inputs)
    ]
    return rows


def _missed(at: Circumstances, excitation: np.ndarray, rate: float) -> np.ndarray:
    """What the run's model leaves of recorded outputs, per command as it was."""
    n_samples = excitation.shape[0]
    omega = 2.0 * np.pi * np.fft.rfftfreq(n_samples, 1.0 / rate)
    inside = (omega >= at.band[0]) & (omega <= at.band[1])
    commands = np.fft.rfft(excitation, axis=0)[inside]
    spectrum = np.zeros((omega.size, len(at.model.outputs)), dtype=complex)
    for name, missed in at.flown.missed.items():
        own = commands[:, [at.model.inputs.index(name)]]
        spectrum[inside] += missed(omega[inside]) * own
    return np.fft.irfft(spectrum, n_samples, axis=0)


def _noise(at: Circumstances, n_samples: int, rate: float) -> np.ndarray:
    """Noise of the run's density, coloured and correlated as it was, the same every time."""
    rng = np.random.default_rng([at.run.id or 0, n_samples])
    omega = 2.0 * np.pi * np.fft.rfftfreq(n_samples, 1.0 / rate)[1:-1]
    density = at.flown.noise(omega)
    n_y = density.shape[1]
    values, vectors = np.linalg.eigh(density)
    root = vectors * np.sqrt(np.maximum(values, 0.0))[:, None, :]
    white = rng.normal(size=(omega.size, n_y)) + 1j * rng.normal(size=(omega.size, n_y))
    spectrum = np.zeros((n_samples // 2 + 1, n_y), dtype=complex)
    # A sequence of density S has sums over T of variance S T; its rfft is rate times that.
    spectrum[1:-1] = np.sqrt(0.5 * n_samples * rate) * np.einsum("kij,kj->ki", root, white)
    return np.fft.irfft(spectrum, n_samples, axis=0)


def _flight(store: Store, aircraft: Aircraft) -> Flight:
    assert aircraft.id is not None
    known = store.flights.find(aircraft_id=aircraft.id, number=_NUMBER)
    if known:
        return known[0]
    return store.flights.add(
        Flight(
            aircraft_id=aircraft.id,
            number=_NUMBER,
            description="Rehearsals: simulated, never flown",
        )
    )


def _servo(aircraft: Aircraft, name: str) -> Instrument:
    surface = next((one for one in aircraft.surfaces if one.name == name), Surface(name=name))
    return aircraft.instruments.get(surface.servo or surface.actuator or "", Instrument())
