"""Time bases: the ``[time]`` part of a mapping and ``[[clocks]]``, checked sample by sample."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from flexsid import units
from flexsid.errors import BadInput, UnreadableFile
from flexsid.importers.quantity import Quantity, refuse, scalar
from flexsid.importers.source import Source, Sources
from flexsid.importers.table import Table

POSSIBLE_RATES_HZ = (1e-4, 1e8)
STEP_TOLERANCE = 0.1
"""Part of a sample by which one time step may differ (a recorder's clock is quantised)."""

DRIFT_TOLERANCE = 0.5
"""Part of a sample by which a time stamp may be off the uniform clock."""


@dataclass(frozen=True, slots=True, kw_only=True)
class TimeRule:
    """Where the time is: a column, or a rate and the time of the first sample.

    ``offset_s`` is added, where recorders did not agree what time it was.
    """

    column: str | None
    unit: str = "s"
    rate: Quantity | None = None
    start_s: float = 0.0
    offset_s: float = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Clock:
    """Uniform time base found in the file."""

    start_s: float
    rate_hz: float
    n_samples: int

    @property
    def stop_s(self) -> float:
        """One sample after the last. [s]"""
        return self.start_s + self.n_samples / self.rate_hz

    def window(self, start_s: float | None, stop_s: float | None) -> slice:
        """Samples from start to stop; None for the ends of the record."""
        first = 0 if start_s is None else max(0, round((start_s - self.start_s) * self.rate_hz))
        if stop_s is None:
            return slice(first, self.n_samples)
        last = min(self.n_samples, round((stop_s - self.start_s) * self.rate_hz))
        return slice(first, max(first, last))


def read_time(table: Table) -> TimeRule:
    """Read ``column`` and ``unit``, or ``rate`` and ``start``."""
    offset = table.si_scalar("offset", "time") if "offset" in table else 0.0
    if "rate" in table:
        rule = TimeRule(
            column=None,
            rate=table.quantity("rate", "frequency"),
            start_s=table.si_scalar("start", "time") if "start" in table else 0.0,
            offset_s=offset,
        )
    else:
        rule = TimeRule(column=table.text("column"), unit=table.text("unit", "s"), offset_s=offset)
        units.factor(rule.unit, "time")
    table.close()
    return rule


def read_clocks(tables: tuple[Table, ...]) -> dict[str, TimeRule]:
    """Read ``[[clocks]]``: further time bases, by name."""
    clocks: dict[str, TimeRule] = {}
    for table in tables:
        name = table.text("name")
        if name in clocks:
            raise refuse(table.path("name"), f"'{name}' is there twice.")
        clocks[name] = read_time(table)
    return clocks


@dataclass(slots=True)
class Timing:
    """The time bases of the files of one import; each is checked once.

    A channel follows the clock that the mapping names for it, else the clock that
    its file says it has, else the column of ``[time]`` or of ``[[clocks]]`` that is in
    its own file, else ``[time]``.
    """

    default: TimeRule | None
    named: Mapping[str, TimeRule]
    sources: Sources
    _known: dict[tuple[TimeRule, str], Clock] = field(default_factory=dict)

    def clock(self, source: Source, path: str, label: str, n: int, name: str | None) -> Clock:
        """Find the time base of a field with ``n`` samples.

        Raises
        ------
        UnreadableFile
            Naming the row at which time stands still, goes backwards or jumps, or
            from which the channel has no time.
        """
        rule = self._rule(source, path, name)
        at = source if rule.column in source.arrays else None
        if rule.column is not None and at is None:
            at, _ = self.sources.find(rule.column)
        key = (rule, (at or source).name)
        found = self._known.get(key)
        if found is None:
            found = _extract(rule, at, self.sources, n)
            self._known[key] = found
        if found.n_samples != n:
            short, row = (label, n) if n < found.n_samples else (rule.column, found.n_samples)
            raise UnreadableFile(
                f"Channel '{label}' has {n} samples but its time '{rule.column or 'rate'}' has "
                f"{found.n_samples}: equal up to row {row}.",
                code="unequal-lengths",
                row=row + 1,
                column=short or label,
            )
        return found

    def _rule(self, source: Source, path: str, name: str | None) -> TimeRule:
        if name is not None:
            if name not in self.named:
                known = ", ".join(self.named) or "none"
                raise refuse("clocks", f"has no clock '{name}'; there is: {known}.")
            return self.named[name]
        if path in source.clocks:
            column = source.clocks[path]
            return TimeRule(column=column, unit=source.units.get(column, "s"))
        if self.default is None or self.default.column not in source.arrays:
            for rule in self.named.values():
                if rule.column is not None and self.sources.find(rule.column)[0] is source:
                    return rule
        if self.default is None:
            raise refuse("time", f"is missing; {source.name} does not say when '{path}' was taken.")
        return self.default


def _extract(rule: TimeRule, source: Source | None, sources: Sources, n_samples: int) -> Clock:
    if rule.column is None or source is None:
        rate = 0.0 if rule.rate is None else scalar(rule.rate, sources)
        if rate <= 0:
            raise BadInput("Mapping: 'time.rate' must be positive.", code="bad-mapping")
        return Clock(
            start_s=rule.start_s + rule.offset_s, rate_hz=_possible(rate), n_samples=n_samples
        )
    column = np.atleast_1d(Sources((source,)).numbers(rule.column))
    stamps = units.to_si(column, rule.unit) + rule.offset_s
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
    usual = float(np.median(steps))
    drift = np.abs(stamps - (stamps[0] + step * np.arange(stamps.size)))
    uneven = np.abs(steps - usual) > STEP_TOLERANCE * usual
    if uneven.any() or (drift > DRIFT_TOLERANCE * step).any():
        worst = int(np.argmax(uneven)) + 1 if uneven.any() else int(np.argmax(drift))
        row = source.first_row + worst
        raise UnreadableFile(
            f"{source.name}: row {row}, column '{rule.column}': the time step is not uniform "
            f"({steps[worst - 1]:.6g} s, usually {usual:.6g} s). "
            "Samples are missing or the clock jumped; resample the record first.",
            code="time-not-uniform",
            row=row,
            column=rule.column,
        )
    try:
        rate = _possible(1.0 / step)
    except BadInput as error:
        raise UnreadableFile(
            f"{source.name}: column '{rule.column}': {error.message}",
            code=error.code,
            column=rule.column,
        ) from error
    # Time stamps are rounded in the file: 199.99999998 Hz is 200 Hz.
    whole = round(rate)
    return Clock(
        start_s=float(stamps[0]),
        rate_hz=float(whole) if whole and abs(rate / whole - 1.0) < 1e-7 else float(rate),
        n_samples=stamps.size,
    )


def _possible(rate_hz: float) -> float:
    """The rate, if a recorder may have it; a time in the wrong unit has not."""
    low, high = POSSIBLE_RATES_HZ
    if not low <= rate_hz <= high:
        raise BadInput(
            f"{rate_hz:.3g} samples per second are no recording ({low:g} to {high:g} Hz are "
            "expected); is the unit of time right?",
            code="bad-rate",
        )
    return rate_hz
