"""Dispatcher: sends queued runs to the workers and stores the results.

Of all servers on a database, only the server with the lease dispatches. It alone changes
the state of a run between queued and finished, in a thread. The state is in the run
table, so that the runs of a server that dies are resumed.
"""

from __future__ import annotations

import logging
import math
import threading
import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Protocol

from flexsid.errors import FlexsidError
from flexsid.jobs.leadership import LEASE_TIMEOUT_S, Leadership
from flexsid.jobs.messages import (
    ComputedMessage,
    FailedMessage,
    Key,
    ProgressMessage,
    StartedMessage,
    TaskLostMessage,
    WorkerDiedMessage,
    WorkerMessage,
    describe_unexpected_error,
)
from flexsid.jobs.pipeline import JobPipeline
from flexsid.jobs.process_id import shorten_process_id
from flexsid.records.run import EstimationRun, Limits, Progress
from flexsid.storage import queue
from flexsid.storage.files import DatabaseUnavailable
from flexsid.storage.store import Store

_log = logging.getLogger(__name__)

_POLL_S = 0.5  # runs may also be queued or cancelled by other processes
_CHECK_S = 0.2  # between checks for cancelled runs
_LOG_S = 2.0  # between progress messages in the log of one run
_TIME_LIMIT_S = 3600.0  # unless the limits of a run differ
_PREPARED_S = 2.0  # afterwards the data of a prepared task may have changed
_START_S = 60.0  # more than a worker process takes to start


class Workers(Protocol):
    """Executor of tasks: worker processes of this computer, or of a cluster."""

    location: str
    count: int

    @property
    def free_slots(self) -> int:
        """Number of further tasks that can start now."""
        ...

    @property
    def keys(self) -> set[Key]:
        """Keys of the running tasks."""
        ...

    def warm_up(self) -> None:
        """Prepare for the next task."""

    def submit(self, key: Key, task: Any, memory_mb: int | None) -> None:
        """Start a task; requires ``free_slots`` above zero."""

    def cancel(self, key: Key) -> None:
        """Stop a task; no further message of it follows."""

    def wait(self, timeout: float) -> list[tuple[Key, WorkerMessage]]:
        """Return new messages of the workers; return at once after ``wake``."""
        ...

    def wake(self) -> None:
        """End ``wait``; thread-safe."""

    def close(self) -> None:
        """Stop all tasks."""


@dataclass(frozen=True, slots=True)
class _PreparedTask:
    """A claimed run whose task waits for a worker."""

    key: Key
    task: Any
    limits: Limits


