"""Streams of a server: starts their processes, restarts them, and has their newest results."""

from __future__ import annotations

import logging
import shutil
import threading
import time
from collections import deque
from collections.abc import Callable, Collection, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
import sqlalchemy as sa

from flexsid.errors import BadInput, Conflict, FlexsidError
from flexsid.jobs.child import Program
from flexsid.jobs.health import get_process_id, is_gone
from flexsid.records.live import (
    LiveResponses,
    LiveSnapshot,
    LiveState,
    LiveStream,
    Reception,
    StreamHeader,
    StreamStatus,
    StripChart,
)
from flexsid.storage.access import using_access
from flexsid.storage.store import Store
from flexsid.storage.tables import live_streams
from flexsid.streams.broker import BrokerAccess, read_credentials
from flexsid.streams.frame_log import (
    StripChartMemory,
    has_sealed,
    locate_frames,
    set_aside,
)
from flexsid.streams.receiver import (
    EndMessage,
    FrameMessage,
    ReceptionMessage,
    ResponsesMessage,
    StateMessage,
    StoredMessage,
    StreamOrder,
)
from flexsid.streams.receivers import find_receiver
from flexsid.workflow.live.frame_assembler import decode_frames
from flexsid.workflow.live.live_fit import LiveTask, prepare_live_task

_log = logging.getLogger(__name__)

_RESTART_S = 1.0
_START_S = 10.0  # more than loading the libraries takes
_STOP_S = 60.0  # for the last estimate, and storing the maneuver
_WATCH_S = 1.0  # between looks whether another server stops a stream
_OTHER_S = 10.0  # for another server to stop a stream; then the response is that it still runs
_MOST_STREAMS = 4  # of one server: each needs up to two cores
_MOST_WITH_RESERVED = 8  # with the first stream of each further campaign
_DELAYS = 1200  # frames, one minute


@dataclass(slots=True)
class _Running:
    """A running stream: its processes, and what they reported."""

    order: StreamOrder
    chart: StripChartMemory
    thread: threading.Thread | None = None
    program: Program | None = None
    lock: threading.Lock = field(default_factory=threading.Lock)  # held while a request is sent
    begun: threading.Event = field(default_factory=threading.Event)  # what is sent now arrives
    stopping: threading.Event = field(default_factory=threading.Event)
    state: LiveState | None = None
    states: int = 0
    delays: deque[float] = field(default_factory=lambda: deque(maxlen=_DELAYS))
    arrived: float | None = None
    reception: Reception | None = None
    responses: LiveResponses | None = None

    @property
    def header(self) -> StreamHeader:
        """Channels of the stream."""
        return self.order.task.header


