"""Loop closed by a controller: poles, margins, measured loops, and sweeps over airspeed.

At the harmonics of one input no other input is excited, so that its deflection over its
recorded excitation is A / (1 + L): its own loop closed around the actuator A, all other
loops closed as they fly.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from jaxtyping import Complex, Float
from scipy.interpolate import make_interp_spline
from scipy.optimize import brentq

from flexsid.errors import BadInput
from flexsid.sysid.model.aeroelastic import AeroelasticModel, StateSpace
from flexsid.sysid.model.derivatives import DerivativeTable
from flexsid.sysid.model.laws import (
    build_delays,
    build_instrument_chain,
    find_loop_channels,
    series,
)
from flexsid.sysid.model.sensor_models import Instrument
from flexsid.sysid.signals import FrequencyData
from flexsid.sysid.spectra.residual_spectrum import estimate_noise_about_responses
from flexsid.sysid.stability.margins import (
    Margins,
    compute_broken_loops,
    compute_margins,
    estimate_margin_errors,
)
from flexsid.sysid.stability.root_tracking import STATIC_ROOT_RAD_S

# --- Loop closed by a controller ------------------------------------------------------------------


def close_loop(plant: StateSpace, controller: StateSpace) -> StateSpace:
    """Connect a controller, u = K y with the sign in K, to the outputs and inputs of its names.

    Raises
    ------
    BadInput
        If the controller reads outputs or drives inputs that the plant does not have, or the
        algebraic loop has no solution.
    """
    read, driven = find_loop_channels(plant, controller)
    D = plant.D[read][:, driven]
    direct = np.eye(len(read)) - D @ controller.D
    if abs(np.linalg.det(direct)) < 1e-12:
        raise BadInput("the algebraic loop of plant and controller feedthrough has no solution")
    B = plant.B[:, driven]
    # y_r = S (C x + D Ck xk + Dr u), u_d = Ck xk + Dk y_r
    S = np.linalg.solve(direct, np.eye(len(read)))
    y_x, y_k = S @ plant.C[read], S @ D @ controller.C
    y_u = S @ plant.D[read]
    u_x, u_k = controller.D @ y_x, controller.C + controller.D @ y_k
    u_u = controller.D @ y_u
    A = np.block(
        [
            [plant.A + B @ u_x, B @ u_k],
            [controller.B @ y_x, controller.A + controller.B @ y_k],
        ]
    )
    return StateSpace(
        A=A,
        B=np.vstack([plant.B + B @ u_u, controller.B @ y_u]),
        C=np.hstack([plant.C + plant.D[:, driven] @ u_x, plant.D[:, driven] @ u_k]),
        D=plant.D + plant.D[:, driven] @ u_u,
        states=(*plant.states, *controller.states),
        inputs=plant.inputs,
        outputs=plant.outputs,
    )


def frequency_response(
    system: StateSpace, omega: Float[np.ndarray, " n_omega"]
) -> Complex[np.ndarray, "n_omega n_y n_u"]:
    """Compute the frequency response of a state-space system."""
    resolvent = 1j * omega[:, None, None] * np.eye(system.A.shape[0]) - system.A
    forced = np.linalg.solve(resolvent, np.broadcast_to(system.B, (omega.size, *system.B.shape)))
    return system.C @ forced + system.D


# --- Measured loops: gain and margins of each surface's loop from one closed-loop maneuver --------

_MONTE_CARLO_SAMPLES = 200  # standard errors of margins scatter by 5 %
_FINE = 500  # frequencies between which margins are interpolated
_LEAST_HARMONICS = 8  # of an input, for a cubic interpolation of its loop gain


@dataclass(frozen=True, slots=True)
class MeasuredLoop:
    """Gain of one loop, broken in front of its actuator, at its own harmonics.

    ``std`` is the standard deviation of the complex error; the margins' are from draws.
    """

    surface: str
    omega: Float[np.ndarray, " n_omega"]
    gain: Complex[np.ndarray, " n_omega"]
    std: Float[np.ndarray, " n_omega"]
    margins: Margins
    phase_std: float
    disk_std: float


def estimate_loop_gains(
    deflections: FrequencyData,
    commands: FrequencyData,
    actuators: Complex[np.ndarray, "n_omega n_u"],
    assigned_input: np.ndarray,
) -> tuple[MeasuredLoop, ...]:
    """Estimate loop gains L_i = A e_i / delta_i - 1 with their margins.

    Parameters
    ----------
    deflections
        True deflections at all harmonics. [rad s]
    commands
        Recorded excitation, added to the command in front of the actuator. [rad s]
    actuators
        Deflection over command of every input. [1]
    assigned_input
        Index of the input that each harmonic is assigned to.

    Raises
    ------
    BadInput
        If an input has fewer than eight harmonics.
    """
    noise = estimate_noise_about_responses(
        deflections.omega,
        assigned_input,
        deflections.values,
        commands.values[np.arange(assigned_input.size), assigned_input],
    )
    rng = np.random.default_rng(0)
    loops = []
    for index, name in enumerate(deflections.names):
        own = np.flatnonzero(assigned_input == index)
        if own.size < _LEAST_HARMONICS:
            raise BadInput(
                f"input '{name}' has {own.size} harmonics; its loop needs {_LEAST_HARMONICS}",
                code="too-few-frequencies",
                input=name,
            )
        delta = deflections.values[own, index]
        returned = actuators[own, index] * commands.values[own, index] / delta
        level = np.zeros(own.size) if noise is None else noise[own, index]
        std = np.abs(returned) * level / np.abs(delta)
        omega, gain = deflections.omega[own], returned - 1.0
        fine = np.linspace(omega[0], omega[-1], _FINE)
        matrix = make_interp_spline(omega, np.eye(own.size), k=3)(fine)
        scatter = rng.normal(size=(_MONTE_CARLO_SAMPLES, own.size)) + 1j * rng.normal(
            size=(_MONTE_CARLO_SAMPLES, own.size)
        )
        drawn = (gain + std * scatter / np.sqrt(2.0)) @ matrix.T
        errors = estimate_margin_errors(drawn[:, :, None])[:, 0]
        loops.append(
            MeasuredLoop(
                surface=name,
                omega=omega,
                gain=gain,
                std=std,
                margins=compute_margins(fine, matrix @ gain),
                phase_std=float(errors.filled(np.nan)[1]),
                disk_std=float(errors[2]),
            )
        )
    return tuple(loops)


# --- Closed loop over airspeed, with uncertainty --------------------------------------------------

_FINE_SWEEP = 400  # frequencies between which margins are interpolated


@dataclass(frozen=True, slots=True)
class Loop:
    """Control law, actuators and delay between outputs and deflections of an aircraft.

    ``law`` is u = K y; ``actuators`` belong to its outputs in order; ``delay_s`` is
    from measurement to command.
    """

    law: StateSpace
    actuators: tuple[Instrument, ...]
    delay_s: float


@dataclass(frozen=True, slots=True)
class LoopPoint:
    """The closed loop at one airspeed.

    ``growth`` is the largest real part of its roots [rad/s]; margins mean something only
    where that is negative. The ``_std`` of margins follow the order of ``margins``.
    """

    airspeed: float
    roots: Complex[np.ndarray, " n_roots"]
    growth: float
    growth_std: float
    margins: tuple[Margins, ...]
    gain_std: Float[np.ndarray, " n_driven"]
    phase_std: Float[np.ndarray, " n_driven"]
    disk_std: Float[np.ndarray, " n_driven"]

    @property
    def stable(self) -> bool:
        """Whether all roots are stable."""
        return self.growth < STATIC_ROOT_RAD_S

    def widen(self, others: Sequence[LoopPoint]) -> LoopPoint:
        """Widen the errors by the differences to stable points of other model structures."""
        alike = [_tabulate_margins(other.margins) for other in others if other.stable]
        if not alike:
            return self
        apart = np.ma.masked_invalid(alike) - np.ma.masked_invalid(_tabulate_margins(self.margins))
        bias = np.ma.filled((apart**2).mean(axis=0), 0.0)
        std = np.sqrt(np.stack([self.gain_std, self.phase_std, self.disk_std]) ** 2 + bias)
        return replace(self, gain_std=std[0], phase_std=std[1], disk_std=std[2])


def evaluate_loop_point(
    model: AeroelasticModel,
    table: DerivativeTable,
    samples: Sequence[DerivativeTable],
    loop: Loop,
    band: tuple[float, float],
) -> LoopPoint:
    """Compute roots and margins at the condition of a model.

    Parameters
    ----------
    table, samples
        Derivatives, and tables drawn from their covariance.
    band
        Frequencies between which margins are looked for. [rad/s]

    Raises
    ------
    BadInput
        If the law reads outputs or drives inputs that the model does not have.

    Notes
    -----
    Margins are read from frequency responses with exact delays, roots from third-order
    Pade delays. Gain margins scatter as factors, standard deviation of their logarithm.
    """
    roots = _compute_roots(model, table, loop)
    growths = np.array([compute_largest_growth(model, one, loop) for one in samples])
    omega = np.geomspace(band[0], band[1], _FINE_SWEEP)
    lead = _law_response(loop, omega)
    broken = _break_loops(model, table, loop, omega, lead)
    margins = tuple(compute_margins(omega, L) for L in broken.T)
    std = np.zeros((3, len(margins)))
    if samples:
        drawn = np.stack([_break_loops(model, one, loop, omega, lead) for one in samples])
        std = estimate_margin_errors(drawn).filled(0.0)
    return LoopPoint(
        airspeed=model.condition.airspeed,
        roots=roots,
        growth=float(np.real(roots).max()),
        growth_std=float(growths.std()) if growths.size else 0.0,
        margins=margins,
        gain_std=std[0],
        phase_std=std[1],
        disk_std=std[2],
    )


def compute_largest_growth(model: AeroelasticModel, table: DerivativeTable, loop: Loop) -> float:
    """Largest real part of the closed loop's roots. [rad/s]"""
    return float(np.real(_compute_roots(model, table, loop)).max())


