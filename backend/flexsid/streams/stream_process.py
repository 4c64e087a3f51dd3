"""Process of a stream: receives frames, writes them to disk, and processes samples.

Estimates are computed in a second process, which this one starts; a slow estimate does not delay
samples. Where estimates are late, a source that waits is slowed; with others the estimate of a
second is skipped, and the state names it.
"""

from __future__ import annotations

import logging
import os
import queue
import signal
import sys
import threading
import time
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace
from multiprocessing.connection import Connection, wait
from pathlib import Path
from types import FrameType

import numpy as np

from flexsid.errors import BadInput
from flexsid.jobs.child import Program
from flexsid.jobs.fork_server import start_fork_server
from flexsid.jobs.messages import configure_interpreter
from flexsid.records.live import Frame, LivePhase, LiveState, Reception
from flexsid.streams.frame_log import LONGEST_TRIM_S, FrameLog
from flexsid.streams.receiver import (
    EndMessage,
    FrameMessage,
    Message,
    ReceptionMessage,
    SegmentMessage,
    StateMessage,
    StreamOrder,
    UpdateMessage,
)
from flexsid.workflow.importing.maneuver_cutting import DECAY_S
from flexsid.workflow.live.frame_assembler import decode_frames
from flexsid.workflow.live.live_estimator import combine_states
from flexsid.workflow.live.stream_processor import StreamProcessor, StreamUpdate

_log = logging.getLogger(__name__)

_MOST_WAITING = 4  # estimates, after which the computer is too slow for one per second
_FRAMES_WAITING = 400  # frames (20 s) between receiver and processing
_FRAMES_AHEAD = 4  # of a source that waits
_AFTER_DECAY_S = 1.0  # of the record after the response has decayed: channels are delayed [s]
_RESTART_S = 0.5
_SKIPPED = "no estimate for this second: the computer is too slow"

_Arrival = tuple[Frame, float]


class _Estimates:
    """The process of estimates: sends updates to it, and restarts it if it ends."""

    def __init__(self, order: StreamOrder, stream: _Stream) -> None:
        self._order = order
        self._stream = stream
        self._requests: queue.SimpleQueue[UpdateMessage | SegmentMessage | None] = (
            queue.SimpleQueue()
        )
        self._waiting = 0
        self._is_changed = threading.Condition()
        self._program: Program | None = None
        self._is_ended = False
        self._threads = [
            threading.Thread(target=target, daemon=True) for target in (self._send, self._receive)
        ]
        for thread in self._threads:
            thread.start()

    def submit(self, update: StreamUpdate, arrived: float) -> None:
        """Request the estimate of an update, or skip it where too many wait."""
        if update.request is not None:
            with self._is_changed:
                if self._order.waits:
                    self._is_changed.wait_for(lambda: self._waiting < _MOST_WAITING)
                if self._waiting >= _MOST_WAITING:
                    state = replace(update.state, reason=_SKIPPED)
                    update = replace(update, request=None, state=state)
                else:
                    self._waiting += 1
        self._requests.put(UpdateMessage(update=update, arrived=arrived))

    def store(self, segment: SegmentMessage) -> None:
        """Request that a maneuver is stored."""
        self._requests.put(segment)

    def finish(self) -> None:
        """Return when all requests are completed."""
        self._requests.put(None)
        for thread in self._threads:
            thread.join()

    def _send(self) -> None:
        """Send requests; only this thread blocks while an estimate is computed."""
        while True:
            request = self._requests.get()
            while True:
                with self._is_changed:
                    self._is_changed.wait_for(lambda: self._program is not None)
                    program = self._program
                assert program is not None
                try:
                    program.connection.send(request)
                except OSError:
                    time.sleep(_RESTART_S)  # it ended; the next process gets the request
                    continue
                break
            if request is None:
                return

    def _receive(self) -> None:
        while True:
            program = Program("flexsid.streams.estimate_process")
            with suppress(OSError):
                program.connection.send(self._order)
            with self._is_changed:
                self._program, self._waiting = program, 0
                self._is_changed.notify_all()
            with suppress(EOFError, OSError):
                while True:
                    message = program.connection.recv()
                    if isinstance(message, EndMessage):
                        program.kill()
                        return
                    if isinstance(message, StateMessage):
                        self._stream.publish_estimate(message)
                        if message.has_estimate:
                            with self._is_changed:
                                self._waiting = max(0, self._waiting - 1)
                                self._is_changed.notify_all()
                    else:
                        self._stream.publish(message)
            with self._is_changed:
                self._program = None
                # Who waits for the estimates of this process must not wait for ever.
                self._waiting = 0
                self._is_changed.notify_all()
            _log.warning("the estimates ended (%s); restarting", program.describe_exit())
            program.kill()
            program.close()
            time.sleep(_RESTART_S)


