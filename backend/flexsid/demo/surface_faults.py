"""Faults of a surface in flight, for checks of the flown against the commanded."""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np
from jaxtyping import Float

from flexsid.sysid.simulation.closed_loop import Actuator, ScheduledController


class FaultKind(StrEnum):
    """What a surface does wrong."""

    STUCK = "stuck"  # it does not move
    REVERSED = "reversed"  # it moves against the excitation
    OSCILLATING = "oscillating"  # it oscillates without command
    SLOW = "slow"  # all actuators have a lower rate limit


@dataclass(frozen=True, slots=True, kw_only=True)
class SurfaceFault:
    """Fault of one surface; amplitude [rad] and frequency [Hz] of an oscillation, rate [rad/s]."""

    kind: FaultKind
    surface: str
    amplitude: float = 0.0
    frequency_hz: float = 0.0
    rate_limit: float = np.inf

    def apply(
        self,
        excitation: Float[np.ndarray, "n_samples n_u"],
        inputs: tuple[str, ...],
        rate_hz: float,
    ) -> Float[np.ndarray, "n_samples n_u"]:
        """Compute the excitation that acts instead of the commanded one. [rad]"""
        flown, k = excitation.copy(), inputs.index(self.surface)
        if self.kind is FaultKind.STUCK:
            flown[:, k] = 0.0
        elif self.kind is FaultKind.REVERSED:
            flown[:, k] *= -1.0
        elif self.kind is FaultKind.OSCILLATING:
            time = np.arange(len(flown)) / rate_hz
            flown[:, k] += self.amplitude * np.sin(2.0 * np.pi * self.frequency_hz * time)
        return flown

    def limit(self, actuator: Actuator) -> Actuator:
        """Return the actuators with this fault."""
        return replace(actuator, rate_limit=min(actuator.rate_limit, self.rate_limit))

    def disconnect(self, controller: ScheduledController) -> ScheduledController:
        """Return the controller with this fault: it does not move a surface that is stuck."""
        if self.kind is not FaultKind.STUCK or self.surface not in controller.surfaces:
            return controller
        gains = controller.gains.copy()
        gains[controller.surfaces.index(self.surface)] = 0.0
        return replace(controller, gains=gains)
