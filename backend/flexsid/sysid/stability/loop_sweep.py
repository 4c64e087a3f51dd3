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
    compute_margins,
    frequency_response,
)

_FINE = 400  # frequencies between which margins are interpolated
_STILL = 1e-3  # rad/s: a slower root neither grows nor decays


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
        return self.growth < _STILL

    def widen(self, others: Sequence[LoopPoint]) -> LoopPoint:
        """Widen the errors by the differences to stable points of other model structures."""
        alike = [other for other in others if other.stable]

        def widened(
            std: Float[np.ndarray, " n"], quantity: Callable[[Margins], float]
        ) -> np.ndarray:
            off = [
                [
                    quantity(b) - quantity(a)
                    for a, b in zip(self.margins, other.margins, strict=True)
                ]
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


def evaluate_loop_point(
    model: AeroelasticModel,
    table: DerivativeTable,
    draws: Sequence[DerivativeTable],
    loop: Loop,
    band: tuple[float, float],
) -> LoopPoint:
    """Compute roots and margins at the condition of a model.

    Parameters
    ----------
    model
        With the outputs that the law reads.
    table, draws
        Derivatives, and tables drawn from their covariance.
    loop
        Law, actuators and delay.
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
    growths = np.array([compute_largest_growth(model, one, loop) for one in draws])
    omega = np.geomspace(band[0], band[1], _FINE)
    lead = _law_response(loop, omega)
    margins = _compute_margins(model, table, loop, omega, lead)
    drawn = [_compute_margins(model, one, loop, omega, lead) for one in draws]
    return LoopPoint(
        airspeed=model.condition.airspeed,
        roots=roots,
        growth=float(np.real(roots).max()),
        growth_std=float(growths.std()) if growths.size else 0.0,
        margins=margins,
        gain_std=_compute_std([[np.log(m.gain_up) for m in row] for row in drawn], len(margins)),
        phase_std=_compute_std([[m.phase for m in row] for row in drawn], len(margins)),
        disk_std=_compute_std([[m.disk for m in row] for row in drawn], len(margins)),
    )


def compute_largest_growth(model: AeroelasticModel, table: DerivativeTable, loop: Loop) -> float:
    """Largest real part of the closed loop's roots. [rad/s]"""
    return float(np.real(_compute_roots(model, table, loop)).max())


def find_stability_limit(
    points: Sequence[LoopPoint],
    growth_at: Callable[[float], float],
    growths_at: Callable[[float], Float[np.ndarray, " n_draws"]],
) -> tuple[float | None, tuple[float, float] | None]:
    """Find the lowest airspeed at which stability is lost, and its 95 % interval from draws.

    Parameters
    ----------
    points
        Airspeeds in rising order, between two of which it is lost.
    growth_at, growths_at
        Largest real part at any airspeed: of the best estimate, and of every draw.

    Notes
    -----
    The crossings of draws are extrapolated from two airspeeds at the crossing.
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
    closed = np.linalg.inv(np.eye(len(driven)) - lead @ G)
    loops = 1.0 / np.einsum("kii->ki", closed) - 1.0
    return tuple(compute_margins(n, omega, loops[:, k]) for k, n in enumerate(loop.law.outputs))


def _compute_std(rows: list[list[float]], count: int) -> Float[np.ndarray, " n_driven"]:
    """Standard deviation over draws of those that are finite."""
    if not rows:
        return np.zeros(count)
    values = np.array(rows, dtype=float)
    finite = np.isfinite(values)
    n = np.maximum(finite.sum(axis=0), 1)
    mean = np.where(finite, values, 0.0).sum(axis=0) / n
    return np.sqrt(np.where(finite, (values - mean) ** 2, 0.0).sum(axis=0) / n)
