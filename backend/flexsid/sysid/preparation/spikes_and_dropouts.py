"""Spikes, dropouts and saturation in samples, stored or as they arrive, and their repair.

As ``spikes_and_dropouts`` does for a whole record, with a bounded number of samples before and
after each block.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
import scipy
from jaxtyping import Bool, Float

from flexsid.errors import BadInput

# --- Spikes, dropouts and saturation in the samples of one channel, and their repair --------------

_SPIKE = 9.0  # robust standard deviations
_WIDEST_SPIKE = 3  # samples
_LOCAL = 201  # samples of the running median that scales a channel
_DROPOUT_SAMPLES = 10  # equal samples in a row of a dropout, where such runs are rare
_REPEATED = 0.25  # of the samples: with fewer different values, the recorder rounds coarsely
_ROUNDED = 0.35  # of a digit: standard deviation of rounding, in the misfit of a cubic
# Times as often as neighbouring values: a crest repeats its last digit, too.
_FREQUENT, _VERY_FREQUENT = 3, 10
_FEW_DIGITS = 64  # resolution steps in the range of a coarse recorder
_LONGEST_REPAIR_S = 0.1  # a longer interval is not interpolated [s]
_SUPPORT = 8  # samples on either side that the spline of a repair passes through
_NEAR = 4  # samples on either side whose misfit a spike of its own does not change
_LEVEL = 8  # samples on either side whose medians are the levels before and after
_ABRUPT = 2.0  # times the steps before: least first step of a wide spike
_EDGE = 0.5  # of the size of a spike: least change of level at the edge of a pulse


class SampleDefect(StrEnum):
    """Kind of defect of an interval of samples."""

    SPIKE = "spike"
    DROPOUT = "dropout"
    SATURATION = "saturation"


@dataclass(frozen=True, slots=True, kw_only=True)
class DefectiveInterval:
    """Samples ``first`` up to, not including, ``stop``."""

    kind: SampleDefect
    first: int
    stop: int


def find_defects(
    samples: Float[np.ndarray, " n_samples"],
    moving: slice | None = None,
    *,
    may_be_held: bool = False,
) -> tuple[DefectiveInterval, ...]:
    """Find spikes, dropouts and saturation in the samples of one channel.

    Parameters
    ----------
    samples
        As recorded, in the native unit: a rounding would hide equal samples.
    moving
        Samples during which the measured quantity is known to move, so that a constant value
        is a dropout; None where that is not known.
    may_be_held
        Whether the quantity may be held, as a surface is in a doublet: constant values are then
        neither dropouts nor saturation.

    Notes
    -----
    A spike departs from the cubic through its neighbours, or from the running median,
    by far more than samples around it do. A dropout repeats one value while samples
    elsewhere change. Saturation stays at the largest or smallest value of the record
    more often than at any value next to it. Equal values due to the resolution of the
    recorder are excluded: where values repeat, a dropout ends with a jump of more than
    one digit, and a spike is larger than the rounding of a smooth signal. The overshoot at
    the edge of a pulse is no spike: without it the signal still is not smooth there, and
    its level changes.
    """
    x = np.asarray(samples, dtype=float)
    if x.size < 3 * _DROPOUT_SAMPLES:
        return ()
    if np.ptp(x) == 0.0:
        whole = DefectiveInterval(kind=SampleDefect.DROPOUT, first=0, stop=x.size)
        return () if moving is None else (whole,)
    first, stop = _find_equal_runs(x)
    digit = _find_resolution(x)
    if may_be_held:
        saturated = held = np.zeros(first.size, dtype=bool)
    else:
        saturated = _find_saturated(x, first, stop, digit)
        held = _find_held(x, first, stop, moving) & _find_jumps(x, first, stop, digit) & ~saturated
    taken = np.repeat(held | saturated, stop - first)
    spikes = _find_single_spikes(x, digit) | _find_wide_spikes(x, digit)
    spikes &= ~scipy.ndimage.binary_dilation(taken, iterations=2)
    limit = _SPIKE * _estimate_local_scale(_compute_misfit(x), digit)
    for run in _find_runs(spikes):
        spikes[run] = not _is_at_edge(x, run, limit)
    found = {
        SampleDefect.SATURATION: _list_runs(first[saturated], stop[saturated]),
        SampleDefect.DROPOUT: _list_runs(first[held], stop[held]),
        SampleDefect.SPIKE: _find_runs(spikes),
    }
    intervals = [
        DefectiveInterval(kind=kind, first=own.start, stop=own.stop)
        for kind, some in found.items()
        for own in some
    ]
    return tuple(sorted(intervals, key=lambda interval: interval.first))


def repair_samples(
    samples: Float[np.ndarray, " n_samples"],
    stretches: Sequence[tuple[int, int]],
    rate_hz: float,
) -> Float[np.ndarray, " n_samples"]:
    """Replace samples by a cubic spline through their neighbours.

    Each stretch is its first sample, and the sample after its last.

    Raises
    ------
    BadInput
        If an interval lies outside the record, or is too long to be interpolated.
    """
    x = np.asarray(samples, dtype=float)
    for first, stop in stretches:
        if not 0 <= first < stop <= x.size:
            raise BadInput(
                f"samples {first} to {stop} do not lie in a channel of {x.size}",
                code="bad-stretch",
            )
        if (stop - first) / rate_hz > _LONGEST_REPAIR_S:
            raise BadInput(
                f"samples {first} to {stop} last {(stop - first) / rate_hz:.3g} s; more than "
                f"{_LONGEST_REPAIR_S:g} s cannot be interpolated; exclude the "
                "channel",
                code="too-long-to-repair",
            )
    return bridge_samples(x, stretches)


def bridge_samples(
    samples: Float[np.ndarray, " n_samples"], stretches: Sequence[tuple[int, int]]
) -> Float[np.ndarray, " n_samples"]:
    """Replace stretches of any length by a cubic spline through their neighbours.

    Raises
    ------
    BadInput
        If a stretch has no valid samples around it.
    """
    x, bad = np.asarray(samples, dtype=float), np.zeros(len(samples), dtype=bool)
    for first, stop in stretches:
        bad[first:stop] = True
    result = x.copy()
    for run in _find_runs(bad):
        first, stop = run.start, run.stop
        around = np.r_[max(0, first - _SUPPORT) : first, stop : min(x.size, stop + _SUPPORT)]
        around = around[~bad[around]]
        if around.size < 2:
            raise BadInput(
                "an interval has no valid samples around it to interpolate", code="bad-stretch"
            )
        degree = min(3, around.size - 1)
        curve = scipy.interpolate.make_interp_spline(around, x[around], k=degree)
        result[run] = curve(np.arange(first, stop))
    return result


def _find_resolution(x: Float[np.ndarray, " n"]) -> float:
    """Resolution of a recorder that rounds so coarsely that values repeat; zero for others."""
    levels = np.unique(x)
    if levels.size > _REPEATED * x.size:
        return 0.0
    gaps = np.diff(levels)
    return float(gaps[gaps > 1e-6 * np.ptp(x)].min())


def _find_jumps(
    x: Float[np.ndarray, " n"], first: np.ndarray, stop: np.ndarray, digit: float
) -> np.ndarray:
    """Runs of equal samples that begin or end with a jump of more than the resolution."""
    before = np.where(first > 0, np.abs(x[first] - x[first - 1]), 0.0)
    after = np.where(stop < x.size, np.abs(x[np.minimum(stop, x.size - 1)] - x[first]), 0.0)
    return (np.maximum(before, after) > 1.5 * digit) | (digit == 0.0)


def _compute_misfit(x: Float[np.ndarray, " n"]) -> Float[np.ndarray, " n"]:
    """Departure of every sample from the cubic through two neighbours on either side."""
    away = np.zeros_like(x)
    away[2:-2] = x[2:-2] - (4.0 * (x[1:-3] + x[3:-1]) - x[:-4] - x[4:]) / 6.0
    return away


def _is_at_edge(x: Float[np.ndarray, " n"], run: slice, limit: Float[np.ndarray, " n"]) -> bool:
    """Whether samples overshoot at the edge of a pulse, and do not depart from a smooth signal."""
    first, stop = max(0, run.start - _NEAR), min(x.size, run.stop + _NEAR)
    around = slice(max(0, first - 2), min(x.size, stop + 2))
    at = np.arange(around.start, around.stop)
    sound = (at < run.start) | (at >= run.stop)
    smooth = np.where(sound, x[around], np.interp(at, at[sound], x[around][sound]))
    left = np.abs(_compute_misfit(smooth)) > limit[around]
    left &= (at < run.start - 1) | (at > run.stop)  # next to it, a line is too coarse a repair
    if not left.any():
        return False
    before = np.median(x[max(0, run.start - _LEVEL) : run.start])
    after = np.median(x[run.stop : run.stop + _LEVEL])
    departure = np.max(np.abs(x[around] - smooth))
    return bool(abs(after - before) > _EDGE * departure)


def _find_single_spikes(x: Float[np.ndarray, " n"], digit: float) -> Bool[np.ndarray, " n"]:
    """Samples that are outliers, the largest of each group of neighbours."""
    away = _compute_misfit(x)
    size = np.abs(away)
    largest = size >= scipy.ndimage.maximum_filter1d(size, 5)
    there, back = np.diff(x, prepend=x[0]), np.diff(x, append=x[-1])
    returns = (there * back < 0) & (np.minimum(np.abs(there), np.abs(back)) > 0.4 * size)
    # A spike changes its neighbours' cubics by two thirds; a step, only the one before it.
    sign = np.sign(away)
    returns &= np.maximum(np.roll(away, 1) * sign, np.roll(away, -1) * sign) < -0.45 * size
    return largest & returns & (size > _SPIKE * _estimate_local_scale(away, digit))


def _find_wide_spikes(x: Float[np.ndarray, " n"], digit: float) -> Bool[np.ndarray, " n"]:
    """Outliers of a few samples: far from the running median, with a jump on both sides."""
    away = x - scipy.ndimage.median_filter(x, 2 * _WIDEST_SPIKE + 1, mode="nearest")
    steps = np.abs(np.diff(x, prepend=x[0]))
    usual = _SPIKE * _estimate_local_scale(steps, digit)
    jump = steps > usual
    off = np.abs(away) > 0.5 * usual
    # The smooth crest of an overshoot is reached by steps that become smaller.
    beside = np.fmax(np.roll(steps, 1), np.roll(steps, 2))
    abrupt = steps > _ABRUPT * beside
    found = np.zeros(x.size, dtype=bool)
    for run in _find_runs(off):
        is_narrow = run.stop - run.start <= _WIDEST_SPIKE and run.stop < x.size
        found[run] = is_narrow and abrupt[run.start] and jump[run.start] and jump[run.stop]
    return found


def _estimate_local_scale(values: Float[np.ndarray, " n"], digit: float) -> Float[np.ndarray, " n"]:
    """Robust standard deviation around every sample, nowhere less than of the record."""
    size = np.abs(values)
    step = max(1, values.size // 2000)
    local = scipy.ndimage.median_filter(size[::step], max(3, _LOCAL // step), mode="reflect")
    spread = np.interp(np.arange(values.size), np.arange(0, values.size, step), local)
    least = max(float(np.median(size)), 1e-3 * float(np.std(values)), _ROUNDED * digit)
    return 1.4826 * np.maximum(spread, least)


def _find_equal_runs(x: Float[np.ndarray, " n"]) -> tuple[np.ndarray, np.ndarray]:
    edges = np.flatnonzero(np.diff(x)) + 1
    return np.r_[0, edges], np.r_[edges, x.size]


def _find_saturated(
    x: Float[np.ndarray, " n"], first: np.ndarray, stop: np.ndarray, digit: float
) -> np.ndarray:
    """Runs of equal samples at the end of a sensor's range."""
    values, length = x[first], stop - first
    found = np.zeros(first.size, dtype=bool)
    more = _FREQUENT if digit == 0.0 or np.ptp(x) > _FEW_DIGITS * digit else _VERY_FREQUENT
    for end, order in ((values.max(), -1), (values.min(), 1)):
        at_end = values == end
        levels = np.unique(values)[::order][1:4]
        beside = max((int(length[values == level].sum()) for level in levels), default=0)
        total = int(length[at_end].sum())
        # a record at rest for most of its length rests there, it is not saturated
        if length[at_end].max() >= 3 and 4 <= total < x.size // 2 and total > more * beside:
            found |= at_end & (length >= 2)
    return found


