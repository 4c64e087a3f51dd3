"""Dispatcher: sends queued jobs to the workers and stores the results.

Of all servers on a database, only the server with the lease dispatches. It alone changes
the state of a job between queued and finished, in a thread. The state is in the table of
jobs, so that the jobs of a server that dies are resumed.
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

from flexsid.errors import FlexsidError, UnknownRecord
from flexsid.jobs.kind import Kinds
from flexsid.jobs.leadership import LEASE_TIMEOUT_S, Leadership
from flexsid.jobs.messages import (
    ComputedMessage,
    FailedMessage,
    Key,
    ProgressMessage,
    TaskLostMessage,
    WorkerDiedMessage,
    WorkerMessage,
    describe_error,
)
from flexsid.jobs.process_id import shorten_process_id
from flexsid.records.job import Job
from flexsid.records.run import Limits, Progress
from flexsid.storage import queue
from flexsid.storage.files import DatabaseUnavailable
from flexsid.storage.store import Store

_log = logging.getLogger(__name__)

_POLL_S = 0.5  # jobs may also be queued or cancelled by other processes
_CHECK_S = 0.2  # between checks for cancelled jobs
_LOG_S = 2.0  # between progress messages in the log of one job
_REUSED_S = 2.0  # afterwards the data of a task prepared to validate a request may have changed
_PREPARED_S = 30.0  # the same for a task prepared while all workers compute
_TIME_LIMIT_S = 3600.0  # unless the limits of a job differ
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
    def extra_slots(self) -> int:
        """Number of tasks that can start beyond, for analysts without a running job."""
        return 0

    @property
    def keys(self) -> set[Key]:
        """Keys of the running tasks."""
        ...

    def warm_up(self) -> None:
        """Prepare for the next task."""

    def submit(self, key: Key, kind: str, task: Any, memory_mb: int | None) -> None:
        """Start a task; requires a free or extra slot."""

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
    """Task of a queued job, or why it cannot be prepared, and until when it may be used."""

    task: Any
    until: float


@dataclass(slots=True)
class _ActiveTask:
    """Time limit of a task that a worker has, and when its progress is logged next."""

    limit_s: float
    deadline: float
    log_at: float = 0.0


class Dispatcher:
    """Executes queued jobs until it is stopped.

    Parameters
    ----------
    store
        Store with the queue and the results.
    kinds
        Kinds of jobs.
    workers
        Executor of the tasks.
    on_change
        Called on the dispatcher's thread after jobs have changed.
    lease_timeout_s
        Time without renewal after which a server loses the lease. [s]
    """

    def __init__(
        self,
        store: Store,
        kinds: Kinds,
        workers: Workers,
        on_change: Callable[[], None] = lambda: None,
        lease_timeout_s: float = LEASE_TIMEOUT_S,
    ) -> None:
        self._store = store
        self._kinds = kinds
        self._workers = workers
        self._on_change = on_change
        self._leadership = Leadership(store, self._status, lease_timeout_s)
        self._idle_s = min(_POLL_S, lease_timeout_s / 4)
        self._thread = threading.Thread(target=self._run, name="dispatcher", daemon=True)
        self._stopping = threading.Event()
        self._prepared: dict[int, _PreparedTask] = {}
        self._served: dict[str, float] = {}  # last start of a job of each analyst
        self._active: dict[Key, _ActiveTask] = {}
        self._messages: deque[tuple[Key, WorkerMessage]] = deque()
        self._checked = 0.0
        self._interrupted = False
        self._idle_since: float | None = None  # without a worker

    def start(self) -> None:
        """Start; jobs are dispatched once this server has the lease."""
        self._thread.start()

    def wake(self) -> None:
        """Check the queue now: a job was queued or cancelled."""
        if not self._stopping.is_set():
            self._checked = 0.0
            self._workers.wake()

    def reuse_task(self, job_id: int, task: Any) -> None:
        """Reuse the task that was prepared to validate a request."""
        if len(self._prepared) < self._workers.count:
            self._prepared[job_id] = _PreparedTask(task, time.monotonic() + _REUSED_S)
        self.wake()

    def stop(self) -> None:
        """Kill the workers and queue their jobs again, for the next server."""
        if self._stopping.is_set():
            return
        self._stopping.set()
        self._workers.wake()
        self._thread.join()
        keys = self._list_keys()
        self._workers.close()
        self._put_back(keys)
        try:
            self._leadership.release()
        except DatabaseUnavailable as error:
            _log.warning("the lease was not released: %s", error.message)

    def _status(self) -> dict[str, Any]:
        return {
            "server": shorten_process_id(self._leadership.process_id),
            "location": self._workers.location,
            "workers": self._workers.count,
            "running": sorted(job_id for job_id, _ in self._workers.keys),
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
                self._interrupted = True  # a job may be marked as started without being computed
                self._stopping.wait(_POLL_S)

    def _dispatch(self) -> None:
        if self._interrupted:
            known = {job_id for job_id, _ in self._list_keys()}
            queue.requeue_unknown(self._store, self._leadership.process_id, known)
            self._interrupted = False
        busy = False
        while self._start_next():
            busy = True
        busy = self._prepare_next() or busy  # while the workers compute
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
        self._stop_overdue_jobs()
        self._stop_cancelled_jobs()
        if changed:
            self._on_change()

    def _start_next(self) -> bool:
        """Start the next queued job; return False if there is no worker or no job for it."""
        has_slot = self._workers.free_slots > 0
        if not has_slot and self._workers.extra_slots <= 0:
            return False
        number = queue.find_next(self._store, self._served, idle_authors_only=not has_slot)
        if number is None:
            return False
        leadership = self._leadership
        job = queue.claim(
            self._store, number, process_id=leadership.process_id, epoch=leadership.epoch
        )
        if job is None:  # cancelled meanwhile, or the lease is lost
            return False
        self._served[job.author] = time.monotonic()
        key = (number, job.attempt)
        try:
            prepared = self._prepared.pop(number, None)
            is_recent = prepared is not None and time.monotonic() < prepared.until
            task = prepared.task if prepared and is_recent else self._prepare(job)
        except DatabaseUnavailable:
            # Queued as a message, it is handled once the database responds.
            self._messages.append((key, TaskLostMessage("the database did not respond")))
            raise
        if isinstance(task, FailedMessage):
            self._messages.append((key, task))
        else:
            self._submit(key, job, task)
        return True

    def _prepare_next(self) -> bool:
        """Prepare the task of the next queued job before a worker is free."""
        now = time.monotonic()
        # Copied, since ``reuse_task`` adds tasks from another thread.
        self._prepared = {n: one for n, one in self._prepared.copy().items() if now < one.until}
        if self._workers.count == 0 or len(self._prepared) >= self._workers.count:
            return False
        number = queue.find_next(self._store, self._served)
        if number is None or number in self._prepared:
            return False
        task = self._prepare(self._store.jobs.get(number))
        self._prepared[number] = _PreparedTask(task, time.monotonic() + _PREPARED_S)
        return True

    def _prepare(self, job: Job) -> Any:
        """Return the task of a job, or a ``FailedMessage``."""
        if job.kind not in self._kinds:
            return FailedMessage("unknown-kind", f"this version has no jobs '{job.kind}'")
        return self._kinds[job.kind].prepare_task(self._store, job)

    def _submit(self, key: Key, job: Job, task: Any) -> None:
        limits = job.limits or Limits()
        limit_s = limits.time_s or _TIME_LIMIT_S
        self._active[key] = _ActiveTask(limit_s, time.monotonic() + limit_s + _START_S)
        try:
            self._workers.submit(key, job.kind, task, limits.memory_mb)
        except OSError as error:  # the worker was killed before it received the task
            self._messages.append((key, WorkerDiedMessage(str(error))))
        except Exception as error:
            self._messages.append((key, describe_error(error)))

    def _handle_message(self, key: Key, message: WorkerMessage) -> None:
        if isinstance(message, ProgressMessage):
            self._note_progress(key, message.progress)
            return
        job_id, attempt = key
        ended = self._save(key, message)
        if isinstance(ended, FailedMessage):
            if ended.trace:
                _log.error("job %d, attempt %d:\n%s", job_id, attempt, ended.trace)
            worker = ended.worker or None
            queue.fail(self._store, job_id, attempt, ended.code, ended.message, worker)
        elif isinstance(ended, WorkerDiedMessage):
            _log.warning("job %d, attempt %d: its worker died, %s", job_id, attempt, ended.reason)
            why = (
                f"the worker process died {{deaths}} times ({ended.reason}),"
                " possibly for lack of memory; ask for less"
            )
            queue.retry_or_fail(self._store, job_id, attempt, why)
        elif isinstance(ended, TaskLostMessage):
            queue.requeue(self._store, job_id, attempt, ended.reason)
        self._active.pop(key, None)

    def _note_progress(self, key: Key, progress: Progress | None) -> None:
        active = self._active.get(key)
        if active is None:
            return
        now = time.monotonic()
        if progress is None:
            active.deadline, active.log_at = now + active.limit_s, now + _LOG_S / 2
            return
        queue.note_progress(self._store, *key, _remove_infinite_cost(progress))
        if now >= active.log_at:
            queue.log_message(self._store, *key, progress.message)
            active.log_at = now + _LOG_S

    def _save(self, key: Key, message: WorkerMessage) -> WorkerMessage | None:
        """Store an outcome; return a message that is no outcome."""
        if not isinstance(message, ComputedMessage):
            return message
        job_id, attempt = key
        try:
            job = replace(self._store.jobs.get(job_id), attempt=attempt)
            return self._kinds[job.kind].save_outcome(self._store, job, message)
        except (queue.StaleAttempt, UnknownRecord) as error:
            _log.info(error.message)
            return None

    def _stop_overdue_jobs(self) -> None:
        now = time.monotonic()
        for key, active in list(self._active.items()):
            if now >= active.deadline:
                self._workers.cancel(key)
                message = (
                    f"the job took longer than {active.limit_s:g} s;"
                    " ask for less or set a higher time limit"
                )
                self._handle_message(key, FailedMessage("time-limit", message))

    def _stop_cancelled_jobs(self) -> None:
        now = time.monotonic()
        active = self._workers.keys
        if not active or now - self._checked < _CHECK_S:
            return
        self._checked = now
        running = queue.find_running(self._store, active)
        for key in active:
            if key[0] not in running:
                self._drop(key)

    def _abandon(self) -> None:
        """Drop all tasks: another server has the lease and has queued them again."""
        for key in self._list_keys():
            self._drop(key)
        self._messages.clear()

    def _list_keys(self) -> set[Key]:
        return self._workers.keys | {key for key, _ in self._messages}

    def _drop(self, key: Key) -> None:
        self._workers.cancel(key)
        self._active.pop(key, None)

    def _put_back(self, keys: set[Key]) -> None:
        for job_id, attempt in keys:
            try:
                queue.requeue(self._store, job_id, attempt)
            except FlexsidError as error:
                # The job stays marked as running; the next server takes it over.
                _log.warning("job %d was not returned to the queue: %s", job_id, error.message)


def _remove_infinite_cost(progress: Progress) -> Progress:
    """Remove a cost that is not finite, as in the first iterations of a diverging fit."""
    if progress.cost is None or math.isfinite(progress.cost):
        return progress
    return replace(progress, cost=None)
