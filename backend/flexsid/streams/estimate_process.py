"""Process of the estimates of a stream: stores what was known when, and maneuvers that ended."""

from __future__ import annotations

import logging
import signal
import sys
import time
from collections.abc import Iterator
from functools import partial
from multiprocessing.connection import Connection, wait

from flexsid.errors import FlexsidError
from flexsid.records.live import LivePhase, LiveResponses, LiveState, RecordedState
from flexsid.storage.live_history import find_newest_state
from flexsid.storage.store import Store
from flexsid.streams.frame_log import read_frames
from flexsid.streams.receiver import (
    EndMessage,
    ResponsesMessage,
    SegmentMessage,
    StateMessage,
    StoredMessage,
    StreamOrder,
    UpdateMessage,
)
from flexsid.workflow.live.live_estimator import LiveEstimator
from flexsid.workflow.live.live_fit import adjust_live_task
from flexsid.workflow.live.maneuver_storage import store_test_point

_log = logging.getLogger(__name__)


class _Recorder:
    """Completes updates, and stores their states.

    States of a maneuver are stored, and others that differ from the one before by alarms or lost
    frames. Updates that a killed process had completed are not computed again.
    """

    def __init__(self, store: Store, order: StreamOrder) -> None:
        assert order.stream.id is not None
        self._store = store
        self._stream_id = order.stream.id
        run = store.runs.get(order.stream.run_id)
        self._estimator = LiveEstimator(order.task, partial(adjust_live_task, store, run))
        self._known = find_newest_state(store, self._stream_id)
        self._last = None if self._known is None else self._known.state

    def complete(self, message: UpdateMessage) -> Iterator[StateMessage]:
        """Yield the states of an update as they are estimated; the last one is stored."""
        update = message.update
        has_estimate = update.request is not None
        if self._known is not None:
            if update.state.time_s <= self._known.time_s:
                self._estimator.resume(update.maneuver, self._known.state)
                yield StateMessage(state=self._known.state, has_estimate=has_estimate)
                return
            self._known = None
        delay_s = None
        for state, is_complete in self._estimator.complete(update):
            delay_s = delay_s or time.monotonic() - message.arrived
            if is_complete and self._is_recorded(state, ends=update.interval_s is not None):
                self._record(state, delay_s)
            yield StateMessage(state=state, has_estimate=has_estimate and is_complete)

    def compute_responses(self) -> LiveResponses | None:
        """Compute the frequency responses of the latest estimate; they are not stored."""
        return self._estimator.compute_responses()

    def _is_recorded(self, state: LiveState, *, ends: bool) -> bool:
        if state.phase is LivePhase.EXCITED or ends:
            return True
        last = self._last
        before = (0, ()) if last is None else (last.lost_frames, last.alarms)
        return (state.lost_frames, state.alarms) != before

    def _record(self, state: LiveState, delay_s: float) -> None:
        self._last = state
        try:
            self._store.live_states.add(
                RecordedState(
                    stream_id=self._stream_id, time_s=state.time_s, state=state, delay_s=delay_s
                )
            )
        except FlexsidError as error:
            # The control room continues with a state that is not in the record.
            _log.warning("the state of %.2f s is not stored: %s", state.time_s, error.message)


def main(arguments: list[str]) -> None:
    """Complete updates until the stream ends; both pipes are given by file descriptor."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    number, lifeline = (int(argument) for argument in arguments)
    connection = Connection(number)
    try:
        order: StreamOrder = connection.recv()
        store = Store.open(order.database)
        recorder = _Recorder(store, order)
        while lifeline not in wait([connection, lifeline]):
            match connection.recv():
                case UpdateMessage() as message:
                    for state in recorder.complete(message):
                        connection.send(state)
                    if message.update.request is not None:
                        responses = recorder.compute_responses()
                        if responses is not None:
                            connection.send(ResponsesMessage(responses=responses))
                case SegmentMessage() as message:
                    connection.send(_store_segment(store, order, message))
                case _:
                    connection.send(EndMessage())
                    break
        store.close()
    except (EOFError, OSError):
        return


def _store_segment(store: Store, order: StreamOrder, message: SegmentMessage) -> StoredMessage:
    """Store the maneuver of a sealed segment, then delete the file."""
    header = order.task.header
    frames = read_frames(message.file, header) if message.file.exists() else []
    interval_s = message.start_s, message.stop_s
    point = store_test_point(store, order.stream, header, frames, interval_s)
    message.file.unlink(missing_ok=True)
    return StoredMessage(point_id=point.id or 0)


if __name__ == "__main__":
    main(sys.argv[1:])
