"""Messages between the server, the process of a stream, and that of its estimates."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from flexsid.records.live import LiveResponses, LiveState, LiveStream, Reception
from flexsid.streams.receiver import Source
from flexsid.workflow.live.live_task import LiveTask
from flexsid.workflow.live.stream_processor import StreamUpdate


@dataclass(frozen=True, slots=True, kw_only=True)
class StreamOrder:
    """What the processes of a stream need.

    ``folder`` has the frames that were received; ``waits`` whether the source waits for the
    processing.
    """

    database: str
    stream: LiveStream
    task: LiveTask
    source: Source
    waits: bool
    folder: Path


@dataclass(frozen=True, slots=True, kw_only=True)
class FrameMessage:
    """Lowest and highest value of every channel in one frame, (2, n_channels).

    ``arrived`` is the time of the monotonic clock of the computer. [s]
    """

    number: int
    time_s: float
    extremes: np.ndarray
    arrived: float


@dataclass(frozen=True, slots=True, kw_only=True)
class ReceptionMessage:
    """What the receiver reports besides frames."""

    reception: Reception


@dataclass(frozen=True, slots=True, kw_only=True)
class UpdateMessage:
    """An update of the stream, for the process of estimates; ``arrived`` as of its last frame."""

    update: StreamUpdate
    arrived: float


@dataclass(frozen=True, slots=True, kw_only=True)
class StateMessage:
    """A state; ``has_estimate`` whether the estimate of its time is complete."""

    state: LiveState
    has_estimate: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class ResponsesMessage:
    """Frequency responses of the newest estimate."""

    responses: LiveResponses


@dataclass(frozen=True, slots=True, kw_only=True)
class SegmentMessage:
    """Frames of a maneuver that has ended, to be stored; its interval by the recorder. [s]"""

    file: Path
    start_s: float
    stop_s: float


@dataclass(frozen=True, slots=True, kw_only=True)
class StoredMessage:
    """A test point was stored, perhaps with a queued run."""

    point_id: int


@dataclass(frozen=True, slots=True, kw_only=True)
class EndMessage:
    """The source of a stream has ended; ``failure`` states why if it could not continue."""

    failure: str = ""


Message = (
    FrameMessage | ReceptionMessage | ResponsesMessage | StateMessage | StoredMessage | EndMessage
)
"""What the process of a stream sends to the server."""
