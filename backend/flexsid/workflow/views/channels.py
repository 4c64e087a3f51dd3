"""Recorded channels and their symmetric combinations by name, in SI."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from flexsid.errors import BadInput
from flexsid.records.aircraft import Combination
from flexsid.records.maneuver import Channel, Maneuver, Role
from flexsid.records.views import ChannelTrace
from flexsid.storage.store import Store
from flexsid.units import si_unit, to_si
from flexsid.workflow.measurements.conditioning import read_conditioning
from flexsid.workflow.measurements.recording import Conditioning

Interval = tuple[float, float]
_Parts = list[tuple[Channel, float]]


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
