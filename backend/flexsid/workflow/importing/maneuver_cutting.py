"""Cutting: maneuvers out of the recording of a whole flight."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np

from flexsid.errors import BadInput, Conflict
from flexsid.records.aircraft import Aircraft
from flexsid.records.cutting import Cut, FoundManeuver
from flexsid.records.flight import Flight, FlightChannel
from flexsid.records.maneuver import Channel, Excitation, Maneuver, Role
from flexsid.records.views import ChannelHistories, ChannelTrace
from flexsid.storage.arrays import describe
from flexsid.storage.channels import read_flight_channels
from flexsid.storage.store import Store
from flexsid.sysid.preparation.cutting import ExcitedInterval, find_excitations, find_marked
from flexsid.units import si_unit, to_si
from flexsid.workflow.aircraft.flight_condition import airspeed_ratio, complete_condition
from flexsid.workflow.aircraft.thrust import TOTAL_TEMPERATURE
from flexsid.workflow.importing.persistence import largest_correlation
from flexsid.workflow.importing.recorded_excitation import excitation_of
from flexsid.workflow.measurements.excitation_interval import excitation_interval, samples_between
from flexsid.workflow.measurements.symmetric_motion import settle_axis

TRIM_S = 2.0
"""Steady flight kept before an excitation."""

DECAY_S = 4.0
"""Kept after an excitation, for the response to decay."""

_MARKER = re.compile(r"(^|_)(fta|marker|event|test_?point)($|_)", re.IGNORECASE)
_MEASURED = {  # of a condition by the names that channels have
    "airspeed": "airspeed",
    "density": "density",
    "altitude": "altitude",
    "fuel_fraction": "fuel_fraction",
    "alpha_trim": "alpha",
    "gamma": "gamma",
    "thrust": "thrust",
    TOTAL_TEMPERATURE: TOTAL_TEMPERATURE,
    "mass": "mass",
    "pitch_inertia": "pitch_inertia",
    "x_cg": "x_cg",
    "z_cg": "z_cg",
}
_LEAST_SAMPLES = 16


def find_maneuvers(store: Store, flight_id: int) -> tuple[FoundManeuver, ...]:
    """Look for maneuvers in a flight: by its commands, else its marker, else its surfaces.

    Raises
    ------
    BadInput
        If the flight has no recording, or nothing in it tells.
    """
    flight = store.flights.get(flight_id)
    channels = store.flight_channels.find(flight_id=flight_id)
    if not channels:
        raise BadInput(
            f"flight {flight.number} has no recording to cut; import one without [maneuver]",
            code="no-recording",
        )
    end_s = min(c.start_s + c.n_samples / c.rate_hz for c in channels)
    begin_s = max(c.start_s for c in channels)
    numbers = _numbers(store, flight_id, channels)
    found, names, clock, basis = _excitations(store, flight_id, channels)
    designs = _known_excitations(store, flight)
    cut = store.maneuvers.find(flight_id=flight_id, deleted_at=None)
    result: list[FoundManeuver] = []
    for place, one in enumerate(found):
        at_s = clock.start_s + one.first / clock.rate_hz
        over_s = clock.start_s + one.stop / clock.rate_hz
        before_s = begin_s if place == 0 else _time(clock, found[place - 1].stop)
        after_s = end_s if place + 1 == len(found) else _time(clock, found[place + 1].first)
        excitation = excitation_of(one, names, clock.rate_hz, clock.start_s)
        fta = one.marker or _marker_at(numbers, 0.5 * (at_s + over_s))
        if fta is None and excitation is not None:
            fta = designs.get(_key(excitation))
        start_s = max(at_s - TRIM_S, 0.5 * (before_s + at_s) if place else begin_s)
        stop_s = min(over_s + DECAY_S, after_s)
        result.append(
            FoundManeuver(
                label=f"{flight.number}-{place + 1:02d}" + (f" FTA {fta}" if fta else ""),
                start_s=start_s,
                stop_s=stop_s,
                excitation=excitation,
                n_periods=one.n_periods,
                fta=fta,
                basis=basis,
                maneuver_id=_cut_there(cut, at_s, over_s),
            )
        )
    return tuple(result)


def cut_maneuver(store: Store, flight_id: int, cut: Cut) -> Maneuver:
    """Make a maneuver of a window of a flight; the recording stays as it is.

    Raises
    ------
    BadInput
        If the window lies outside the recording, holds no input, or the condition cannot be
        told from what was recorded.
    Conflict
        If the flight has a maneuver of this label.
    """
    flight = store.flights.get(flight_id)
    aircraft = store.aircraft.get(flight.aircraft_id)
    if not cut.stop_s > cut.start_s:
        raise BadInput(
            f"the window from {cut.start_s:g} to {cut.stop_s:g} s is empty", code="bad-window"
        )
    recorded = read_flight_channels(store.database, flight_id)
    pieces = _pieces(recorded, cut)
    if not any(channel.role is Role.INPUT for channel, _ in pieces):
        raise BadInput("no input was recorded in this window", code="no-input")
    condition = complete_condition(aircraft, _measured(pieces, aircraft))
    inputs = [samples for channel, samples in pieces if channel.role is Role.INPUT]
    axis = settle_axis(cut.axis, aircraft, pieces)
    alike = len({samples.size for samples in inputs}) == 1
    with store.transaction():
        for known in store.maneuvers.find(flight_id=flight_id, deleted_at=None):
            if known.label == cut.label:
                raise Conflict(
                    f"flight {flight.number} has a maneuver '{cut.label}' already; give this one "
                    "another label",
                    code="already-exists",
                    maneuver_id=known.id,
                )
        first = pieces[0][0]
        kept = store.maneuvers.add(
            Maneuver(
                aircraft_id=flight.aircraft_id,
                flight_id=flight_id,
                label=cut.label,
                start_s=max(channel.start_s for channel, _ in pieces),
                duration_s=_duration(pieces),
                condition=condition,
                fta=cut.fta,
                axis=axis,
                excitation=_within(store, flight_id, cut),
                airspeed_ratio=airspeed_ratio(condition),
                max_input_correlation=largest_correlation(inputs) if alike else None,
                source_file=first.source_file,
                source_hash=first.source_hash,
                note=cut.note,
            )
        )
        rows = [describe(samples, channel.unit) for channel, samples in pieces]
        hashes = store.arrays.put_many(rows)
        store.channels.add_many(
            [_channel(c, hash_, kept.id) for (c, _), hash_ in zip(pieces, hashes, strict=True)]
        )
    return kept


def flight_history(
    store: Store,
    flight_id: int,
    names: Sequence[str] = (),
    start_s: float | None = None,
    stop_s: float | None = None,
    points: int = 2000,
) -> ChannelHistories:
    """Channels of a whole flight over a window; its commands or inputs by default."""
    channels = store.flight_channels.find(flight_id=flight_id)
    store.flights.get(flight_id)
    chosen = tuple(names) or _first_look(channels)
    known = {channel.name for channel in channels}
    for name in chosen:
        if name not in known:
            raise BadInput(
                f"the flight has no channel '{name}'; it has {', '.join(sorted(known)) or 'none'}",
                code="unknown-channel",
                channel=name,
            )
    low = -np.inf if start_s is None else start_s
    high = np.inf if stop_s is None else stop_s
    traces = []
    for channel, samples in read_flight_channels(store.database, flight_id, chosen).values():
        window = samples_between((low, high), channel.start_s, channel.rate_hz, channel.n_samples)
        index = np.arange(window.start, window.stop)
        traces.append(
            ChannelTrace(
                name=channel.name,
                unit=si_unit(channel.unit),
                role=channel.role,
                time_s=channel.start_s + index / channel.rate_hz,
                values=np.asarray(to_si(samples[window], channel.unit), dtype=float),
            )
        )
    return ChannelHistories(maneuver_id=0, traces=tuple(traces), excitation_s=None, points=points)


def _first_look(channels: Iterable[FlightChannel]) -> tuple[str, ...]:
    by_role = {role: [c.name for c in channels if c.role is role] for role in Role}
    shown = by_role[Role.COMMAND] or by_role[Role.INPUT]
    return (*shown[:3], *by_role[Role.OUTPUT][:1])


def _excitations(
    store: Store, flight_id: int, channels: list[FlightChannel]
) -> tuple[tuple[ExcitedInterval, ...], tuple[str, ...], FlightChannel, str]:
    """What ran, in which channels, on which clock, and what told it."""
    commands = [c for c in channels if c.role is Role.COMMAND]
    marker = _marker(channels)
    surfaces = [c for c in channels if c.role is Role.INPUT]
    chosen, basis = (commands, "recorded excitation") if commands else ([], "")
    if not chosen and marker is not None:
        values = read_flight_channels(store.database, flight_id, [marker.name])[marker.name][1]
        found = find_marked(np.asarray(values, dtype=float), marker.rate_hz)
        return found, (), marker, f"marker {marker.name}"
    if not chosen:
        chosen, basis = surfaces, "motion of the surfaces"
    if not chosen:
        raise BadInput(
            "neither commands nor a marker nor surfaces were recorded: choose the window yourself",
            code="nothing-tells",
        )
    clock = chosen[0]
    same = [
        c
        for c in chosen
        if (c.rate_hz, c.start_s, c.n_samples) == (clock.rate_hz, clock.start_s, clock.n_samples)
    ]
    read = read_flight_channels(store.database, flight_id, [c.name for c in same])
    samples = np.stack([np.asarray(read[c.name][1], dtype=float) for c in same], axis=1)
    names = tuple(c.name for c in same)
    return find_excitations(samples, clock.rate_hz), names, clock, basis


def _within(store: Store, flight_id: int, cut: Cut) -> Excitation | None:
    """The excitation found in a flight that lies whole in a window."""
    try:
        found = find_maneuvers(store, flight_id)
    except BadInput:
        return None
    for one in found:
        if one.excitation is None:
            continue
        first_s, last_s = excitation_interval(one.excitation)
        if cut.start_s <= first_s and last_s <= cut.stop_s + 1e-6:
            return one.excitation
    return None


def _pieces(
    recorded: dict[str, tuple[FlightChannel, np.ndarray]], cut: Cut
) -> list[tuple[FlightChannel, np.ndarray]]:
    """Every channel over the window, with its new first sample and number of samples."""
    pieces = []
    for channel, samples in recorded.values():
        window = samples_between(
            (cut.start_s, cut.stop_s), channel.start_s, channel.rate_hz, channel.n_samples
        )
        count = window.stop - window.start
        if count < _LEAST_SAMPLES and channel.role in (Role.INPUT, Role.OUTPUT):
            raise BadInput(
                f"the window from {cut.start_s:g} to {cut.stop_s:g} s holds {count} samples of "
                f"'{channel.name}', recorded from {channel.start_s:g} to "
                f"{channel.start_s + channel.n_samples / channel.rate_hz:g} s",
                code="bad-window",
                channel=channel.name,
            )
        if count < 1:
            continue
        start_s = channel.start_s + window.start / channel.rate_hz
        moved = replace(channel, start_s=start_s, n_samples=count)
        pieces.append((moved, np.ascontiguousarray(samples[window])))
    if not pieces:
        raise BadInput("nothing was recorded in this window", code="bad-window")
    return pieces


def _measured(
    pieces: Sequence[tuple[FlightChannel, np.ndarray]], aircraft: Aircraft
) -> dict[str, float]:
    """Averages of what was recorded of the condition, in SI."""
    measured: dict[str, float] = {}
    engines = () if aircraft.thrust is None else aircraft.thrust.engines
    known = _MEASURED | {name: name for name in engines}
    for channel, samples in pieces:
        key = known.get(channel.name)
        if channel.role is Role.CONDITION and key is not None:
            measured[key] = float(np.mean(to_si(samples, channel.unit), dtype=np.float64))
    for key, also in (("airspeed", None), ("density", "altitude")):
        if key not in measured and (also is None or also not in measured):
            raise BadInput(
                f"the flight has no condition channel '{key}'"
                + (f" or '{also}'" if also else "")
                + f"; {aircraft.name} cannot be modelled without it: record or import it",
                code="bad-condition",
            )
    if "density" in measured:
        measured.pop("altitude", None)
    return measured


def _duration(pieces: Sequence[tuple[FlightChannel, np.ndarray]]) -> float:
    start_s = max(channel.start_s for channel, _ in pieces)
    stop_s = min(channel.start_s + channel.n_samples / channel.rate_hz for channel, _ in pieces)
    return stop_s - start_s


def _channel(piece: FlightChannel, array: str, maneuver_id: int | None) -> Channel:
    return Channel(
        name=piece.name,
        unit=piece.unit,
        role=piece.role,
        rate_hz=piece.rate_hz,
        start_s=piece.start_s,
        n_samples=piece.n_samples,
        array=array,
        sensor=piece.sensor,
        source_file=piece.source_file,
        source_hash=piece.source_hash,
        source_field=piece.source_field,
        maneuver_id=maneuver_id,
    )


def _marker(channels: Iterable[FlightChannel]) -> FlightChannel | None:
    return next((c for c in channels if c.role is Role.CONDITION and _MARKER.search(c.name)), None)


def _numbers(
    store: Store, flight_id: int, channels: Iterable[FlightChannel]
) -> tuple[FlightChannel, np.ndarray] | None:
    marker = _marker(channels)
    if marker is None:
        return None
    return read_flight_channels(store.database, flight_id, [marker.name])[marker.name]


def _marker_at(numbers: tuple[FlightChannel, np.ndarray] | None, time_s: float) -> int | None:
    if numbers is None:
        return None
    channel, values = numbers
    place = round((time_s - channel.start_s) * channel.rate_hz)
    if not 0 <= place < values.size or not np.isfinite(values[place]):
        return None
    return round(float(values[place])) or None


def _known_excitations(store: Store, flight: Flight) -> dict[tuple[object, ...], int]:
    """Numbers of flight test aids by the harmonics that maneuvers of this aircraft had."""
    return {
        _key(known.excitation): known.fta
        for known in store.maneuvers.find(aircraft_id=flight.aircraft_id, deleted_at=None)
        if known.excitation is not None and known.fta is not None
    }


def _key(excitation: Excitation) -> tuple[object, ...]:
    lines = sorted((name, tuple(lines)) for name, lines in excitation.harmonics.items())
    return (round(excitation.period_s, 3), *lines)


def _cut_there(cut: Iterable[Maneuver], at_s: float, over_s: float) -> int | None:
    """A maneuver that holds most of an excitation already."""
    for known in cut:
        shared = min(over_s, known.start_s + known.duration_s) - max(at_s, known.start_s)
        if shared > 0.5 * (over_s - at_s):
            return known.id
    return None


def _time(clock: FlightChannel, sample: int) -> float:
    return clock.start_s + sample / clock.rate_hz
