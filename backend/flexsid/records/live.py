"""Live identification: streams of samples, and what is known of a maneuver while it is flown."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from flexsid.records.maneuver import Role


@dataclass(frozen=True, slots=True, kw_only=True)
class StreamChannel:
    """One channel of a stream, named as the mapping of imports names it."""

    name: str
    unit: str
    role: Role
    rate_hz: float


@dataclass(frozen=True, slots=True, kw_only=True)
class StreamHeader:
    """Channels of a stream and the length of a frame [s], a whole number of all samples.

    The channels of one rate are a group; groups are in the order of their first channel.
    """

    channels: tuple[StreamChannel, ...]
    frame_s: float

    @property
    def groups(self) -> tuple[tuple[StreamChannel, ...], ...]:
        """Channels by sampling rate."""
        rates = dict.fromkeys(channel.rate_hz for channel in self.channels)
        return tuple(tuple(c for c in self.channels if c.rate_hz == rate) for rate in rates)

    @property
    def frame_shapes(self) -> tuple[tuple[int, int], ...]:
        """Samples and channels of every group in a frame."""
        return tuple((round(self.frame_s * g[0].rate_hz), len(g)) for g in self.groups)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Frame:
    """Samples of all channels over one interval, in native units; NaN where one is missing.

    ``number`` counts frames from the start of the stream, sent or not; ``time_s`` is that of the
    first sample on the clock of the recorder.
    """

    number: int
    time_s: float
    samples: tuple[np.ndarray, ...]


class LivePhase(StrEnum):
    """Phase of a stream."""

    TRIM = "trim"
    EXCITED = "excited"
    ENDED = "ended"


class AlarmKind(StrEnum):
    """Reason for an alarm."""

    UNSTABLE = "unstable"  # a pole of the bare airframe at this test point
    NEXT_POINT = "next point"  # the flutter speed lies below the next test point
    LIMIT = "limit"  # a recorded channel exceeds its limit


@dataclass(frozen=True, slots=True, kw_only=True)
class LiveAlarm:
    """An alarm with its evidence. [s]"""

    kind: AlarmKind
    time_s: float
    subject: str
    evidence: str


@dataclass(frozen=True, slots=True, kw_only=True)
class LiveMode:
    """One pole of the identified airframe. [rad/s, 1]

    ``instability_probability`` is that of negative damping; None without standard errors.
    """

    name: str
    frequency: float
    frequency_std: float | None
    damping: float
    damping_std: float | None
    instability_probability: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class LiveEstimate:
    """Identified airframe from the record so far.

    ``duration_s`` is the length of the record without gaps. The flutter speed is None where none
    is predicted; ``next_point_probability`` is that of a flutter speed below the next test point.
    ``excluded`` are channels without data over the whole record.
    """

    duration_s: float
    converged: bool
    modes: tuple[LiveMode, ...]
    names: tuple[str, ...]
    values: tuple[float, ...]
    std_errors: tuple[float | None, ...]
    flutter_m_s: float | None
    flutter_std_m_s: float | None
    next_point_probability: float | None
    excluded: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class ChannelHealth:
    """Defects of one channel in the present maneuver.

    ``missing_s`` is the time without valid samples, ``is_frozen`` whether its samples do not
    change at present, ``is_excluded`` whether it no longer takes part in the estimate.
    """

    name: str
    missing_s: float
    spikes: int
    is_frozen: bool
    is_excluded: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class LiveState:
    """What is known of a stream at a time of its recorder [s].

    One for every second, and one at once where a channel leaves its limits.

    ``lost_frames`` never arrived, ``late_frames`` arrived after they were taken as lost.
    ``reason`` states why there is no new estimate; ``health`` has channels with defects only.
    """

    time_s: float
    phase: LivePhase
    maneuver_s: float
    lost_frames: int
    late_frames: int
    health: tuple[ChannelHealth, ...]
    estimate: LiveEstimate | None
    reason: str
    alarms: tuple[LiveAlarm, ...]
