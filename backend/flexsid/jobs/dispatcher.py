"""Dispatcher: sends queued jobs to the workers and stores the results, or runs one in this process.

Of all servers on a database, only the server with the lease dispatches. It alone changes
the state of a job between queued and finished, in a thread. The state is in the table of
jobs, so that the jobs of a server that dies are resumed.
"""

from __future__ import annotations

import logging
import threading
import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, TypeVar

from flexsid.errors import FlexsidError, UnknownRecord
from flexsid.jobs.health import LEASE_TIMEOUT_S, Leadership, get_process_id, shorten_process_id
from flexsid.jobs.kind import Kind, Kinds, build_job, fail_job
from flexsid.jobs.local import Workers
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
from flexsid.records import finite_or_none
from flexsid.records.job import Job
from flexsid.records.run import EstimationRun, Limits, Progress, ReportProgress, RunState
from flexsid.storage.files import DatabaseUnavailable
from flexsid.storage.jobs import queue
from flexsid.storage.jobs.queue import StaleAttempt
from flexsid.storage.store import Store
from flexsid.workflow.runs.run_identity import add_hashes

# --- Dispatcher: sends queued jobs to the workers and stores the results --------------------------

_log = logging.getLogger(__name__)

_POLL_S = 0.5  # jobs may also be queued or cancelled by other processes
_CHECK_S = 0.2  # between checks for cancelled jobs
_LOG_S = 2.0  # between progress messages in the log of one job
_HANDLING_S = 1.0  # for which a stop waits for a message that is handled
_TIME_LIMIT_S = 3600.0  # unless the limits of a job differ
_START_S = 60.0  # more than a worker process takes to start


