"""Pre-flight simulation of a linear model in closed loop under an excitation."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy import linalg

from flexsid.errors import BadInput
from flexsid.sysid.model.aeroelastic import StateSpace
from flexsid.sysid.model.laws import series

_LARGEST_ANGLE = 1.5  # rad of incidence or attitude: a linear model is not valid beyond
_REPORT_INTERVAL = 500  # samples


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
    plant
        Aircraft with its sensors; inputs are deflections.
    actuators
        Deflections from commands, for every input of the plant in its order.
    actuator_delay_s
        Pure delay of every actuator. [s]
    excitation
        Added to the commands after the control law. [rad]
    rate_hz
        Of the excitation, of the control law and of the result. [Hz]
    controller
        u = K y with the sign in K; None for open loop.
    delay_s
        From measurement to command, in addition to one sample. [s]
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
    F, G = _discretise(joined.A, joined.B, 1.0 / rate_hz)
    n_a, n_u = actuators.A.shape[0], excitation.shape[1]
    leads = np.round(actuator_delay_s * rate_hz).astype(int)
    wait = 1 + round(delay_s * rate_hz)
    n_samples = excitation.shape[0]
    commands = np.vstack([excitation, np.zeros((wait, n_u))])
    top = int(leads.max(initial=0))
    delayed = np.zeros((top + n_samples, n_u))
    law, read, driven = _discretise_law(plant, controller, 1.0 / rate_hz)
    x, law_state = np.zeros(F.shape[0]), np.zeros(law[0].shape[0])
    states = np.zeros((n_samples, F.shape[0]))
    ordered = np.zeros((n_samples, n_u))
    angles = n_a + np.array([plant.states.index(name) for name in ("alpha", "theta")])
    every = np.arange(n_u)
    Fk, Gk, Ck, Dk = law
    C_read, D_read = joined.C[read], joined.D[read]
    for k in range(n_samples):
        delayed[top + k] = commands[k]
        now = delayed[top + k - leads, every]
        states[k], ordered[k] = x, now
        if driven.size:
            y = C_read @ x + D_read @ now
            commands[k + wait, driven] += Ck @ law_state + Dk @ y
            law_state = Fk @ law_state + Gk @ y
        x = F @ x + G @ now
        if k % _REPORT_INTERVAL == 0:
            if report is not None:
                report(k / n_samples)
            if not np.all(np.abs(x[angles]) < _LARGEST_ANGLE):
                break
    too_far = ~(np.abs(states[:, angles]).max(axis=1) < _LARGEST_ANGLE)
    if too_far.any():
        first = int(np.argmax(too_far))
        raise BadInput(
            f"the aircraft diverges within {first / rate_hz:.1f} s: the model is unstable and "
            + (
                "needs a controller"
                if controller is None
                else "this controller does not stabilise it"
            ),
            code="diverges",
        )
    return SimulatedFlight(
        outputs=states @ joined.C.T + ordered @ joined.D.T,
        deflections=states[:, :n_a] @ actuators.C.T + ordered @ actuators.D.T,
        commands=commands[:n_samples],
    )


def _discretise_law(
    plant: StateSpace, controller: StateSpace | None, step_s: float
) -> tuple[tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray], np.ndarray, np.ndarray]:
    none = np.zeros(0, dtype=int)
    if controller is None:
        return (np.zeros((0, 0)), np.zeros((0, 0)), np.zeros((0, 0)), np.zeros((0, 0))), none, none
    for names, known, what in (
        (controller.inputs, plant.outputs, "reads"),
        (controller.outputs, plant.inputs, "drives"),
    ):
        missing = [name for name in names if name not in known]
        if missing:
            raise BadInput(
                f"the controller {what} '{missing[0]}', which is not in the model; it has "
                f"{', '.join(known)}",
                code="unknown-channel",
                channel=missing[0],
            )
    read = np.array([plant.outputs.index(name) for name in controller.inputs], dtype=int)
    driven = np.array([plant.inputs.index(name) for name in controller.outputs], dtype=int)
    F, G = _discretise(controller.A, controller.B, step_s)
    return (F, G, controller.C, controller.D), read, driven


def _discretise(
    A: Float[np.ndarray, "n n"], B: Float[np.ndarray, "n m"], step_s: float
) -> tuple[Float[np.ndarray, "n n"], Float[np.ndarray, "n m"]]:
    """Compute the transition over one step, and the effect of constant inputs over it."""
    n, m = B.shape
    joined = np.zeros((n + m, n + m))
    joined[:n, :n], joined[:n, n:] = A, B
    exponential = linalg.expm(joined * step_s)
    return exponential[:n, :n], exponential[:n, n:]
