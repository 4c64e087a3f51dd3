"""Checks of samples as they arrive: spikes, frozen channels, short gaps.

As ``spikes_and_dropouts`` does for a whole record, with a bounded number of samples before and
after each block.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

LONGEST_REPAIR = 2
"""Missing samples in a row that are interpolated; a longer gap ends a stretch of the record."""

_SPIKE = 9.0  # robust standard deviations of the misfit of a cubic, as in spikes_and_dropouts
_FROZEN_S = 0.25  # equal samples of a noisy sensor last this long only if it is frozen [s]
_REPEATED = 0.25  # of the samples so far equal to the one before: a coarse recorder, not frozen
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
