"""Sensors on the flexible airframe, as rows on [x, u]."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float

from flexsid.sysid.model.condition import GRAVITY
from flexsid.sysid.simulation.airframe import ALPHA, THETA, Airframe, Q


def accelerometer(
    airframe: Airframe, axis: str, point: str, position: Float[np.ndarray, " xyz"]
) -> Float[np.ndarray, " n_w"]:
    """Build the row of an accelerometer along a body axis, with gravity by tilt. [m/s2]

    ``point`` is the name of one of the mode shapes, ``position`` in body axes from the centre of
    gravity. [m]
    """
    translation, rotation = _shapes(airframe, point)
    n = translation.shape[1]
    pitch_acceleration = airframe.rates[1]
    modal_acceleration = airframe.rates[3 + n : 3 + 2 * n]
    row = translation["xyz".index(axis)] @ modal_acceleration
    if axis == "x":
        row += airframe.drag_row + position[2] * pitch_acceleration
        row[3 : 3 + n] += GRAVITY * rotation[1]
    elif axis == "y":
        row[3 : 3 + n] -= GRAVITY * rotation[0]
    else:
        row += airframe.lift_row - position[0] * pitch_acceleration
        row[3 : 3 + n] += GRAVITY * np.sin(airframe.condition.alpha) * rotation[1]
    return row


def gyro(airframe: Airframe, point: str) -> Float[np.ndarray, " n_w"]:
    """Build the row of a gyro: pitch rate of airframe and local structure. [rad/s]"""
    _, rotation = _shapes(airframe, point)
    n = rotation.shape[1]
    row = np.zeros(airframe.rates.shape[1])
    row[Q] = 1.0
    row[3 + n : 3 + 2 * n] = rotation[1]
    return row


def attitude(airframe: Airframe, point: str) -> Float[np.ndarray, " n_w"]:
    """Build the row of pitch attitude with the local slope of the structure. [rad]"""
    _, rotation = _shapes(airframe, point)
    row = np.zeros(airframe.rates.shape[1])
    row[THETA] = 1.0
    row[3 : 3 + rotation.shape[1]] = rotation[1]
    return row


def vane(
    airframe: Airframe, point: str, position: Float[np.ndarray, " xyz"]
) -> Float[np.ndarray, " n_w"]:
    """Build the row of an angle-of-attack vane on a flexible boom. [rad]"""
    translation, rotation = _shapes(airframe, point)
    n = rotation.shape[1]
    speed = airframe.condition.airspeed
    row = np.zeros(airframe.rates.shape[1])
    row[ALPHA] = 1.0
    row[Q] = -position[0] / speed
    row[3 : 3 + n] = rotation[1]
    row[3 + n : 3 + 2 * n] = translation[2] / speed
    return row


def strain_gauge(airframe: Airframe, gauge: str) -> Float[np.ndarray, " n_w"]:
    """Build the row of a strain gauge. [1]"""
    modes = airframe.modes
    row = np.zeros(airframe.rates.shape[1])
    row[3 : 3 + len(modes.numbers)] = modes.strain[modes.gauges.index(gauge)]
    return row


def _shapes(
    airframe: Airframe, point: str
) -> tuple[Float[np.ndarray, "3 n_modes"], Float[np.ndarray, "3 n_modes"]]:
    index = airframe.modes.points.index(point)
    return airframe.modes.translation[index], airframe.modes.rotation[index]
