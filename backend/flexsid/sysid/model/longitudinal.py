"""Longitudinal axis: motions alpha and q, attitude theta, rows of sensors (Eqs 5-17)."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float

from flexsid.sysid.model.condition import GRAVITY, FlightCondition, Trim
from flexsid.sysid.model.rigid_body import (
    ACCELERATION,
    INTEGRAL,
    POSITION,
    RATE,
    FreeFlight,
    Kinematics,
    Mounting,
    RigidBody,
    stack_factors,
)


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


def mounted_accelerometer_row(
    axis: str, at: Mounting, condition: FlightCondition
) -> Float[np.ndarray, "4 n_r"]:
    """Build the row of an accelerometer where it is mounted. [m/s2]"""
    return accelerometer_row(axis, at.position, at.translation, at.rotation, condition)


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


def _kinematics(condition: FlightCondition, trim: Trim) -> Kinematics:
    """Known terms of alpha-dot in alpha and theta (second matrix of Eq. 14a)."""
    V = trim.airspeed
    tilt = GRAVITY * np.sin(condition.gamma) / V
    coupling = np.zeros((*V.shape, 2, 2))
    coupling[..., 0, 0] = tilt - trim.thrust * np.cos(trim.alpha) / (condition.mass * V)
    coupling[..., 0, 1] = 1.0
    gravity = np.zeros((*V.shape, 2))
    gravity[..., 0] = -tilt
    attitude_rate = np.broadcast_to(np.array([0.0, 1.0]), (*V.shape, 2))
    return Kinematics(np.eye(2), coupling, gravity, attitude_rate)


def _scale_rows(condition: FlightCondition, trim: Trim) -> Float[np.ndarray, "*n_v 2"]:
    force = trim.dynamic_pressure * condition.area
    return stack_factors(
        force / (condition.mass * trim.airspeed),
        force * condition.chord / condition.pitch_inertia,
    )


def _scale_motions(condition: FlightCondition, trim: Trim) -> Float[np.ndarray, "*n_v 2"]:
    return stack_factors(1.0, condition.chord / (2.0 * trim.airspeed))


def _describe_free_flight(condition: FlightCondition) -> FreeFlight:
    """Describe heave (up) and pitch: alpha = theta - hdot/V, q = thetadot.

    Thrust follows the body: it acts on heave by the angle of attack.
    """
    forward = condition.thrust * np.cos(condition.alpha)
    return FreeFlight(
        position=np.array([[0.0, 1.0], [0.0, 0.0]]),
        rate=np.array([[-1.0, 0.0], [0.0, 0.5 * condition.chord]]),
        force=condition.area * np.diag([-1.0, condition.chord]),
        mass=np.diag([condition.mass, condition.pitch_inertia]),
        damping=np.diag([forward / condition.airspeed, 0.0]),
        stiffness=np.array([[0.0, -forward], [0.0, 0.0]]),
        membership=np.ones((1, 2)),
    )


LONGITUDINAL = RigidBody(
    axis="longitudinal",
    symmetry="symmetric",
    motions=("alpha", "q"),
    attitude="theta",
    coefficients=("CZ", "Cm"),
    poles={"SP": ("alpha", "q", "theta")},
    acts_by_gravity=False,
    acceleration="normal",
    kinematics=_kinematics,
    scale_rows=_scale_rows,
    scale_motions=_scale_motions,
    free_flight=_describe_free_flight,
)