def _find_held(
    x: Float[np.ndarray, " n"], first: np.ndarray, stop: np.ndarray, moving: slice | None
) -> np.ndarray:
    """Runs of equal samples that are far longer than usual in the record.

    Rest at either end of a record is trim, but for what lies in ``moving``.
    """
    begin, end = (0, 0) if moving is None else (moving.start, moving.stop)
    at_ends = np.maximum(np.minimum(stop, end) - np.maximum(first, begin), 0)
    length = np.where((first > 0) & (stop < x.size), stop - first, at_ends)
    usual = float(np.percentile(length, 95))
    long = length >= max(_DROPOUT_SAMPLES, 5.0 * usual)
    if moving is not None:
        return long
    return long if length[long].sum() <= x.size // 2 else np.zeros_like(long)


def _list_runs(first: np.ndarray, stop: np.ndarray) -> list[slice]:
    return [slice(int(a), int(b)) for a, b in zip(first, stop, strict=True)]


def _find_runs(mask: Bool[np.ndarray, " n"]) -> list[slice]:
    return [run for (run,) in scipy.ndimage.find_objects(scipy.ndimage.label(mask)[0])]


# --- Checks of samples as they arrive: spikes, frozen channels, short gaps ------------------------

LONGEST_REPAIR = 2
"""Missing samples in a row that are interpolated; a longer gap ends a stretch of the record."""

