"""Actuator: second-order lag behind a delay, limited in rate and position."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float


@dataclass(frozen=True, slots=True, kw_only=True)
class Actuator:
    """Actuator model of all surfaces. [rad/s], [1], [s], [rad/s], [rad]"""

    natural_frequency: float
    damping: float
    delay_s: float
    rate_limit: float
    position_limit: float

    def limit(
        self,
        before: Float[np.ndarray, " n_u"],
        position: Float[np.ndarray, " n_u"],
        rate: Float[np.ndarray, " n_u"],
        step_s: float,
    ) -> None:
        """Limit a step of the linear actuator in rate and position, in place.

        Parameters
        ----------
        before
            Positions at the start of the step. [rad]
        position, rate
            Values of the linear actuator at its end; changed here. [rad], [rad/s]
        step_s
            Length of the step. [s]
        """
        fast = np.abs(rate) > self.rate_limit
        rate[fast] = np.sign(rate[fast]) * self.rate_limit
        position[fast] = before[fast] + rate[fast] * step_s
        far = np.abs(position) > self.position_limit
        position[far] = np.sign(position[far]) * self.position_limit
        outward = far & (rate * position > 0.0)
        rate[outward] = 0.0
