"""The part of a record in which the multisines run."""

from __future__ import annotations

from flexsid.records.maneuver import Excitation


def excitation_interval(excitation: Excitation) -> tuple[float, float]:
    """Start and stop of the excitation on the clock of the recorder. [s]"""
    length = excitation.n_periods * excitation.period_s
    return excitation.start_s, excitation.start_s + length


def samples_between(
    interval_s: tuple[float, float], start_s: float, rate_hz: float, n_samples: int
) -> slice:
    """Samples of a channel from the first time up to, not including, the second."""
    first, last = (
        round(min(max((time_s - start_s) * rate_hz, 0), n_samples)) for time_s in interval_s
    )
    return slice(first, last)