class Dispatcher:
    """Executes queued runs until it is stopped.

    Parameters
    ----------
    store
        Store with the queue and the results.
    pipeline
        Functions that prepare, compute and save a run.
    workers
        Executor of the tasks.
    on_change
        Called on the dispatcher's thread after runs have changed.
    lease_timeout_s
        Time without renewal after which a server loses the lease. [s]
    """

    def __init__(
        self,
        store: Store,
        pipeline: JobPipeline,
        workers: Workers,
        on_change: Callable[[], None] = lambda: None,
        lease_timeout_s: float = LEASE_TIMEOUT_S,
    ) -> None:
        self._store = store
        self._pipeline = pipeline
        self._workers = workers
        self._on_change = on_change
        self._leadership = Leadership(store, self._status, lease_timeout_s)
        self._idle_s = min(_POLL_S, lease_timeout_s / 4)
        self._thread = threading.Thread(target=self._run, name="dispatcher", daemon=True)
        self._stopping = threading.Event()
        self._ready: deque[_PreparedTask] = deque()
        self._prepared: dict[int, tuple[float, Any]] = {}
        self._messages: deque[tuple[Key, WorkerMessage]] = deque()
        self._limits: dict[Key, float] = {}
        self._deadlines: dict[Key, float] = {}
        self._last_logged: dict[Key, float] = {}
        self._checked = 0.0
        self._interrupted = False
        self._idle_since: float | None = None  # without a worker

    def start(self) -> None:
        """Start; runs are dispatched once this server has the lease."""
        self._thread.start()

    def wake(self) -> None:
        """Check the queue now: a run was queued or cancelled."""
        if not self._stopping.is_set():
            self._checked = 0.0
            self._workers.wake()

    def reuse_task(self, run_id: int, task: Any) -> None:
        """Reuse the task that was prepared to validate a run."""
        if len(self._prepared) < self._workers.count:
            self._prepared[run_id] = (time.monotonic(), task)
        self.wake()

    def stop(self) -> None:
        """Kill the workers and queue their runs again, for the next server."""
        if self._stopping.is_set():
            return
        self._stopping.set()
        self._workers.wake()
        self._thread.join()
        active = self._under_way | {key for key, _ in self._messages}
        self._workers.close()
        self._put_back(active)
        try:
            self._leadership.release()
        except DatabaseUnavailable as error:
            _log.warning("the lease was not released: %s", error.message)

    @property
    def _under_way(self) -> set[Key]:
        return self._workers.keys | {ready.key for ready in self._ready}

    def _status(self) -> dict[str, Any]:
        return {
            "server": shorten_process_id(self._leadership.process_id),
            "place": self._workers.location,
            "workers": self._workers.count,
            "running": sorted(run_id for run_id, _ in self._workers.keys),
            "without_workers_s": self._without_workers_s(),
        }

    def _without_workers_s(self) -> float:
        if self._workers.count > 0:
            self._idle_since = None
            return 0.0
        self._idle_since = self._idle_since or time.monotonic()
        return round(time.monotonic() - self._idle_since, 1)

    def _run(self) -> None:
        while not self._stopping.is_set():
            try:
                if self._leadership.hold():
                    self._dispatch()
                else:
                    self._abandon()
                    self._workers.wait(self._idle_s)
            except DatabaseUnavailable as error:
                _log.warning("%s; trying again", error.message)
                self._interrupted = True
                self._stopping.wait(_POLL_S)
            except Exception:
                _log.exception("the dispatcher continues after an error")
                self._interrupted = True  # a run may be marked as started without being computed
                self._stopping.wait(_POLL_S)

    def _dispatch(self) -> None:
        if self._interrupted:
            known = {key[0] for key in self._under_way} | {key[0] for key, _ in self._messages}
            queue.requeue_unknown(self._store, self._leadership.process_id, known)
            self._interrupted = False
        busy = False
        while self._workers.free_slots > 0 and (self._ready or self._prepare_next()):
            self._submit()
            busy = True
        if self._workers.count == 0:
            self._put_back_ready()
        # The next tasks are prepared while the workers compute.
        if self._workers.free_slots <= 0 and len(self._ready) < self._workers.count:
            busy = self._prepare_next() or busy
        self._workers.warm_up()
        self._messages.extend(self._workers.wait(0.0 if busy else self._idle_s))
        changed = busy or bool(self._messages)
        while self._messages:
            key, message = self._messages.popleft()
            try:
                self._handle_message(key, message)
            except DatabaseUnavailable:
                self._messages.appendleft((key, message))  # handled once the database responds
                raise
        self._stop_overdue_runs()
        self._stop_cancelled_runs()
        if changed:
            self._on_change()

    def _prepare_next(self) -> bool:
        """Claim the next queued run and prepare its task; return False if none is queued."""
        leadership = self._leadership
        run = queue.claim(self._store, process_id=leadership.process_id, epoch=leadership.epoch)
        if run is None or run.id is None:
            return False
        key = (run.id, run.attempt)
        try:
            task = self._get_task(run)
        except DatabaseUnavailable:
            # Queued as a message, it is handled once the database responds.
            self._messages.append((key, TaskLostMessage("the database did not respond")))
            raise
        except FlexsidError as error:
            self._messages.append((key, FailedMessage(error.code, error.message)))
        except Exception as error:
            self._messages.append((key, describe_unexpected_error(error)))
        else:
            self._ready.append(_PreparedTask(key, task, run.limits or Limits()))
            if self._workers.free_slots <= 0:
                waiting = Progress(message="Waiting for a worker")
                queue.note_progress(self._store, *key, waiting)
        return True

    def _get_task(self, run: EstimationRun) -> Any:
        now = time.monotonic()
        for number, (at, _) in list(self._prepared.items()):
            if now - at > _PREPARED_S:
                del self._prepared[number]
        prepared = self._prepared.pop(run.id or 0, None)
        return self._pipeline.prepare(self._store, run) if prepared is None else prepared[1]

    def _put_back_ready(self) -> None:
        """Return prepared tasks to the queue, because no worker is left."""
        for ready in self._ready:
            self._messages.append((ready.key, TaskLostMessage("no worker is available")))
        self._ready.clear()

    def _submit(self) -> None:
        if not self._ready:  # the preparation failed
            return
        ready = self._ready.popleft()
        self._limits[ready.key] = ready.limits.time_s or _TIME_LIMIT_S
        self._deadlines[ready.key] = time.monotonic() + self._limits[ready.key] + _START_S
        try:
            self._workers.submit(ready.key, ready.task, ready.limits.memory_mb)
        except OSError as error:  # the worker was killed before it received the task
            self._messages.append((ready.key, WorkerDiedMessage(str(error))))
        except Exception as error:
            self._messages.append((ready.key, describe_unexpected_error(error)))

    def _handle_message(self, key: Key, message: WorkerMessage) -> None:
        run_id, attempt = key
        if isinstance(message, StartedMessage):
            if key in self._limits:
                self._deadlines[key] = time.monotonic() + self._limits[key]
            return
        if isinstance(message, ProgressMessage):
            now = time.monotonic()
            queue.note_progress(
                self._store, run_id, attempt, _remove_infinite_cost(message.progress)
            )
            if now - self._last_logged.get(key, now - _LOG_S / 2) >= _LOG_S:
                queue.log_message(self._store, run_id, attempt, message.progress.message)
                self._last_logged[key] = now
            self._last_logged.setdefault(key, now - _LOG_S / 2)
            return
        if isinstance(message, ComputedMessage):
            message = self._save(key, message) or message
        if isinstance(message, FailedMessage):
            if message.trace:
                _log.error("run %d, attempt %d:\n%s", run_id, attempt, message.trace)
            queue.fail(
                self._store, run_id, attempt, message.code, message.message, message.worker or None
            )
        elif isinstance(message, WorkerDiedMessage):
            _log.warning("run %d, attempt %d: its worker died, %s", run_id, attempt, message.reason)
            queue.retry_or_fail(
                self._store,
                run_id,
                attempt,
                f"the worker process died {{deaths}} times ({message.reason}),"
                " possibly for lack of memory; use a smaller model",
            )
        elif isinstance(message, TaskLostMessage):
            queue.requeue(self._store, run_id, attempt, message.reason)
        self._clear_timers(key)

    def _save(self, key: Key, message: ComputedMessage) -> FailedMessage | None:
        run_id, attempt = key
        try:
            self._pipeline.save(self._store, run_id, attempt, message.outcome, message.worker)
        except queue.StaleAttempt as error:
            _log.info(error.message)
        except DatabaseUnavailable:
            raise
        except FlexsidError as error:
            return FailedMessage(error.code, error.message, worker=message.worker)
        except Exception as error:
            return describe_unexpected_error(error)
        return None

    def _stop_overdue_runs(self) -> None:
        now = time.monotonic()
        for key in [key for key, deadline in self._deadlines.items() if now >= deadline]:
            self._workers.cancel(key)
            limit = self._limits[key]
            message = (
                f"the run took longer than {limit:g} s; use a smaller model or a higher time limit"
            )
            self._handle_message(key, FailedMessage("time-limit", message))

    def _stop_cancelled_runs(self) -> None:
        now = time.monotonic()
        active = self._under_way
        if not active or now - self._checked < _CHECK_S:
            return
        self._checked = now
        running = queue.find_running(self._store, active)
        for key in active:
            if key[0] not in running:
                self._drop(key)

    def _abandon(self) -> None:
        """Drop all tasks: another server has the lease and has queued them again."""
        for key in self._under_way:
            self._drop(key)
        self._messages.clear()

    def _drop(self, key: Key) -> None:
        self._workers.cancel(key)
        self._ready = deque(ready for ready in self._ready if ready.key != key)
        self._clear_timers(key)

    def _clear_timers(self, key: Key) -> None:
        self._last_logged.pop(key, None)
        self._deadlines.pop(key, None)
        self._limits.pop(key, None)

    def _put_back(self, keys: set[Key]) -> None:
        for run_id, attempt in keys:
            try:
                queue.requeue(self._store, run_id, attempt)
            except FlexsidError as error:
                # The run stays marked as running; the next server takes it over.
                _log.warning("run %d was not returned to the queue: %s", run_id, error.message)


def _remove_infinite_cost(progress: Progress) -> Progress:
    """Remove a cost that is not finite, as in the first iterations of a diverging fit."""
    if progress.cost is None or math.isfinite(progress.cost):
        return progress
    return replace(progress, cost=None)
