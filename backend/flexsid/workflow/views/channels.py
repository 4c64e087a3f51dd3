"""Recorded channels and their symmetric combinations by name, in SI."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from flexsid.errors import BadInput
from flexsid.records.aircraft import (
    Aircraft,
    Combination,
    Sensor,
    get_symmetry,
    list_surface_parts,
)
from flexsid.records.maneuver import Channel, Excitation, Maneuver, Role
from flexsid.records.views import ChannelTrace, DefaultChannels
from flexsid.storage.store import Store
from flexsid.sysid.model.sensor_models import ATTITUDE, GYRO, VANE, load_sensor_models
from flexsid.units import si_unit, to_si
from flexsid.workflow.aircraft.axes import classify_part, list_bodies, list_moved_surfaces
from flexsid.workflow.measurements.conditioning import read_conditioning
from flexsid.workflow.measurements.recording import Conditioning

Interval = tuple[float, float]
_Parts = list[tuple[Channel, float]]


_KINDS_FIRST = (VANE.kind, GYRO.kind, ATTITUDE.kind)


def select_default_channels(
    aircraft: Aircraft, axis: str, excitation: Excitation | None, recorded: Mapping[str, Role]
) -> DefaultChannels:
    """Select the channels of a maneuver that views show first, of those that were recorded.

    Of several sensors of one quantity it is the one nearest to the plane of symmetry.
    """
    sensors = _list_rigid_body_sensors(aircraft, axis, recorded)
    rates = {
        one.model.mirror_sign(one.axis): one.name for one in sensors[::-1] if one.kind == GYRO.kind
    }
    outputs = [name for name, role in recorded.items() if role is Role.OUTPUT]
    own = {body.symmetry for body in list_bodies(axis)}
    combined = (
        one
        for one in aircraft.combinations
        if one.name not in recorded and all(term in recorded for term, _ in one.terms)
    )
    return DefaultChannels(
        inputs=list_moved_surfaces(
            aircraft, axis, excitation, (n for n, role in recorded.items() if role is Role.INPUT)
        ),
        outputs=tuple(sensor.name for sensor in sensors) or tuple(outputs),
        rates=tuple(rates[sign] for sign in sorted(rates, reverse=True)) or tuple(outputs[:1]),
        combinations=tuple(
            one.name
            for one in sorted(combined, key=lambda one: _find_part(aircraft, one) not in own)
        ),
    )


def _find_part(aircraft: Aircraft, combination: Combination) -> str | None:
    """Find the part of the motion that a combination of surfaces or sensors has."""
    if combination.name in list_surface_parts(aircraft):
        return get_symmetry(aircraft, combination.name)
    models = load_sensor_models()
    sensors = {sensor.name: sensor for sensor in aircraft.sensors if sensor.kind in models}
    known = [(sensors[name], weight) for name, weight in combination.terms if name in sensors]
    return classify_part(known) if len(known) == len(combination.terms) > 0 else None


def _list_rigid_body_sensors(
    aircraft: Aircraft, axis: str, recorded: Mapping[str, Role]
) -> list[Sensor]:
    """List one sensor of each rigid-body quantity of an axis, angles and rates first."""
    bodies, models = list_bodies(axis), load_sensor_models()
    found: dict[tuple[str, str], Sensor] = {}
    for sensor in sorted(aircraft.sensors, key=lambda one: abs(one.location_m[1])):
        model = models.get(sensor.kind)  # None: of a package that is not installed
        if model is None or recorded.get(sensor.name) is not Role.OUTPUT:
            continue
        if any(model.measures_rigid_body(sensor.axis, body) for body in bodies):
            found.setdefault((sensor.kind, sensor.axis), sensor)
    return sorted(found.values(), key=_rank)


def _rank(sensor: Sensor) -> tuple[int, bool]:
    known = sensor.kind in _KINDS_FIRST
    rank = _KINDS_FIRST.index(sensor.kind) if known else len(_KINDS_FIRST)
    return rank, sensor.axis != sensor.model.usual_axis and not known


def list_input_names(store: Store, maneuver: Maneuver) -> tuple[str, ...]:
    """List the measured surfaces of a maneuver, in the order of the recorder."""
    measured = store.channels.find(maneuver_id=maneuver.id, role=Role.INPUT)
    return tuple(channel.name for channel in measured)


def read_traces(
    store: Store, maneuver: Maneuver, names: Sequence[str], interval_s: Interval | None = None
) -> tuple[ChannelTrace, ...]:
    """Read channels, or combinations of channels, over an interval of the record.

    Raises
    ------
    BadInput
        If there is neither a channel nor a combination of this name, or the channels of a
        combination have different sampling.
    """
    parts = _find(store, maneuver, names)
    needed = {channel.array for terms in parts.values() for channel, _ in terms}
    samples = store.arrays.get_many(needed)
    steps = read_conditioning(store, maneuver.id)
    return tuple(
        _build_trace(name, terms, samples, steps, interval_s) for name, terms in parts.items()
    )


def find_sampling(
    store: Store, maneuver: Maneuver, names: Sequence[str]
) -> dict[str, tuple[float, str]]:
    """Return sampling rate [Hz] and SI unit of channels and combinations, by name."""
    parts = _find(store, maneuver, names)
    return {
        name: (channel.rate_hz, si_unit(channel.unit)) for name, ((channel, _), *_) in parts.items()
    }


def _find(store: Store, maneuver: Maneuver, names: Sequence[str]) -> dict[str, _Parts]:
    recorded = {channel.name: channel for channel in store.channels.find(maneuver_id=maneuver.id)}
    aircraft = store.aircraft.get(maneuver.aircraft_id)
    combined = {combination.name: combination for combination in aircraft.combinations}
    return {name: _list_terms(name, recorded, combined) for name in dict.fromkeys(names)}


def _list_terms(
    name: str, recorded: dict[str, Channel], combined: dict[str, Combination]
) -> _Parts:
    if name in recorded:
        return [(recorded[name], 1.0)]
    terms = combined[name].terms if name in combined else ()
    if not terms or any(term not in recorded for term, _ in terms):
        known = [
            *recorded,
            *(n for n, c in combined.items() if all(t in recorded for t, _ in c.terms)),
        ]
        raise BadInput(
            f"the maneuver has no channel '{name}'; it has {', '.join(known)}",
            code="unknown-channel",
            channel=name,
        )
    channels = [recorded[term] for term, _ in terms]
    if len({(c.rate_hz, c.start_s, c.n_samples, si_unit(c.unit)) for c in channels}) > 1:
        raise BadInput(
            f"'{name}' combines channels of different rates or units; select its parts instead: "
            f"{', '.join(channel.name for channel in channels)}",
            code="unequal-channels",
            channel=name,
        )
    return [(recorded[term], weight) for term, weight in terms]


def _build_trace(
    name: str,
    parts: _Parts,
    samples: dict[str, np.ndarray],
    steps: dict[str, Conditioning],
    interval_s: Interval | None,
) -> ChannelTrace:
    first, _ = parts[0]
    window = slice(0, first.n_samples)
    if interval_s is not None:
        window = first.slice_samples(interval_s)
    values = sum(
        weight * _apply_conditioning(channel, samples[channel.array], steps, window)
        for channel, weight in parts
    )
    index = np.arange(window.start, window.stop)
    return ChannelTrace(
        name=name,
        unit=si_unit(first.unit),
        role=first.role,
        time_s=first.start_s + index / first.rate_hz,
        values=np.asarray(values),
    )


def _apply_conditioning(
    channel: Channel, samples: np.ndarray, steps: dict[str, Conditioning], window: slice
) -> np.ndarray:
    """Return samples of a window in SI with the conditioning of the channel applied."""
    if channel.name not in steps:
        return to_si(samples[window], channel.unit)
    values = np.asarray(to_si(samples, channel.unit), dtype=float)
    return steps[channel.name].align(values, channel.rate_hz)[window]


def resample_to_slowest(traces: Sequence[ChannelTrace]) -> tuple[ChannelTrace, ...]:
    """Resample traces to the time axis of the one with the fewest samples."""
    clock = min(traces, key=lambda trace: trace.time_s.size).time_s
    return tuple(
        trace
        if trace.time_s is clock
        else replace(trace, time_s=clock, values=np.interp(clock, trace.time_s, trace.values))
        for trace in traces
    )