_FROZEN_S = 0.25  # equal samples of a noisy sensor last this long only if it is frozen [s]
_CUBIC = 2  # samples on either side of a cubic
_LEARNING_S = 0.5  # before it, spikes are not searched: the misfit of the cubics is not known [s]
_TYPICAL_S = 5.0  # time constant of the typical misfit [s]


@dataclass(frozen=True, slots=True)
class CheckedSamples:
    """A block of samples of one group, NaN where they are missing, and what was found in it.

    ``spikes`` is the number of spikes replaced, by channel; ``frozen`` are the channels with
    frozen samples, which are missing then.
    """

    samples: Float[np.ndarray, "n_samples n_channels"]
    spikes: np.ndarray
    frozen: Bool[np.ndarray, " n_channels"]


class StreamChecks:
    """Checks of the channels of one rate; each block is returned once later samples are known.

    Parameters
    ----------
    rate_hz
        Samples per second. [Hz]
    n_channels
        Number of channels.
    noisy
        Channels whose samples differ unless they are frozen; commands at rest are not.

    Notes
    -----
    The misfit of a cubic through two neighbours on either side has a typical size, which is
    followed with a time constant of five seconds; what exceeds it ninefold, falls back at once
    and stands alone is a spike. It is replaced as a missing sample is.
    """

    def __init__(self, rate_hz: float, n_channels: int, noisy: np.ndarray) -> None:
        self._rate_hz = rate_hz
        self._noisy = noisy
        self._frozen_samples = max(LONGEST_REPAIR + 1, round(_FROZEN_S * rate_hz))
        self.lookahead = self._frozen_samples + _CUBIC
        self._samples = np.full((self.lookahead, n_channels), np.nan)  # those before the block
        self._typical = np.zeros(n_channels)
        self._repeats = np.zeros(n_channels)
        self._seen = 0

    def append(self, samples: Float[np.ndarray, "n_new n_channels"]) -> None:
        """Add samples as they arrive, NaN where they are missing."""
        self._samples = np.concatenate([self._samples, samples])

    @property
    def ready(self) -> int:
        """Number of samples that can be taken."""
        return max(0, len(self._samples) - 2 * self.lookahead)

    def take(self, count: int, *, moving: bool) -> CheckedSamples:
        """Take the next samples, at most ``ready``.

        Parameters
        ----------
        count
            Number of samples.
        moving
            Whether the aircraft moves, so that equal samples are a fault.
        """
        n = self.lookahead
        window = self._samples[: count + 2 * n]
        own = slice(n, n + count)
        equal = np.diff(window, axis=0) == 0.0
        self._seen += count
        frozen = np.zeros(window.shape, dtype=bool)
        for k in np.flatnonzero(self._noisy & equal.any(axis=0)):
            frozen[:, k] = _mark_equal_runs(equal[:, k], self._frozen_samples)
        self._repeats += np.count_nonzero(equal[n - 1 : n - 1 + count] & ~frozen[own], axis=0)
        coarse = self._repeats >= _REPEATED * self._seen
        if not moving or coarse.any():
            frozen &= moving & ~coarse
        away = _compute_cubic_misfit(window)
        spikes = np.zeros(window.shape, dtype=bool)
        if self._seen > _LEARNING_S * self._rate_hz:
            spikes = _mark_spikes(window, away, _SPIKE * self._typical)
        self._learn(away[own])
        cleaned = np.where(frozen | spikes, np.nan, window)
        for k in np.flatnonzero(np.isnan(cleaned[own]).any(axis=0)):
            _fill_short_gaps(cleaned[:, k])
        found = CheckedSamples(
            cleaned[own].copy(),
            np.count_nonzero(spikes[own], axis=0),
            np.asarray(frozen[own].any(axis=0)),
        )
        # Later blocks see the samples before them as they were repaired.
        self._samples[own] = np.where(spikes[own], cleaned[own], self._samples[own])
        self._samples = self._samples[count:]
        return found

    def _learn(self, away: Float[np.ndarray, "n_samples n_channels"]) -> None:
        """Follow the typical size of the misfit; missing samples do not change it."""
        size = np.abs(away)
        known = np.isfinite(size)
        count = np.count_nonzero(known, axis=0)
        mean = np.where(known, size, 0.0).sum(axis=0) / np.maximum(count, 1)
        new = 1.25 * np.minimum(mean, np.where(self._typical > 0.0, 2.0 * self._typical, np.inf))
        share = min(1.0, len(away) / (_TYPICAL_S * self._rate_hz))
        first = self._typical == 0.0
        self._typical = np.where(
            count > 0,
            np.where(first, new, self._typical + share * (new - self._typical)),
            self._typical,
        )


