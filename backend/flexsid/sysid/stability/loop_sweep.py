"""Closed loop over airspeed, with uncertainty."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from jaxtyping import Complex, Float
from scipy.optimize import brentq

from flexsid.sysid.model.aeroelastic import AeroelasticModel, StateSpace
from flexsid.sysid.model.derivatives import DerivativeTable
from flexsid.sysid.model.instruments import Instrument
from flexsid.sysid.model.laws import build_delays, build_instrument_chain, series
from flexsid.sysid.stability.closed_loop import (
    Margins,
    close_loop,
    compute_broken_loops,
    compute_margins,
    frequency_response,
)
from flexsid.sysid.stability.root_tracking import STATIC_ROOT_RAD_S

_FINE = 400  # frequencies between which margins are interpolated


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
    omega = np.geomspace(band[0], band[1], _FINE)
    lead = _law_response(loop, omega)
    margins = _compute_margins(model, table, loop, omega, lead)
    drawn = [_tabulate_margins(_compute_margins(model, one, loop, omega, lead)) for one in samples]
    std = np.zeros((3, len(margins)))
    if drawn:
        std = np.ma.filled(np.ma.masked_invalid(drawn).std(axis=0), 0.0)
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


def _compute_margins(
    model: AeroelasticModel,
    table: DerivativeTable,
    loop: Loop,
    omega: Float[np.ndarray, " n_omega"],
    lead: Complex[np.ndarray, "n_omega n_driven n_read"],
) -> tuple[Margins, ...]:
    read = [model.outputs.index(name) for name in loop.law.inputs]
    driven = [model.inputs.index(name) for name in loop.law.outputs]
    G = model.response(table, omega)[:, read][:, :, driven]
    return tuple(map(compute_margins, compute_broken_loops(lead @ G).T))


def _tabulate_margins(margins: Sequence[Margins]) -> Float[np.ndarray, "3 n_driven"]:
    """Logarithm of the gain, phase and disk margin of every loop; infinite where unlimited."""
    return np.array([[np.log(one.gain_up), one.phase, one.disk] for one in margins]).T
