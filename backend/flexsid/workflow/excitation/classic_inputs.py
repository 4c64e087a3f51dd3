"""A design against classic inputs that keep the same limits."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from flexsid.errors import NotIdentifiable
from flexsid.records.excitation import ExcitationDesign
from flexsid.storage.store import Store
from flexsid.sysid.estimation.expectation import (
    LOAD_FACTOR,
    Expectation,
    expect_from_history,
    waves_of_history,
)
from flexsid.sysid.excitation.classic import KINDS, in_turn, pulse_lengths
from flexsid.sysid.signals import TimeHistory
from flexsid.workflow.excitation.excitation_designs import multisine_of
from flexsid.workflow.excitation.predicted_accuracy import Circumstances, circumstances


@dataclass(frozen=True, slots=True, kw_only=True)
class ComparedInput:
    """One way to excite: largest deflection [rad], load factor [g], energy [rad2 s].

    ``pulse_s`` is the pulse length that told most; ``std_errors`` are empty, and ``lacking``
    says why, where derivatives are not told apart.
    """

    kind: str
    pulse_s: float | None
    deflection: float
    load_factor: float
    energy: float
    std_errors: tuple[float, ...]
    lacking: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class InputComparison:
    """Multisine first, then classic inputs; standard errors in the order of ``names``."""

    names: tuple[str, ...]
    values: tuple[float, ...]
    inputs: tuple[ComparedInput, ...]
    next: str | None = None


def compare_inputs(
    store: Store, design: ExcitationDesign, run_id: int, level: int = 0
) -> InputComparison:
    """Tell what doublets, 3-2-1-1s and sweeps of the same duration and limits would tell.

    Surfaces move in turn, in the design's duration and band, as large as neither the largest
    deflection nor the load factor of the design is exceeded; pulses have the length, of six, with
    the smallest confidence ellipsoid.
    """
    at = circumstances(store, run_id)
    told = at.expect(design, level)
    made, rate = multisine_of(design, level), design.wish.rate_hz
    command = made.sample(np.arange(round(made.period_s * rate)) / rate)
    count = len(at.derivatives)
    rows = [_row("multisine", None, told, command, rate, count)]
    peaks = dict(zip(made.inputs, np.abs(command).max(axis=0).tolist(), strict=True))
    for kind in KINDS:
        rows.append(_best(at, design, kind, peaks, told, count))
    return InputComparison(
        names=told.names[:count],
        values=tuple(map(float, told.theta[:count])),
        inputs=tuple(rows),
    )


def _best(
    at: Circumstances,
    design: ExcitationDesign,
    kind: str,
    peaks: dict[str, float],
    against: Expectation,
    count: int,
) -> ComparedInput:
    best: tuple[float, ComparedInput] | None = None
    lacking = ""
    for pulse_s, history in _candidates(at, design, kind, peaks):
        try:
            scaled, told = _at_limits(at, design, history, against)
            size = np.linalg.slogdet(told.covariance())[1]
        except NotIdentifiable as error:
            lacking = error.message
            continue
        row = _row(kind, pulse_s, told, scaled.values, scaled.rate_hz, count)
        if best is None or size < best[0]:
            best = size, row
    if best is not None:
        return best[1]
    return ComparedInput(
        kind=kind, pulse_s=None, deflection=0.0, load_factor=0.0, energy=0.0,
        std_errors=(), lacking=lacking,
    )  # fmt: skip


def _candidates(
    at: Circumstances, design: ExcitationDesign, kind: str, peaks: dict[str, float]
) -> Iterator[tuple[float | None, TimeHistory]]:
    duration_s, rate_hz = design.wish.duration_s, design.wish.rate_hz
    record_s = duration_s + at.flown.margin_s
    band = _band(design)
    if kind == "sweep":
        yield None, in_turn(kind, peaks, duration_s, rate_hz, record_s, band)
        return
    for unit in pulse_lengths(kind, duration_s, len(peaks), rate_hz):
        yield float(unit), in_turn(kind, peaks, duration_s, rate_hz, record_s, band, float(unit))


def _at_limits(
    at: Circumstances, design: ExcitationDesign, history: TimeHistory, against: Expectation
) -> tuple[TimeHistory, Expectation]:
    """Scaled until one of the design's limits is reached."""
    moved = np.abs(waves_of_history(at.model, at.parameters, history, at.flown)).max(axis=0)
    gain = float(np.min(np.array(_largest(against)) / np.array([moved[:-1].max(), moved[-1]])))
    scaled = replace(history, values=gain * history.values)
    return scaled, expect_from_history(
        at.model, at.parameters, scaled, at.flown, _band(design), at.priors
    )


def _band(design: ExcitationDesign) -> tuple[float, float]:
    every = [harmonic for own in design.wish.inputs for harmonic in own.harmonics]
    return min(every) / design.wish.duration_s, max(every) / design.wish.duration_s


def _largest(told: Expectation) -> tuple[float, float]:
    """Largest deflection of any surface [rad], and load factor [g]."""
    peaks = dict(zip(told.limited, told.peaks().tolist(), strict=True))
    load = peaks.pop(LOAD_FACTOR)
    return max(peaks.values()), load


def _row(
    kind: str,
    pulse_s: float | None,
    told: Expectation,
    command: np.ndarray,
    rate_hz: float,
    count: int,
) -> ComparedInput:
    deflection, load_factor = _largest(told)
    return ComparedInput(
        kind=kind,
        pulse_s=pulse_s,
        deflection=deflection,
        load_factor=load_factor,
        energy=float(np.sum(command**2)) / rate_hz,
        std_errors=tuple(map(float, told.std_errors()[:count])),
    )
