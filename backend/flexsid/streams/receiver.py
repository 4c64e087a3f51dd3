"""Receiver: a way to receive the frames of a stream, and what its source reports besides them."""

from __future__ import annotations

import queue
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, Protocol

from pydantic import BaseModel, ConfigDict

from flexsid.errors import BadInput
from flexsid.records.live import Frame, Reception, StreamHeader
from flexsid.storage.store import Store
from flexsid.workflow.live.packets import decode_frames

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