@dataclass(slots=True)
class _ActiveJob:
    """A started job, its time limit, and when its progress is logged next."""

    job: Job
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
    url
        Address of the server in a browser.
    get_failure
        Returns why messages could not be sent, or ""; None if none are sent.
    """

    def __init__(
        self,
        store: Store,
        kinds: Kinds,
        workers: Workers[Any],
        on_change: Callable[[], None] = lambda: None,
        lease_timeout_s: float = LEASE_TIMEOUT_S,
        url: str | None = None,
        get_failure: Callable[[], str] | None = None,
    ) -> None:
        self._store = store
        self._get_failure = get_failure
        self._kinds = kinds
        self._workers = workers
        self._on_change = on_change
        self._url = url
        self._leadership = Leadership(store, self._status, lease_timeout_s)
        self._idle_s = min(_POLL_S, lease_timeout_s / 4)
        self._thread = threading.Thread(target=self._run, name="dispatcher", daemon=True)
        self._stopping = threading.Event()
        self._served: dict[str, float] = {}  # last start of a job of each analyst
        self._active: dict[Key, _ActiveJob] = {}  # started, and neither ended nor dropped
        self._messages: deque[tuple[Key, WorkerMessage]] = deque()
        self._checked = 0.0
        self._interrupted = False

    @property
    def is_leading(self) -> bool:
        """Whether this server has the lease."""
        return self._leadership.epoch is not None and not self._stopping.is_set()

    def start(self) -> None:
        """Start; jobs are dispatched once this server has the lease."""
        self._thread.start()

    def wake(self) -> None:
        """Check the queue now: a job was queued or cancelled."""
        if not self._stopping.is_set():
            self._checked = 0.0
            self._workers.wake()

    def stop(self) -> None:
        """Kill the workers and queue their jobs again, for the next server."""
        if self._stopping.is_set():
            return
        self._stopping.set()
        self._workers.wake()
        self._thread.join(_HANDLING_S)
        # What stops the server may kill it soon, which would count against the jobs that run.
        self._put_back()
        self._thread.join()
        self._workers.close()
        self._put_back()
        try:
            self._leadership.release()
        except DatabaseUnavailable as error:
            _log.warning("the lease was not released: %s", error.message)

    def _status(self) -> dict[str, Any]:
        valid_until = self._workers.valid_until
        return {
            "server": shorten_process_id(self._leadership.process_id),
            "url": self._url,
            "location": self._workers.location,
            "workers": self._workers.count,
            "running": sorted(job_id for job_id, _ in self._workers.keys),
            "without_workers_s": round(self._workers.absent_s, 1),
            "valid_until": None if valid_until is None else valid_until.isoformat(),
            "unsent": None if self._get_failure is None else self._get_failure(),
        }

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
            known = {job_id for job_id, _ in self._active}
            queue.requeue_unknown(self._store, self._leadership.process_id, known)
            self._interrupted = False
        busy = False
        while not self._messages and self._start_next():
            busy = True
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
            except Exception:
                self._drop(key)  # and queued again
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
        limits = job.limits or Limits()
        limit_s = limits.time_s or _TIME_LIMIT_S
        self._active[key] = _ActiveJob(job, limit_s, time.monotonic() + limit_s + _START_S)
        self._send(key, job, limits.memory_mb)
        return True

    def _send(self, key: Key, job: Job, memory_mb: int | None) -> None:
        """Send the task of a job to a worker; if that fails, the reason is handled as a message."""
        try:
            if job.kind not in self._kinds:
                message = f"this version has no jobs '{job.kind}'"
                raise FlexsidError(message, code="unknown-kind")
            task = self._kinds[job.kind].prepare_task(self._store, job)
            self._workers.submit(key, job.kind, task, memory_mb)
        except DatabaseUnavailable:
            self._messages.append((key, TaskLostMessage("the database did not respond")))
            raise
        except Exception as error:
            self._messages.append((key, describe_error(error)))

    def _handle_message(self, key: Key, message: WorkerMessage) -> None:
        active = self._active.get(key)
        if active is None:  # dropped meanwhile
            return
        if isinstance(message, ProgressMessage):
            self._note_progress(active, message.progress)
            return
        job_id, attempt = key
        if isinstance(message, ComputedMessage):
            try:
                self._kinds[active.job.kind].save_outcome(self._store, active.job, message)
            except (queue.StaleAttempt, UnknownRecord) as error:
                _log.info(error.message)
        elif isinstance(message, FailedMessage):
            fail_job(self._store, active.job, message)
        elif isinstance(message, WorkerDiedMessage):
            _log.warning("job %d, attempt %d: its worker died, %s", job_id, attempt, message.reason)
            why = (
                f"the worker process died {{deaths}} times ({message.reason}),"
                " possibly for lack of memory; ask for less"
            )
            queue.retry_or_fail(self._store, job_id, attempt, why)
        else:
            queue.requeue(self._store, job_id, attempt, message.reason)
        del self._active[key]

    def _note_progress(self, active: _ActiveJob, progress: Progress | None) -> None:
        now = time.monotonic()
        if progress is None:
            active.deadline, active.log_at = now + active.limit_s, now + _LOG_S / 2
            return
        key = (active.job.id or 0, active.job.attempt)
        # In the first iterations of a diverging fit the cost is not finite.
        progress = replace(progress, cost=finite_or_none(progress.cost))
        queue.note_progress(self._store, *key, progress)
        if now >= active.log_at:
            queue.log_message(self._store, *key, progress.message)
            active.log_at = now + _LOG_S

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
        if not self._active or now - self._checked < _CHECK_S:
            return
        self._checked = now
        running = queue.find_running(self._store, list(self._active))
        for key in list(self._active):
            if key[0] not in running:
                self._drop(key)

    def _abandon(self) -> None:
        """Drop all jobs: another server has the lease and has queued them again."""
        for key in list(self._active):
            self._drop(key)
        self._messages.clear()

    def _drop(self, key: Key) -> None:
        self._workers.cancel(key)
        self._active.pop(key, None)

    def _put_back(self) -> None:
        for job_id, attempt in list(self._active):
            try:
                queue.requeue(self._store, job_id, attempt)
            except FlexsidError as error:
                # The job stays marked as running; the next server takes it over.
                _log.warning("job %d was not returned to the queue: %s", job_id, error.message)


# --- Execution of one job in this process, without server and workers -----------------------------

Request = TypeVar("Request")


def execute_run(
    store: Store, requested: EstimationRun, kind: Kind[Any, Any], report: ReportProgress
) -> EstimationRun:
    """Store a run, execute it at once and return it, succeeded or failed; see ``execute_job``."""

    def add() -> int:
        return queue.add(store, add_hashes(store, requested)).id or 0

    return store.runs.get(execute_job(store, kind, add, report).id or 0)


def execute_request(
    store: Store, kind: Kind[Request, Any], request: Request, report: ReportProgress
) -> Job:
    """Return the job of an equal request that succeeded, or execute it; see ``execute_job``."""
    job = build_job(store, kind, request)
    known = queue.find_equal(store, job.request_hash)
    if known is not None and known.state is RunState.SUCCEEDED:
        return known
    titled = replace(job, title=kind.describe(store, request))
    return execute_job(store, kind, lambda: queue.add_job(store, titled).id or 0, report)


def execute_job(
    store: Store, kind: Kind[Any, Any], add: Callable[[], int], report: ReportProgress
) -> Job:
    """Queue a job, execute it at once and return it, succeeded or failed.

    Parameters
    ----------
    store
        Store of the jobs.
    kind
        Kind of the job.
    add
        Queues the job and returns its id.
    report
        Called with the progress.

    Raises
    ------
    StaleAttempt
        If the job was cancelled, or taken over by a server that started meanwhile.
    """
    with store.transaction():  # no server claims it
        job_id = add()
        job = queue.claim(store, job_id, process_id=get_process_id())
    assert job is not None
    worker = shorten_process_id(get_process_id())
    try:
        outcome = kind.compute(kind.prepare_task(store, job), report)
        kind.save_outcome(store, job, ComputedMessage(outcome, worker))
    except StaleAttempt:
        raise
    except Exception as error:
        fail_job(store, job, describe_error(error, worker))
    except KeyboardInterrupt:
        queue.request_cancel(store, job_id)
        raise
    return store.jobs.get(job_id)
