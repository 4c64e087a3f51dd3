"""Dispatcher: takes queued runs to the workers and keeps what they bring back.

Of all servers on a database the one with the lease has the dispatcher that
works. It is the only owner of what happens to a run between queued and ended,
and it lives in a thread. What it must not forget stands in the run table, so
that a server that dies loses nothing but time.
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
from flexsid.jobs.leadership import PATIENCE_S, Leadership
from flexsid.jobs.news import (
    Begun,
    ComputedMessage,
    Died,
    Failed,
    Key,
    Lost,
    News,
    Progressed,
    unexpected,
)
from flexsid.jobs.place import short
from flexsid.jobs.steps import Steps
from flexsid.records.run import EstimationRun, Limits, Progress
from flexsid.storage import queue
from flexsid.storage.files import DatabaseUnavailable
from flexsid.storage.store import Store

_log = logging.getLogger(__name__)

_POLL_S = 0.5  # runs may also be queued or cancelled by other processes
_CHECK_S = 0.2  # between looks at what was cancelled
_LOG_S = 2.0  # between lines of what a worker says, in the log of one run
_LONGEST_S = 3600.0  # unless a run says otherwise
_EXPECTED_S = 2.0  # then what a prepared task rests on may have changed
_START_S = 60.0  # more than a worker process takes to start


class Workers(Protocol):
    """Where tasks are computed: processes of this computer, or of a cluster."""

    place: str
    count: int

    @property
    def room(self) -> int:
        """How many more tasks can start now."""
        ...

    @property
    def keys(self) -> set[Key]:
        """Tasks under way."""
        ...

    def warm_up(self) -> None:
        """Be ready for the next task."""

    def submit(self, key: Key, task: Any, memory_mb: int | None) -> None:
        """Begin a task; there must be ``room``."""

    def cancel(self, key: Key) -> None:
        """Stop a task; nothing more is heard of it."""

    def wait(self, timeout: float) -> list[tuple[Key, News]]:
        """Return what workers have to tell; at once when someone calls ``wake``."""
        ...

    def wake(self) -> None:
        """End ``wait``; may be called from any thread."""

    def close(self) -> None:
        """Stop all tasks."""


@dataclass(frozen=True, slots=True)
class _Ready:
    """A run that was started and waits for a worker."""

    key: Key
    task: Any
    limits: Limits


class Dispatcher:
    """Carries out what is queued, until it is stopped.

    Parameters
    ----------
    store
        Where runs are queued and results are kept.
    steps
        How a run is carried out.
    workers
        Who computes.
    on_change
        Called, from the dispatcher's thread, after runs have changed.
    patience_s
        After which time a server that stands still is no longer the leader.
    """

    def __init__(
        self,
        store: Store,
        steps: Steps,
        workers: Workers,
        on_change: Callable[[], None] = lambda: None,
        patience_s: float = PATIENCE_S,
    ) -> None:
        self._store = store
        self._steps = steps
        self._workers = workers
        self._on_change = on_change
        self._leadership = Leadership(store, self._status, patience_s)
        self._idle_s = min(_POLL_S, patience_s / 4)
        self._thread = threading.Thread(target=self._run, name="dispatcher", daemon=True)
        self._stopping = threading.Event()
        self._ready: deque[_Ready] = deque()
        self._expected: dict[int, tuple[float, Any]] = {}
        self._news: deque[tuple[Key, News]] = deque()
        self._limits: dict[Key, float] = {}
        self._deadlines: dict[Key, float] = {}
        self._last_logged: dict[Key, float] = {}
        self._checked = 0.0
        self._interrupted = False
        self._idle_since: float | None = None  # without a worker

    def start(self) -> None:
        """Begin, as soon as no other server leads."""
        self._thread.start()

    def wake(self) -> None:
        """Look at the queue now: something was queued or cancelled."""
        if not self._stopping.is_set():
            self._checked = 0.0
            self._workers.wake()

    def expect(self, run_id: int, task: Any) -> None:
        """Take over the task of a run that was prepared to see whether it can be done."""
        if len(self._expected) < self._workers.count:
            self._expected[run_id] = (time.monotonic(), task)
        self.wake()

    def stop(self) -> None:
        """Kill the workers and queue their runs again, for the next server."""
        if self._stopping.is_set():
            return
        self._stopping.set()
        self._workers.wake()
        self._thread.join()
        under_way = self._under_way | {key for key, _ in self._news}
        self._workers.close()
        self._put_back(under_way)
        try:
            self._leadership.release()
        except DatabaseUnavailable as error:
            _log.warning("the lease is left as it is: %s", error.message)

    @property
    def _under_way(self) -> set[Key]:
        return self._workers.keys | {ready.key for ready in self._ready}

    def _status(self) -> dict[str, Any]:
        return {
            "server": short(self._leadership.me),
            "place": self._workers.place,
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
                    self._turn()
                else:
                    self._abandon()
                    self._workers.wait(self._idle_s)
            except DatabaseUnavailable as error:
                _log.warning("%s; trying again", error.message)
                self._interrupted = True
                self._stopping.wait(_POLL_S)
            except Exception:
                _log.exception("the dispatcher goes on after an error")
                self._interrupted = True  # a run may stand as started that nobody carries out
                self._stopping.wait(_POLL_S)

    def _turn(self) -> None:
        if self._interrupted:
            known = {key[0] for key in self._under_way} | {key[0] for key, _ in self._news}
            queue.put_back_strays(self._store, self._leadership.me, known)
            self._interrupted = False
        busy = False
        while self._workers.room > 0 and (self._ready or self._prepare_next()):
            self._submit()
            busy = True
        if self._workers.count == 0:
            self._put_back_ready()
        # While they compute, the next tasks are made ready: no worker waits for them.
        if self._workers.room <= 0 and len(self._ready) < self._workers.count:
            busy = self._prepare_next() or busy
        self._workers.warm_up()
        self._news.extend(self._workers.wait(0.0 if busy else self._idle_s))
        changed = busy or bool(self._news)
        while self._news:
            key, news = self._news.popleft()
            try:
                self._take(key, news)
            except DatabaseUnavailable:
                self._news.appendleft((key, news))  # it waits until the database answers
                raise
        self._stop_what_lasts_too_long()
        self._stop_what_no_longer_counts()
        if changed:
            self._on_change()

    def _prepare_next(self) -> bool:
        """Start the next run, and have its task ready; False where none waits."""
        leadership = self._leadership
        run = queue.claim(self._store, owner=leadership.me, epoch=leadership.epoch)
        if run is None or run.id is None:
            return False
        key = (run.id, run.attempt)
        try:
            task = self._task_of(run)
        except DatabaseUnavailable:
            # As news, it waits until the database answers; told at once, it would be forgotten.
            self._news.append((key, Lost("the database did not answer")))
            raise
        except FlexsidError as error:
            self._news.append((key, Failed(error.code, error.message)))
        except Exception as error:
            self._news.append((key, unexpected(error)))
        else:
            self._ready.append(_Ready(key, task, run.limits or Limits()))
            if self._workers.room <= 0:
                waits = Progress(message="Waiting for a worker")
                queue.note_progress(self._store, *key, waits)
        return True

    def _task_of(self, run: EstimationRun) -> Any:
        now = time.monotonic()
        for number, (at, _) in list(self._expected.items()):
            if now - at > _EXPECTED_S:
                del self._expected[number]
        known = self._expected.pop(run.id or 0, None)
        return self._steps.prepare(self._store, run) if known is None else known[1]

    def _put_back_ready(self) -> None:
        """Queue again what was prepared for workers that went away."""
        for ready in self._ready:
            self._news.append((ready.key, Lost("there is no worker")))
        self._ready.clear()

    def _submit(self) -> None:
        if not self._ready:  # what was prepared could not be done
            return
        ready = self._ready.popleft()
        self._limits[ready.key] = ready.limits.time_s or _LONGEST_S
        self._deadlines[ready.key] = time.monotonic() + self._limits[ready.key] + _START_S
        try:
            self._workers.submit(ready.key, ready.task, ready.limits.memory_mb)
        except OSError as error:  # the worker was killed before it took the task
            self._news.append((ready.key, Died(str(error))))
        except Exception as error:
            self._news.append((ready.key, unexpected(error)))

    def _take(self, key: Key, news: News) -> None:
        run_id, attempt = key
        if isinstance(news, Begun):
            if key in self._limits:
                self._deadlines[key] = time.monotonic() + self._limits[key]
            return
        if isinstance(news, Progressed):
            now = time.monotonic()
            queue.note_progress(self._store, run_id, attempt, _presentable(news.progress))
            if now - self._last_logged.get(key, now - _LOG_S / 2) >= _LOG_S:
                queue.say(self._store, run_id, attempt, news.progress.message)
                self._last_logged[key] = now
            self._last_logged.setdefault(key, now - _LOG_S / 2)
            return
        if isinstance(news, ComputedMessage):
            news = self._keep(key, news) or news
        if isinstance(news, Failed):
            if news.trace:
                _log.error("run %d, attempt %d:\n%s", run_id, attempt, news.trace)
            queue.fail(self._store, run_id, attempt, news.code, news.message, news.worker or None)
        elif isinstance(news, Died):
            _log.warning("run %d, attempt %d: its worker died, %s", run_id, attempt, news.how)
            queue.retry_or_fail(
                self._store,
                run_id,
                attempt,
                f"the worker process died {{deaths}} times ({news.how}),"
                " perhaps for want of memory; try a smaller model",
            )
        elif isinstance(news, Lost):
            queue.put_back(self._store, run_id, attempt, news.why)
        self._forget(key)

    def _keep(self, key: Key, news: ComputedMessage) -> Failed | None:
        run_id, attempt = key
        try:
            self._steps.keep(self._store, run_id, attempt, news.outcome, news.worker)
        except queue.StaleAttempt as error:
            _log.info(error.message)
        except DatabaseUnavailable:
            raise
        except FlexsidError as error:
            return Failed(error.code, error.message, worker=news.worker)
        except Exception as error:
            return unexpected(error)
        return None

    def _stop_what_lasts_too_long(self) -> None:
        now = time.monotonic()
        for key in [key for key, deadline in self._deadlines.items() if now >= deadline]:
            self._workers.cancel(key)
            limit = self._limits[key]
            message = f"it took longer than {limit:g} s; try a smaller model or a higher limit"
            self._take(key, Failed("time-limit", message))

    def _stop_what_no_longer_counts(self) -> None:
        now = time.monotonic()
        under_way = self._under_way
        if not under_way or now - self._checked < _CHECK_S:
            return
        self._checked = now
        counting = queue.still_running(self._store, under_way)
        for key in under_way:
            if key[0] not in counting:
                self._drop(key)

    def _abandon(self) -> None:
        """Stop everything: another server has the lease, and has queued it again."""
        for key in self._under_way:
            self._drop(key)
        self._news.clear()

    def _drop(self, key: Key) -> None:
        self._workers.cancel(key)
        self._ready = deque(ready for ready in self._ready if ready.key != key)
        self._forget(key)

    def _forget(self, key: Key) -> None:
        self._last_logged.pop(key, None)
        self._deadlines.pop(key, None)
        self._limits.pop(key, None)

    def _put_back(self, keys: set[Key]) -> None:
        for run_id, attempt in keys:
            try:
                queue.put_back(self._store, run_id, attempt)
            except FlexsidError as error:
                # It stays marked as running; the next server takes it over.
                _log.warning("run %d is left as it is: %s", run_id, error.message)


def _presentable(progress: Progress) -> Progress:
    """Drop a cost that is no number, as in the first steps of a fit that diverges."""
    if progress.cost is None or math.isfinite(progress.cost):
        return progress
    return replace(progress, cost=None)
