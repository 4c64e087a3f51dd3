"""Sensor equations: outputs per rigid and elastic motion (Eq. 17), as polynomials in s.

With the motion r = [alpha, q, eta_1..n] every output is a known combination
y = (P_-1 / s + P_0 + P_1 s + P_2 s^2) r: theta = q/s, etadot = s eta, and
forces are expressed by the accelerations. No derivative enters P, so that one
model serves all three estimators without C and D of its own.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float

from flexsid.errors import BadInput
from flexsid.sysid.model.condition import GRAVITY, FlightCondition

INTEGRAL, POSITION, RATE, ACCELERATION = range(4)


@dataclass(frozen=True, slots=True)
class SensorRows:
    """Coefficients of 1/s, 1, s, s^2 for each output; axis 0 is the power."""

    names: tuple[str, ...]
    polynomial: Float[np.ndarray, "4 n_y n_r"]

    def response(
        self, omega: Float[np.ndarray, " n_omega"]
    ) -> Complex[np.ndarray, "n_omega n_y n_r"]:
        """Compute the outputs per unit motion at each frequency. [output unit]

        Raises
        ------
        BadInput
            If a frequency is not above zero.
        """
        w = np.asarray(omega, dtype=float)
        if not np.all(w > 0.0):
            raise BadInput(
                "a frequency is 0 Hz or negative, where motion has no frequency response; begin "
                "the band above 0 Hz",
                code="line-at-zero",
            )
        powers = np.stack([1.0 / w, np.ones_like(w), w, w * w], axis=1)
        weighted = np.array([-1j, 1.0, 1j, -1.0])[:, None] * self.polynomial.reshape(4, -1)
        response = (powers @ weighted.view(float)).view(complex)
        return response.reshape(w.size, *self.polynomial.shape[1:])

    def rigid_only(self) -> SensorRows:
        """Return the same sensors without elastic response (C_e = 0, Fig. 11)."""
        polynomial = self.polynomial.copy()
        polynomial[:, :, 2:] = 0.0
        return SensorRows(self.names, polynomial)


def stack_rows(names: Sequence[str], rows: Sequence[Float[np.ndarray, "4 n_r"]]) -> SensorRows:
    """Stack single rows to one set."""
    return SensorRows(tuple(names), np.stack(rows, axis=1))


def center_of_gravity_acceleration(
    condition: FlightCondition, n_modes: int
) -> Float[np.ndarray, "4 n_r"]:
    """Build the row of an accelerometer at the c.g.: normal acceleration, V times Z.

    Notes
    -----
    Z is alpha-dot less q and less the thrust and gravity terms of Eq. 14a.
    """
    row = np.zeros((4, 2 + n_modes))
    sine = np.sin(condition.gamma)
    row[RATE, 0] = condition.airspeed
    row[POSITION, 1] = -condition.airspeed
    row[POSITION, 0] = condition.thrust * np.cos(condition.alpha) / condition.mass - GRAVITY * sine
    row[INTEGRAL, 1] = GRAVITY * sine
    return row


def body_axes(
    location: tuple[float, float, float], condition: FlightCondition
) -> tuple[float, float, float]:
    """Transform a structural location (x aft, y right, z up) to body axes at the c.g. [m]"""
    x, y, z = location
    return condition.x_cg - x, y, condition.z_cg - z


def accelerometer_row(
    axis: str,
    position: tuple[float, float, float],
    translation: Float[np.ndarray, "3 n_modes"],
    rotation: Float[np.ndarray, "3 n_modes"],
    condition: FlightCondition,
) -> Float[np.ndarray, "4 n_r"]:
    """Build the row of an accelerometer at a body-axes position, with gravity by tilt. [m/s2]

    Raises
    ------
    ValueError
        If the axis is not x, y or z.
    """
    x, _, z = position
    n_modes = translation.shape[1]
    normal = center_of_gravity_acceleration(condition, n_modes)
    row = np.zeros_like(normal)
    if axis == "z":
        row += normal
        row[RATE, 1] -= x
        row[POSITION, 2:] += GRAVITY * np.sin(condition.alpha) * rotation[1]
    elif axis == "x":
        lift = condition.lift_coefficient
        row -= (condition.alpha - 2.0 * condition.induced_drag * lift) * normal
        row[POSITION, 0] += GRAVITY
        row[RATE, 1] += z
        row[POSITION, 2:] += GRAVITY * rotation[1]
    elif axis == "y":
        row[POSITION, 2:] -= GRAVITY * rotation[0]
    else:
        raise ValueError(f"accelerometer axis must be x, y or z, not '{axis}'")
    row[ACCELERATION, 2:] += translation["xyz".index(axis)]
    return row


def gyro_row(rotation: Float[np.ndarray, "3 n_modes"]) -> Float[np.ndarray, "4 n_r"]:
    """Build the row of a pitch-rate gyro: q and the local elastic rate. [rad/s]"""
    row = np.zeros((4, 2 + rotation.shape[1]))
    row[POSITION, 1] = 1.0
    row[RATE, 2:] = rotation[1]
    return row


def attitude_row(rotation: Float[np.ndarray, "3 n_modes"]) -> Float[np.ndarray, "4 n_r"]:
    """Build the row of pitch attitude with the local elastic slope. [rad]"""
    row = np.zeros((4, 2 + rotation.shape[1]))
    row[INTEGRAL, 1] = 1.0
    row[POSITION, 2:] = rotation[1]
    return row


def vane_row(
    position: tuple[float, float, float],
    translation: Float[np.ndarray, "3 n_modes"],
    rotation: Float[np.ndarray, "3 n_modes"],
    condition: FlightCondition,
) -> Float[np.ndarray, "4 n_r"]:
    """Build the row of an angle-of-attack vane on a boom, elastic parts included. [rad]"""
    row = np.zeros((4, 2 + rotation.shape[1]))
    row[POSITION, 0] = 1.0
    row[POSITION, 1] = -position[0] / condition.airspeed
    row[POSITION, 2:] = rotation[1]
    row[RATE, 2:] = translation[2] / condition.airspeed
    return row


def strain_row(strain: Float[np.ndarray, " n_modes"]) -> Float[np.ndarray, "4 n_r"]:
    """Build the row of a strain gauge from the modal strains. [1]"""
    row = np.zeros((4, 2 + strain.size))
    row[POSITION, 2:] = strain
    return row
