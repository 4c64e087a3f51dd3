"""The ``[time]`` part of a mapping: a uniform clock, checked sample by sample."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexsid import units
from flexsid.errors import BadInput, UnreadableFile
from flexsid.importers.quantity import Quantity, resolve
from flexsid.importers.source import Sources
from flexsid.importers.table import Table

STEP_TOLERANCE = 0.1
"""Part of a sample by which one time step may differ (a recorder's clock is quantised)."""

DRIFT_TOLERANCE = 0.5
"""Part of a sample by which a time stamp may be off the uniform clock."""


@dataclass(frozen=True, slots=True, kw_only=True)
class TimeRule:
    """Where the time is: a column, or a rate and the time of the first sample."""

    column: str | None
    unit: str = "s"
    rate: Quantity | None = None
    start_s: float = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Clock:
    """Uniform time base found in the file."""

    start_s: float
    rate_hz: float
    n_samples: int


def read_time(table: Table) -> TimeRule:
    """Read ``column`` and ``unit``, or ``rate`` and ``start``."""
    if "rate" in table:
        rule = TimeRule(
            column=None,
            rate=table.quantity("rate", "frequency"),
            start_s=table.si_scalar("start", "time") if "start" in table else 0.0,
        )
    else:
        rule = TimeRule(column=table.text("column"), unit=table.text("unit", "s"))
        units.factor(rule.unit, "time")
    table.close()
    return rule


def extract_clock(rule: TimeRule, sources: Sources, n_samples: int) -> Clock:
    """Find the uniform time base.

    Raises
    ------
    UnreadableFile
        Naming the row at which time stands still, goes backwards or jumps.
    """
    if rule.column is None:
        rate = resolve(rule.rate, sources, None) if rule.rate is not None else 0.0
        if rate <= 0:
            raise BadInput("Mapping: 'time.rate' must be positive.", code="bad-mapping")
        return Clock(start_s=rule.start_s, rate_hz=rate, n_samples=n_samples)
    source, _ = sources.find(rule.column)
    stamps = units.to_si(np.atleast_1d(sources.numbers(rule.column)), rule.unit)
    if stamps.ndim != 1 or stamps.size < 2:
        raise UnreadableFile(
            f"{source.name}: column '{rule.column}' holds {stamps.size} time stamp; "
            "a record has at least two samples.",
            column=rule.column,
        )
    source.check_finite(stamps, rule.column)
    steps = np.diff(stamps)
    step = (stamps[-1] - stamps[0]) / steps.size
    backwards = np.flatnonzero(steps <= 0)
    if backwards.size:
        row = source.first_row + int(backwards[0]) + 1
        raise UnreadableFile(
            f"{source.name}: row {row}, column '{rule.column}': time does not increase "
            f"({stamps[backwards[0] + 1]:.6g} s after {stamps[backwards[0]]:.6g} s).",
            code="time-backwards",
            row=row,
            column=rule.column,
        )
    drift = np.abs(stamps - (stamps[0] + step * np.arange(stamps.size)))
    uneven = np.abs(steps - np.median(steps)) > STEP_TOLERANCE * np.median(steps)
    if uneven.any() or (drift > DRIFT_TOLERANCE * step).any():
        worst = int(np.argmax(uneven)) + 1 if uneven.any() else int(np.argmax(drift))
        row = source.first_row + worst
        raise UnreadableFile(
            f"{source.name}: row {row}, column '{rule.column}': the time step is not uniform "
            f"({steps[worst - 1]:.6g} s, usually {np.median(steps):.6g} s). "
            "Samples are missing or the clock jumped; resample the record first.",
            code="time-not-uniform",
            row=row,
            column=rule.column,
        )
    rate = 1.0 / step
    # Time stamps are rounded in the file: 199.99999998 Hz is 200 Hz.
    whole = round(rate)
    return Clock(
        start_s=float(stamps[0]),
        rate_hz=float(whole) if whole and abs(rate / whole - 1.0) < 1e-7 else float(rate),
        n_samples=stamps.size,
    )
