"""The loop that a controller closes, at one airspeed after another, with what is uncertain."""

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
from flexsid.sysid.model.laws import chain_of, delay_of, series
from flexsid.sysid.stability.closed_loop import Margins, close_loop, frequency_response, margins_of

_FINE = 400  # frequencies between which margins are interpolated
_STILL = 1e-3  # rad/s: a root slower than this neither grows nor decays


@dataclass(frozen=True, slots=True)
class Loop:
    """What stands between the outputs of an aircraft and its deflections.

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
        """Whether nothing grows."""
        return self.growth < _STILL

    def beside(self, others: Sequence[LoopPoint]) -> LoopPoint:
        """The same with errors that hold what stable points of other structures say too."""
        alike = [other for other in others if other.stable]

        def widened(std: Float[np.ndarray, " n"], told: Callable[[Margins], float]) -> np.ndarray:
            off = [
                [told(b) - told(a) for a, b in zip(self.margins, other.margins, strict=True)]
                for other in alike
            ]
            values = np.array(off, dtype=float).reshape(-1, std.size)
            known = np.where(np.isfinite(values), values, 0.0)
            n = np.maximum(np.isfinite(values).sum(axis=0), 1)
            return np.sqrt(std**2 + (known**2).sum(axis=0) / n)

        return replace(
            self,
            gain_std=widened(self.gain_std, lambda m: float(np.log(m.gain_up))),
            phase_std=widened(self.phase_std, lambda m: m.phase),
            disk_std=widened(self.disk_std, lambda m: m.disk),
        )


def loop_point(
    model: AeroelasticModel,
    table: DerivativeTable,
    draws: Sequence[DerivativeTable],
    loop: Loop,
    band: tuple[float, float],
) -> LoopPoint:
    """Roots and margins at the condition of a model.

    Parameters
    ----------
    model
        With the outputs that the law reads.
    table, draws
        Derivatives, and tables scattered as they are uncertain.
    loop
        Law, actuators and delay.
    band
        Frequencies between which margins are looked for. [rad/s]

    Raises
    ------
    BadInput
        If the law reads or drives what the model has not.

    Notes
    -----
    Margins are read from frequency responses with exact delays, roots from third-order
    Pade delays. Gain margins scatter as factors, standard deviation of their logarithm.
    """
    roots = _roots(model, table, loop)
    growths = np.array([largest_growth(model, one, loop) for one in draws])
    omega = np.geomspace(band[0], band[1], _FINE)
    lead = _law_response(loop, omega)
    margins = _margins(model, table, loop, omega, lead)
    drawn = [_margins(model, one, loop, omega, lead) for one in draws]
    return LoopPoint(
        airspeed=model.condition.airspeed,
        roots=roots,
        growth=float(np.real(roots).max()),
        growth_std=float(growths.std()) if growths.size else 0.0,
        margins=margins,
        gain_std=_scatter([[np.log(m.gain_up) for m in row] for row in drawn], len(margins)),
        phase_std=_scatter([[m.phase for m in row] for row in drawn], len(margins)),
        disk_std=_scatter([[m.disk for m in row] for row in drawn], len(margins)),
    )


def largest_growth(model: AeroelasticModel, table: DerivativeTable, loop: Loop) -> float:
    """Largest real part of the closed loop's roots. [rad/s]"""
    return float(np.real(_roots(model, table, loop)).max())


def lost_at(
    points: Sequence[LoopPoint],
    growth_at: Callable[[float], float],
    growths_at: Callable[[float], Float[np.ndarray, " n_draws"]],
) -> tuple[float | None, tuple[float, float] | None]:
    """Airspeed at which stability is lost first, and the middle 95 % of what the draws say.

    Parameters
    ----------
    points
        Airspeeds in rising order, between two of which it is lost.
    growth_at, growths_at
        Largest real part at any airspeed: of the best estimate, and of every draw.

    Notes
    -----
    Draws cross where a straight line through two airspeeds at the crossing puts them.
    """
    between = next(
        (
            (low.airspeed, high.airspeed)
            for low, high in pairwise(points)
            if low.stable and not high.stable
        ),
        None,
    )
    if between is None:
        return None, None
    lost = float(brentq(lambda v: growth_at(v) - _STILL, *between, xtol=1e-4 * between[0]))
    beyond = 1.01 * lost
    here, there = growths_at(lost) - _STILL, growths_at(beyond) - _STILL
    if here.size == 0:
        return lost, None
    slope = np.maximum(there - here, 1e-9)
    crossings = np.sort(lost - here / slope * (beyond - lost))
    low, high = np.percentile(crossings, [2.5, 97.5])
    return lost, (max(0.0, float(low)), float(high))


def _roots(
    model: AeroelasticModel, table: DerivativeTable, loop: Loop
) -> Complex[np.ndarray, " n_roots"]:
    driven = loop.law.outputs
    law = series(loop.law, delay_of([loop.delay_s] * len(driven), driven))
    law = series(law, delay_of([one.delay_s for one in loop.actuators], driven))
    law = series(law, chain_of(loop.actuators, driven))
    return np.linalg.eigvals(close_loop(model.state_space(table), law).A)


def _law_response(
    loop: Loop, omega: Float[np.ndarray, " n_omega"]
) -> Complex[np.ndarray, "n_omega n_driven n_read"]:
    """From outputs to deflections, actuators and delays included."""
    acts = np.stack([one.response(omega) for one in loop.actuators], axis=1)
    lead = acts * np.exp(-1j * omega * loop.delay_s)[:, None]
    return lead[:, :, None] * frequency_response(loop.law, omega)


def _margins(
    model: AeroelasticModel,
    table: DerivativeTable,
    loop: Loop,
    omega: Float[np.ndarray, " n_omega"],
    lead: Complex[np.ndarray, "n_omega n_driven n_read"],
) -> tuple[Margins, ...]:
    read = [model.outputs.index(name) for name in loop.law.inputs]
    driven = [model.inputs.index(name) for name in loop.law.outputs]
    G = model.response(table, omega)[:, read][:, :, driven]
    closed = np.linalg.inv(np.eye(len(driven)) - lead @ G)
    loops = 1.0 / np.einsum("kii->ki", closed) - 1.0
    return tuple(margins_of(n, omega, loops[:, k]) for k, n in enumerate(loop.law.outputs))


def _scatter(rows: list[list[float]], count: int) -> Float[np.ndarray, " n_driven"]:
    """Standard deviation over draws of those that are finite."""
    if not rows:
        return np.zeros(count)
    values = np.array(rows, dtype=float)
    finite = np.isfinite(values)
    n = np.maximum(finite.sum(axis=0), 1)
    mean = np.where(finite, values, 0.0).sum(axis=0) / n
    return np.sqrt(np.where(finite, (values - mean) ** 2, 0.0).sum(axis=0) / n)
