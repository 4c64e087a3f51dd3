"""A whole flight as one recording: maneuvers separated by steady flight, not cut yet."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from datetime import date

import numpy as np

from flexsid.demo.flights import TRIM_S, FlownManeuver, fly
from flexsid.demo.recorder import FlownChannel
from flexsid.records.aircraft import Aircraft
from flexsid.records.maneuver import Flight, FlightChannel, Role
from flexsid.storage.store import Store
from flexsid.sysid.preparation.resampling import resample

PAUSE_S = 20.0
"""Steady flight before the first maneuver, between two, and after the last."""

_NUMBER = 4
_START_S = 480.0
_CARDS = ((0.65, 0.60, 506), (0.72, 0.57, 503))  # V/V_f, fuel, FTA
_LATE, _LATE_S = "az_mar", 0.009
_SPIKED, _SPIKES_S = "az_cf", (35.0, 88.0, 88.4)


def record_flight(
    flown: Sequence[FlownManeuver], pause_s: float = PAUSE_S
) -> tuple[FlownChannel, ...]:
    """Return one recording of maneuvers with the same channels, and steady flight about them."""
    joined = []
    for columns in zip(*(one.channels for one in flown), strict=True):
        pieces = [_build_pause(columns[0], pause_s)]
        for column, following in zip(columns, (*columns[1:], columns[-1]), strict=True):
            pieces += [column.samples, _build_transition(column, following, pause_s)]
        samples = np.concatenate(pieces).astype(columns[0].samples.dtype)
        joined.append(replace(columns[0], samples=samples))
    return tuple(joined)


def add_recording(
    store: Store, channels: Sequence[FlownChannel], flight: Flight, start_s: float = 0.0
) -> None:
    """Store a recording as the channels of a flight."""
    assert flight.id is not None
    with store.transaction():
        for channel in channels:
            fields = channel.save(store.arrays.put)
            store.flight_channels.add(FlightChannel(flight_id=flight.id, start_s=start_s, **fields))


def _build_pause(channel: FlownChannel, pause_s: float) -> np.ndarray:
    """Return steady flight: the trim of a maneuver, repeated forwards and backwards."""
    count = round(pause_s * channel.rate_hz)
    trim = channel.samples[: max(2, round(0.9 * TRIM_S * channel.rate_hz))]
    there_and_back = np.concatenate([trim[::-1], trim])
    return np.tile(there_and_back, -(-count // there_and_back.size))[-count:]


def _build_transition(channel: FlownChannel, following: FlownChannel, pause_s: float) -> np.ndarray:
    """Return the transition to the next maneuver: slow change of trim, zero commands."""
    steady = _build_pause(following, pause_s)
    if channel.role is Role.COMMAND:
        return steady
    last = float(channel.samples[-max(1, round(0.2 * channel.rate_hz)) :].mean())
    change = last - float(steady.mean())
    ramp = 0.5 * (1.0 + np.cos(np.pi * np.arange(steady.size) / steady.size))
    return steady + change * ramp


def add_uncut_flight(store: Store, aircraft: Aircraft, seed: int) -> None:
    """Simulate and store an uncut flight, if missing.

    Two of its channels are faulty, as test of the quality page: one accelerometer is
    delayed, another has spikes.
    """
    assert aircraft.id is not None
    if store.flights.find(aircraft_id=aircraft.id, number=_NUMBER):
        return
    flown = [
        fly(airspeed_ratio=ratio, fuel=fuel, fta=fta, seed=(seed, _NUMBER, index))
        for index, (ratio, fuel, fta) in enumerate(_CARDS)
    ]
    channels = tuple(_add_fault(channel) for channel in record_flight(flown))
    with store.transaction():
        flight = store.flights.add(
            Flight(
                aircraft_id=aircraft.id,
                number=_NUMBER,
                flown_on=date(2025, 5, 27),
                description="Recorded whole: its maneuvers wait to be cut",
            )
        )
        add_recording(store, channels, flight, _START_S)


def _add_fault(channel: FlownChannel) -> FlownChannel:
    samples = channel.samples.astype(float)
    if channel.name == _LATE:
        rate_hz = channel.rate_hz
        band = (0.0, 0.625 * rate_hz)
        samples = resample(samples, rate_hz, 0.0, rate_hz, -_LATE_S, samples.size, None, band)
    elif channel.name == _SPIKED:
        samples[np.round(np.array(_SPIKES_S) * channel.rate_hz).astype(int)] += 2.5
    else:
        return channel
    return replace(channel, samples=samples.astype(channel.samples.dtype))