class LiveStreams:
    """Runs the streams of this server, each in processes of its own.

    Parameters
    ----------
    store
        Database.
    on_change
        Called on a separate thread with the id of a stream that has a new frame or state.
    on_queued
        Called on a separate thread after a run was queued.
    credentials
        File with the credentials of brokers (see ``read_credentials``).
    brokers
        Addresses of the brokers that streams may connect to without these credentials; None: any.
    """

    def __init__(
        self,
        store: Store,
        on_change: Callable[[int], None] = lambda stream_id: None,
        on_queued: Callable[[], None] = lambda: None,
        credentials: Path | None = None,
        brokers: Collection[str] | None = None,
    ) -> None:
        self._store = store
        self._on_change = on_change
        self._on_queued = on_queued
        self._credentials = credentials
        self._brokers = brokers
        self._starting = threading.Lock()
        self._holder = get_process_id()
        self._running: dict[int, _Running] = {}
        self._lock = threading.Lock()
        self._resuming: threading.Thread | None = None

    def start(self, stream: LiveStream) -> LiveStream:
        """Store a new stream and start its processes.

        Raises
        ------
        BadInput
            If the run cannot be a stream, or an option of the receiver is invalid.
        Conflict
            If too many streams are running.
        """
        if stream.flight_id is not None:
            flight = self._store.flights.get(stream.flight_id)
            if flight.aircraft_id != stream.aircraft_id:
                raise BadInput(
                    f"flight {stream.flight_id} is of another aircraft than run {stream.run_id}",
                    code="different-aircraft",
                )
        order = self._prepare(replace(stream, holder=self._holder))
        with self._starting:
            self._refuse_too_many(stream.aircraft_id)
            stored = self._store.live_streams.add(order.stream)
            assert stored.id is not None
            folder = locate_frames(self._store, stored.id)
            if (left := set_aside(folder)) is not None:
                _log.warning("an earlier stream %d left frames, now in %s", stored.id, left)
            self._begin(stored.id, replace(order, stream=stored, folder=folder))
        return stored

    def _refuse_too_many(self, aircraft_id: int) -> None:
        """Refuse a stream without a place; a campaign without streams has one for longer."""
        with self._lock:
            campaigns = [running.order.stream.aircraft_id for running in self._running.values()]
        if len(campaigns) >= (_MOST_STREAMS if aircraft_id in campaigns else _MOST_WITH_RESERVED):
            raise Conflict(
                f"{len(campaigns)} streams are running, the most of one server; stop one",
                code="too-many-streams",
            )

    def resume(self) -> None:
        """Start the streams again that a stopped server was running; returns at once."""
        self._resuming = threading.Thread(target=self._resume, name="streams", daemon=True)
        self._resuming.start()

    def stop(self, stream_id: int) -> LiveStream:
        """Stop a stream; returns when its last maneuver is stored."""
        stream = self._store.live_streams.get(stream_id)
        if stream.status is not StreamStatus.RUNNING:
            return stream
        running = self._running.get(stream_id)
        # In the name of who stops it; the rest is done by the threads of the server.
        self._store.live_streams.replace(replace(stream, stopped_at=datetime.now(UTC)))
        if running is not None:
            return self._end(stream_id, running)
        if is_gone(stream.holder):
            return self._finish(stream_id, StreamStatus.STOPPED)
        until = time.monotonic() + _OTHER_S
        while stream.status is StreamStatus.RUNNING and time.monotonic() < until:
            time.sleep(_WATCH_S / 4)
            stream = self._store.live_streams.get(stream_id)
        return stream

    def _end(self, stream_id: int, running: _Running) -> LiveStream:
        running.stopping.set()
        self._send(running, None)
        if running.thread is not None:
            running.thread.join(_STOP_S)
        self._kill(running)
        stream = self._store.live_streams.get(stream_id)
        if stream.status is StreamStatus.RUNNING:
            return self._finish(stream_id, StreamStatus.STOPPED)
        return stream

    def _watch(self, stream_id: int, running: _Running) -> None:
        """End a stream that is stopped by another server."""
        stopped_at = sa.select(live_streams.c.stopped_at).where(live_streams.c.id == stream_id)
        with using_access(None):
            while not running.stopping.wait(_WATCH_S) and stream_id in self._running:
                try:
                    with self._store.database.reading() as connection:
                        is_stopped = connection.scalar(stopped_at) is not None
                    if is_stopped:
                        self._end(stream_id, running)
                except FlexsidError as error:  # the database does not respond: asked again
                    _log.warning("stream %d: %s", stream_id, error.message)

    def close(self) -> None:
        """End all processes; the next server resumes the streams."""
        if self._resuming is not None:
            self._resuming.join()
        for running in list(self._running.values()):
            running.stopping.set()
            self._kill(running)
        for running in list(self._running.values()):
            if running.thread is not None:
                running.thread.join(_STOP_S)

    def push(self, stream_id: int, packets: bytes) -> int:
        """Pass packets to a stream; return the number of frames.

        Raises
        ------
        BadInput
            If the bytes are not whole packets of the stream.
        Conflict
            If the stream does not run here, or has another receiver.
        """
        running = self._require(stream_id)
        name = running.order.stream.receiver.name
        if name != "push":
            raise Conflict(f"stream {stream_id} has the receiver '{name}'", code="not-pushed")
        frames = decode_frames(packets, running.header)
        self._send(running, packets)
        return len(frames)

    def find_task(self, stream_id: int) -> LiveTask | None:
        """Return the model and channels of a running stream; None if it does not run here."""
        running = self._running.get(stream_id)
        return None if running is None else running.order.task

    def find_process(self, stream_id: int) -> int | None:
        """Return the number of the process of a stream; None while there is none."""
        running = self._running.get(stream_id)
        program = None if running is None else running.program
        return None if program is None else program.pid

    def find_campaign(self, stream_id: int) -> int | None:
        """Return the aircraft of a running stream; None if it does not run here."""
        running = self._running.get(stream_id)
        return None if running is None else running.order.stream.aircraft_id

    def find_snapshot(self, stream_id: int) -> LiveSnapshot | None:
        """Return what is known of a running stream; None if it does not run here."""
        running = self._running.get(stream_id)
        if running is None:
            return None
        state, newest_s = running.state, running.chart.newest_s
        estimate = None if state is None else state.estimate
        age_s = None if estimate is None or newest_s is None else newest_s - estimate.time_s
        silent_s = None if running.arrived is None else time.monotonic() - running.arrived
        delays = list(running.delays)
        return LiveSnapshot(
            stream_id=stream_id,
            state=state,
            newest_s=newest_s,
            silent_s=silent_s,
            delay_s=float(np.percentile(delays, 95)) if delays else None,
            estimate_age_s=age_s,
            reception=running.reception,
        )

    def find_responses(self, stream_id: int) -> LiveResponses | None:
        """Return the frequency responses of the newest estimate of a running stream, if any."""
        running = self._running.get(stream_id)
        return None if running is None else running.responses

    def count_states(self, stream_id: int) -> int:
        """Return the number of states that a stream had so far; readers see new ones by it."""
        running = self._running.get(stream_id)
        return 0 if running is None else running.states

    def find_newest_s(self, stream_id: int) -> float | None:
        """Return the end of the newest frame of a stream on the clock of the recorder. [s]"""
        running = self._running.get(stream_id)
        return None if running is None else running.chart.newest_s

    def read_samples(
        self, stream_id: int, names: Sequence[str], since_s: float | None, columns: int
    ) -> StripChart:
        """Return the extremes of channels of a running stream (see ``StripChartMemory.read``)."""
        return self._require(stream_id).chart.read(names, since_s, columns)

    def publish(self, stream_id: int) -> None:
        """Send the state of a stream again: an alarm was acknowledged."""
        running = self._running.get(stream_id)
        if running is not None:
            running.states += 1
            self._on_change(stream_id)

    def _require(self, stream_id: int) -> _Running:
        running = self._running.get(stream_id)
        if running is None:
            raise Conflict(f"stream {stream_id} does not run on this server", code="not-running")
        return running

    def _prepare(self, stream: LiveStream) -> StreamOrder:
        credentials = read_credentials(self._credentials)
        access = BrokerAccess(credentials=credentials, brokers=self._brokers)
        receiver, options = find_receiver(stream.receiver, access)
        run = self._store.runs.get(stream.run_id)
        task = prepare_live_task(self._store, run, stream.next_airspeed_m_s, stream.limits)
        source = receiver.open(self._store, options, task.header)
        return StreamOrder(
            database=str(self._store.database.url.render_as_string(hide_password=False)),
            stream=stream,
            task=task,
            source=source,
            waits=receiver.waits,
            folder=locate_frames(self._store, stream.id or 0),
        )

    def _begin(self, stream_id: int, order: StreamOrder) -> None:
        running = _Running(order, StripChartMemory(order.task.header))
        running.thread = threading.Thread(
            target=self._run, args=(stream_id, running), name=f"stream-{stream_id}", daemon=True
        )
        with self._lock:
            self._running[stream_id] = running
        running.thread.start()
        running.begun.wait(_START_S)  # packets that are posted next must not be lost
        threading.Thread(
            target=self._watch, args=(stream_id, running), name=f"watch-{stream_id}", daemon=True
        ).start()

    def _resume(self) -> None:
        with using_access(None):
            for stream in self._store.live_streams.find(status=StreamStatus.RUNNING):
                if not is_gone(stream.holder) or not self._take_over(stream):
                    continue
                assert stream.id is not None
                if stream.stopped_at is not None:  # and its server ended before it could
                    self._finish(stream.id, StreamStatus.STOPPED)
                    continue
                try:
                    order = self._prepare(replace(stream, holder=self._holder))
                except FlexsidError as error:
                    self._finish(stream.id, StreamStatus.FAILED, error.message)
                else:
                    _log.info("stream %d is resumed", stream.id)
                    self._begin(stream.id, order)

    def _take_over(self, stream: LiveStream) -> bool:
        """Become the server of a stream; False if another one was faster."""
        mine = (live_streams.c.id == stream.id) & (live_streams.c.holder.is_(stream.holder))
        if stream.holder is not None:
            mine = (live_streams.c.id == stream.id) & (live_streams.c.holder == stream.holder)
        with self._store.database.transaction() as connection:
            done = connection.execute(
                sa.update(live_streams).where(mine).values(holder=self._holder)
            )
        return done.rowcount == 1

    def _run(self, stream_id: int, running: _Running) -> None:
        """Start the process, receive its messages until it ends, and restart it."""
        while True:
            with running.lock:
                if running.stopping.is_set() and running.program is None:
                    running.begun.set()  # nothing is sent any more
                    break
                running.program = program = Program("flexsid.streams.stream_process")
                with suppress(OSError):  # before any request
                    program.connection.send(running.order)
            running.begun.set()
            end: EndMessage | None = None
            with suppress(EOFError, OSError):
                while True:
                    message = program.connection.recv()
                    if isinstance(message, EndMessage):
                        end = message
                        break
                    self._receive(stream_id, running, message)
            with running.lock:
                running.program = None
                reason = program.describe_exit()
                program.kill()
                program.close()
            if end is not None:
                status = StreamStatus.FAILED if end.failure else StreamStatus.STOPPED
                self._finish(stream_id, status, end.failure)
                return
            if running.stopping.is_set():
                return
            _log.warning("the process of stream %d ended (%s); restarting", stream_id, reason)
            running.stopping.wait(_RESTART_S)

    def _receive(self, stream_id: int, running: _Running, message: object) -> None:
        now = time.monotonic()
        match message:
            case FrameMessage():
                running.arrived = message.arrived
                running.delays.append(now - message.arrived)
                running.chart.append(message.number, message.time_s, message.extremes)
            case ReceptionMessage():
                running.reception = message.reception
                running.states += 1
            case ResponsesMessage():
                running.responses = message.responses
            case StateMessage():
                running.state = message.state
                running.states += 1
            case StoredMessage():
                running.states += 1
                self._on_queued()
            case _:
                return
        self._on_change(stream_id)

    def _send(self, running: _Running, request: bytes | None) -> None:
        with running.lock, suppress(OSError):
            if running.program is not None:
                running.program.connection.send(request)

    def _kill(self, running: _Running) -> None:
        with running.lock:
            if running.program is not None:
                running.program.release_lifeline()
                running.program.kill()

    def _finish(self, stream_id: int, status: StreamStatus, message: str = "") -> LiveStream:
        with using_access(None), self._store.transaction():
            stream = self._store.live_streams.get(stream_id)
            stream = replace(
                stream,
                status=status,
                message=message,
                holder=None,
                stopped_at=stream.stopped_at or datetime.now(UTC),
            )
            self._store.live_streams.replace(stream)
        with self._lock:
            self._running.pop(stream_id, None)
        folder = locate_frames(self._store, stream_id)
        if has_sealed(folder):
            _log.warning("maneuvers of stream %d are not stored; frames: %s", stream_id, folder)
        else:
            shutil.rmtree(folder, ignore_errors=True)
        self._on_change(stream_id)
        return stream
