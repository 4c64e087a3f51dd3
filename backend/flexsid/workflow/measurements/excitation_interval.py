"""Excitation interval of a record."""

from __future__ import annotations

from flexsid.records.maneuver import Excitation


def get_excitation_interval(excitation: Excitation) -> tuple[float, float]:
    """Return start and stop of the excitation on the clock of the recorder. [s]"""
    length = excitation.n_periods * excitation.period_s
    return excitation.start_s, excitation.start_s + length


def slice_samples(
    interval_s: tuple[float, float], start_s: float, rate_hz: float, n_samples: int
) -> slice:
    """Return the samples of a channel from the first time up to, not including, the second."""
    first, last = (
        round(min(max((time_s - start_s) * rate_hz, 0), n_samples)) for time_s in interval_s
    )
    return slice(first, last)
