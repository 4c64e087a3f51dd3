"""Lateral-directional axis: motions beta, p and r, attitude phi, and the rows of its sensors.

Body axes at the c.g.; phi-dot = p + r tan theta0. The yaw angle feeds nothing back and is no
state.
"""

from __future__ import annotations

import numpy as np
from jaxtyping import Float

from flexsid.errors import BadInput
from flexsid.sysid.model.condition import GRAVITY, FlightCondition, Trim
from flexsid.sysid.model.rigid_body import (
    ACCELERATION,
    INTEGRAL,
    POSITION,
    RATE,
    SPIRAL,
    FreeFlight,
    Kinematics,
    Mounting,
    RigidBody,
    stack_factors,
)

BETA, P, R = range(3)


def side_acceleration(condition: FlightCondition, n_modes: int) -> Float[np.ndarray, "4 n_r"]:
    """Build the row of an accelerometer at the c.g. along y, V times the side force Y.

    Notes
    -----
    V (beta-dot - sin(alpha0) p + cos(alpha0) r) - g cos(theta0) phi: exact kinematics, without
    a derivative.
    """
    row = np.zeros((4, 3 + n_modes))
    V, alpha, theta = condition.airspeed, condition.alpha, condition.alpha + condition.gamma
    row[RATE, BETA] = V
    row[POSITION, P] = -V * np.sin(alpha)
    row[POSITION, R] = V * np.cos(alpha)
    row[INTEGRAL, P] = -GRAVITY * np.cos(theta)
    row[INTEGRAL, R] = row[INTEGRAL, P] * np.tan(theta)
    return row


def accelerometer_row(
    axis: str, at: Mounting, condition: FlightCondition
) -> Float[np.ndarray, "4 n_r"]:
    """Build the row of an accelerometer: antisymmetric part, lever arms and local tilt. [m/s2]

    Notes
    -----
    With g in body axes (-sin theta0, 0, cos theta0), phi and nu the shapes:

    - a_y: specific force at the c.g. + x r-dot - z p-dot + phi_y eta-ddot
      - g (cos theta0 nu_x + sin theta0 nu_z) eta
    - a_z: y p-dot + phi_z eta-ddot + g sin theta0 nu_y eta
    - a_x: -y r-dot + phi_x eta-ddot + g cos theta0 nu_y eta
    """
    x, y, z = at.position
    theta = condition.alpha + condition.gamma
    cos, sin = np.cos(theta), np.sin(theta)
    nu_x, nu_y, nu_z = at.rotation
    row = np.zeros((4, 3 + at.n_modes))
    if axis == "y":
        row = side_acceleration(condition, at.n_modes)
        row[RATE, R] += x
        row[RATE, P] -= z
        row[POSITION, 3:] -= GRAVITY * (cos * nu_x + sin * nu_z)
    elif axis == "z":
        row[RATE, P] = y
        row[POSITION, 3:] = GRAVITY * sin * nu_y
    else:
        row[RATE, R] = -y
        row[POSITION, 3:] = GRAVITY * cos * nu_y
    row[ACCELERATION, 3:] += at.translation["xyz".index(axis)]
    return row


def gyro_row(axis: str, at: Mounting, condition: FlightCondition) -> Float[np.ndarray, "4 n_r"]:
    """Build the row of a roll-rate (x) or yaw-rate (z) gyro: p + nu_x eta-dot. [rad/s]"""
    row = np.zeros((4, 3 + at.n_modes))
    row[POSITION, P if axis == "x" else R] = 1.0
    row[RATE, 3:] = at.rotation["xyz".index(axis)]
    return row


def bank_angle_row(at: Mounting, condition: FlightCondition) -> Float[np.ndarray, "4 n_r"]:
    """Build the row of bank angle: phi + (nu_x + tan theta0 nu_z) eta. [rad]"""
    tan = np.tan(condition.alpha + condition.gamma)
    row = np.zeros((4, 3 + at.n_modes))
    row[INTEGRAL, P], row[INTEGRAL, R] = 1.0, tan
    row[POSITION, 3:] = at.rotation[0] + tan * at.rotation[2]
    return row


def vane_row(at: Mounting, condition: FlightCondition) -> Float[np.ndarray, "4 n_r"]:
    """Build the row of a sideslip vane. [rad]

    Notes
    -----
    beta + (x r - z p + phi_y eta-dot)/V - (cos alpha0 nu_z - sin alpha0 nu_x) eta
    """
    x, _, z = at.position
    V, alpha = condition.airspeed, condition.alpha
    row = np.zeros((4, 3 + at.n_modes))
    row[POSITION, BETA] = 1.0
    row[POSITION, P], row[POSITION, R] = -z / V, x / V
    row[POSITION, 3:] = np.sin(alpha) * at.rotation[0] - np.cos(alpha) * at.rotation[2]
    row[RATE, 3:] = at.translation[1] / V
    return row


