"""Maneuvers in the recording of a whole flight: intervals and periods of the excitation.

A recorded excitation is constant between maneuvers; a marker has a number during one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from operator import itemgetter

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy import fft, ndimage

from flexsid.errors import BadInput
from flexsid.sysid.excitation.checks import recognise_multisine

_ACTIVE = 1e-3  # of the largest command, for a digital command that rests at one level exactly
_AT_REST = 0.05  # of the samples at one value: the level at which a digital command rests
_LEAST_MOVE = 0.05  # of the largest command: a smaller one of a noisy command is rest
_NOISY = 8.0  # robust standard deviations, for a command with noise
_PAUSE_S = 1.0  # a shorter rest is part of the excitation
_SHORTEST_S = 1.0  # a shorter interval is not a maneuver
_SAME = 0.02  # of its size: how little a period may differ from the one before
_SHORTEST_PERIOD_S = 2.0  # a shorter lag is not a period
_SLACK = 2  # samples by which a detected onset may be late


@dataclass(frozen=True, slots=True, kw_only=True)
class ExcitedInterval:
    """Samples ``first`` up to ``stop`` in which an excitation ran.

    ``period`` is in samples, not whole where the excitation came from another clock;
    ``harmonics`` are those of each input, empty where no multisine was recognised.
    ``marker`` is the value of the marker.
    """

    first: int
    stop: int
    period: float
    n_periods: int
    harmonics: tuple[tuple[int, ...], ...] = ()
    marker: int | None = None


def find_excitations(
    commands: Float[np.ndarray, "n_samples n_inputs"], rate_hz: float
) -> tuple[ExcitedInterval, ...]:
    """Find every interval in which a command moves, with its periods and harmonics.

    The commands are those before they were added to anything else. [rad]
    """
    moving = np.zeros(commands.shape[0], dtype=bool)
    for command in commands.T:
        moving |= _find_moving(command)
    for (rest,) in ndimage.find_objects(ndimage.label(~moving)[0]):
        is_inside = rest.start > 0 and rest.stop < moving.size
        if is_inside and rest.stop - rest.start < round(_PAUSE_S * rate_hz):
            moving[rest] = True
    return tuple(
        _describe_interval(commands, own.start, own.stop, rate_hz)
        for (own,) in ndimage.find_objects(ndimage.label(moving)[0])
        if own.stop - own.start >= _SHORTEST_S * rate_hz
    )


def find_marked_intervals(
    marker: Float[np.ndarray, " n_samples"], rate_hz: float
) -> tuple[ExcitedInterval, ...]:
    """Find every interval in which a marker has one number other than zero.

    It is that of the flight test aid during its maneuver, and zero or negative between.
    """
    number = np.where(np.isfinite(marker), np.rint(marker), 0).astype(np.int64)
    number = np.maximum(number, 0)
    edges = np.flatnonzero(np.diff(number)) + 1
    first, stop = np.r_[0, edges], np.r_[edges, number.size]
    return tuple(
        ExcitedInterval(
            first=int(a), stop=int(b), period=float(b - a), n_periods=1, marker=int(number[a])
        )
        for a, b in zip(first, stop, strict=True)
        if number[a] > 0 and b - a >= _SHORTEST_S * rate_hz
    )


def _find_moving(command: Float[np.ndarray, " n_samples"]) -> Bool[np.ndarray, " n_samples"]:
    """Samples away from the level at which a command rests."""
    values, counts = np.unique(command, return_counts=True)
    rest = float(values[np.argmax(counts)])
    away = np.abs(command - rest)
    most = float(away.max())
    if most == 0.0 or not np.isfinite(most):
        return np.zeros(command.size, dtype=bool)
    if counts.max() > _AT_REST * command.size:
        return away > _ACTIVE * most
    # A command that never rests exactly has noise, estimated from the quieter samples.
    away = np.abs(command - np.median(command))
    noise = 1.4826 * float(np.percentile(away, 25)) / 0.4726  # quartile of a half normal
    return away > max(_NOISY * noise, _LEAST_MOVE * most)


def _describe_interval(
    commands: Float[np.ndarray, "n_samples n_inputs"], first: int, stop: int, rate_hz: float
) -> ExcitedInterval:
    """Count the periods of an excitation and recognise its sines.

    A multisine begins at zero, so that its first sample may not be seen to move.
    """
    x = commands[first:stop]
    busy = np.flatnonzero(np.ptp(x, axis=0) > 0)
    lag = _find_period(x[:, busy], round(_SHORTEST_PERIOD_S * rate_hz))
    n_periods = 1 if lag is None else max(1, round((stop - first) / lag))
    length = (stop - first) / n_periods if lag is None else float(lag)
    recognised = []
    for start in range(max(0, first - _SLACK), first + 1):
        for period in range(round(length) - _SLACK, round(length) + _SLACK + 1):
            samples = commands[start : start + period]
            if samples.shape[0] == period >= 8 and (found := _find_harmonics(samples, busy)):
                recognised.append((_compute_unexplained(samples, found), start, period, found))
    if not recognised:
        return ExcitedInterval(first=first, stop=stop, period=length, n_periods=n_periods)
    _, start, period, harmonics = min(recognised, key=itemgetter(0))
    return ExcitedInterval(
        first=start,
        stop=start + n_periods * period,
        period=float(period),
        n_periods=n_periods,
        harmonics=harmonics,
    )


def _find_period(x: Float[np.ndarray, "n_samples n_inputs"], least: int) -> int | None:
    """Smallest lag after which the excitation repeats; None if it does not repeat."""
    n = x.shape[0]
    if n < 2 * least:
        return None
    power = np.sum(x**2)
    size = fft.next_fast_len(2 * n - 1, real=True)
    spectrum = fft.rfft(x, size, axis=0)
    together = fft.irfft(np.sum(np.abs(spectrum) ** 2, axis=1), size)[:n]
    energy = np.concatenate([[0.0], np.cumsum(np.sum(x**2, axis=1))])
    lags = np.arange(n)
    early, late = energy[n - lags], energy[n] - energy[lags]
    likeness = 2.0 * together / np.maximum(early + late, 1e-12 * power)
    inside = slice(least, n // 2 + 2)
    peaks = np.flatnonzero(likeness[inside] > 1.0 - 0.5 * _SAME) + least
    if peaks.size == 0:
        return None
    group = peaks[peaks < peaks[0] + 0.01 * n + 3]
    return int(group[np.argmax(likeness[group])])


def _find_harmonics(
    period: Float[np.ndarray, "n_samples n_inputs"], busy: Int[np.ndarray, " n_busy"]
) -> tuple[tuple[int, ...], ...] | None:
    """Harmonics of every input; None unless each is a multisine and none shares a harmonic."""
    found: list[tuple[int, ...]] = [() for _ in range(period.shape[1])]
    assigned: set[int] = set()
    for column in busy.tolist():
        try:
            tones, length = recognise_multisine(np.ascontiguousarray(period[:, column]))
        except BadInput:
            return None
        harmonics = tuple(int(k) for k in tones.harmonics)
        if length != period.shape[0] or assigned & set(harmonics) or 0 in harmonics:
            return None
        assigned |= set(harmonics)
        found[column] = harmonics
    return tuple(found)


def _compute_unexplained(
    period: Float[np.ndarray, "n_samples n_inputs"], harmonics: Sequence[tuple[int, ...]]
) -> float:
    """Share of the power outside the harmonics: least where the period begins."""
    power = np.abs(np.fft.rfft(period, axis=0)) ** 2
    power[0] = 0.0
    on = sum(float(power[list(own), k].sum()) for k, own in enumerate(harmonics))
    return 1.0 - on / float(power.sum())
