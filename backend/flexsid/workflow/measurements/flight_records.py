"""Sensors of a maneuver for checks of compatibility, at their own times and with their noise."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from flexsid.errors import BadInput
from flexsid.records.aircraft import Aircraft, Sensor
from flexsid.records.maneuver import Channel, Maneuver, Role
from flexsid.storage.recordings import read_channels
from flexsid.storage.store import Store
from flexsid.sysid.compatibility.kinematics import ALTITUDE, CompatibilitySensor, FlightRecord
from flexsid.sysid.model.rigid_body import body_axes
from flexsid.sysid.model.sensor_models import ACCELEROMETER, AIRSPEED_PROBE, ATTITUDE, GYRO, VANE
from flexsid.sysid.preparation.resampling import find_new_samples, resample
from flexsid.sysid.preparation.spikes_and_dropouts import SampleDefect, find_defects
from flexsid.units import to_si
from flexsid.workflow.aircraft.aircraft_models import (
    build_flight_condition,
    define_outputs,
    get_output_instrument,
)
from flexsid.workflow.measurements.maneuver_spectra import read_conditioning
from flexsid.workflow.measurements.recording import Conditioning
from flexsid.workflow.measurements.sensor_faults import (
    FrozenInterval,
    HeldChannel,
    RecordedSensors,
)

_KINDS = (ACCELEROMETER.kind, GYRO.kind, ATTITUDE.kind, VANE.kind)
_AIRSPEED, _ALTITUDE = "airspeed", "altitude"  # condition channels
_QUIET = 2.0  # times its noise: a channel of smaller standard deviation hardly moves
_RESOLUTION = 1.0 / np.sqrt(12.0)  # of a digit: standard deviation of rounding
_LEAST_NOISE = 1e-4  # of the standard deviation of the samples
_LARGEST_GAP = 0.5  # of the record
MAX_CLIPPED = 0.005  # of the samples: a channel with more does not measure its motion


def read_flight_record(store: Store, maneuver: Maneuver) -> RecordedSensors:
    """Read all sensors of a maneuver that kinematics relate, corrected, at their own times.

    Airspeed is that recorded, else that of the condition. It is compared itself only beside a
    forward accelerometer, which measures its derivative.

    Raises
    ------
    BadInput
        If no sensor was recorded, or the maneuver has no airspeed.
    """
    assert maneuver.id is not None
    aircraft = store.aircraft.get(maneuver.aircraft_id)
    condition = build_flight_condition(aircraft, maneuver.condition)
    channels = read_channels(store.database, maneuver.id)
    steps = read_conditioning(store, maneuver.id)
    sensors = {one.name: one for one in aircraft.sensors}
    found: dict[str, CompatibilitySensor] = {}
    excluded: dict[str, str] = {}
    held: list[HeldChannel] = []
    frozen: dict[tuple[float, float], list[str]] = {}
    for name, (channel, samples) in channels.items():
        if channel.role is Role.INPUT:
            held += _find_held(channel, samples, steps)
            continue
        if channel.role is not Role.OUTPUT and name not in (_AIRSPEED, _ALTITUDE):
            continue
        sensor = _find_sensor(name, channel, sensors)
        if sensor is None:
            excluded[name] = "the aircraft record has no such sensor"
            continue
        if sensor.kind not in (*_KINDS, AIRSPEED_PROBE.kind, ALTITUDE):
            excluded[name] = f"kinematics do not relate a {sensor.kind} to other sensors"
            continue
        if (clipped := _compute_clipped_share(samples)) > MAX_CLIPPED:
            excluded[name] = f"it is clipped for {clipped:.1%} of its samples"
            continue
        one = _read_sensor(aircraft, sensor, channel, samples, steps.get(name, Conditioning()))
        if np.std(one.samples) < _QUIET * one.noise_std:
            excluded[name] = "it contains little but noise"
            continue
        held += _find_held(channel, samples, steps)
        if find_new_samples(samples) is None and channel.role is Role.OUTPUT:
            for interval in _find_frozen(channel, samples):
                frozen.setdefault(interval, []).append(name)
        position = body_axes(sensor.location_m, condition)
        found[name] = replace(one, position=position)
    speed = found.pop(_AIRSPEED, None)
    forward = any((s.kind, s.axis) == (ACCELEROMETER.kind, "x") for s in found.values())
    if speed is not None and forward:
        found[_AIRSPEED] = speed
    if not forward:
        for name in [n for n, s in found.items() if s.kind == AIRSPEED_PROBE.kind]:
            excluded[name] = "airspeed is checked by a forward accelerometer, which is missing"
            del found[name]
    if not found:
        raise BadInput(
            "no accelerometer, gyro, attitude or vane of the aircraft record was recorded in "
            "this maneuver, or none moves",
            code="no-sensors",
        )
    record = FlightRecord(tuple(found.values()), condition, speed)
    gaps = tuple(
        FrozenInterval(tuple(names), *interval) for interval, names in sorted(frozen.items())
    )
    if sum(one.stop_s - one.start_s for one in gaps) < _LARGEST_GAP * record.duration_s:
        record = replace(record, gaps=tuple((one.start_s, one.stop_s) for one in gaps))
    return RecordedSensors(record, tuple(held), gaps, excluded)


def list_moving(store: Store, maneuver_id: int, names: Sequence[str]) -> list[str]:
    """List the recorded channels that contain more than their noise."""
    found = read_channels(store.database, maneuver_id, names)
    values = {name: np.asarray(samples, dtype=float) for name, (_, samples) in found.items()}
    return [n for n, x in values.items() if np.std(x) >= _QUIET * _estimate_noise(x)]


def _find_sensor(name: str, channel: Channel, sensors: Mapping[str, Sensor]) -> Sensor | None:
    if channel.role is Role.OUTPUT:
        return sensors.get(channel.sensor or name, sensors.get(name))
    kind = AIRSPEED_PROBE.kind if name == _AIRSPEED else ALTITUDE
    return Sensor(name=name, kind=kind, point="", axis="x" if name == _AIRSPEED else "z")


def _read_sensor(
    aircraft: Aircraft,
    sensor: Sensor,
    channel: Channel,
    samples: np.ndarray,
    steps: Conditioning,
) -> CompatibilitySensor:
    """Read the samples of a sensor at the times at which they are new, its instrument removed."""
    raw = np.asarray(to_si(samples, channel.unit), dtype=float)
    values = steps.correct(raw, channel.rate_hz)
    new = find_new_samples(np.asarray(samples, dtype=float))
    index = np.arange(values.size) if new is None else new
    time = channel.start_s + index / channel.rate_hz
    noise = _estimate_noise(values[index])
    if new is None and sensor.instrument is not None:
        (output,) = define_outputs(aircraft, (sensor.name,))
        response = get_output_instrument(aircraft, output).response
        clock = channel.rate_hz, channel.start_s, values.size
        values = resample(values, *clock[:2], *clock, response)
    return CompatibilitySensor(
        name=channel.name,
        kind=sensor.kind,
        axis=sensor.axis,
        position=(0.0, 0.0, 0.0),
        time=time - steps.delay_s,
        samples=values[index],
        noise_std=noise,
    )


def _estimate_noise(values: np.ndarray) -> float:
    """Standard deviation of white noise, by third differences, and of rounding.

    Notes
    -----
    A third difference of white noise has twenty times its variance, and hardly any of a smooth
    signal; the median is robust to where the signal is not.
    """
    away = np.abs(np.diff(values, 3))
    levels = np.unique(values)
    digit = float(np.diff(levels).min()) if 1 < levels.size < values.size // 4 else 0.0
    white = 1.4826 * float(np.median(away)) / np.sqrt(20.0) if away.size else 0.0
    return max(white, _RESOLUTION * digit, _LEAST_NOISE * float(np.std(values)), 1e-12)


def _find_held(
    channel: Channel, samples: np.ndarray, steps: Mapping[str, Conditioning]
) -> list[HeldChannel]:
    """Find a channel that repeats its samples, and of which nobody has said what is between."""
    if steps.get(channel.name, Conditioning()).between is not None:
        return []
    new = find_new_samples(np.asarray(samples, dtype=float))
    if new is None:
        return []
    rate = channel.rate_hz * (new.size - 1) / float(new[-1] - new[0])
    return [HeldChannel(channel.name, rate, channel.rate_hz, channel.role is Role.INPUT)]


def _compute_clipped_share(samples: np.ndarray) -> float:
    defects = find_defects(np.asarray(samples, dtype=float))
    clipped = (one for one in defects if one.kind is SampleDefect.SATURATION)
    return sum(one.stop - one.first for one in clipped) / samples.size


def _find_frozen(channel: Channel, samples: np.ndarray) -> Iterator[tuple[float, float]]:
    x = np.asarray(samples, dtype=float)
    for defect in find_defects(x):
        at_end = defect.first == 0 or defect.stop == x.size
        if defect.kind is SampleDefect.DROPOUT and not at_end:
            yield channel.get_time(defect.first), channel.get_time(defect.stop)
