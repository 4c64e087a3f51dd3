"""Closed-loop simulation of an airframe with actuators and controller, sample by sample."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from flexsid.sysid.model.laws import discretise
from flexsid.sysid.simulation.airframe import ALPHA, Airframe


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
    commands = np.vstack([excitation, np.zeros((wait, n_u))])
    states = np.zeros((n_samples, transition.shape[0]))
    x = states[0].copy()
    rest = np.zeros(n_u)
    # Limits are not active while every linear rate and position is inside them.
    for k in range(n_samples):
        states[k] = x
        commands[k + wait] += to_commands @ x[lagged]
        ordered = commands[k - lead] if k >= lead else rest
        x = transition @ x + entry @ ordered
        if gust[k]:
            x += gust_entry * gust[k]
        fastest, farthest = abs(x[rate]).max(), abs(x[position]).max()
        if fastest > actuator.rate_limit or farthest > actuator.position_limit:
            actuator.limit(states[k, position], x[position], x[rate], step_s)
    return SimulatedMotion(
        rate_hz, states[:, :n_x], states[:, position], commands[:n_samples], gust
    )


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
