"""The true aircraft in closed loop, with faults of a surface, and the recorder on board."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Any

import numpy as np
from jaxtyping import Float

from flexsid.demo.aircraft import build_thrust_table
from flexsid.demo.flex28 import Truth
from flexsid.records.aircraft import Aircraft, Sensor
from flexsid.records.live import StreamChannel
from flexsid.records.maneuver import Role
from flexsid.sysid.model.condition import FlightCondition
from flexsid.sysid.model.derivatives import DerivativeTable
from flexsid.sysid.model.sensor_models import (
    ACCELEROMETER,
    ATTITUDE,
    GYRO,
    STRAIN,
    VANE,
    Butterworth,
    Instrument,
)
from flexsid.sysid.simulation import sensors as feel
from flexsid.sysid.simulation.airframe import Airframe, apply_instruments, assemble_airframe
from flexsid.sysid.simulation.closed_loop import (
    Actuator,
    ScheduledController,
    SimulatedMotion,
    simulate_closed_loop,
)
from flexsid.units import factor, lookup
from flexsid.workflow.aircraft.flight_condition import TOTAL_TEMPERATURE, compute_total_temperature

# --- Faults of a surface in flight, for checks of the flown against the commanded -----------------


class FaultKind(StrEnum):
    """What a surface does wrong."""

    STUCK = "stuck"  # it does not move
    REVERSED = "reversed"  # it moves against the excitation
    OSCILLATING = "oscillating"  # it oscillates without command
    SLOW = "slow"  # all actuators have a lower rate limit


@dataclass(frozen=True, slots=True, kw_only=True)
class SurfaceFault:
    """Fault of one surface; amplitude [rad] and frequency [Hz] of an oscillation, rate [rad/s]."""

    kind: FaultKind
    surface: str
    amplitude: float = 0.0
    frequency_hz: float = 0.0
    rate_limit: float = np.inf

    def apply(
        self,
        excitation: Float[np.ndarray, "n_samples n_u"],
        inputs: tuple[str, ...],
        rate_hz: float,
    ) -> Float[np.ndarray, "n_samples n_u"]:
        """Compute the excitation that acts instead of the commanded one. [rad]"""
        flown, k = excitation.copy(), inputs.index(self.surface)
        if self.kind is FaultKind.STUCK:
            flown[:, k] = 0.0
        elif self.kind is FaultKind.REVERSED:
            flown[:, k] *= -1.0
        elif self.kind is FaultKind.OSCILLATING:
            time = np.arange(len(flown)) / rate_hz
            flown[:, k] += self.amplitude * np.sin(2.0 * np.pi * self.frequency_hz * time)
        return flown

    def limit(self, actuator: Actuator) -> Actuator:
        """Return the actuators with this fault."""
        return replace(actuator, rate_limit=min(actuator.rate_limit, self.rate_limit))

    def disconnect(self, controller: ScheduledController) -> ScheduledController:
        """Return the controller with this fault: it does not move a surface that is stuck."""
        if self.kind is not FaultKind.STUCK or self.surface not in controller.surfaces:
            return controller
        gains = controller.gains.copy()
        gains[controller.surfaces.index(self.surface)] = 0.0
        return replace(controller, gains=gains)


# --- Closed-loop simulation of the true aircraft, with sensor outputs -----------------------------

RATE_HZ = 1000.0
"""Rate of the simulation and of the fastest recorder channels."""


@dataclass(frozen=True, slots=True, eq=False)
class TrueFlight:
    """One simulation without instruments: ``felt`` (n_samples, n_sensors) in SI."""

    condition: FlightCondition
    derivatives: DerivativeTable
    motion: SimulatedMotion
    felt: np.ndarray


def fly_truth(
    truth: Truth,
    sensors: Sequence[Sensor],
    airspeed: float,
    fuel: float,
    count: int,
    excitation: np.ndarray,
    gust: np.ndarray | None = None,
    fault: SurfaceFault | None = None,
) -> TrueFlight:
    """Simulate the response to an excitation from trim.

    Parameters
    ----------
    truth
        The aircraft with its actuators and its controller.
    sensors
        Sensors whose outputs are returned.
    airspeed
        True airspeed. [m/s]
    fuel
        Fuel fraction. [1]
    count
        Number of symmetric modes in the truth; the others are truncated.
    excitation
        Added to the surface commands at ``RATE_HZ``, (n_samples, 5). [rad]
    gust
        Angle of attack of turbulence at ``RATE_HZ``, None for still air. [rad]
    fault
        Fault of a surface, None for none.
    """
    condition = truth.condition_at(airspeed, fuel)
    derivatives = truth.derivatives_at(fuel, count)
    airframe = assemble_airframe(
        condition, truth.modes_at(fuel, count), derivatives, truth.shape_at(fuel, count)
    )
    motion = simulate_closed_loop(
        airframe,
        truth.actuator if fault is None else fault.limit(truth.actuator),
        excitation,
        RATE_HZ,
        truth.controller if fault is None else fault.disconnect(truth.controller),
        np.stack([feel.gyro(airframe, "nose_gyro"), feel.attitude(airframe, "egi_att")]),
        gust,
    )
    rows = sensor_rows(truth, airframe, sensors)
    return TrueFlight(condition, derivatives, motion, motion.sense(rows))


def sensor_rows(truth: Truth, airframe: Airframe, sensors: Sequence[Sensor]) -> np.ndarray:
    """Return the output matrix of sensors from states and surfaces, (n_sensors, n_w)."""
    return np.stack([_row(truth, airframe, sensor) for sensor in sensors])


def _row(truth: Truth, airframe: Airframe, sensor: Sensor) -> np.ndarray:
    if sensor.kind == STRAIN.kind:
        return feel.strain_gauge(airframe, sensor.point)
    if sensor.kind == GYRO.kind:
        return feel.gyro(airframe, sensor.point)
    if sensor.kind == ATTITUDE.kind:
        return feel.attitude(airframe, sensor.point)
    position = truth.body_position(sensor.point, airframe.condition)
    if sensor.kind == VANE.kind:
        return feel.vane(airframe, sensor.point, position)
    return feel.accelerometer(airframe, sensor.axis, sensor.point, position)


# --- The recorder on board: instruments, noise, native units and three sampling rates -------------

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
