"""FlightCondition and the factors that make derivatives nondimensional (Eq. 12)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

GRAVITY = 9.80665  # standard gravity [m/s2]


@dataclass(frozen=True, slots=True, kw_only=True)
class FlightCondition:
    """One steady condition, all in SI units and radians.

    ``induced_drag`` is K of C_D = C_D0 + K C_L^2; it only enters the
    forward acceleration.
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

    def row_factors(
        self, generalized_mass: Float[np.ndarray, " n_modes"]
    ) -> Float[np.ndarray, " n_rows"]:
        """Compute the dimensional factors of the rows Z, M, Q_1..n (Eq. 12).

        Z is divided by mV and so enters alpha-dot directly. [1/s, 1/s2, 1/s2...]
        """
        force = self.dynamic_pressure * self.area
        return np.concatenate(
            [
                [force / (self.mass * self.airspeed), force * self.chord / self.pitch_inertia],
                force * self.chord / np.asarray(generalized_mass, dtype=float),
            ]
        )

    def column_factors(self, n_modes: int, n_inputs: int) -> Float[np.ndarray, " n_w"]:
        """Compute the factors of the variables alpha, q, eta, etadot, inputs (Eq. 12)."""
        rate = self.rate_factor
        return np.concatenate(
            [[1.0, rate], np.ones(n_modes), np.full(n_modes, rate), np.ones(n_inputs)]
        )