def _kinematics(condition: FlightCondition, trim: Trim) -> Kinematics:
    """Known terms of beta-dot, and inertial coupling of p-dot and r-dot by the product Ixz."""
    V, alpha = trim.airspeed, trim.alpha
    theta = alpha + condition.gamma
    product = condition.product_of_inertia
    inertia = np.eye(3)
    inertia[P, R] = -product / condition.roll_inertia
    inertia[R, P] = -product / condition.yaw_inertia
    coupling = np.zeros((*V.shape, 3, 3))
    coupling[..., BETA, P] = np.sin(alpha)
    coupling[..., BETA, R] = -np.cos(alpha)
    gravity = np.zeros((*V.shape, 3))
    gravity[..., BETA] = GRAVITY * np.cos(theta) / V
    attitude_rate = np.zeros((*V.shape, 3))
    attitude_rate[..., P] = 1.0
    attitude_rate[..., R] = np.tan(theta)
    return Kinematics(inertia, coupling, gravity, attitude_rate)


def _require_span_and_inertias(condition: FlightCondition) -> None:
    named = {
        "span": condition.span,
        "roll_inertia": condition.roll_inertia,
        "yaw_inertia": condition.yaw_inertia,
    }
    missing = [name for name, value in named.items() if not value > 0.0]
    if missing:
        raise BadInput(
            f"a lateral-directional model needs a positive {' and '.join(missing)} of the "
            "aircraft; complete its record",
            code="no-lateral-inertia",
            key=missing[0],
        )


def _scale_rows(condition: FlightCondition, trim: Trim) -> Float[np.ndarray, "*n_v 3"]:
    _require_span_and_inertias(condition)
    force = trim.dynamic_pressure * condition.area
    moment = force * condition.span
    return stack_factors(
        force / (condition.mass * trim.airspeed),
        moment / condition.roll_inertia,
        moment / condition.yaw_inertia,
    )


def _scale_motions(condition: FlightCondition, trim: Trim) -> Float[np.ndarray, "*n_v 3"]:
    rate = condition.span / (2.0 * trim.airspeed)
    return stack_factors(1.0, rate, rate)


def _describe_free_flight(condition: FlightCondition) -> FreeFlight:
    """Describe side motion y, bank phi and heading psi.

    Notes
    -----
    beta = ydot/V + sin(alpha0) phi - cos(gamma0) psi, p = phidot - sin(theta0) psidot and
    r = cos(theta0) psidot make the equations of ``_kinematics`` m y'' = Y + m g cos(theta0) phi
    and, in phi and psi, those of the moments about the body axes.
    """
    _require_span_and_inertias(condition)
    theta, half_span = condition.alpha + condition.gamma, 0.5 * condition.span
    sin, cos = np.sin(theta), np.cos(theta)
    rates = np.array([[1.0, -sin], [0.0, cos]])  # p and r of phidot and psidot
    product = condition.product_of_inertia
    inertia = np.array([[condition.roll_inertia, -product], [-product, condition.yaw_inertia]])
    rate, force, mass = np.zeros((3, 3)), np.zeros((3, 3)), np.zeros((3, 3))
    rate[0, 0], rate[1:, 1:] = 1.0, half_span * rates
    force[0, 0], force[1:, 1:] = condition.area, condition.area * condition.span * rates.T
    mass[0, 0], mass[1:, 1:] = condition.mass, rates.T @ inertia @ rates
    position, stiffness = np.zeros((3, 3)), np.zeros((3, 3))
    position[0] = 0.0, np.sin(condition.alpha), -np.cos(condition.gamma)
    stiffness[0, 1] = -condition.mass * GRAVITY * cos
    # Dutch roll is side motion and yaw, the spiral has no coordinate of its own.
    membership = np.array([[1.0, 0.0, 1.0], [0.0, 1.0, 0.0], [0.0, 0.0, 0.0]])
    return FreeFlight(position, rate, force, mass, np.zeros((3, 3)), stiffness, membership)


LATERAL = RigidBody(
    axis="lateral",
    symmetry="antisymmetric",
    motions=("beta", "p", "r"),
    attitude="phi",
    coefficients=("CY", "Cl", "Cn"),
    poles={"DR": ("beta", "r"), "roll": ("p",), SPIRAL: ("phi",)},
    acts_by_gravity=True,
    acceleration="lateral",
    kinematics=_kinematics,
    scale_rows=_scale_rows,
    scale_motions=_scale_motions,
    free_flight=_describe_free_flight,
)