def _compute_cubic_misfit(x: Float[np.ndarray, "n_samples n_channels"]) -> np.ndarray:
    away = np.full_like(x, np.nan)
    away[2:-2] = x[2:-2] - (4.0 * (x[1:-3] + x[3:-1]) - x[:-4] - x[4:]) / 6.0
    return away


def _mark_spikes(
    x: Float[np.ndarray, "n_samples n_channels"],
    away: Float[np.ndarray, "n_samples n_channels"],
    limit: Float[np.ndarray, " n_channels"],
) -> Bool[np.ndarray, "n_samples n_channels"]:
    """Mark samples that depart from their neighbours and fall back at once."""
    found = np.zeros(x.shape, dtype=bool)
    rows, columns = np.nonzero(np.abs(away) > np.where(limit > 0.0, limit, np.inf))
    for i, k in zip(rows.tolist(), columns.tolist(), strict=True):
        size, near = abs(away[i, k]), np.abs(away[max(0, i - 2) : i + 3, k])
        there, back = x[i, k] - x[i - 1, k], x[i + 1, k] - x[i, k]
        returns = there * back < 0.0 and min(abs(there), abs(back)) > 0.4 * size
        sign = np.sign(away[i, k])
        # A spike changes its neighbours' cubics by two thirds; a step, only the one before it.
        beside = max(away[i - 1, k] * sign, away[i + 1, k] * sign)
        found[i, k] = returns and size >= np.nanmax(near) and beside < -0.45 * size
    return found


