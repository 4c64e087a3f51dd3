"""Second-order actuators with limits of position, rate and acceleration, and freeplay."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import copysign, inf

import numpy as np
from jaxtyping import Float
from scipy import linalg

from flexsid.sysid.excitation.checks import ActuatorLimits

SUBSTEPS = 8
"""Parts of a sample while a limit is active: 3200 Hz at 400 Hz, a fiftieth of a radian of the
fastest servo (62 rad/s), so that the error of interpolation between them is below 1e-4."""


@dataclass(frozen=True, slots=True)
class LimitedActuator:
    """One actuator over a part of a sample.

    ``stiffness`` is w^2 [1/s2] and ``damping`` 2 zeta w [1/s]; ``transition`` acts on the distance
    from the command and the rate. Limits are infinite where there are none.
    """

    stiffness: float
    damping: float
    transition: tuple[float, float, float, float]
    step_s: float
    position: float
    rate: float
    acceleration: float
    half_play: float

    def advance(self, position: float, rate: float, command: float) -> tuple[list[float], float]:
        """Advance over ``SUBSTEPS`` parts with a constant command.

        Returns
        -------
        list, float
            Positions at the start and the end of every part [rad], and the final rate. [rad/s]

        Notes
        -----
        x'' = sat(w^2 (c - x) - 2 zeta w x', a_max), |x'| <= r_max, |x| <= p_max with x' = 0 at a
        stop. The limits are those of the integrators, as in a hydraulic or electric servo, not of
        the command. Each part is exact with or without limited acceleration; a limit is reached
        or left at its ends.
        """
        h, (f11, f12, f21, f22) = self.step_s, self.transition
        nodes = [position]
        for _ in range(SUBSTEPS):
            acceleration = self.stiffness * (command - position) - self.damping * rate
            if abs(acceleration) <= self.acceleration:
                away = position - command
                after, speed = command + f11 * away + f12 * rate, f21 * away + f22 * rate
            else:
                acceleration = copysign(self.acceleration, acceleration)
                after = position + h * (rate + 0.5 * h * acceleration)
                speed = rate + h * acceleration
            if abs(speed) > self.rate:
                speed = copysign(self.rate, speed)
                after = position + 0.5 * h * (rate + speed)
            if abs(after) > self.position:
                after = copysign(self.position, after)
                speed = 0.0 if speed * after > 0.0 else speed
            position, rate = after, speed
            nodes.append(position)
        return nodes, rate

    def follow(self, surface: float, nodes: Sequence[float]) -> list[float]:
        """Return the surface behind freeplay: it stays while the actuator moves within the play.

        Notes
        -----
        The play operator: friction holds the surface, and air loads do not move it.
        """
        half, found = self.half_play, []
        for position in nodes:
            surface = min(max(surface, position - half), position + half)
            found.append(surface)
        return found


def build_limited_actuator(limits: ActuatorLimits, sample_s: float) -> LimitedActuator:
    """Build an actuator whose samples are divided into ``SUBSTEPS`` parts."""
    step_s = sample_s / SUBSTEPS
    stiffness = limits.natural_frequency**2
    damping = 2.0 * limits.damping * limits.natural_frequency
    exponential = linalg.expm(np.array([[0.0, 1.0], [-stiffness, -damping]]) * step_s)
    (f11, f12), (f21, f22) = exponential.tolist()
    return LimitedActuator(
        stiffness=stiffness,
        damping=damping,
        transition=(f11, f12, f21, f22),
        step_s=step_s,
        position=inf if limits.position is None else limits.position,
        rate=inf if limits.rate is None else limits.rate,
        acceleration=inf if limits.acceleration is None else limits.acceleration,
        half_play=0.5 * limits.freeplay,
    )


def discretise_between_nodes(
    A: Float[np.ndarray, "n n"], B: Float[np.ndarray, "n m"], sample_s: float
) -> tuple[Float[np.ndarray, "n n"], Float[np.ndarray, "n n_weights"]]:
    """Compute the transition over a sample, and the effect of inputs at the ends of its parts.

    Notes
    -----
    Inputs vary linearly over each part (first-order hold), for which the transition is exact:
    the exponential of [[A, B, 0], [0, 0, I/h], [0, 0, 0]] h.
    """
    n, m = B.shape
    h = sample_s / SUBSTEPS
    block = np.zeros((n + 2 * m, n + 2 * m))
    block[:n, :n], block[:n, n : n + m] = A * h, B * h
    block[n : n + m, n + m :] = np.eye(m)
    exponential = linalg.expm(block)
    F, whole, ramp = exponential[:n, :n], exponential[:n, n : n + m], exponential[:n, n + m :]
    weights = np.zeros((SUBSTEPS + 1, n, m))
    power = np.eye(n)
    for part in reversed(range(SUBSTEPS)):
        weights[part] += power @ (whole - ramp)
        weights[part + 1] += power @ ramp
        power = F @ power
    return power, weights.transpose(1, 0, 2).reshape(n, -1)
