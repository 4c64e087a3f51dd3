"""Closed-loop simulation with limited actuators."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import copysign, inf

import numpy as np
import scipy
from jaxtyping import Float

from flexsid.sysid.excitation.checks import ActuatorLimits
from flexsid.sysid.model.laws import (
    discretise,
)
from flexsid.sysid.simulation.airframe import ALPHA, Airframe

# --- Closed-loop simulation of an airframe with actuators and controller, sample by sample --------


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


@dataclass(frozen=True, slots=True)
class SimulatedMotion:
    """True states and surface positions, commands before the actuators, and the gust. [rad]"""

    rate_hz: float
    states: Float[np.ndarray, "n_samples n_x"]
    surfaces: Float[np.ndarray, "n_samples n_u"]
    commands: Float[np.ndarray, "n_samples n_u"]
    gust: Float[np.ndarray, " n_samples"]

    def sense(self, rows: Float[np.ndarray, "n_y n_w"]) -> Float[np.ndarray, "n_samples n_y"]:
        """Compute the outputs of sensor rows on [states, surfaces]. [unit of the rows]

        Sensors depend on the angle of attack by the air alone: the gust adds to it.
        """
        return np.hstack([self.states, self.surfaces]) @ rows.T + np.outer(
            self.gust, rows[:, ALPHA]
        )


def simulate_closed_loop(
    airframe: Airframe,
    actuator: Actuator,
    excitation: Float[np.ndarray, "n_samples n_u"],
    rate_hz: float,
    controller: ScheduledController | None = None,
    feedback: Float[np.ndarray, "2 n_w"] | None = None,
    gust: Float[np.ndarray, " n_samples"] | None = None,
) -> SimulatedMotion:
    """Simulate the closed loop from trim at rest.

    Parameters
    ----------
    airframe, actuator
        The equations of motion, and the actuator in front of every surface.
    excitation
        Added to the commands after control law and mixer. [rad]
    rate_hz
        Rate of the excitation, of the control law and of the result. [Hz]
    controller, feedback
        Control law, None for open loop, and the rows of the gyro and of the attitude sensor
        that it reads.
    gust
        Angle of attack of a gust, uniform over the aircraft, None for still air. [rad]

    Notes
    -----
    Between samples commands and gust are held, and airframe, actuators and filters are
    advanced together by their exact transition matrix; only the actuators'
    limits are applied step by step. The control law runs once per sample: a
    measurement at one sample is commanded at the next at the earliest.
    Source: Sec. V.A, Fig. 7.
    """
    step_s = 1.0 / rate_hz
    n_samples, n_u = excitation.shape
    n_x = airframe.n_x
    position, rate = slice(n_x, n_x + n_u), slice(n_x + n_u, n_x + 2 * n_u)
    lagged = slice(n_x + 2 * n_u, n_x + 2 * n_u + 2)
    to_commands = np.zeros((n_u, 2))
    corner, wait = 0.0, 1
    reading = np.zeros((2, n_x))
    if controller is not None and feedback is not None:
        reading, corner = feedback[:, :n_x], controller.filter_corner
        wait += round(controller.delay_s * rate_hz)
        rows = [airframe.inputs.index(name) for name in controller.surfaces]
        to_commands[rows] = -controller.gains_at(airframe.condition.airspeed)
    entry = np.zeros((lagged.stop, n_u + 1))
    entry[rate, :n_u] = actuator.natural_frequency**2 * np.eye(n_u)
    entry[:n_x, n_u] = airframe.gust_rates
    transition, entry = discretise(_join(airframe, actuator, reading, corner), entry, step_s)
    entry, gust_entry = entry[:, :n_u], entry[:, n_u]
    gust = np.zeros(n_samples) if gust is None else gust
    lead = round(actuator.delay_s * rate_hz)
    commands = np.vstack([np.zeros((lead, n_u)), excitation, np.zeros((wait, n_u))])
    states = np.zeros((n_samples + 1, transition.shape[0]))
    # Commands of so many samples are known before the first of them is simulated.
    block = _SampleBlock.build(transition, np.hstack([entry, gust_entry[:, None]]), wait + lead)
    for first in range(0, n_samples, wait + lead):
        stop = min(first + wait + lead, n_samples)
        driven = np.column_stack([commands[first:stop], gust[first:stop]])
        found = block.advance(states[first], driven)
        fastest, farthest = abs(found[:, rate]).max(), abs(found[:, position]).max()
        # Limits are not active while every linear rate and position is inside them.
        if fastest > actuator.rate_limit or farthest > actuator.position_limit:
            for k in range(stop - first):
                x = block.advance(states[first + k], driven[k : k + 1])[0]
                actuator.limit(states[first + k, position], x[position], x[rate], step_s)
                states[first + k + 1] = x
        else:
            states[first + 1 : stop + 1] = found
        late = slice(lead + wait + first, lead + wait + stop)
        commands[late] += states[first:stop, lagged] @ to_commands.T
    states = states[:n_samples]
    commands = commands[lead : lead + n_samples]
    return SimulatedMotion(rate_hz, states[:, :n_x], states[:, position], commands, gust)


@dataclass(frozen=True, slots=True)
class _SampleBlock:
    """States of several samples, linear in the first state and in what drives each sample."""

    free: Float[np.ndarray, "n_block n_all n_all"]
    forced: Float[np.ndarray, "n_block n_all n_block n_in"]

    @classmethod
    def build(
        cls,
        transition: Float[np.ndarray, "n_all n_all"],
        entry: Float[np.ndarray, "n_all n_in"],
        n_block: int,
    ) -> _SampleBlock:
        """Multiply the transitions of the samples of a block."""
        free = [transition]
        for _ in range(n_block - 1):
            free.append(transition @ free[-1])
        forced = np.zeros((n_block, *entry.shape[:1], n_block, entry.shape[1]))
        for row in range(n_block):
            forced[row, :, row] = entry
            for column in range(row):
                forced[row, :, column] = free[row - column - 1] @ entry
        return cls(np.array(free), forced)

    def advance(
        self, state: Float[np.ndarray, " n_all"], driven: Float[np.ndarray, "n n_in"]
    ) -> Float[np.ndarray, "n n_all"]:
        """Compute the states after 1, 2, ... samples, each with what drives it."""
        n = driven.shape[0]
        forced = self.forced[:n, :, :n].reshape(n * state.size, -1)
        return self.free[:n] @ state + (forced @ driven.ravel()).reshape(n, -1)


def _join(
    airframe: Airframe,
    actuator: Actuator,
    reading: Float[np.ndarray, "2 n_x"],
    corner: float,
) -> Float[np.ndarray, "n_all n_all"]:
    """Build the state matrix of airframe, actuator positions and rates, and measurement lags."""
    n_x, n_u = airframe.n_x, len(airframe.inputs)
    natural, damping = actuator.natural_frequency, actuator.damping
    return np.block(
        [
            [airframe.state_matrix, airframe.input_matrix, np.zeros((n_x, n_u + 2))],
            [np.zeros((n_u, n_x + n_u)), np.eye(n_u), np.zeros((n_u, 2))],
            [
                np.zeros((n_u, n_x)),
                -(natural**2) * np.eye(n_u),
                -2.0 * damping * natural * np.eye(n_u),
                np.zeros((n_u, 2)),
            ],
            [corner * reading, np.zeros((2, 2 * n_u)), -corner * np.eye(2)],
        ]
    )


# --- Second-order actuators with limits of position, rate and acceleration, and freeplay ----------

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
    exponential = scipy.linalg.expm(np.array([[0.0, 1.0], [-stiffness, -damping]]) * step_s)
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
    exponential = scipy.linalg.expm(block)
    F, whole, ramp = exponential[:n, :n], exponential[:n, n : n + m], exponential[:n, n + m :]
    weights = np.zeros((SUBSTEPS + 1, n, m))
    power = np.eye(n)
    for part in reversed(range(SUBSTEPS)):
        weights[part] += power @ (whole - ramp)
        weights[part + 1] += power @ ramp
        power = F @ power
    return power, weights.transpose(1, 0, 2).reshape(n, -1)
