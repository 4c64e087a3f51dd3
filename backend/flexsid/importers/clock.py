"""Time bases: the ``[time]`` part of a mapping and ``[[clocks]]``, checked sample by sample."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from scipy.interpolate import CubicSpline

from flexsid import units
from flexsid.errors import BadInput, UnreadableFile
from flexsid.importers.mapping import ClockMapping, TimeMapping
from flexsid.importers.quantity import scalar
from flexsid.importers.repairs import suggest_repair
from flexsid.importers.source import SourceFile, Sources
from flexsid.importers.table import refuse

POSSIBLE_RATES_HZ = (1e-4, 1e8)
USUAL_RATES_HZ = (2.0, 5000.0)
"""Usual sampling rates of flight-test records; other rates must be confirmed. [Hz]"""

STEP_TOLERANCE = 0.1
"""Tolerance on one time step, as a fraction of a sample (a recorder's clock is quantised)."""

RATE_TOLERANCE = 1e-4
"""Largest relative uncertainty of the sampling rate from rounded time stamps: 10 ms in 100 s, one
or two samples at the end of a long record."""

_FEW = 0.1
"""Fraction of the steps that may differ before a clock is rounded rather than interrupted."""

_SHOWN_SEGMENTS = 6  # in messages
UNUSUAL_RATE = "unusual-rate"

UNEVEN_STEPS = (0.2, 3.0)
"""Steps of time between which uneven samples are interpolated, over the usual step: at most two
samples are missing, and no two are so close that a spline through both amplifies their noise."""

DRIFT_TOLERANCE = 0.5
"""Tolerance of a time stamp against the uniform clock, as a fraction of a sample."""


_JUMP = 3.0
"""Usual steps of time beyond which a recording begins anew, as after a change of clock."""


class Segment(NamedTuple):
    """Rows of a file between jumps of its clock, of ``n_rows`` in all; times of the ends. [s]"""

    first: int
    end: int
    n_rows: int
    start_s: float
    stop_s: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Clock:
    """Uniform time base of a record."""

    start_s: float
    rate_hz: float
    n_samples: int
    rounded_s: float | None = None
    """Resolution of the time stamps, if coarser than a tenth of a sample. [s]"""

    confirmed: tuple[str, ...] = ()
    stamps: np.ndarray | None = field(default=None, compare=False, repr=False)
    """Times of recorded samples that are interpolated to this clock. [s]"""

    segment: Segment | None = None
    """Rows of the file that have this clock, where it jumps elsewhere; None for all."""

    @property
    def stop_s(self) -> float:
        """One sample after the last. [s]"""
        return self.start_s + self.n_samples / self.rate_hz

    @property
    def n_recorded(self) -> int:
        """Number of samples in the file."""
        if self.segment is not None:
            return self.segment.n_rows
        return self.n_samples if self.stamps is None else self.stamps.size

    @property
    def first_row(self) -> int:
        """Row of the file, from 0, with the first sample of this clock."""
        return 0 if self.segment is None else self.segment.first

    def select(self, samples: np.ndarray) -> np.ndarray:
        """Return the recorded samples that have this clock."""
        return samples if self.segment is None else samples[self.segment.first : self.segment.end]

    @property
    def unevenness_s(self) -> float:
        """Largest difference of a time step from the sampling interval. [s]"""
        if self.stamps is None:
            return 0.0
        return float(np.abs(np.diff(self.stamps) - 1.0 / self.rate_hz).max())

    def interpolate(self, samples: np.ndarray) -> np.ndarray:
        """Return samples of this clock from the selected ones.

        Notes
        -----
        Uneven samples are interpolated by a cubic spline (not-a-knot).
        """
        if self.stamps is None:
            return samples
        times = self.start_s + np.arange(self.n_samples) / self.rate_hz
        return CubicSpline(self.stamps, samples)(np.minimum(times, self.stamps[-1]))

    def window(self, start_s: float | None, stop_s: float | None) -> slice:
        """Return the samples from start to stop; None for the ends of the record."""
        first = 0 if start_s is None else max(0, round((start_s - self.start_s) * self.rate_hz))
        if stop_s is None:
            return slice(first, self.n_samples)
        last = min(self.n_samples, round((stop_s - self.start_s) * self.rate_hz))
        return slice(first, max(first, last))


@dataclass(slots=True)
class Timing:
    """The time bases of the files of one import; each is checked once.

    A channel uses the clock that the mapping names for it, else the clock that its file
    assigns, else the column of ``[time]`` or of ``[[clocks]]`` in its own file, else
    ``[time]``.
    """

    default: TimeMapping | None
    named: tuple[ClockMapping, ...]
    sources: Sources
    window_s: tuple[float | None, float | None] = (None, None)
    """Start and stop of the maneuver: of a clock that jumps, the segment there is used."""

    _known: dict[tuple[TimeMapping, str], Clock] = field(default_factory=dict)

    def clock(self, source: SourceFile, path: str, label: str, n: int, name: str | None) -> Clock:
        """Return the time base of a field with ``n`` samples.

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
            found = _extract(rule, at, self.sources, n, self.window_s)
            self._known[key] = found
        if found.n_recorded != n:
            short, row = (label, n) if n < found.n_recorded else (rule.column, found.n_recorded)
            raise UnreadableFile(
                f"Channel '{label}' has {n} samples but its time '{rule.column or 'rate'}' has "
                f"{found.n_recorded}: equal up to row {row}.",
                code="unequal-lengths",
                row=row + 1,
                column=short or label,
            )
        return found

    def _rule(self, source: SourceFile, path: str, name: str | None) -> TimeMapping:
        if name is not None:
            for rule in self.named:
                if rule.name == name:
                    return rule
            known = ", ".join(rule.name for rule in self.named) or "none"
            raise refuse("clocks", f"has no clock '{name}'; defined: {known}.")
        if path in source.clocks:
            column = source.clocks[path]
            uneven = None if self.default is None else self.default.uneven
            unit = source.units.get(column, "s")
            return TimeMapping.model_construct(column=column, unit=unit, uneven=uneven)
        if self.default is None or self.default.column not in source.arrays:
            for rule in self.named:
                if rule.column is not None and self.sources.find(rule.column)[0] is source:
                    return rule
        if self.default is None or (self.default.column is None and self.default.rate is None):
            raise refuse("time", f"is missing; {source.name} has no clock for '{path}'.")
        return self.default


def _extract(
    rule: TimeMapping,
    source: SourceFile | None,
    sources: Sources,
    n_samples: int,
    window_s: tuple[float | None, float | None],
) -> Clock:
    if rule.column is None or source is None:
        rate = 0.0 if rule.rate is None else scalar(rule.rate, sources)
        if rate <= 0:
            raise refuse(rule.path("rate"), "must be positive.")
        return Clock(
            start_s=rule.start_s + rule.offset_s,
            rate_hz=_check_rate(rate),
            n_samples=n_samples,
            confirmed=rule.confirmed,
        )
    column = np.atleast_1d(Sources((source,)).numbers(rule.column))
    stamps = units.to_si(column, rule.unit) + rule.offset_s
    if stamps.ndim != 1 or stamps.size < 2:
        problem = f"holds {stamps.size} time stamp; a record has at least two samples."
        raise _refuse(source, rule, problem)
    segment = _select_segment(rule, source, stamps, window_s)
    if segment is None:
        return _fit_clock(rule, source, stamps)
    clock = _fit_clock(rule, source.skip_rows(segment.first), stamps[segment.first : segment.end])
    return replace(clock, segment=segment)


def _select_segment(
    rule: TimeMapping,
    source: SourceFile,
    stamps: np.ndarray,
    window_s: tuple[float | None, float | None],
) -> Segment | None:
    """Return the only segment with start and stop; None if the clock does not jump, or in several.

    Raises
    ------
    UnreadableFile
        If start and stop are in none, naming all of them.
    """
    start_s, stop_s = window_s
    segments = _find_segments(stamps)
    if len(segments) < 2 or (start_s is None and stop_s is None):
        return None
    low = start_s if start_s is not None else stop_s
    high = stop_s if stop_s is not None else start_s
    assert low is not None
    assert high is not None
    inside = [one for one in segments if one.start_s <= high and one.stop_s >= low]
    if inside:
        return inside[0] if len(inside) == 1 else None
    problem = (
        "the clock jumps, and start and stop of the maneuver are in none of the segments: "
        f"{_list_segments(source, segments)}."
    )
    raise _refuse(source, rule, problem, "time-not-uniform", segments[1].first)


def _find_segments(stamps: np.ndarray) -> list[Segment]:
    """Return the segments of at least two rows between steps backwards and long gaps."""
    steps = np.diff(stamps)
    if not (steps > 0).any():
        return []
    jumps = (steps < 0) | ~(steps <= _JUMP * float(np.median(steps[steps > 0])))
    ends = [0, *(np.flatnonzero(jumps) + 1).tolist(), stamps.size]
    return [
        Segment(first, end, stamps.size, float(stamps[first]), float(stamps[end - 1]))
        for first, end in pairwise(ends)
        if end - first > 1
    ]


def _list_segments(source: SourceFile, segments: Sequence[Segment]) -> str:
    shown = [
        f"{one.start_s:.6g} to {one.stop_s:.6g} s (rows {source.first_row + one.first} to "
        f"{source.first_row + one.end - 1})"
        for one in segments[:_SHOWN_SEGMENTS]
    ]
    more = len(segments) - len(shown)
    return ", ".join(shown) + (f" and {more} more" if more else "")


def _fit_clock(rule: TimeMapping, source: SourceFile, stamps: np.ndarray) -> Clock:
    """Return the uniform clock of the stamps of a file, or of a segment of it."""
    assert rule.column is not None
    if units.LARGEST["time"] < abs(float(stamps[0])) < np.inf:
        expected = f"expected at most {units.LARGEST['time']:g} s. Check its unit."
        raise _refuse(source, rule, f"begins at {stamps[0]:.4g} s; {expected}", "bad-rate")
    source.check_finite(stamps, rule.column)
    steps = np.diff(stamps)
    backwards = np.flatnonzero(steps < 0)
    if not backwards.size and stamps[-1] > stamps[0]:
        resolution = find_resolution(stamps)
        try:
            rounded = (
                None if resolution is None else _fit_rounded_clock(rule, source, stamps, resolution)
            )
        except UnreadableFile:
            if rule.uneven is None:
                raise
            rounded = None
        if rounded is not None:
            return rounded
    stopped = backwards if backwards.size else np.flatnonzero(steps == 0)
    if stopped.size:
        first = int(stopped[0])
        stalled = f"{stamps[first + 1]:.6g} s after {stamps[first]:.6g} s"
        problem = f"time does not increase ({stalled})."
        repair = suggest_repair(stamps, first + 1)
        segments = _find_segments(stamps)
        if repair:
            problem += f' If that is right, write repair = ["{repair}"] at the top of the mapping.'
        elif len(segments) > 1:
            problem += _propose_segments(source, segments)
        raise _refuse(source, rule, problem, "time-backwards", first + 1)
    worst = _find_uneven_step(stamps)
    if worst is not None:
        usual = float(np.median(steps))
        if rule.uneven is not None:
            return _extract_uneven(rule, source, stamps, usual)
        segments = _find_segments(stamps)
        raise _refuse_step(source, rule, worst, float(steps[worst - 1]), usual, segments)
    return _clock(rule, source, stamps, steps.size / float(stamps[-1] - stamps[0]))


def is_even(stamps: np.ndarray) -> bool:
    """Return whether increasing times (n,) are those of a uniform clock, in its tolerances."""
    return _find_uneven_step(stamps) is None


def _find_uneven_step(stamps: np.ndarray) -> int | None:
    """Return the sample after the first step that is not uniform, or that has drifted most."""
    steps = np.diff(stamps)
    step = float(stamps[-1] - stamps[0]) / steps.size
    usual = float(np.median(steps))
    drift = np.abs(stamps - (stamps[0] + step * np.arange(stamps.size)))
    uneven = np.abs(steps - usual) > STEP_TOLERANCE * usual
    if uneven.any():
        return int(np.argmax(uneven)) + 1
    return int(np.argmax(drift)) if (drift > DRIFT_TOLERANCE * step).any() else None


def _extract_uneven(
    rule: TimeMapping, source: SourceFile, stamps: np.ndarray, usual: float
) -> Clock:
    """Return the uniform clock to which samples at uneven intervals are interpolated."""
    steps = np.diff(stamps)
    low, high = UNEVEN_STEPS
    bad = np.flatnonzero((steps < low * usual) | (steps > high * usual))
    if bad.size:
        step = float(steps[bad[0]])
        problem = (
            f"the time step is {step:.6g} s, usually {usual:.6g} s; samples are interpolated over "
            f"steps of {low * usual:.3g} to {high * usual:.3g} s. Cut the record there, or give "
            "the rate if only the time stamps are late."
        )
        raise _refuse(source, rule, problem, "time-not-uniform", int(bad[0]) + 1)
    n_steps = max(1, round((stamps[-1] - stamps[0]) / usual))
    clock = _clock(rule, source, stamps, n_steps / float(stamps[-1] - stamps[0]))
    # The last sample is omitted where a whole rate ends after it.
    n = 1 + int(np.floor((stamps[-1] - stamps[0]) * clock.rate_hz * (1.0 + 1e-12)))
    return replace(clock, n_samples=n, stamps=stamps)


def find_resolution(stamps: np.ndarray) -> float | None:
    """Return the resolution of rounded time stamps, if it is coarse against the sample interval.

    Parameters
    ----------
    stamps : (n,) array
        Times that never decrease. [s]

    Returns
    -------
    float or None
        The largest step of which all intervals are multiples [s]; None where it is finer than
        ``STEP_TOLERANCE`` of a sample, or the stamps have no common step.

    Notes
    -----
    A clock of resolution ``r`` stamps sample ``k`` with the multiple of ``r`` next to (or below)
    ``t0 + k dt``. Intervals then take two neighbouring multiples of ``r``, so that their
    difference, or the interval itself beside repeated stamps, is ``r``.
    """
    steps = np.diff(stamps)
    noise = _compute_round_off(stamps)
    ordered = np.unique(steps)
    values = ordered[np.concatenate([[True], np.diff(ordered) > 4.0 * noise])]
    if values.size < 2:
        return None
    gaps = np.diff(values)
    usual = float(stamps[-1] - stamps[0]) / steps.size
    resolution = float(gaps.min())
    if values[0] > noise:
        resolution = min(resolution, float(values[0]))
    multiples = values / resolution
    exact = np.abs(multiples - np.round(multiples)) <= 1e-3 + 8.0 * noise / resolution
    return resolution if exact.all() and resolution > STEP_TOLERANCE * usual else None


def _fit_rounded_clock(
    rule: TimeMapping, source: SourceFile, stamps: np.ndarray, resolution: float
) -> Clock | None:
    """Return the clock behind rounded time stamps; None if no rate explains every stamp.

    Notes
    -----
    Sample ``k`` of a uniform clock is stamped within one interval of length ``resolution``
    about ``t0 + k / rate``: the stamps minus ``k / rate`` span less than ``resolution``. From
    first to last the mean rate is known to ``rate * resolution / duration``. Within that, the
    whole number of Hz (or, where the record is short, the interval in whole ms) is taken if it is
    the only one that explains the stamps.
    """
    n = stamps.size
    steps = np.diff(stamps)
    odd = np.abs(steps - float(np.median(steps))) > 0.5 * resolution
    if np.count_nonzero(odd) <= 2:  # a lost or a doubled sample, no resolution
        return None
    stands = np.flatnonzero(np.diff(stamps) == 0.0)
    if stands.size and _are_repeated(source, stands, n):
        problem = (
            f"this row repeats the row before it, as do {stands.size} rows; every sample must "
            "occur once. Remove repeated rows."
        )
        raise _refuse(source, rule, problem, "rows-repeated", int(stands[0]) + 1)
    duration = float(stamps[-1] - stamps[0])
    index = np.arange(n)
    mean = float(np.polyfit(index, stamps - stamps[0], 1)[0])
    spread = (n - 1) / duration * resolution / duration

    def span(step_s: float) -> float:
        return float(np.ptp(stamps - step_s * index)) / resolution

    low, high = 1.0 / mean - spread, 1.0 / mean + spread
    whole = [float(rate) for rate in range(max(1, int(np.ceil(low))), int(high) + 1)][:100]
    # Half a resolution is rounded up or down, as it happens: the span may just be reached.
    most = 1.0 + 1e-6 + 2.0 * _compute_round_off(stamps) / resolution
    fitting = [rate for rate in whole if span(1.0 / rate) < most]
    if len(fitting) == 1:
        missing = _find_missing(stamps, resolution, fitting[0])
        if missing is not None:
            step = float(stamps[missing] - stamps[missing - 1])
            raise _refuse_step(source, rule, missing, step, 1.0 / fitting[0])
        return _clock(rule, source, stamps, fitting[0], resolution)
    if odd.mean() < _FEW:
        return None
    if not fitting and span(mean) >= most:
        problem = (
            f"is rounded to {resolution:.3g} s, and no uniform rate near {1.0 / mean:.5g} Hz "
            "explains every time stamp. Samples are missing or the clock jumped; resample the "
            "record."
        )
        raise _refuse(source, rule, problem, "time-not-uniform")
    if spread * mean > RATE_TOLERANCE:
        problem = (
            f"is rounded to {resolution:.3g} s, so the sampling rate is between {low:.5g} and "
            f"{high:.5g} Hz. Set it in the mapping instead of the column: rate = "
            f'{{ value = {1.0 / mean:.0f}, unit = "Hz" }} and start = '
            f'{{ value = {stamps[0]:.6g}, unit = "s" }} in [time].'
        )
        raise _refuse(source, rule, problem, "clock-rounded")
    return _clock(rule, source, stamps, 1.0 / mean, resolution)


def _compute_round_off(stamps: np.ndarray) -> float:
    """Return the round-off of differences of these times in double precision. [s]"""
    return 8.0 * float(np.finfo(np.float64).eps) * float(np.abs(stamps).max())


def _find_missing(stamps: np.ndarray, resolution: float, rate: float) -> int | None:
    """Return the index of the first stamp with missing or extra samples; None if there is none.

    Notes
    -----
    Where a whole number of samples shares every stamp, one stamp with another number of them,
    among nearly all with the same, has lost samples or has some too many.
    """
    share = resolution * rate
    _, first, counts = np.unique(stamps, return_index=True, return_counts=True)
    odd = np.flatnonzero(counts[1:-1] != round(share)) + 1
    if abs(share - round(share)) > 1e-6 or not 0 < odd.size <= 0.1 * counts.size:
        return None
    return int(first[odd[0]])


def _are_repeated(source: SourceFile, stands: np.ndarray, n: int) -> bool:
    """Return whether every row with a repeated time stamp repeats the row before it."""
    columns = [values for values in map(np.squeeze, source.arrays.values()) if values.shape == (n,)]
    return len(columns) > 1 and all(
        bool((values[stands] == values[stands + 1]).all()) for values in columns
    )


def _refuse(
    source: SourceFile,
    rule: TimeMapping,
    problem: str,
    code: str | None = None,
    sample: int | None = None,
) -> UnreadableFile:
    """Build the error for the time stamps of a file, or for one of them."""
    if sample is None:
        message = f"{source.name}: column '{rule.column}' {problem}"
        return UnreadableFile(message, code=code, column=rule.column)
    row = source.first_row + sample
    message = f"{source.name}: row {row}, column '{rule.column}': {problem}"
    return UnreadableFile(message, code=code, row=row, column=rule.column)


def _propose_segments(source: SourceFile, segments: Sequence[Segment]) -> str:
    return (
        " Of a record in several segments, start and stop of the maneuver select one: "
        f"{_list_segments(source, segments)}."
    )


def _refuse_step(
    source: SourceFile,
    rule: TimeMapping,
    sample: int,
    step: float,
    usual: float,
    segments: Sequence[Segment] = (),
) -> UnreadableFile:
    problem = (
        f"the time step is not uniform ({step:.6g} s, usually {usual:.6g} s). Samples are missing "
        "or the clock jumped. If every sample has its true time, interpolate the samples by "
        'uneven = "interpolate" in [time].'
    )
    if len(segments) > 1:
        problem += _propose_segments(source, segments)
    return _refuse(source, rule, problem, "time-not-uniform", sample)


def _clock(
    rule: TimeMapping,
    source: SourceFile,
    stamps: np.ndarray,
    rate: float,
    resolution: float | None = None,
) -> Clock:
    try:
        rate = _check_rate(rate)
    except BadInput as error:
        message = f"{source.name}: column '{rule.column}': {error.message}"
        raise UnreadableFile(message, code=error.code, column=rule.column) from error
    # Time stamps are rounded in the file: 199.99999998 Hz is 200 Hz.
    whole = round(rate)
    return Clock(
        start_s=float(stamps[0]),
        rate_hz=float(whole) if whole and abs(rate / whole - 1.0) < 1e-7 else float(rate),
        n_samples=stamps.size,
        rounded_s=resolution,
        confirmed=rule.confirmed,
    )


def _check_rate(rate_hz: float) -> float:
    """Return the rate, or reject a rate outside ``POSSIBLE_RATES_HZ``, as from a wrong unit."""
    low, high = POSSIBLE_RATES_HZ
    if not low <= rate_hz <= high:
        raise BadInput(
            f"{rate_hz:.3g} samples per second were found; expected {low:g} to {high:g} Hz. Check "
            "the unit of time.",
            code="bad-rate",
        )
    return rate_hz
