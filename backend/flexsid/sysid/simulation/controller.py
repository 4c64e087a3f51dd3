"""Controller: scheduled pitch-rate and attitude feedback that stabilises the aircraft."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float


@dataclass(frozen=True, slots=True, kw_only=True)
class ScheduledController:
    """delta = -g(V) K [q, theta], on measurements lagged by a first-order filter.

    ``gains`` has one row per surface: on pitch rate [s] and on attitude [1].
    ``delay_s`` is the time from filtered measurement to surface command.
    """

    surfaces: tuple[str, ...]
    gains: Float[np.ndarray, "n_surfaces 2"]
    low_speed: float
    high_speed: float
    least_gain: float
    filter_corner: float
    delay_s: float

    def gains_at(self, airspeed: float) -> Float[np.ndarray, "n_surfaces 2"]:
        """Compute the gains at an airspeed. [m/s]"""
        fraction = (airspeed - self.low_speed) / (self.high_speed - self.low_speed)
        return float(np.clip(fraction, self.least_gain, 1.0)) * self.gains
