"""Time-domain check: simulated response of an identified model against measured outputs."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from flexsid.errors import BadInput
from flexsid.records.aircraft import Aircraft
from flexsid.records.maneuver import Channel, Maneuver
from flexsid.records.views import CheckedTrace, TimeCheck
from flexsid.storage.store import Store
from flexsid.sysid.model.time_response import time_response
from flexsid.units import si_unit
from flexsid.workflow.aircraft.aircraft_models import (
    compute_input_corrections,
    define_outputs,
    get_output_instrument,
    insert_instruments,
)
from flexsid.workflow.measurements.maneuver_spectra import load_channels
from flexsid.workflow.measurements.recording import remove_trim
from flexsid.workflow.runs.identified_models import IdentifiedModel, load_identified_model

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

    def correct(omega: np.ndarray) -> np.ndarray:
        return compute_input_corrections(aircraft, found.model.inputs, omega)

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
