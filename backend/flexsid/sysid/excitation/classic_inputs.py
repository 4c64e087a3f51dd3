"""Classic inputs for comparison: doublet, 3-2-1-1 and sweep, one surface after the other."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from jaxtyping import Float

from flexsid.sysid.signals import TimeHistory

KINDS = ("doublet", "3-2-1-1", "sweep")
_LENGTHS = 6  # units of time to choose from
_PULSES = {"doublet": (1, -1), "3-2-1-1": (1, 1, 1, -1, -1, 1, -1)}


def design_classic_input(
    kind: str,
    peaks: Mapping[str, float],
    duration_s: float,
    rate_hz: float,
    record_s: float,
    band_hz: tuple[float, float],
    pulse_s: float | None = None,
) -> TimeHistory:
    """Move one surface after the other, each for its share of the duration.

    Parameters
    ----------
    kind
        ``doublet``, ``3-2-1-1`` or ``sweep``.
    peaks
        Largest command of each input, in the order of their turns. [rad]
    duration_s
        Of all turns together. [s]
    rate_hz
        Of the samples. [Hz]
    record_s
        Of the history; zero after the last turn. [s]
    band_hz
        Of a sweep. [Hz]
    pulse_s
        Unit of time of pulses; must fit the turn. [s]
    """
    turn = int(duration_s / len(peaks) * rate_hz)
    values = np.zeros((round(record_s * rate_hz), len(peaks)))
    for column, peak in enumerate(peaks.values()):
        if kind == "sweep":
            samples = _sweep(turn, rate_hz, band_hz)
        else:
            samples = _pulses(_PULSES[kind], turn, round((pulse_s or 0.0) * rate_hz))
        values[column * turn : (column + 1) * turn, column] = peak * samples
    return TimeHistory(0.0, rate_hz, values, tuple(peaks))


def pulse_lengths(
    kind: str, duration_s: float, n_inputs: int, rate_hz: float
) -> Float[np.ndarray, " n_lengths"]:
    """Units of time to choose from, from two samples to half a turn for all pulses. [s]"""
    longest = 0.5 * duration_s / n_inputs / len(_PULSES[kind])
    shortest = min(2.0 / rate_hz, longest)
    return np.geomspace(shortest, longest, _LENGTHS)


def _sweep(
    n_samples: int, rate_hz: float, band_hz: tuple[float, float]
) -> Float[np.ndarray, " n_samples"]:
    """Sine of unit size whose frequency rises linearly over the whole turn."""
    time = np.arange(n_samples) / rate_hz
    slope = (band_hz[1] - band_hz[0]) * rate_hz / n_samples
    return np.sin(2.0 * np.pi * (band_hz[0] + 0.5 * slope * time) * time)


def _pulses(signs: tuple[int, ...], n_samples: int, unit: int) -> Float[np.ndarray, " n_samples"]:
    pulse = np.repeat(np.array(signs, dtype=float), max(1, unit))
    samples = np.zeros(n_samples)
    samples[: min(n_samples, pulse.size)] = pulse[:n_samples]
    return samples
