"""Longitudinal axis with airspeed: motions alpha, q and V, attitude theta, for long records.

V is the deviation of true airspeed from trim. Forces are those of wind axes: CX along the
velocity (-CD) and CZ normal to it (-CL), as in the axis without airspeed.
"""

from __future__ import annotations

import numpy as np
from jaxtyping import Float

from flexsid.sysid.model.condition import GRAVITY, FlightCondition, Trim
from flexsid.sysid.model.longitudinal import LONGITUDINAL
from flexsid.sysid.model.rigid_body import (
    ACCELERATION,
    INTEGRAL,
    PHUGOID,
    POSITION,
    RATE,
    Kinematics,
    Mounting,
    RigidBody,
    stack_factors,
)

ALPHA, Q, V = range(3)


def accelerometer_row(
    axis: str, at: Mounting, condition: FlightCondition
) -> Float[np.ndarray, "4 n_r"]:
    """Build the row of an accelerometer: exact kinematics of the c.g., arms and tilt. [m/s2]

    Notes
    -----
    The specific force in wind axes is V-dot + g sin(gamma) along the velocity and
    V0 (alpha-dot - q) - g cos(gamma) normal to it; body axes are turned by alpha, and the sensor
    by the local slope. Its deviations from trim, with the arms (x, z) from the c.g., are

    - f_x = cos(a0) f_V - sin(a0) f_N + g cos(theta0) (alpha + nu_y eta) + z q-dot + phi_x eta-ddot
    - f_z = sin(a0) f_V + cos(a0) f_N + g sin(theta0) (alpha + nu_y eta) - x q-dot + phi_z eta-ddot

    with f_V = V-dot + g cos(gamma) (theta - alpha), f_N = V0 (alpha-dot - q)
    + g sin(gamma) (theta - alpha), a0 the trim angle and theta0 = a0 + gamma.
    """
    x, _, z = at.position
    speed, alpha, gamma = condition.airspeed, condition.alpha, condition.gamma
    row = np.zeros((4, 3 + at.n_modes))
    row[ACCELERATION, 3:] = at.translation["xyz".index(axis)]
    if axis == "y":
        row[POSITION, 3:] = -GRAVITY * at.rotation[0]
        return row
    along, normal = np.zeros((2, 4, 3))
    along[RATE, V], normal[RATE, ALPHA], normal[POSITION, Q] = 1.0, speed, -speed
    for force, gravity in ((along, np.cos(gamma)), (normal, np.sin(gamma))):
        force[INTEGRAL, Q] = GRAVITY * gravity
        force[POSITION, ALPHA] -= GRAVITY * gravity
    if axis == "x":
        row[:, :3] = np.cos(alpha) * along - np.sin(alpha) * normal
        tilt, arm = GRAVITY * np.cos(alpha + gamma), z
    else:
        row[:, :3] = np.sin(alpha) * along + np.cos(alpha) * normal
        tilt, arm = GRAVITY * np.sin(alpha + gamma), -x
    row[RATE, Q] += arm
    row[POSITION, ALPHA] += tilt
    row[POSITION, 3:] += tilt * at.rotation[1]
    return row


def airspeed_row(at: Mounting, condition: FlightCondition) -> Float[np.ndarray, "4 n_r"]:
    """Build the row of an airspeed probe: V + (z cos a0 - x sin a0) q and the local rate. [m/s]"""
    x, _, z = at.position
    cos, sin = np.cos(condition.alpha), np.sin(condition.alpha)
    row = np.zeros((4, 3 + at.n_modes))
    row[POSITION, V] = 1.0
    row[POSITION, Q] = z * cos - x * sin
    row[RATE, 3:] = cos * at.translation[0] + sin * at.translation[2]
    return row


def _kinematics(condition: FlightCondition, trim: Trim) -> Kinematics:
    """Known terms of alpha-dot, q-dot and V-dot in alpha, V and theta.

    Notes
    -----
    Deviations of m V-dot = T cos(alpha) - D - m g sin(gamma) and
    m V gamma-dot = T sin(alpha) + L - m g cos(gamma) with gamma = theta - alpha. Lift and drag
    at constant coefficients change with 2 V/V0 of their values at trim,
    L0 = m g cos(gamma) - T sin(a0) and D0 = T cos(a0) - m g sin(gamma): the derivatives with
    respect to V are those of the coefficients. Thrust is constant; what it changes by
    airspeed is part of CX_V.
    """
    speed, mass = trim.airspeed, condition.mass
    climb, level = GRAVITY * np.sin(condition.gamma), GRAVITY * np.cos(condition.gamma)
    forward, upward = trim.thrust * np.cos(trim.alpha), trim.thrust * np.sin(trim.alpha)
    without = LONGITUDINAL.kinematics(condition, trim)
    coupling = np.zeros((*speed.shape, 3, 3))
    coupling[..., :V, :V] = without.coupling
    coupling[..., ALPHA, V] = -2.0 * (level - upward / mass) / speed**2
    coupling[..., V, ALPHA] = level - upward / mass
    coupling[..., V, V] = -2.0 * (forward / mass - climb) / speed
    gravity = np.zeros((*speed.shape, 3))
    gravity[..., :V] = without.gravity
    gravity[..., V] = -level
    attitude_rate = np.broadcast_to(np.array([0.0, 1.0, 0.0]), (*speed.shape, 3))
    return Kinematics(np.eye(3), coupling, gravity, attitude_rate)


def _scale_rows(condition: FlightCondition, trim: Trim) -> Float[np.ndarray, "*n_v 3"]:
    normal = LONGITUDINAL.scale_rows(condition, trim)
    along = normal[..., ALPHA] * trim.airspeed
    return np.concatenate([normal, along[..., None]], axis=-1)


def _scale_motions(condition: FlightCondition, trim: Trim) -> Float[np.ndarray, "*n_v 3"]:
    return stack_factors(1.0, condition.chord / (2.0 * trim.airspeed), 1.0 / trim.airspeed)


AIRSPEED = RigidBody(
    axis="longitudinal-airspeed",
    symmetry="symmetric",
    motions=("alpha", "q", "V"),
    attitude="theta",
    coefficients=("CZ", "Cm", "CX"),
    poles={"SP": ("alpha", "q"), PHUGOID: ("V", "theta")},
    acts_by_gravity=True,
    acceleration="",  # with airspeed, lift also changes at constant CZ
    kinematics=_kinematics,
    scale_rows=_scale_rows,
    scale_motions=_scale_motions,
    fast=LONGITUDINAL,
)
