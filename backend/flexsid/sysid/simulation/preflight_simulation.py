"""Pre-flight simulation of a linear model in closed loop under an excitation."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from flexsid.errors import BadInput
from flexsid.sysid.model.aeroelastic import StateSpace
from flexsid.sysid.model.laws import discretise, find_loop_channels, series

_LARGEST_ANGLE = 1.5  # rad of flow or attitude: a linear model is not valid beyond
_ANGLES = ("alpha", "theta", "beta", "phi")
_REPORT_INTERVAL = 500  # samples
_NO_LAW = StateSpace(*(np.zeros((0, 0)) for _ in range(4)), states=(), inputs=(), outputs=())


@dataclass(frozen=True, slots=True)
class SimulatedFlight:
    """Outputs, true deflections, and commands before the actuators."""

    outputs: Float[np.ndarray, "n_samples n_y"]
    deflections: Float[np.ndarray, "n_samples n_u"]
    commands: Float[np.ndarray, "n_samples n_u"]


def simulate_flight(
    plant: StateSpace,
    actuators: StateSpace,
    actuator_delay_s: Float[np.ndarray, " n_u"],
    excitation: Float[np.ndarray, "n_samples n_u"],
    rate_hz: float,
    controller: StateSpace | None = None,
    delay_s: float = 0.0,
    report: Callable[[float], None] | None = None,
) -> SimulatedFlight:
    """Simulate a flight from trim at rest.

    Parameters
    ----------
    plant, actuators
        Aircraft with its sensors, whose inputs are deflections, and deflections from commands,
        for every input of the plant in its order.
    actuator_delay_s
        Pure delay of every actuator. [s]
    excitation
        Added to the commands after the control law. [rad]
    rate_hz
        Of the excitation, of the control law and of the result. [Hz]
    controller, delay_s
        u = K y with the sign in K, None for open loop, and its delay from measurement to
        command, in addition to one sample. [s]
    report
        Called with the fraction done; may raise to stop.

    Raises
    ------
    BadInput
        If the aircraft diverges: the model is unstable without stabilising controller.

    Notes
    -----
    Between samples commands are held; aircraft and actuators are advanced together by
    their exact transition, the law by its own.
    """
    joined = series(actuators, plant)
    F, G = discretise(joined.A, joined.B, 1.0 / rate_hz)
    n_a, n_u = actuators.A.shape[0], excitation.shape[1]
    leads = np.round(actuator_delay_s * rate_hz).astype(int)
    wait = 1 + round(delay_s * rate_hz)
    n_samples = excitation.shape[0]
    commands = np.vstack([excitation, np.zeros((wait, n_u))])
    top = int(leads.max(initial=0))
    delayed = np.zeros((top + n_samples, n_u))
    law = _NO_LAW if controller is None else controller
    Fk, Gk = discretise(law.A, law.B, 1.0 / rate_hz)
    read, driven = find_loop_channels(plant, law)
    x, law_state = np.zeros(F.shape[0]), np.zeros(Fk.shape[0])
    states = np.zeros((n_samples, F.shape[0]))
    ordered = np.zeros((n_samples, n_u))
    angles = n_a + np.flatnonzero([name in _ANGLES for name in plant.states])
    every = np.arange(n_u)
    C_read, D_read = joined.C[read], joined.D[read]
    for k in range(n_samples):
        delayed[top + k] = commands[k]
        now = delayed[top + k - leads, every]
        states[k], ordered[k] = x, now
        if driven:
            y = C_read @ x + D_read @ now
            commands[k + wait, driven] += law.C @ law_state + law.D @ y
            law_state = Fk @ law_state + Gk @ y
        x = F @ x + G @ now
        if k % _REPORT_INTERVAL == 0:
            if report is not None:
                report(k / n_samples)
            if not np.all(np.abs(states[k, angles]) < _LARGEST_ANGLE):
                break
    too_far = ~(np.abs(states[:, angles]).max(axis=1) < _LARGEST_ANGLE)
    if too_far.any():
        first = int(np.argmax(too_far))
        raise BadInput(
            f"the aircraft diverges within {first / rate_hz:.1f} s: the model is unstable and"
            f" {'needs a' if controller is None else 'is not stabilised by this'} controller",
            code="diverges",
        )
    return SimulatedFlight(
        outputs=states @ joined.C.T + ordered @ joined.D.T,
        deflections=states[:, :n_a] @ actuators.C.T + ordered @ actuators.D.T,
        commands=commands[:n_samples],
    )
