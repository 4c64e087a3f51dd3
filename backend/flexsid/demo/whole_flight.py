"""A whole flight as one recording: maneuvers with steady flight between, nothing cut yet."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from flexsid.demo.flights import TRIM_S, FlownManeuver
from flexsid.demo.recorder import FlownChannel
from flexsid.records.flight import Flight, FlightChannel
from flexsid.records.maneuver import Role
from flexsid.storage.store import Store

PAUSE_S = 20.0
"""Steady flight before the first maneuver, between two, and after the last."""


def record_flight(flown: Sequence[FlownManeuver]) -> tuple[FlownChannel, ...]:
    """Join maneuvers of the same channels to one recording."""
    joined = []
    for columns in zip(*(one.channels for one in flown), strict=True):
        pieces = [_pause(columns[0])]
        for column, following in zip(columns, (*columns[1:], columns[-1]), strict=True):
            pieces += [column.samples, _between(column, following)]
        samples = np.concatenate(pieces).astype(columns[0].samples.dtype)
        joined.append(replace(columns[0], samples=samples))
    return tuple(joined)


def add_recording(
    store: Store, channels: Sequence[FlownChannel], flight: Flight, start_s: float = 0.0
) -> None:
    """Keep a recording as the channels of a flight."""
    assert flight.id is not None
    with store.transaction():
        for channel in channels:
            store.flight_channels.add(
                FlightChannel(
                    flight_id=flight.id,
                    name=channel.name,
                    unit=channel.unit,
                    role=channel.role,
                    rate_hz=channel.rate_hz,
                    start_s=start_s,
                    n_samples=channel.samples.size,
                    array=store.arrays.put(channel.samples, channel.unit),
                )
            )


def _pause(channel: FlownChannel) -> np.ndarray:
    """Steady flight: the trim of a maneuver over and over, forwards and backwards."""
    count = round(PAUSE_S * channel.rate_hz)
    trim = channel.samples[: max(2, round(0.9 * TRIM_S * channel.rate_hz))]
    there_and_back = np.concatenate([trim[::-1], trim])
    return np.tile(there_and_back, -(-count // there_and_back.size))[-count:]


def _between(channel: FlownChannel, following: FlownChannel) -> np.ndarray:
    """From one maneuver to the next: conditions and trim change slowly, commands rest."""
    steady = _pause(following)
    if channel.role is Role.COMMAND:
        return steady
    last = float(channel.samples[-max(1, round(0.2 * channel.rate_hz)) :].mean())
    change = last - float(steady.mean())
    ramp = 0.5 * (1.0 + np.cos(np.pi * np.arange(steady.size) / steady.size))
    return steady + change * ramp
