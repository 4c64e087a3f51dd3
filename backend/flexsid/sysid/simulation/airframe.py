"""Airframe: the aeroelastic equations of motion in state-space form (Eqs. 5-16).

Independent of the estimators' model on purpose: this is the truth model for their
verification.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from flexsid.sysid.model.condition import GRAVITY, FlightCondition
from flexsid.sysid.model.derivatives import DerivativeTable
from flexsid.sysid.model.frequency_shape import FrequencyShape
from flexsid.sysid.model.rational_functions import build_lagged_forces
from flexsid.sysid.modes import StructuralModes

ALPHA, Q, THETA = range(3)


@dataclass(frozen=True, slots=True)
class Airframe:
    """x = [alpha, q, theta, eta..., etadot..., lags...], u = surfaces; rows act on [x, u].

    ``rates`` gives x-dot, ``lift_row`` the normal force and ``drag_row`` the
    forward force, both per unit mass [m/s2], as measured by an accelerometer.
    """

    condition: FlightCondition
    modes: StructuralModes
    inputs: tuple[str, ...]
    rates: Float[np.ndarray, "n_x n_w"]
    lift_row: Float[np.ndarray, " n_w"]
    drag_row: Float[np.ndarray, " n_w"]

    @property
    def n_x(self) -> int:
        """Number of states."""
        return self.rates.shape[0]

    @property
    def state_matrix(self) -> Float[np.ndarray, "n_x n_x"]:
        """A of x-dot = A x + B u. [1/s]"""
        return self.rates[:, : self.n_x]

    @property
    def input_matrix(self) -> Float[np.ndarray, "n_x n_u"]:
        """B of x-dot = A x + B u. [1/s]"""
        return self.rates[:, self.n_x :]

    @property
    def gust_rates(self) -> Float[np.ndarray, " n_x"]:
        """x-dot per angle of attack of a gust: its aerodynamic forces, not the motion. [1/s]"""
        rates = self.rates[:, ALPHA].copy()
        rates[ALPHA] = self.lift_row[ALPHA] / self.condition.airspeed
        return rates


def assemble_airframe(
    condition: FlightCondition,
    modes: StructuralModes,
    derivatives: DerivativeTable,
    shape: FrequencyShape | None = None,
) -> Airframe:
    """Build the equations of motion at a trim condition, whose thrust balances the drag.

    With a frequency shape the air forces lag the motion, by rational functions.

    Raises
    ------
    ValueError
        If modes and derivatives are not of the same modes.

    Notes
    -----
    Source: Eqs. 5-16; Eq. 12c in its first printing. The forward force has its
    lift-dependent part from the parabolic polar.
    """
    if modes.numbers != derivatives.modes:
        raise ValueError(f"modes {modes.numbers} and derivatives {derivatives.modes} must match")
    n = len(modes.numbers)
    n_motion, n_u = 3 + 2 * n, len(derivatives.inputs)
    speed, chord = condition.airspeed, condition.chord
    force = condition.dynamic_pressure * condition.area

    if shape is None:
        # Columns of the table (alpha, q, eta, etadot, u) in the vector [x, u].
        columns = np.r_[ALPHA, Q, 3 : n_motion + n_u]
        half = chord / (2.0 * speed)
        scale = np.concatenate([[1.0, half], np.ones(n), np.full(n, half), np.ones(n_u)])
        table = np.zeros((2 + n, n_motion + n_u))
        table[:, columns] = derivatives.values * scale
        lag_rates = np.zeros((0, n_motion + n_u))
    else:
        lagged = build_lagged_forces(shape, condition)
        table = np.einsum("rw,rwz->rz", derivatives.values, lagged.loads)
        lag_rates = lagged.lag_rates

    rates = np.vstack([np.zeros((n_motion, table.shape[1])), lag_rates])
    rates[ALPHA] = force / (condition.mass * speed) * table[0]
    rates[Q] = force * chord / condition.pitch_inertia * table[1]
    rates[3 + n : n_motion] = force * chord / modes.mass[:, None] * table[2:]

    tilt = GRAVITY * np.sin(condition.gamma) / speed
    rates[ALPHA, ALPHA] += tilt - condition.thrust * np.cos(condition.alpha) / (
        condition.mass * speed
    )
    rates[ALPHA, Q] += 1.0
    rates[ALPHA, THETA] -= tilt
    rates[THETA, Q] = 1.0
    rates[3 : 3 + n, 3 + n : n_motion] = np.eye(n)
    rates[3 + n : n_motion, 3 : 3 + n] -= np.diag(modes.omega**2)
    rates[3 + n : n_motion, 3 + n : n_motion] -= np.diag(2.0 * modes.zeta * modes.omega)

    lift = condition.lift_coefficient
    forward = -(condition.alpha - 2.0 * condition.induced_drag * lift) * table[0]
    forward[ALPHA] += lift
    return Airframe(
        condition,
        modes,
        derivatives.inputs,
        rates,
        force / condition.mass * table[0],
        force / condition.mass * forward,
    )
