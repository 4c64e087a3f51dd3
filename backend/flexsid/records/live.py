"""Live identification: streams of samples, and what is known of a maneuver while it is flown."""

from __future__ import annotations

from dataclasses import dataclass, field
from datetime import datetime
from enum import StrEnum
from typing import Any

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
class LiveCondition:
    """Flight condition of an estimate; that of the run of the stream where it is not measured."""

    airspeed_m_s: float
    density_kg_m3: float
    fuel_fraction: float
    is_measured: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class LiveEstimate:
    """Identified airframe from the record so far.

    ``time_s`` is the end of the record on the clock of the recorder, ``duration_s`` its length
    without gaps. The flutter speed is None where none
    is predicted; ``next_point_probability`` is that of a flutter speed below the next test point.
    ``recent_modes`` are the poles from the last seconds of the record only, where a mode is lightly
    damped; ``excluded`` are channels without data over the whole record.
    ``change_by_noise_weights`` is that of the damping of the least damped mode, in standard errors
    without the weights; what exceeds 1 is in the standard errors. None without a noise spectrum.
    ``no_errors_reason`` is why there are no standard errors.
    """

    time_s: float
    duration_s: float
    converged: bool
    modes: tuple[LiveMode, ...]
    recent_modes: tuple[LiveMode, ...] = ()
    names: tuple[str, ...]
    values: tuple[float, ...]
    std_errors: tuple[float | None, ...]
    flutter_m_s: float | None
    flutter_std_m_s: float | None
    next_point_probability: float | None
    excluded: tuple[str, ...]
    condition: LiveCondition | None = None  # states of earlier versions have none
    change_by_noise_weights: float | None = None
    no_errors_reason: str = ""


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


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LiveResponses:
    """Frequency responses of the bare airframe from the record so far, and those of the estimate.

    ``measured`` (n_frequencies, n_outputs, n_inputs) has the relative standard deviation of its
    complex error beside it; ``model`` is on a grid of its own. ``units`` are SI units by channel,
    ``time_s`` is the end of the record by the recorder. [s]
    """

    time_s: float
    outputs: tuple[str, ...]
    inputs: tuple[str, ...]
    units: dict[str, str]
    frequency_hz: np.ndarray
    measured: np.ndarray
    relative_std: np.ndarray
    model_frequency_hz: np.ndarray
    model: np.ndarray


class StreamStatus(StrEnum):
    """Status of a stream; a running one is resumed by the next server."""

    RUNNING = "running"
    STOPPED = "stopped"
    FAILED = "failed"


@dataclass(frozen=True, slots=True, kw_only=True)
class ReceiverSettings:
    """Receiver of a stream, by name, and its options."""

    name: str
    options: dict[str, Any] = field(default_factory=dict[str, Any])


@dataclass(frozen=True, slots=True, kw_only=True)
class Reception:
    """What a receiver reports besides frames, since its process started.

    ``is_connected`` is None for receivers without a connection; ``connection_error`` states why
    there is none. ``interruptions`` of the connection had a total of ``interrupted_s`` [s].
    ``rejected`` messages had no samples of the stream; ``rejection`` states why of the newest.
    ``lost_messages`` are missing by their numbers.
    """

    is_connected: bool | None = None
    connection_error: str = ""
    interruptions: int = 0
    interrupted_s: float = 0.0
    rejected: int = 0
    rejection: str = ""
    lost_messages: int = 0


@dataclass(frozen=True, slots=True, kw_only=True)
class LiveStream:
    """A stream of samples and how it is processed.

    Model, channels and settings are those of a run (``run_id``). Maneuvers are stored in the
    flight ``flight_id``; None if they are not stored. ``limits`` are the lowest and highest value
    of channels in their native unit. ``holder`` is the server that runs the stream, ``message``
    why it failed.
    """

    aircraft_id: int
    run_id: int
    title: str
    receiver: ReceiverSettings
    flight_id: int | None = None
    next_airspeed_m_s: float | None = None
    limits: dict[str, tuple[float, float]] = field(default_factory=dict[str, tuple[float, float]])
    status: StreamStatus = StreamStatus.RUNNING
    message: str = ""
    author: str = ""
    holder: str | None = None
    created_at: datetime | None = None
    stopped_at: datetime | None = None
    id: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class RecordedState:
    """What was known at one time of a stream, for the debrief.

    ``delay_s`` is the time from the arrival of the last sample to the state.
    """

    stream_id: int
    time_s: float
    state: LiveState
    delay_s: float
    id: int | None = None


class LiveTestPointStatus(StrEnum):
    """Status of a test point of a stream."""

    STORED = "stored"
    REFUSED = "refused"  # the maneuver could not be stored
    ACCEPTED = "accepted"
    REPEAT = "repeat"


@dataclass(frozen=True, slots=True, kw_only=True)
class LiveTestPoint:
    """A maneuver of a stream that has ended.

    ``maneuver_id`` is the stored maneuver, ``run_id`` the queued run; ``message`` states why one
    of them is missing.
    """

    stream_id: int
    start_s: float
    stop_s: float
    status: LiveTestPointStatus
    maneuver_id: int | None = None
    run_id: int | None = None
    message: str = ""
    author: str = ""
    created_at: datetime | None = None
    id: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Acknowledgement:
    """An alarm of a stream that somebody acknowledged by name."""

    stream_id: int
    kind: AlarmKind
    subject: str
    time_s: float
    author: str
    note: str = ""
    created_at: datetime | None = None
    id: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class LiveSnapshot:
    """What is known of a running stream at present.

    ``newest_s`` is the end of the newest samples on the clock of the recorder; ``silent_s`` the
    time since they arrived, by the clock of the server. ``delay_s`` is the time from the arrival
    of samples to the server, 95th percentile of the last minute. ``estimate_age_s`` is the
    time of the recorder since the end of the record of the estimate. ``reception`` is None before
    its first report.
    """

    stream_id: int
    state: LiveState | None
    newest_s: float | None
    silent_s: float | None
    delay_s: float | None
    estimate_age_s: float | None
    reception: Reception | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class LiveHistory:
    """Estimates of a stream over time, by the recorder [s]; None where a value is unknown.

    ``damping`` has the damping ratio of every mode, with its standard error.
    """

    time_s: tuple[float, ...]
    airspeed_m_s: tuple[float | None, ...]
    flutter_m_s: tuple[float | None, ...]
    flutter_std_m_s: tuple[float | None, ...]
    damping: dict[str, tuple[float | None, ...]]
    damping_std: dict[str, tuple[float | None, ...]]


@dataclass(frozen=True, slots=True, kw_only=True)
class StripChart:
    """Lowest and highest value of channels in each column of a strip chart, in native units.

    Columns are ``column_s`` long and begin at ``time_s``; values are None without samples.
    ``low`` and ``high`` have one row for each channel.
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    column_s: float
    time_s: tuple[float, ...]
    low: tuple[tuple[float | None, ...], ...]
    high: tuple[tuple[float | None, ...], ...]
