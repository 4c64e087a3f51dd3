"""Responses of live identification."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from flexsid.records.live import (
    Acknowledgement,
    LiveAlarm,
    LiveSnapshot,
    LiveStream,
    LiveTestPoint,
    RecordedState,
    StreamHeader,
)
from flexsid.records.views import DefaultChannels


@dataclass(frozen=True, slots=True, kw_only=True)
class ReceiverOption:
    """One option of a receiver: its name, JSON type and default; ``is_required`` without one."""

    name: str
    type: str
    description: str
    default: Any
    is_required: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class ReceiverItem:
    """A way to receive samples; ``missing_extra`` is that of flexsid which it needs."""

    name: str
    label: str
    missing_extra: str | None
    options: tuple[ReceiverOption, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class StreamDetail:
    """A stream: its channels, what is known at present, test points and alarms.

    ``header`` is None until the stream has begun; ``packet_bytes`` is the size of one packet of a
    frame. ``outputs`` and ``inputs`` are those of the estimates; empty where the stream does not
    run here. ``default_channels`` are those that strip charts show first. ``alarms`` are those of
    all maneuvers. ``expected_std_errors`` are those of the run whose settings the stream has.
    """

    stream: LiveStream
    header: StreamHeader | None
    packet_bytes: int | None
    outputs: tuple[str, ...]
    inputs: tuple[str, ...]
    default_channels: DefaultChannels | None
    snapshot: LiveSnapshot | None
    test_points: tuple[LiveTestPoint, ...]
    alarms: tuple[LiveAlarm, ...]
    acknowledgements: tuple[Acknowledgement, ...]
    expected_std_errors: dict[str, float | None]


@dataclass(frozen=True, slots=True, kw_only=True)
class StreamHistory:
    """Stored states of a stream in order, of the seconds after ``since_s``.

    ``more`` states that later ones exist beyond the limit.
    """

    states: tuple[RecordedState, ...]
    more: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class ReceivedFrames:
    """Number of frames that were passed on to a stream."""

    frames: int