def _mark_equal_runs(equal: Bool[np.ndarray, " n_steps"], least: int) -> np.ndarray:
    """Mark the samples of runs of at least so many equal samples."""
    found = np.zeros(equal.size + 1, dtype=bool)
    ends = np.flatnonzero(np.diff(np.concatenate([[False], equal, [False]]).astype(int)))
    for first, stop in ends.reshape(-1, 2).tolist():
        if stop - first + 1 >= least:
            found[first : stop + 1] = True
    return found


def _fill_short_gaps(x: Float[np.ndarray, " n_samples"]) -> None:
    """Interpolate gaps of at most ``LONGEST_REPAIR`` samples by a cubic through neighbours."""
    missing = np.isnan(x)
    ends = np.flatnonzero(np.diff(np.concatenate([[False], missing, [False]]).astype(int)))
    for first, stop in ends.reshape(-1, 2).tolist():
        if stop - first > LONGEST_REPAIR or first < _CUBIC or stop + _CUBIC > x.size:
            continue
        around = np.r_[first - _CUBIC : first, stop : stop + _CUBIC]
        if missing[around].any():
            continue
        fit = np.polynomial.polynomial.polyfit(around - first, x[around], 3)
        x[first:stop] = np.polynomial.polynomial.polyval(np.arange(stop - first), fit)
