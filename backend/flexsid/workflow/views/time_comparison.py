"""Time histories: measured, simulated by identified models, and commanded."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from flexsid.errors import BadInput
from flexsid.records.aircraft import Aircraft, list_surface_parts
from flexsid.records.maneuver import Channel, Maneuver, Role
from flexsid.records.views import (
    ChannelTrace,
    CheckedTrace,
    ComparedRecord,
    SimulatedOutput,
    SurfaceHistories,
    SurfaceHistory,
    TimeCheck,
    TimeComparison,
)
from flexsid.storage.store import Store
from flexsid.sysid.model.reduction import time_response
from flexsid.sysid.preparation.resampling import find_pairs, respond_between
from flexsid.sysid.simulation.airframe import apply_instruments
from flexsid.units import si_unit
from flexsid.workflow.aircraft.aircraft_models import (
    compute_input_corrections,
    define_outputs,
    get_output_instrument,
    get_recorded_servo,
    insert_instruments,
)
from flexsid.workflow.measurements.maneuver_spectra import load_channels, read_conditioning
from flexsid.workflow.measurements.recording import (
    COMMAND_SUFFIX,
    Conditioning,
    remove_trim,
)
from flexsid.workflow.runs.exports import IdentifiedModel, load_identified_model
from flexsid.workflow.views.maneuver import POINTS, list_input_names, read_traces

# --- Time-domain check: simulated response of an identified model against measured outputs --------

_SHOWN_FIRST = 4


def check_in_time(
    store: Store,
    run_id: int,
    outputs: Sequence[str] = (),
    maneuver_id: int | None = None,
    points: int = 2000,
) -> TimeCheck:
    """Simulate the model of a run with recorded inputs of its own or another maneuver.

    Raises
    ------
    BadInput
        If the model has no such output, or the maneuver is of another aircraft.
    """
    run = store.runs.get(run_id)
    own = store.maneuvers.get(run.maneuver_id)
    maneuver = own if maneuver_id is None else store.maneuvers.get(maneuver_id)
    if maneuver.aircraft_id != own.aircraft_id:
        raise BadInput(
            f"maneuver {maneuver_id} belongs to another aircraft than the run",
            code="wrong-aircraft",
        )
    found = load_identified_model(store, run, maneuver.id)
    names = tuple(outputs) or found.model.outputs[:_SHOWN_FIRST]
    unknown = [name for name in names if name not in found.model.outputs]
    if unknown:
        raise BadInput(
            f"the model has no output '{unknown[0]}'; it has {', '.join(found.model.outputs)}",
            code="unknown-output",
            output=unknown[0],
        )
    aircraft = insert_instruments(store.aircraft.get(maneuver.aircraft_id), run.structure)
    time_s, simulated = _simulate(store, maneuver, aircraft, found.select_outputs(names))
    traces = [
        _compare(store, maneuver, aircraft, name, time_s, simulated[:, k])
        for k, name in enumerate(names)
    ]
    return TimeCheck(
        run_id=run_id, method=run.method, maneuver_id=maneuver.id or 0, points=points,
        traces=tuple(traces),
    )  # fmt: skip


def _simulate(
    store: Store, maneuver: Maneuver, aircraft: Aircraft, found: IdentifiedModel
) -> tuple[np.ndarray, np.ndarray]:
    """Simulate recorded outputs on the clock of the inputs."""
    inputs = _read_channels(store, maneuver, found.model.inputs)
    first = inputs[0][0]
    if any((c.rate_hz, c.start_s) != (first.rate_hz, first.start_s) for c, _ in inputs):
        raise BadInput(
            "the inputs of this maneuver have different sampling; a simulation needs one clock",
            code="unequal-channels",
        )
    recorded = np.stack([values for _, values in inputs], axis=1)

    steps = read_conditioning(store, maneuver.id)

    def correct(omega: np.ndarray) -> np.ndarray:
        factors = compute_input_corrections(aircraft, found.model.inputs, omega)
        between = [steps.get(name, Conditioning()).between for name in found.model.inputs]
        return factors * np.stack(
            [respond_between(omega / first.rate_hz, one) for one in between], axis=1
        )

    definitions = define_outputs(aircraft, found.model.outputs)

    def sense(omega: np.ndarray) -> np.ndarray:
        instruments = [get_output_instrument(aircraft, o).response(omega) for o in definitions]
        delays = np.exp(-1j * np.outer(omega, found.delays))
        return np.stack(instruments, axis=1) * found.scales * delays

    outputs = time_response(found.model, found.derivatives, recorded, first.rate_hz, correct, sense)
    return first.start_s + np.arange(first.n_samples) / first.rate_hz, outputs


def _compare(
    store: Store,
    maneuver: Maneuver,
    aircraft: Aircraft,
    name: str,
    time_s: np.ndarray,
    simulated: np.ndarray,
) -> CheckedTrace:
    (definition,) = define_outputs(aircraft, [name])
    parts = _read_channels(store, maneuver, tuple(sensor.name for sensor, _ in definition.terms))
    channel = parts[0][0]
    weights = [weight for _, weight in definition.terms]
    measured = np.sum([w * v for w, (_, v) in zip(weights, parts, strict=True)], axis=0)
    at = channel.start_s + np.arange(channel.n_samples) / channel.rate_hz
    model = np.interp(at, time_s, simulated)
    power = float(np.sum(measured**2))
    error = float(np.sum((measured - model) ** 2))
    return CheckedTrace(
        name=name,
        unit=si_unit(channel.unit),
        time_s=at,
        measured=measured,
        simulated=model,
        r_squared=1.0 - error / power if power > 0 else 0.0,
    )


def _read_channels(
    store: Store, maneuver: Maneuver, names: tuple[str, ...]
) -> list[tuple[Channel, np.ndarray]]:
    assert maneuver.id is not None
    return [
        (channel, remove_trim(values[:, None], channel.rate_hz, channel.start_s, maneuver)[:, 0])
        for channel, values in load_channels(store, maneuver.id, names)
    ]


# --- One output over time: records of maneuvers with the simulated outputs of runs ----------------

MOST_SIMULATIONS = 12
"""Simulations of one figure, which take less than a second."""


def compare_in_time(
    store: Store,
    run_ids: Sequence[int],
    output: str | None = None,
    maneuver_ids: Sequence[int] = (),
    points: int = 2000,
) -> TimeComparison:
    """Simulate runs under recorded inputs, and compare one output with its record.

    Parameters
    ----------
    store
        The campaign.
    run_ids
        Succeeded runs with a complete model.
    output
        Output of all runs; by default the first of the first run.
    maneuver_ids
        Maneuvers under whose inputs every run is simulated; by default each run under those of
        its own maneuver.
    points
        Points of a curve on the screen.

    Returns
    -------
    TimeComparison
        One record per maneuver, in order of dynamic pressure and fuel, with the fit of every
        run in percent: 100 (1 - ||y - yhat|| / ||y - mean(y)||), y the record without trim.

    Raises
    ------
    BadInput
        Without runs, if a run does not have the output, a maneuver is of another aircraft, or
        more than ``MOST_SIMULATIONS`` are requested.
    """
    runs = {number: store.runs.get(number) for number in dict.fromkeys(run_ids)}
    pairs = [
        (maneuver_id, number)
        for number, run in runs.items()
        for maneuver_id in (dict.fromkeys(maneuver_ids) or (run.maneuver_id,))
    ]
    if not pairs:
        raise BadInput("run_ids names no run; give ids separated by commas", code="no-runs")
    if len(pairs) > MOST_SIMULATIONS:
        raise BadInput(
            f"{len(pairs)} simulations are requested; at most {MOST_SIMULATIONS} are compared in"
            " one figure: give fewer runs or maneuvers",
            code="too-many",
        )
    found: dict[int, list[tuple[int, CheckedTrace]]] = {}
    for maneuver_id, number in pairs:
        names = () if output is None else (output,)
        trace = check_in_time(store, number, names, maneuver_id).traces[0]
        output = trace.name
        found.setdefault(maneuver_id, []).append((number, trace))
    records: list[ComparedRecord] = []
    for maneuver_id, traces in found.items():
        maneuver = store.maneuvers.get(maneuver_id)
        _, first = traces[0]
        records.append(
            ComparedRecord(
                maneuver_id=maneuver_id,
                label=maneuver.label,
                airspeed_m_s=maneuver.condition.airspeed_m_s,
                dynamic_pressure_pa=maneuver.condition.dynamic_pressure_pa,
                fuel_fraction=maneuver.condition.fuel_fraction,
                time_s=first.time_s - first.time_s[0],
                measured=first.measured,
                simulated=tuple(
                    SimulatedOutput(
                        run_id=number,
                        method=runs[number].method,
                        values=trace.simulated,
                        fit_percent=compute_fit_percent(trace.measured, trace.simulated),
                    )
                    for number, trace in traces
                ),
            )
        )
    records.sort(key=lambda one: (one.dynamic_pressure_pa, one.fuel_fraction, one.maneuver_id))
    unit = found[pairs[0][0]][0][1].unit
    return TimeComparison(output=output or "", unit=unit, points=points, records=tuple(records))


def compute_fit_percent(measured: np.ndarray, simulated: np.ndarray) -> float | None:
    """Return the fit as of MATLAB's ``compare``: normalised rms error from 100, in percent.

    Parameters
    ----------
    measured, simulated
        Samples, (N,).

    Returns
    -------
    float or None
        100 for a perfect model, 0 for the mean of the record, negative for worse; None for a
        constant record.
    """
    spread = float(np.linalg.norm(measured - np.mean(measured)))
    if not spread > 0.0:
        return None
    return 100.0 * (1.0 - float(np.linalg.norm(measured - simulated)) / spread)


# --- Surfaces over time as measured and as their commands move them through the servos ------------


def read_surface_histories(
    store: Store,
    maneuver_id: int,
    start_s: float | None = None,
    stop_s: float | None = None,
    points: int = POINTS,
) -> SurfaceHistories:
    """Read all measured surfaces over a window, with their commands through servo and instrument.

    The command of a side is the sum of its own and of those of the parts that it is a term of.
    Commands are the recorded excitation: what feedback adds is in the measured deflections only.

    Raises
    ------
    BadInput
        If no surface was measured.
    """
    maneuver = store.maneuvers.get(maneuver_id)
    aircraft = store.aircraft.get(maneuver.aircraft_id)
    names = list_input_names(store, maneuver)
    if not names:
        raise BadInput(
            "no surface of this maneuver was measured; import its deflections as inputs",
            code="no-surfaces",
        )
    commands = [c.name for c in store.channels.find(maneuver_id=maneuver_id, role=Role.COMMAND)]
    traces = {one.name: one for one in read_traces(store, maneuver, (*names, *commands))}
    window = (-np.inf if start_s is None else start_s, np.inf if stop_s is None else stop_s)
    found = {}
    for name in names:
        commanded = _compute_commanded(aircraft, name, traces)
        found[name] = SurfaceHistory(
            measured=_cut(traces[name], window),
            commanded=None if commanded is None else _cut(commanded, window),
        )
    right = {left: other for left, other, _ in find_pairs(names)}
    for terms in list_surface_parts(aircraft).values():
        sides = tuple(side for side, _ in terms)
        if len(sides) == 2 and set(sides) <= set(names):
            right |= [sides]
    rows = ((name, right[name]) if name in right else (name,) for name in names)
    return SurfaceHistories(
        maneuver_id=maneuver_id,
        rows=tuple(
            tuple(found[name] for name in row) for row in rows if row[0] not in right.values()
        ),
        points=points,
    )


def _compute_commanded(
    aircraft: Aircraft, surface: str, traces: Mapping[str, ChannelTrace]
) -> ChannelTrace | None:
    """Compute what the recording of a surface is if it follows its command alone."""
    # Of parts s = (l + r) / 2 and a = (r - l) / 2 the sides are s - a and s + a.
    signs = {surface: 1.0} | {
        part: float(np.sign(dict(terms)[surface]))
        for part, terms in list_surface_parts(aircraft).items()
        if surface in dict(terms)
    }
    given = [
        (sign, traces[name + COMMAND_SUFFIX])
        for name, sign in signs.items()
        if name + COMMAND_SUFFIX in traces
    ]
    if not given or len({one.values.size for _, one in given}) > 1:
        return None
    first = given[0][1]
    command = np.sum([sign * one.values for sign, one in given], axis=0)
    if not np.isfinite(command).all():  # with lost samples there is no transform
        return None
    command -= command[0]
    rate_hz = 1.0 / float(np.median(np.diff(first.time_s)))
    servo = get_recorded_servo(aircraft, surface)
    moved = apply_instruments(command[:, None], rate_hz, [servo])[:, 0]
    trim = np.nanmean(traces[surface].values) - moved.mean()
    return replace(first, name=surface, values=moved + trim)


def _cut(trace: ChannelTrace, window: tuple[float, float]) -> ChannelTrace:
    inside = (trace.time_s >= window[0]) & (trace.time_s <= window[1])
    return replace(trace, time_s=trace.time_s[inside], values=trace.values[inside])