def find_stability_limit(
    points: Sequence[LoopPoint],
    growth_at: Callable[[float], float],
    growths_at: Callable[[float], Float[np.ndarray, " n_resamplings"]],
) -> tuple[float | None, tuple[float, float] | None]:
    """Find the lowest airspeed at which stability is lost, and its 95 % interval from samples.

    The airspeeds of the points are rising; ``growth_at`` and ``growths_at`` give the largest real
    part at any airspeed, of the best estimate and of every sample.

    Notes
    -----
    The crossings of samples are extrapolated from two airspeeds at the crossing.
    """
    for stable, unstable in pairwise(points):
        if stable.stable and not unstable.stable:
            break
    else:
        return None, None
    low, high = stable.airspeed, unstable.airspeed
    lost = float(brentq(lambda v: growth_at(v) - STATIC_ROOT_RAD_S, low, high, xtol=1e-4 * low))
    beyond = 1.01 * lost
    here, there = growths_at(lost) - STATIC_ROOT_RAD_S, growths_at(beyond) - STATIC_ROOT_RAD_S
    if here.size == 0:
        return lost, None
    slope = np.maximum(there - here, 1e-9)
    crossings = np.sort(lost - here / slope * (beyond - lost))
    low, high = np.percentile(crossings, [2.5, 97.5])
    return lost, (max(0.0, float(low)), float(high))


