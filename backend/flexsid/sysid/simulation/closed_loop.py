"""Closed-loop simulation of an airframe under an excitation, sample by sample."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy import linalg

from flexsid.sysid.simulation.actuators import Actuator
from flexsid.sysid.simulation.airframe import Airframe
from flexsid.sysid.simulation.controller import ScheduledController


@dataclass(frozen=True, slots=True)
class SimulatedMotion:
    """True states and surface positions, and the commands before the actuators."""

    rate_hz: float
    states: Float[np.ndarray, "n_samples n_x"]
    surfaces: Float[np.ndarray, "n_samples n_u"]
    commands: Float[np.ndarray, "n_samples n_u"]

    def sense(self, rows: Float[np.ndarray, "n_y n_w"]) -> Float[np.ndarray, "n_samples n_y"]:
        """Compute the outputs of sensor rows on [states, surfaces]. [unit of the rows]"""
        return np.hstack([self.states, self.surfaces]) @ rows.T


def simulate_closed_loop(
    airframe: Airframe,
    actuator: Actuator,
    excitation: Float[np.ndarray, "n_samples n_u"],
    rate_hz: float,
    controller: ScheduledController | None = None,
    feedback: Float[np.ndarray, "2 n_w"] | None = None,
) -> SimulatedMotion:
    """Simulate the closed loop from trim at rest.

    Parameters
    ----------
    airframe
        The equations of motion.
    actuator
        Actuator in front of every surface.
    excitation
        Added to the commands after control law and mixer. [rad]
    rate_hz
        Rate of the excitation, of the control law and of the result. [Hz]
    controller
        Control law; None for open loop.
    feedback
        Rows of the gyro and of the attitude sensor, inputs of the control law.

    Notes
    -----
    Between samples commands are held, and airframe, actuators and filters are
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
    transition, entry = _discretise(
        _join(airframe, actuator, reading, corner), actuator, n_x, step_s
    )

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
        fastest, farthest = abs(x[rate]).max(), abs(x[position]).max()
        if fastest > actuator.rate_limit or farthest > actuator.position_limit:
            actuator.limit(states[k, position], x[position], x[rate], step_s)
    return SimulatedMotion(rate_hz, states[:, :n_x], states[:, position], commands[:n_samples])


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


def _discretise(
    matrix: Float[np.ndarray, "n_all n_all"], actuator: Actuator, n_x: int, step_s: float
) -> tuple[Float[np.ndarray, "n_all n_all"], Float[np.ndarray, "n_all n_u"]]:
    """Compute the transition over one step, and the effect of constant commands over it."""
    n_all = matrix.shape[0]
    n_u = (n_all - n_x - 2) // 2
    entry = np.zeros((n_all, n_u))
    entry[n_x + n_u : n_x + 2 * n_u] = actuator.natural_frequency**2 * np.eye(n_u)
    joined = np.block([[matrix, entry], [np.zeros((n_u, n_all + n_u))]])
    exponential = linalg.expm(joined * step_s)
    return exponential[:n_all, :n_all], exponential[:n_all, n_all:]
