"""Receiver: a way to receive the frames of a stream, and messages between its processes."""

from __future__ import annotations

import queue
import socket
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Protocol

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from flexsid.errors import BadInput
from flexsid.records.live import (
    Frame,
    LiveResponses,
    LiveState,
    LiveStream,
    Reception,
    StreamHeader,
)
from flexsid.storage.store import Store
from flexsid.workflow.live.frame_assembler import compute_packet_size, decode_frames
from flexsid.workflow.live.live_fit import LiveTask
from flexsid.workflow.live.stream_processor import StreamUpdate

# --- Receiver: a way to receive the frames of a stream, and what its source reports besides them

REPORT_S = 0.25
"""Time between two reports of a source; a source waits no longer for data. [s]"""

_MESSAGES_WAITING = 400  # 20 s of frames, as between receiver and processing


class Options(BaseModel):
    """Options of a receiver; unknown ones are refused."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)


class Source(Protocol):
    """Frames as they arrive, in the process of a stream; it is pickled to get there."""

    def receive(self, after: int | None) -> Iterator[Frame | Reception]:
        """Yield frames until the source ends; those up to number ``after`` are stored already.

        A ``Reception`` between them reports connection and rejected messages on the page.
        """
        ...


@dataclass(frozen=True, slots=True, kw_only=True)
class Receiver:
    """A way to receive frames.

    Parameters
    ----------
    name
        Name in the request and in the table of streams.
    label
        Label on the page.
    options
        Type of its options, from which requests are checked and described.
    open
        Makes the source of a stream with these options and channels.
    waits
        Whether the source waits for the processing, so that nothing is ever skipped.
    needs, extra
        Python package that must be installed, and the extra of flexsid that has it.
    """

    name: str
    label: str
    options: type[Options]
    open: Callable[[Store, Any, StreamHeader], Source]
    waits: bool = False
    needs: str = ""
    extra: str = ""


class ReceptionMonitor:
    """Connection and rejected messages of a source; thread-safe.

    Parameters
    ----------
    connects
        Whether the source needs a connection, which is not there yet.
    """

    def __init__(self, *, connects: bool = False) -> None:
        self._lock = threading.Lock()
        self._is_connected = False if connects else None
        self._connection_error = self._rejection = ""
        self._interruptions = self._rejected = self._lost = 0
        self._interrupted_s = 0.0
        self._since: float | None = None  # interrupted
        self._reported = Reception()
        self._next_s = 0.0

    def connect(self) -> None:
        """Note a connection."""
        with self._lock:
            if self._since is not None:
                self._interrupted_s += time.monotonic() - self._since
            self._is_connected, self._connection_error, self._since = True, "", None

    def disconnect(self, reason: str) -> None:
        """Note that the connection was lost, or that none is possible."""
        with self._lock:
            if self._is_connected:
                self._interruptions += 1
                self._since = time.monotonic()
            self._is_connected, self._connection_error = False, reason

    def reject(self, reason: str) -> None:
        """Count a message that has no samples of the stream."""
        with self._lock:
            self._rejected += 1
            self._rejection = reason

    def lose(self, count: int) -> None:
        """Count messages that are missing by their numbers."""
        with self._lock:
            self._lost += count

    def report(self) -> Iterator[Reception]:
        """Yield what has changed, at most once in ``REPORT_S``."""
        now = time.monotonic()
        if now < self._next_s:
            return
        with self._lock:
            since = now if self._since is None else self._since
            reception = Reception(
                is_connected=self._is_connected,
                connection_error=self._connection_error,
                interruptions=self._interruptions,
                interrupted_s=round(self._interrupted_s + now - since, 1),
                rejected=self._rejected,
                rejection=self._rejection,
                lost_messages=self._lost,
            )
        if reception != self._reported:
            self._reported, self._next_s = reception, now + REPORT_S
            yield reception


class MessageQueue:
    """Packets that the thread of a network client receives, in order."""

    def __init__(self) -> None:
        self.monitor = ReceptionMonitor(connects=True)
        self._messages: queue.Queue[bytes] = queue.Queue(_MESSAGES_WAITING)

    def put(self, message: bytes) -> None:
        """Add a message; one that finds no space is lost, and counted."""
        try:
            self._messages.put_nowait(message)
        except queue.Full:
            self.monitor.reject("the computer is too slow: a message was skipped")

    def receive_frames(self, header: StreamHeader) -> Iterator[Frame | Reception]:
        """Yield the frames of all messages; never ends."""
        while True:
            try:
                yield from decode_frames(self._messages.get(timeout=REPORT_S), header)
            except queue.Empty:
                pass
            except BadInput as error:
                self.monitor.reject(error.message)
            yield from self.monitor.report()


# --- Messages between the server, the process of a stream, and that of its estimates --------------


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


# --- Packets of frames by UDP and TCP -------------------------------------------------------------

_LARGEST_DATAGRAM = 65_507  # bytes of UDP over IPv4
_BUFFERED_BYTES = 4 * 1024**2  # in the system, while a process starts again

_Port = Annotated[int, Field(ge=1024, le=65535, description="Port that packets are sent to.")]
_Address = Annotated[
    str,
    Field(
        pattern=r"^[0-9a-fA-F:.]{2,45}$",
        description="Address of this computer at which packets arrive; 0.0.0.0 for all.",
    ),
]


class PortOptions(Options):
    """Address and port of packets."""

    port: _Port
    address: _Address = "127.0.0.1"


@dataclass(frozen=True, slots=True)
class UdpPackets:
    """Frames in datagrams of one or several whole packets; others are rejected."""

    header: StreamHeader
    options: PortOptions

    def receive(self, after: int | None) -> Iterator[Frame | Reception]:
        """Yield frames as they arrive."""
        monitor = ReceptionMonitor()
        for data in receive_datagrams(self.options):
            if data:
                try:
                    yield from decode_frames(data, self.header)
                except BadInput as error:
                    monitor.reject(error.message)
            yield from monitor.report()


@dataclass(frozen=True, slots=True)
class TcpPackets:
    """Frames in packets, one after the other, over one connection at a time."""

    header: StreamHeader
    options: PortOptions

    def receive(self, after: int | None) -> Iterator[Frame | Reception]:
        """Yield frames as they arrive; a connection with other bytes is closed."""
        size = compute_packet_size(self.header)
        monitor = ReceptionMonitor(connects=True)
        with bind_port(self.options, socket.SOCK_STREAM) as receiver:
            receiver.listen(1)
            while True:
                yield from monitor.report()
                try:
                    connection, _ = receiver.accept()
                except TimeoutError:
                    continue
                connection.settimeout(None)
                monitor.connect()
                yield from monitor.report()
                with connection, connection.makefile("rb") as stream:
                    while len(packet := stream.read(size)) == size:
                        try:
                            yield from decode_frames(packet, self.header)
                        except BadInput as error:
                            monitor.reject(error.message)
                            break
                monitor.disconnect("the sender closed the connection, or sent other bytes")


def receive_datagrams(options: PortOptions) -> Iterator[bytes]:
    """Yield datagrams for ever, and empty ones while none arrives."""
    with bind_port(options, socket.SOCK_DGRAM) as receiver:
        while True:
            try:
                yield receiver.recv(_LARGEST_DATAGRAM)
            except TimeoutError:
                yield b""


def bind_port(options: PortOptions, kind: socket.SocketKind) -> socket.socket:
    """Open a port; its calls end after ``REPORT_S``."""
    family = socket.AF_INET6 if ":" in options.address else socket.AF_INET
    receiver = socket.socket(family, kind)
    receiver.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    receiver.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, _BUFFERED_BYTES)
    receiver.bind((options.address, options.port))
    receiver.settimeout(REPORT_S)
    return receiver
