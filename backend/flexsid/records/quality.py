"""Data quality of one maneuver, by channel, with warnings and a verdict."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime
from enum import StrEnum

import numpy as np


class QualityVerdict(StrEnum):
    """Whether a maneuver may be estimated from; ``unchecked`` where this cannot be concluded."""

    GOOD = "good"
    QUESTIONABLE = "questionable"
    BAD = "bad"
    UNCHECKED = "unchecked"


@dataclass(frozen=True, slots=True, kw_only=True)
class QualityWarning:
    """One thing that an analyst should know; ``good`` is only information."""

    severity: QualityVerdict
    about: str
    channel: str | None
    text: str


@dataclass(frozen=True, slots=True, kw_only=True)
class FoundStretch:
    """Samples that are a spike, a dropout or saturated, and when they begin. [s]"""

    kind: str
    first: int
    stop: int
    start_s: float


@dataclass(frozen=True, slots=True, kw_only=True)
class ChannelQuality:
    """Quality of one channel; None where undetermined.

    ``signal_to_noise_db`` is the median over the harmonics, ``coherence`` that with the motion
    reconstructed from all other sensors, ``noise_excess`` the rms difference to it over its noise
    and one per cent of its level. ``not_checked`` is the reason why an output could not be checked
    against the others: nothing is concluded of its delay, scale factor and sign.
    ``delay_s`` counts from the reference, ``scale`` is recorded over true, ``bias`` in SI.
    At most fifty ``stretches`` are listed; ``n_stretches`` counts all.
    """

    name: str
    role: str
    unit: str
    signal_to_noise_db: float | None = None
    coherence: float | None = None
    noise_excess: float | None = None
    delay_s: float | None = None
    delay_std: float | None = None
    scale: float | None = None
    scale_std: float | None = None
    bias: float | None = None
    bias_std: float | None = None
    bias_basis: str = ""
    saturated: float = 0.0  # share of samples
    n_stretches: int = 0
    stretches: tuple[FoundStretch, ...] = ()
    not_checked: str | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Average:
    """A condition channel over the maneuver; ``drift`` is its trend from start to end."""

    name: str
    unit: str
    mean: float
    std: float
    smallest: float
    largest: float
    drift: float


@dataclass(frozen=True, slots=True, kw_only=True)
class FlightConditionQuality:
    """The flight condition with its spread, and whether one linear model holds over it.

    ``separation_factor`` is the lowest structural over the highest rigid-body frequency of
    the predicted model: from five on, rigid and elastic motion may be taken apart.
    """

    averages: tuple[Average, ...]
    airspeed_ratio: float | None
    fuel_fraction: float
    fuel_change: float | None
    airspeed_drift: float | None  # share of the mean
    separation_factor: float | None
    time_invariant: bool | None


@dataclass(frozen=True, slots=True, kw_only=True)
class InputPair:
    """Correlation of two inputs while the excitation ran."""

    first: str
    second: str
    correlation: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Figures:
    """The numbers that a campaign is sorted by."""

    signal_to_noise_db: float | None = None
    largest_skew_s: float | None = None
    largest_skew_channel: str | None = None
    least_coherence: float | None = None
    n_stretches: int = 0
    saturated: float = 0.0
    max_input_correlation: float | None = None
    fuel_change: float | None = None
    airspeed_drift: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class QualityReport:
    """Quality report of a maneuver; ``not_checked`` lists omitted checks with reasons."""

    channels: tuple[ChannelQuality, ...]
    condition: FlightConditionQuality
    inputs: tuple[InputPair, ...]
    warnings: tuple[QualityWarning, ...]
    skew_reference: str | None
    skew_band_hz: tuple[float, float] | None
    not_checked: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class ManeuverQuality:
    """Quality of a maneuver; ``content_hash`` is the hash of its inputs."""

    maneuver_id: int
    content_hash: str
    verdict: QualityVerdict
    summary: str
    figures: Figures
    report: QualityReport
    created_at: datetime | None = None
    id: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SignalToNoise:
    """Signal-to-noise ratio of every channel at every harmonic, ``decibel`` (n_lines, n_channels).

    NaN above the Nyquist frequency of a channel.
    """

    maneuver_id: int
    names: tuple[str, ...]
    frequency_hz: np.ndarray
    assigned_inputs: tuple[str, ...]
    decibel: np.ndarray
