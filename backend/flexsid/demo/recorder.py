"""The recorder on board: instruments, noise, native units and three sampling rates."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from flexsid.demo.aircraft import build_thrust_table
from flexsid.demo.truth_flight import RATE_HZ
from flexsid.records.aircraft import Aircraft, Sensor
from flexsid.records.live import StreamChannel
from flexsid.records.maneuver import Role
from flexsid.sysid.model.condition import FlightCondition
from flexsid.sysid.model.instruments import Butterworth, Instrument
from flexsid.sysid.model.sensor_models import ACCELEROMETER, ATTITUDE, GYRO, STRAIN, VANE
from flexsid.sysid.simulation.recording import apply_instruments
from flexsid.units import factor, lookup
from flexsid.workflow.aircraft.thrust import TOTAL_TEMPERATURE, compute_total_temperature

HIGH, MEDIUM, LOW = RATE_HZ, 200.0, 20.0
"""The three rates of the paper: f_s, 0.20 f_s, 0.02 f_s. [Hz]"""

# Surfaces, the nose gyro and the outboard accelerometers are recorded fast; the
# navigation unit, the vane and the strain gauges at the analysis rate.
_FAST = ("q", "az_ofl", "az_ofr", "az_oal", "az_oar")

_UNITS = {
    ACCELEROMETER.kind: "g",
    GYRO.kind: "rad/s",
    ATTITUDE.kind: "rad",
    VANE.kind: "rad",
    STRAIN.kind: "ustrain",
}


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FlownChannel(StreamChannel):
    """One recorded channel in its native unit; ``samples`` (n,) as recorded."""

    samples: np.ndarray

    def save(self, put: Callable[[np.ndarray, str], str]) -> dict[str, Any]:
        """Store the samples and return the fields of the record of the channel."""
        return {
            "name": self.name,
            "unit": self.unit,
            "role": self.role,
            "rate_hz": self.rate_hz,
            "n_samples": self.samples.size,
            "array": put(self.samples, self.unit),
        }


class Recorder:
    """Records in single precision; without a noise generator, free of noise.

    Noise is white and enters before the anti-alias filter. ``noise_std`` of a
    sensor is defined at the medium rate without that filter, so that the noise
    spectrum of a channel does not depend on its rate.
    """

    def __init__(
        self, aircraft: Aircraft, anti_alias: Butterworth, noise: np.random.Generator | None
    ) -> None:
        self._aircraft = aircraft
        self._anti_alias = Instrument(elements=(anti_alias,))
        self._noise = noise

    def surfaces(self, deflections: np.ndarray, lead: int = 0) -> list[FlownChannel]:
        """Record surface positions by their potentiometers, from the sample ``lead``."""
        surfaces = self._aircraft.surfaces
        measured = self._measure(
            deflections,
            [str(surface.instrument) for surface in surfaces],
            [surface.noise_std_rad or 0.0 for surface in surfaces],
        )[lead:]
        return [
            _channel(surface.name, "rad", Role.INPUT, HIGH, samples)
            for surface, samples in zip(surfaces, measured.T, strict=True)
        ]

    def sensors(
        self,
        sensors: Sequence[Sensor],
        true_values: np.ndarray,
        condition: FlightCondition,
        lead: int = 0,
    ) -> list[FlownChannel]:
        """Record sensors, including their readings in trim, from the sample ``lead``."""
        measured = self._measure(
            true_values,
            [str(sensor.instrument) for sensor in sensors],
            [sensor.noise_std or 0.0 for sensor in sensors],
        )[lead:]
        channels = []
        for sensor, samples in zip(sensors, measured.T, strict=True):
            unit = _UNITS[sensor.kind]
            rate = HIGH if sensor.name in _FAST else MEDIUM
            level = samples + compute_trim_reading(sensor, condition)
            channels.append(
                _channel(sensor.name, unit, Role.OUTPUT, rate, level / lookup(unit).factor)
            )
        return channels

    def commands(self, names: Sequence[str], excitation: np.ndarray) -> list[FlownChannel]:
        """Record the excitation as it was added to the commands: digital, without noise."""
        return [
            _channel(f"{name}_command", "rad", Role.COMMAND, MEDIUM, samples)
            for name, samples in zip(names, excitation.T, strict=True)
        ]

    def _measure(
        self, true: np.ndarray, instruments: Sequence[str], noise_std: Sequence[float]
    ) -> np.ndarray:
        own = [self._aircraft.instruments[name] for name in instruments]
        measured = apply_instruments(true, HIGH, own)
        if self._noise is None:
            return measured
        white = self._noise.standard_normal(true.shape) * np.array(noise_std)
        white *= np.sqrt(HIGH / MEDIUM)
        return measured + apply_instruments(white, HIGH, [self._anti_alias] * len(instruments))


def compute_trim_reading(sensor: Sensor, condition: FlightCondition) -> float:
    """Return the reading of a sensor in steady level flight. [SI unit of the sensor]"""
    gravity = factor("g", "acceleration")
    if sensor.kind in (VANE.kind, ATTITUDE.kind):
        return condition.alpha if sensor.axis == "y" else 0.0
    if sensor.kind == ACCELEROMETER.kind:
        tilt = {"x": np.sin(condition.alpha), "y": 0.0, "z": -np.cos(condition.alpha)}
        return gravity * float(tilt[sensor.axis])
    return 0.0


def condition_channels(
    condition: FlightCondition,
    fuel: float,
    altitude: float,
    duration_s: float,
    noise_std: float,
    noise: np.random.Generator | None,
) -> list[FlownChannel]:
    """Record the flight condition at the low rate.

    Parameters
    ----------
    condition
        Flight condition; the recorded values have small variations about it.
    fuel
        Fuel fraction in the middle of the record; it burns down slowly. [1]
    altitude
        Pressure altitude. [m]
    duration_s
        Length of the record. [s]
    noise_std
        Noise of the airspeed. [m/s]
    noise
        None for constants.
    """
    time = np.arange(round(duration_s * LOW)) / LOW
    level = np.ones_like(time)
    airspeed, height = condition.airspeed * level, altitude * level
    if noise is not None:
        airspeed *= 1.0 + 0.002 * _generate_drift(time, noise)
        airspeed += noise_std * noise.standard_normal(time.size)
        height += 3.0 * _generate_drift(time, noise)
    burn = 0.004 * (time / duration_s - 0.5) if noise is not None else 0.0 * time
    values = (
        ("airspeed", "m/s", airspeed),
        ("altitude", "m", height),
        ("density", "kg/m3", condition.density * level),
        ("fuel_fraction", "1", fuel - burn),
        ("alpha_trim", "rad", condition.alpha * level),
        *_engines(condition, level),
    )
    return [_channel(name, unit, Role.CONDITION, LOW, samples) for name, unit, samples in values]


def _engines(
    condition: FlightCondition, level: np.ndarray
) -> Iterator[tuple[str, str, np.ndarray]]:
    """Yield rotation speeds at which thrust balances drag, and the total temperature."""
    table = build_thrust_table()
    kelvin = compute_total_temperature(condition.density, condition.airspeed)
    each = np.array([np.interp(kelvin, table.total_temperature_k, row) for row in table.thrust_n])
    speed = np.interp(condition.thrust / len(table.engines), each, table.engine_speed_rad_s)
    for name in table.engines:
        yield name, "rpm", speed / factor("rpm", "angular rate") * level
    yield TOTAL_TEMPERATURE, "K", kelvin * level


def _generate_drift(time: np.ndarray, noise: np.random.Generator) -> np.ndarray:
    """Return a slow drift of about unit amplitude and zero mean."""
    periods = time[-1] * np.array([0.5, 1.0, 2.5])
    drift = np.sin(
        2.0 * np.pi * time[:, None] / periods + noise.uniform(0.0, 2.0 * np.pi, 3)
    ) @ np.array([0.3, 0.5, 0.6])
    return drift - drift.mean()


def _channel(name: str, unit: str, role: Role, rate: float, samples: np.ndarray) -> FlownChannel:
    """Return a channel with every n-th sample, after the anti-alias filter."""
    step = round(HIGH / rate) if rate != LOW else 1
    return FlownChannel(
        name=name,
        unit=unit,
        role=role,
        rate_hz=rate,
        samples=np.ascontiguousarray(samples[::step], dtype=np.float32),
    )
