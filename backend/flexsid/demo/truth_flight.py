"""Closed-loop simulation of the true aircraft, with sensor outputs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from flexsid.demo.flex28 import Truth
from flexsid.demo.surface_faults import SurfaceFault
from flexsid.records.aircraft import Sensor
from flexsid.sysid.model.condition import FlightCondition
from flexsid.sysid.model.derivatives import DerivativeTable
from flexsid.sysid.model.sensor_models import ATTITUDE, GYRO, STRAIN, VANE
from flexsid.sysid.simulation import sensors as feel
from flexsid.sysid.simulation.airframe import Airframe, assemble_airframe
from flexsid.sysid.simulation.closed_loop import SimulatedMotion, simulate_closed_loop

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