def _compute_roots(
    model: AeroelasticModel, table: DerivativeTable, loop: Loop
) -> Complex[np.ndarray, " n_roots"]:
    driven = loop.law.outputs
    law = series(loop.law, build_delays([loop.delay_s] * len(driven), driven))
    law = series(law, build_delays([one.delay_s for one in loop.actuators], driven))
    law = series(law, build_instrument_chain(loop.actuators, driven))
    return np.linalg.eigvals(close_loop(model.state_space(table), law).A)


def _law_response(
    loop: Loop, omega: Float[np.ndarray, " n_omega"]
) -> Complex[np.ndarray, "n_omega n_driven n_read"]:
    """From outputs to deflections, actuators and delays included."""
    acts = np.stack([one.response(omega) for one in loop.actuators], axis=1)
    lead = acts * np.exp(-1j * omega * loop.delay_s)[:, None]
    return lead[:, :, None] * frequency_response(loop.law, omega)


def _break_loops(
    model: AeroelasticModel,
    table: DerivativeTable,
    loop: Loop,
    omega: Float[np.ndarray, " n_omega"],
    lead: Complex[np.ndarray, "n_omega n_driven n_read"],
) -> Complex[np.ndarray, "n_omega n_driven"]:
    read = [model.outputs.index(name) for name in loop.law.inputs]
    driven = [model.inputs.index(name) for name in loop.law.outputs]
    G = model.response(table, omega)[:, read][:, :, driven]
    return compute_broken_loops(lead @ G)


def _tabulate_margins(margins: Sequence[Margins]) -> Float[np.ndarray, "3 n_driven"]:
    """Logarithm of the gain, phase and disk margin of every loop; infinite where unlimited."""
    return np.array([[np.log(one.gain_up), one.phase, one.disk] for one in margins]).T


# --- Margins of a digital control law -------------------------------------------------------------

_HOLD = 1.5  # samples: one of computation, half of one of the hold between samples
_LOWEST = 0.05  # rad/s: below any loop on a surface
_DIGITAL_FINE = 3000  # spacing 0.4 %: less than the half-power width of a mode of 0.5 % damping


def compute_digital_margins(plant: StateSpace, loop: Loop, rate_hz: float) -> tuple[Margins, ...]:
    """Compute the margins of a digital loop at every surface that its law drives.

    Parameters
    ----------
    plant
        Aircraft with its sensors.
    loop
        Control law, the actuators of its outputs, and its delay.
    rate_hz
        Of the control law: its computation delays by one sample and a half. [Hz]

    Raises
    ------
    BadInput
        If the law reads outputs or drives inputs that the plant does not have.

    Notes
    -----
    Actuators are linear: margins hold where no limit is active.
    """
    read, driven = find_loop_channels(plant, loop.law)
    omega = np.geomspace(_LOWEST, np.pi * rate_hz, _DIGITAL_FINE)
    digital = replace(loop, delay_s=loop.delay_s + _HOLD / rate_hz)
    G = frequency_response(plant, omega)[:, read][:, :, driven]
    broken = compute_broken_loops(_law_response(digital, omega) @ G)
    return tuple(compute_margins(omega, L) for L in broken.T)
