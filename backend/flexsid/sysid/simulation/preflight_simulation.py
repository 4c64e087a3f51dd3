"""Pre-flight simulation of a linear model in closed loop, with limits of its actuators."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from flexsid.errors import BadInput
from flexsid.sysid.excitation.checks import ActuatorLimits
from flexsid.sysid.model.aeroelastic import StateSpace
from flexsid.sysid.model.laws import (
    build_instrument_chain,
    discretise,
    find_loop_channels,
    series,
)
from flexsid.sysid.model.sensor_models import Instrument, SecondOrder
from flexsid.sysid.simulation.closed_loop import (
    SUBSTEPS,
    LimitedActuator,
    build_limited_actuator,
    discretise_between_nodes,
)

_LARGEST_ANGLE = 1.5  # rad of flow or attitude: a linear model is not valid beyond
_ANGLES = ("alpha", "theta", "beta", "phi")
_REPORT_INTERVAL = 500  # samples
_NEAR = 0.9  # of a limit at the ends of a sample: within it the limit may be passed
_NO_LAW = StateSpace(*(np.zeros((0, 0)) for _ in range(4)), states=(), inputs=(), outputs=())


@dataclass(frozen=True, slots=True)
class SimulatedFlight:
    """Outputs, true deflections, commands before the actuators, and limited samples.

    ``limited`` is True where an actuator is at a limit of position, rate or acceleration.
    """

    outputs: Float[np.ndarray, "n_samples n_y"]
    deflections: Float[np.ndarray, "n_samples n_u"]
    commands: Float[np.ndarray, "n_samples n_u"]
    limited: Bool[np.ndarray, "n_samples n_u"]


def simulate_flight(
    plant: StateSpace,
    actuators: Sequence[Instrument | ActuatorLimits],
    excitation: Float[np.ndarray, "n_samples n_u"],
    rate_hz: float,
    controller: StateSpace | None = None,
    delay_s: float = 0.0,
    report: Callable[[float], None] | None = None,
    *,
    excitation_of_law: Float[np.ndarray, "n_samples n_driven"] | None = None,
    rate_limit: float = np.inf,
) -> SimulatedFlight:
    """Simulate a flight from trim at rest.

    Parameters
    ----------
    plant
        Aircraft with its sensors, whose inputs are deflections.
    actuators
        From command to deflection, for every input of the plant in its order; a linear chain, or
        a second-order actuator with limits.
    excitation
        Added to the commands after the control law. [rad]
    rate_hz
        Of the excitation, of the control law and of the result. [Hz]
    controller, delay_s
        u = K y with the sign in K, None for open loop, and its delay from measurement to
        command, in addition to one sample. [s]
    report
        Called with the fraction done; may raise to stop.
    excitation_of_law
        Added to the commands of the control law before its rate limit: that of excitation
        before the mixer, mixed. [rad]
    rate_limit
        Of the commands of the control law. [rad/s]

    Raises
    ------
    BadInput
        If the aircraft diverges: the model is unstable without stabilising controller.

    Notes
    -----
    Between samples commands are held; aircraft and actuators are advanced together by
    their exact transition, the law by its own. Where that transition passes a limit, or a surface
    has freeplay, the actuators are advanced alone in parts of the sample, and the aircraft by its
    exact transition for deflections that are linear over each part.
    """
    chain = [_get_linear_part(one) for one in actuators]
    linear = build_instrument_chain(chain, plant.inputs)
    joined = series(linear, plant)
    limiter = _build_limiter(plant, actuators, rate_hz)
    F, G = discretise(joined.A, joined.B, 1.0 / rate_hz)
    n_a, n_u, n = linear.A.shape[0], excitation.shape[1], joined.A.shape[0]
    has_play = limiter is not None and limiter.has_play
    if limiter is not None:
        # One product gives the state and what is limited: products are most of a sample's time.
        G = np.vstack([G, limiter.by_end @ G + limiter.by_command])
        F = np.vstack([F, limiter.by_end @ F + limiter.by_start])
    leads = np.round(np.array([one.delay_s for one in actuators]) * rate_hz).astype(int)
    wait = 1 + round(delay_s * rate_hz)
    n_samples = excitation.shape[0]
    commands = np.vstack([excitation, np.zeros((wait, n_u))])
    top = int(leads.max(initial=0))
    delayed = np.zeros((top + n_samples, n_u))
    law = _NO_LAW if controller is None else controller
    Fk, Gk = discretise(law.A, law.B, 1.0 / rate_hz)
    read, driven = find_loop_channels(plant, law)
    x, law_state = np.zeros(n), np.zeros(Fk.shape[0])
    states = np.zeros((n_samples, n - n_a))
    deflections = np.zeros((n_samples, n_u))
    limited = np.zeros((n_samples, n_u), dtype=bool)
    angles = np.flatnonzero([name in _ANGLES for name in plant.states])
    every = np.arange(n_u)
    C_read, D_read = plant.C[read], plant.D[read]
    surfaces = np.zeros(n_u)  # behind the freeplay
    injected = np.zeros((wait + n_samples, len(driven)))
    if excitation_of_law is not None:
        injected[:n_samples] = excitation_of_law
    largest_step, computed = rate_limit / rate_hz, np.zeros(len(driven))
    for k in range(n_samples):
        delayed[top + k] = commands[k]
        now = delayed[top + k - leads, every]
        deflection = surfaces if has_play else linear.C @ x[:n_a] + linear.D @ now
        states[k], deflections[k] = x[n_a:], deflection
        if driven:
            y = C_read @ x[n_a:] + D_read @ deflection
            total = law.C @ law_state + law.D @ y + injected[k + wait]
            computed = (
                total
                if largest_step == np.inf
                else np.clip(total, computed - largest_step, computed + largest_step)
            )
            commands[k + wait, driven] += computed
            law_state = Fk @ law_state + Gk @ y
        step = F @ x + G @ now
        over = step[n:]
        is_near = over.size > 0 and (over.max() > _NEAR or over.min() < -_NEAR)
        if limiter is not None and (is_near or has_play):
            x, surfaces = limiter.advance(x, now, surfaces)
            limited[k, limiter.columns] = np.abs(over).reshape(4, -1).max(axis=0) > 1.0
        else:
            x = step[:n]
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
        outputs=states @ plant.C.T + deflections @ plant.D.T,
        deflections=deflections,
        commands=commands[:n_samples],
        limited=limited,
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class _Limiter:
    """Limited actuators of a simulation, None where deflection is the command itself.

    ``by_end``, ``by_start`` and ``by_command`` give position, rate and acceleration at the end of
    a sample, and acceleration at its start, over their limits: four rows of all limited actuators.
    """

    actuators: tuple[LimitedActuator | None, ...]
    columns: tuple[int, ...]
    by_end: Float[np.ndarray, "n_checks n_x"]
    by_start: Float[np.ndarray, "n_checks n_x"]
    by_command: Float[np.ndarray, "n_checks n_u"]
    transition: Float[np.ndarray, "n_plant n_plant"]
    weights: Float[np.ndarray, "n_plant n_nodes"]

    @property
    def has_play(self) -> bool:
        """Whether a surface has freeplay."""
        return any(one is not None and one.half_play > 0.0 for one in self.actuators)

    def advance(
        self,
        x: Float[np.ndarray, " n_x"],
        command: Float[np.ndarray, " n_u"],
        surfaces: Float[np.ndarray, " n_u"],
    ) -> tuple[Float[np.ndarray, " n_x"], Float[np.ndarray, " n_u"]]:
        """Advance actuators within their limits, and the plant: state and surfaces at the end."""
        nodes = np.empty((SUBSTEPS + 1, command.size))
        after = np.empty_like(x)
        state = 0
        for column, (actuator, constant) in enumerate(
            zip(self.actuators, command.tolist(), strict=True)
        ):
            if actuator is None:
                nodes[:, column] = constant
                continue
            own, scale = slice(state, state + 2), actuator.stiffness
            rate, position = (scale * x[own]).tolist()
            moved, rate = actuator.advance(position, rate, constant)
            after[own] = rate / scale, moved[-1] / scale
            nodes[:, column] = (
                moved
                if actuator.half_play == 0.0
                else actuator.follow(float(surfaces[column]), moved)
            )
            state += 2
        after[state:] = self.transition @ x[state:] + self.weights @ nodes.ravel()
        return after, nodes[-1]


def _build_limiter(
    plant: StateSpace, actuators: Sequence[Instrument | ActuatorLimits], rate_hz: float
) -> _Limiter | None:
    """Build the limiter of a simulation; None where no actuator has limits."""
    if not any(isinstance(one, ActuatorLimits) for one in actuators):
        return None
    n_u, sample_s = len(actuators), 1.0 / rate_hz
    built = tuple(
        None if limits is None else build_limited_actuator(limits, sample_s)
        for limits in (_find_limits(one) for one in actuators)
    )
    columns = tuple(k for k, one in enumerate(built) if one is not None)
    n_a = 2 * len(columns)
    by_end, by_start = np.zeros((2, 4, len(columns), n_a + plant.A.shape[0]))
    by_command = np.zeros((4, len(columns), n_u))
    for j, column in enumerate(columns):
        own = built[column]
        assert own is not None
        # The realisation of a second-order element has the states rate and position over w^2.
        rate, position = 2 * j, 2 * j + 1
        by_end[0, j, position] = own.stiffness / own.position
        by_end[1, j, rate] = own.stiffness / own.rate
        for row, by_state in ((2, by_end), (3, by_start)):
            by_state[row, j, position] = -(own.stiffness**2) / own.acceleration
            by_state[row, j, rate] = -own.damping * own.stiffness / own.acceleration
            by_command[row, j, column] = own.stiffness / own.acceleration
    transition, weights = discretise_between_nodes(plant.A, plant.B, sample_s)
    return _Limiter(
        actuators=built,
        columns=columns,
        by_end=by_end.reshape(-1, by_end.shape[-1]),
        by_start=by_start.reshape(-1, by_start.shape[-1]),
        by_command=by_command.reshape(-1, n_u),
        transition=transition,
        weights=weights,
    )


def _find_limits(actuator: Instrument | ActuatorLimits) -> ActuatorLimits | None:
    """Find the second-order actuator with limits; None for a direct input.

    Raises
    ------
    BadInput
        If a servo beside limited ones is not of second order.
    """
    if isinstance(actuator, ActuatorLimits):
        return actuator
    if not actuator.elements:
        return None
    element = actuator.elements[0]
    if len(actuator.elements) > 1 or not isinstance(element, SecondOrder):
        raise BadInput(
            "limits need servos of second order; give natural frequency and damping of the"
            " actuators",
            code="servo-not-second-order",
        )
    return ActuatorLimits(
        natural_frequency=element.natural_frequency,
        damping=element.damping,
        delay_s=actuator.delay_s,
    )


def _get_linear_part(actuator: Instrument | ActuatorLimits) -> Instrument:
    if isinstance(actuator, Instrument):
        return actuator
    element = SecondOrder(natural_frequency=actuator.natural_frequency, damping=actuator.damping)
    return Instrument(elements=(element,), delay_s=actuator.delay_s)
