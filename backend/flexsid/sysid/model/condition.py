"""FlightCondition, and the part of it that changes with airspeed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

GRAVITY = 9.80665  # standard gravity [m/s2]


@dataclass(frozen=True, slots=True)
class Trim:
    """Steady flight at one airspeed (arrays without dimension) or at several.

    True airspeed [m/s], dynamic pressure [Pa], angle of attack [rad] and thrust [N].
    """

    airspeed: Float[np.ndarray, "*n_v"]
    dynamic_pressure: Float[np.ndarray, "*n_v"]
    alpha: Float[np.ndarray, "*n_v"]
    thrust: Float[np.ndarray, "*n_v"]


@dataclass(frozen=True, slots=True, kw_only=True)
class FlightCondition:
    """One steady condition, all in SI units and radians.

    ``induced_drag`` is K of C_D = C_D0 + K C_L^2; it only enters the
    forward acceleration. ``product_of_inertia`` is the integral of x z dm. Span, inertia in
    roll and yaw are those of the lateral-directional model only, pitch inertia that of the
    longitudinal one.
    """

    airspeed: float
    density: float
    mass: float
    pitch_inertia: float
    area: float
    chord: float
    alpha: float = 0.0
    gamma: float = 0.0
    thrust: float = 0.0
    x_cg: float = 0.0
    z_cg: float = 0.0
    induced_drag: float = 0.0
    span: float = 0.0
    roll_inertia: float = 0.0
    yaw_inertia: float = 0.0
    product_of_inertia: float = 0.0

    @property
    def dynamic_pressure(self) -> float:
        """Dynamic pressure. [Pa]"""
        return 0.5 * self.density * self.airspeed**2

    @property
    def lift_coefficient(self) -> float:
        """Lift coefficient of steady flight. [1]"""
        weight = self.mass * GRAVITY * np.cos(self.gamma)
        return float(weight / (self.dynamic_pressure * self.area))

    @property
    def rate_factor(self) -> float:
        """Factor c/2V that makes q and etadot nondimensional. [s]"""
        return self.chord / (2.0 * self.airspeed)

    @property
    def trim(self) -> Trim:
        """Airspeed, dynamic pressure, angle of attack and thrust."""
        values = (self.airspeed, self.dynamic_pressure, self.alpha, self.thrust)
        return Trim(*(np.asarray(float(value)) for value in values))