class _Stream:
    """State of the process: newest samples and newest estimate."""

    def __init__(self, order: StreamOrder, connection: Connection) -> None:
        self._order = order
        self._connection = connection
        self._publishing = threading.Lock()
        self._newest: LiveState | None = None
        self._estimated: LiveState | None = None
        self._processor = StreamProcessor(order.task)
        self._log = FrameLog(order.folder, order.task.header)
        self._ended: tuple[float, float] | None = None
        self._last: int | None = None
        self._estimates = _Estimates(order, self)
        for file, interval_s in self._log.list_sealed():
            self._store(file, interval_s)

    def resume(self) -> int | None:
        """Process the frames that a killed process left; return the number of the last one."""
        for frame in self._log.resume():
            self._process(frame, time.monotonic())
        return self._last

    def push(self, frame: Frame, arrived: float) -> None:
        """Take a frame: write it to disk, process it, and publish what is new."""
        is_apart = self._processor.is_apart(frame)
        try:
            updates = self._processor.push(frame)
        except BadInput as error:
            _log.warning("%s", error.message)
            return
        if is_apart:
            # All updates are of the frames before, which end a segment.
            for update in updates:
                self._take(update, arrived)
            updates = []
            self._seal()
            self._log.drop(overlaps=False)
        self._log.append(frame)
        self._complete(frame, updates, arrived)

    def finish(self, failure: str = "") -> None:
        """Complete all estimates and store the maneuver, then report the end."""
        for update in self._processor.finish():
            self._take(update, time.monotonic())
        self._seal()
        self._log.close()
        self._estimates.finish()
        self.publish(EndMessage(failure=failure))

    def publish(self, message: Message) -> None:
        """Send a message to the server."""
        with self._publishing, suppress(OSError):  # the server ended, and this process will too
            self._connection.send(message)

    def publish_estimate(self, message: StateMessage) -> None:
        """Send the newest state with an estimate to the server."""
        self._estimated = message.state
        self._publish_state(has_estimate=message.has_estimate)

    def _process(self, frame: Frame, arrived: float) -> None:
        self._complete(frame, self._processor.push(frame), arrived)

    def _complete(self, frame: Frame, updates: Sequence[StreamUpdate], arrived: float) -> None:
        self._last = frame.number if self._last is None else max(self._last, frame.number)
        self.publish(
            FrameMessage(
                number=frame.number,
                time_s=frame.time_s,
                extremes=_compute_extremes(frame),
                arrived=arrived,
            )
        )
        for update in updates:
            self._take(update, arrived)
        if self._newest is None:
            return
        if self._ended is not None:
            if self._newest.time_s >= self._ended[1] + DECAY_S + _AFTER_DECAY_S:
                self._seal()
        elif self._newest.phase is not LivePhase.EXCITED and self._log.length_s > LONGEST_TRIM_S:
            self._log.drop()

    def _take(self, update: StreamUpdate, arrived: float) -> None:
        if update.state.phase is LivePhase.EXCITED:
            self._seal()  # the next maneuver began before the last one had decayed
        if update.interval_s is not None:
            self._ended = update.interval_s
        self._newest = update.state
        self._publish_state(has_estimate=False)
        self._estimates.submit(update, arrived)

    def _publish_state(self, *, has_estimate: bool) -> None:
        newest = self._newest or self._estimated
        if newest is not None:
            state = combine_states(newest, self._estimated)
            self.publish(StateMessage(state=state, has_estimate=has_estimate))

    def _seal(self) -> None:
        if self._ended is not None:
            interval_s, self._ended = self._ended, None
            self._store(self._log.seal(interval_s), interval_s)

    def _store(self, file: Path, interval_s: tuple[float, float]) -> None:
        start_s, stop_s = interval_s
        self._estimates.store(SegmentMessage(file=file, start_s=start_s, stop_s=stop_s))


def main(arguments: list[str]) -> None:
    """Run a stream until its source ends or the lifeline closes."""
    # Ctrl-C reaches the whole process group; the server handles it.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, _exit)
    number, lifeline = (int(argument) for argument in arguments)
    connection = Connection(number)
    try:
        order: StreamOrder = connection.recv()
    except EOFError:
        return
    start_fork_server()  # of the estimates
    arrivals: queue.Queue[_Arrival | EndMessage] = queue.Queue(
        _FRAMES_AHEAD if order.waits else _FRAMES_WAITING
    )
    stream = _Stream(order, connection)
    after = stream.resume()
    threading.Thread(
        target=_receive_requests, args=(order, connection, lifeline, arrivals), daemon=True
    ).start()
    threading.Thread(
        target=_receive_frames, args=(order, after, arrivals, stream), daemon=True
    ).start()
    configure_interpreter()
    while True:
        arrival = arrivals.get()
        if isinstance(arrival, EndMessage):
            stream.finish(arrival.failure)
            return
        stream.push(*arrival)


def _receive_frames(
    order: StreamOrder,
    after: int | None,
    arrivals: queue.Queue[_Arrival | EndMessage],
    stream: _Stream,
) -> None:
    """Pass on the frames of the source, and what it reports besides them."""
    try:
        for received in order.source.receive(after):
            if isinstance(received, Reception):
                stream.publish(ReceptionMessage(reception=received))
            else:
                arrivals.put((received, time.monotonic()))
    except Exception as error:
        # Of any library or package: the stream ends with a reason, not without one.
        arrivals.put(EndMessage(failure=f"receiver {order.stream.receiver.name}: {error}"))
    else:
        arrivals.put(EndMessage())


def _receive_requests(
    order: StreamOrder,
    connection: Connection,
    lifeline: int,
    arrivals: queue.Queue[_Arrival | EndMessage],
) -> None:
    """Pass on pushed frames and the request to stop; end with the server."""
    with suppress(EOFError, OSError):
        while lifeline not in wait([connection, lifeline]):
            request: bytes | None = connection.recv()
            if request is None:
                arrivals.put(EndMessage())
                continue
            for frame in decode_frames(request, order.task.header):
                arrivals.put((frame, time.monotonic()))
    os._exit(0)  # the frames are on disk, and the next server resumes


def _compute_extremes(frame: Frame) -> np.ndarray:
    """Compute the lowest and highest value of every channel, NaN where all are missing."""
    low = [np.fmin.reduce(samples, axis=0) for samples in frame.samples]
    high = [np.fmax.reduce(samples, axis=0) for samples in frame.samples]
    return np.stack([np.concatenate(low), np.concatenate(high)]).astype(np.float32)


def _exit(number: int, frame: FrameType | None) -> None:
    os._exit(0)


if __name__ == "__main__":
    main(sys.argv[1:])
