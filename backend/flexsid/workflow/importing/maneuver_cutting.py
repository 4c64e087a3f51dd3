"""Cutting of maneuvers out of the recording of a whole flight."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import fields, replace
from functools import partial
from typing import Any

import numpy as np

from flexsid.errors import BadInput, Conflict
from flexsid.records.aircraft import Aircraft
from flexsid.records.maneuver import (
    Channel,
    Cut,
    Excitation,
    Flight,
    FlightChannel,
    Maneuver,
    ManeuverProposal,
    RecordedChannel,
    Role,
)
from flexsid.records.views import ChannelHistories, ChannelTrace
from flexsid.storage.arrays import describe_array
from flexsid.storage.recordings import read_recording
from flexsid.storage.store import Store
from flexsid.sysid.preparation.cutting import (
    ExcitedInterval,
    find_excitations,
    find_marked_intervals,
)
from flexsid.units import si_unit, to_si
from flexsid.workflow.aircraft.flight_condition import (
    TOTAL_TEMPERATURE,
    complete_condition,
    compute_airspeed_ratio,
)
from flexsid.workflow.importing.flight_import import build_excitation, correlate_inputs
from flexsid.workflow.importing.parsed_files import add_repairs, list_repairs
from flexsid.workflow.measurements.maneuver_spectra import add_shared_corrections
from flexsid.workflow.measurements.measured_axis import determine_axis

TRIM_S = 2.0
"""Steady flight included before an excitation. [s]"""

DECAY_S = 4.0
"""Included after an excitation, for the response to decay. [s]"""

_MARKER = re.compile(r"(^|_)(fta|marker|event|test_?point)($|_)", re.IGNORECASE)
_MEASURED = (  # condition channels that define the flight condition
    *("airspeed", "density", "altitude", TOTAL_TEMPERATURE, "fuel_fraction", "alpha_trim"),
    *("gamma", "thrust", "mass", "pitch_inertia", "x_cg", "z_cg"),
    *("roll_inertia", "yaw_inertia", "product_of_inertia"),
)
_LEAST_SAMPLES = 16

RecordedFlight = Mapping[str, tuple[FlightChannel, np.ndarray]]
"""Channels of a recording by name, with their samples in native units."""

_ReadSamples = Callable[[Sequence[FlightChannel]], np.ndarray]


def find_maneuvers(store: Store, flight_id: int) -> tuple[ManeuverProposal, ...]:
    """Find maneuvers in a flight by its commands, else its marker, else its surfaces.

    Raises
    ------
    BadInput
        If the flight has no recording, or neither commands, marker nor surfaces.
    """
    flight = store.flights.get(flight_id)
    channels = store.flight_channels.find(flight_id=flight_id)
    if not channels:
        raise BadInput(
            f"flight {flight.number} has no recording to cut; import one without [maneuver]",
            code="no-recording",
        )
    return _propose(store, flight, channels, partial(_read_samples, store, flight_id))


def find_recorded_maneuvers(
    store: Store, flight: Flight, recorded: RecordedFlight
) -> tuple[ManeuverProposal, ...]:
    """Find maneuvers in a recording that is not stored, as ``find_maneuvers``.

    Raises
    ------
    BadInput
        If it has neither commands, marker nor surfaces.
    """
    channels = [channel for channel, _ in recorded.values()]
    return _propose(store, flight, channels, partial(_stack_samples, recorded))


def _propose(
    store: Store, flight: Flight, channels: list[FlightChannel], read: _ReadSamples
) -> tuple[ManeuverProposal, ...]:
    begin_s, end_s = _find_common_interval(channels)
    marker = _find_marker(channels)
    numbers = None if marker is None else (marker, read([marker])[:, 0])
    found, names, clock, basis = _find_intervals(channels, read)
    designs = _map_excitations(store, flight)
    cut = store.maneuvers.find(flight_id=flight.id, deleted_at=None)
    result: list[ManeuverProposal] = []
    for index, one in enumerate(found):
        at_s, over_s = clock.get_time(one.first), clock.get_time(one.stop)
        before_s = begin_s if index == 0 else clock.get_time(found[index - 1].stop)
        after_s = end_s if index + 1 == len(found) else clock.get_time(found[index + 1].first)
        excitation = build_excitation(one, names, clock.rate_hz, clock.start_s)
        fta = one.marker or _read_marker(numbers, 0.5 * (at_s + over_s))
        if fta is None and excitation is not None:
            fta = designs.get(_build_key(excitation))
        start_s = max(at_s - TRIM_S, 0.5 * (before_s + at_s) if index else begin_s)
        stop_s = min(over_s + DECAY_S, after_s)
        result.append(
            ManeuverProposal(
                label=f"{flight.number}-{index + 1:02d}" + (f" FTA {fta}" if fta else ""),
                start_s=start_s,
                stop_s=stop_s,
                excitation=excitation,
                n_periods=one.n_periods,
                fta=fta,
                basis=basis,
                maneuver_id=_find_existing(cut, at_s, over_s),
            )
        )
    return tuple(result)


def cut_maneuver(store: Store, flight_id: int, cut: Cut) -> Maneuver:
    """Cut a maneuver out of a flight; the recording is not changed.

    Raises
    ------
    BadInput
        If the window lies outside the recording or has no input, or the condition was not
        recorded.
    Conflict
        If the flight has a maneuver of this label.
    """
    flight = store.flights.get(flight_id)
    _check_window(store.flight_channels.find(flight_id=flight_id), cut)
    interval_s = (cut.start_s, cut.stop_s)
    recorded = read_recording(store.database, store.recordings, flight_id, None, interval_s)
    try:
        proposals = find_maneuvers(store, flight_id)
    except BadInput:  # without commands, marker and surfaces
        proposals = ()
    return store_cut(store, flight, recorded, cut, proposals)


def store_cut(
    store: Store,
    flight: Flight,
    recorded: RecordedFlight,
    cut: Cut,
    proposals: Iterable[ManeuverProposal],
) -> Maneuver:
    """Store a maneuver that is cut out of a recording; raises as ``cut_maneuver``.

    ``proposals`` are the maneuvers that were found in the flight.
    """
    aircraft = store.aircraft.get(flight.aircraft_id)
    assert flight.id is not None
    _check_window([channel for channel, _ in recorded.values()], cut)
    pieces = _cut_channels(recorded, cut)
    if not any(channel.role is Role.INPUT for channel, _ in pieces):
        raise BadInput("no input was recorded in this window", code="no-input")
    condition = complete_condition(aircraft, _average_condition(pieces, aircraft))
    inputs = {channel.name: samples for channel, samples in pieces if channel.role is Role.INPUT}
    axis = determine_axis(cut.axis, aircraft, pieces)
    start_s, stop_s = _find_common_interval([channel for channel, _ in pieces])
    with store.transaction():
        for known in store.maneuvers.find(flight_id=flight.id, label=cut.label, deleted_at=None):
            raise Conflict(
                f"flight {flight.number} has a maneuver '{cut.label}' already; give this one "
                "another label",
                code="already-exists",
                maneuver_id=known.id,
            )
        first = pieces[0][0]
        excitation = _find_excitation(proposals, cut)
        stored = store.maneuvers.add(
            Maneuver(
                aircraft_id=flight.aircraft_id,
                flight_id=flight.id,
                label=cut.label,
                start_s=start_s,
                duration_s=stop_s - start_s,
                condition=condition,
                fta=cut.fta,
                axis=axis,
                excitation=excitation,
                airspeed_ratio=compute_airspeed_ratio(condition),
                max_input_correlation=correlate_inputs(aircraft, axis, excitation, inputs),
                source_file=first.source_file,
                source_hash=first.source_hash,
                note=add_repairs(cut.note, list_repairs(flight.description)),
            )
        )
        rows = [describe_array(samples, channel.unit) for channel, samples in pieces]
        hashes = store.arrays.put_many(rows)
        store.channels.add_many(
            [
                Channel(**_list_fields(replace(channel, array=name)), maneuver_id=stored.id)
                for (channel, _), name in zip(pieces, hashes, strict=True)
            ]
        )
        add_shared_corrections(store, stored)
    return stored


def read_flight_history(
    store: Store,
    flight_id: int,
    names: Sequence[str] = (),
    start_s: float | None = None,
    stop_s: float | None = None,
    points: int = 2000,
) -> ChannelHistories:
    """Read channels of a flight over a window; its commands or inputs by default."""
    channels = store.flight_channels.find(flight_id=flight_id)
    store.flights.get(flight_id)
    selected = tuple(names) or _select_default(channels)
    known = {channel.name for channel in channels}
    for name in selected:
        if name not in known:
            raise BadInput(
                f"the flight has no channel '{name}'; it has {', '.join(sorted(known)) or 'none'}",
                code="unknown-channel",
                channel=name,
            )
    interval_s = (-np.inf if start_s is None else start_s, np.inf if stop_s is None else stop_s)
    recorded = read_recording(store.database, store.recordings, flight_id, selected, interval_s)
    traces = tuple(
        ChannelTrace(
            name=channel.name,
            unit=si_unit(channel.unit),
            role=channel.role,
            time_s=channel.start_s + np.arange(samples.size) / channel.rate_hz,
            values=np.asarray(to_si(samples, channel.unit), dtype=float),
        )
        for channel, samples in recorded.values()
    )
    return ChannelHistories(maneuver_id=0, traces=traces, excitation_s=None, points=points)


def _select_default(channels: Iterable[FlightChannel]) -> tuple[str, ...]:
    by_role = {role: [c.name for c in channels if c.role is role] for role in Role}
    shown = by_role[Role.COMMAND] or by_role[Role.INPUT]
    return (*shown[:3], *by_role[Role.OUTPUT][:1])


def _find_intervals(
    channels: list[FlightChannel], read: _ReadSamples
) -> tuple[tuple[ExcitedInterval, ...], tuple[str, ...], FlightChannel, str]:
    """Find excited intervals, with their channels, clock and basis."""
    selected, basis = [c for c in channels if c.role is Role.COMMAND], "recorded excitation"
    marker = _find_marker(channels)
    if not selected and marker is not None:
        values = read([marker])[:, 0]
        found = find_marked_intervals(values, marker.rate_hz)
        return found, (), marker, f"marker {marker.name}"
    if not selected:
        selected, basis = [c for c in channels if c.role is Role.INPUT], "motion of the surfaces"
    if not selected:
        raise BadInput(
            "neither commands, marker nor surfaces were recorded; set the window manually",
            code="no-boundaries",
        )
    clock = selected[0]
    same = [channel for channel in selected if channel.clock == clock.clock]
    found = find_excitations(read(same), clock.rate_hz)
    return found, tuple(channel.name for channel in same), clock, basis


def _read_samples(store: Store, flight_id: int, channels: Sequence[FlightChannel]) -> np.ndarray:
    """Read samples of channels of one clock, (n_samples, n_channels)."""
    names = [channel.name for channel in channels]
    recorded = read_recording(store.database, store.recordings, flight_id, names)
    return _stack_samples(recorded, channels)


def _stack_samples(recorded: RecordedFlight, channels: Sequence[FlightChannel]) -> np.ndarray:
    """Stack samples of channels of one clock, (n_samples, n_channels)."""
    return np.stack([np.asarray(recorded[c.name][1], dtype=float) for c in channels], axis=1)


def _find_common_interval(channels: Sequence[FlightChannel]) -> tuple[float, float]:
    """Find the first and last time at which all channels were recorded. [s]"""
    return max(c.start_s for c in channels), min(c.stop_s for c in channels)


def _find_excitation(proposals: Iterable[ManeuverProposal], cut: Cut) -> Excitation | None:
    """Find the excitation of a flight that lies completely within a window."""
    for one in proposals:
        if one.excitation is None:
            continue
        first_s, last_s = one.excitation.interval_s
        if cut.start_s <= first_s and last_s <= cut.stop_s + 1e-6:
            return one.excitation
    return None


def _check_window(channels: Iterable[FlightChannel], cut: Cut) -> None:
    """Refuse a window that is empty, or in which an input or output was hardly recorded."""
    if not cut.stop_s > cut.start_s:
        raise BadInput(
            f"the window from {cut.start_s:g} to {cut.stop_s:g} s is empty", code="bad-window"
        )
    for channel in channels:
        window = channel.slice_samples((cut.start_s, cut.stop_s))
        count = window.stop - window.start
        if count < _LEAST_SAMPLES and channel.role in (Role.INPUT, Role.OUTPUT):
            raise BadInput(
                f"the window from {cut.start_s:g} to {cut.stop_s:g} s holds {count} samples of "
                f"'{channel.name}', recorded from {channel.start_s:g} to {channel.stop_s:g} s",
                code="bad-window",
                channel=channel.name,
            )


def _cut_channels(recorded: RecordedFlight, cut: Cut) -> list[tuple[FlightChannel, np.ndarray]]:
    """Cut every channel to the window, with its new start and number of samples."""
    pieces = []
    for channel, samples in recorded.values():
        window = channel.slice_samples((cut.start_s, cut.stop_s))
        count = window.stop - window.start
        if count < 1:
            continue
        moved = replace(channel, start_s=channel.get_time(window.start), n_samples=count)
        pieces.append((moved, np.ascontiguousarray(samples[window])))
    if not pieces:
        raise BadInput("nothing was recorded in this window", code="bad-window")
    return pieces


def _average_condition(
    pieces: Sequence[tuple[FlightChannel, np.ndarray]], aircraft: Aircraft
) -> dict[str, float]:
    """Average the recorded condition channels, in SI."""
    measured = select_condition_values(
        {
            channel.name: float(np.mean(to_si(samples, channel.unit), dtype=np.float64))
            for channel, samples in pieces
            if channel.role is Role.CONDITION
        },
        aircraft,
    )
    for keys in (("airspeed",), ("density", "altitude")):
        if not any(key in measured for key in keys):
            names = "' or '".join(keys)
            raise BadInput(
                f"the flight has no condition channel '{names}'; {aircraft.name} "
                "cannot be modelled without it: record or import it",
                code="bad-condition",
            )
    return measured


def select_condition_values(means: Mapping[str, float], aircraft: Aircraft) -> dict[str, float]:
    """Select what defines the flight condition from condition channels, in SI."""
    engines = () if aircraft.thrust is None else aircraft.thrust.engines
    return {
        "alpha" if name == "alpha_trim" else name: value
        for name, value in means.items()
        if name in (*_MEASURED, *engines)
    }


def _list_fields(channel: FlightChannel) -> dict[str, Any]:
    """List the fields that channels of flights and maneuvers have in common."""
    return {field.name: getattr(channel, field.name) for field in fields(RecordedChannel)}


def _find_marker(channels: Iterable[FlightChannel]) -> FlightChannel | None:
    return next((c for c in channels if c.role is Role.CONDITION and _MARKER.search(c.name)), None)


def _read_marker(numbers: tuple[FlightChannel, np.ndarray] | None, time_s: float) -> int | None:
    if numbers is None:
        return None
    channel, values = numbers
    index = round((time_s - channel.start_s) * channel.rate_hz)
    if not 0 <= index < values.size or not np.isfinite(values[index]):
        return None
    return round(float(values[index])) or None


def _map_excitations(store: Store, flight: Flight) -> dict[tuple[object, ...], int]:
    """Map harmonics of maneuvers of this aircraft to flight test aid numbers."""
    return {
        _build_key(known.excitation): known.fta
        for known in store.maneuvers.find(aircraft_id=flight.aircraft_id, deleted_at=None)
        if known.excitation is not None and known.fta is not None
    }


def _build_key(excitation: Excitation) -> tuple[object, ...]:
    harmonics = sorted((name, tuple(own)) for name, own in excitation.harmonics.items())
    return (round(excitation.period_s, 3), *harmonics)


def _find_existing(cut: Iterable[Maneuver], at_s: float, over_s: float) -> int | None:
    """Find an existing maneuver that covers most of an excitation."""
    for known in cut:
        shared = min(over_s, known.start_s + known.duration_s) - max(at_s, known.start_s)
        if shared > 0.5 * (over_s - at_s):
            return known.id
    return None
