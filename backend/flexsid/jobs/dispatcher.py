"""Dispatcher: takes queued runs to the workers and keeps what they bring back.

It is the only owner of what happens to a run between queued and ended, and it
lives in a thread of the server. What it must not forget stands in the run
table, so that a server that dies loses nothing but time.
"""

from __future__ import annotations

import logging
import math
import threading
import time
from collections import deque
from dataclasses import replace

from flexsid.errors import FlexsidError
from flexsid.jobs.local import Died, Key, LocalWorkers
from flexsid.jobs.steps import Steps
from flexsid.jobs.worker import Computed, Failed, News, Progressed, unexpected
from flexsid.records.run import Progress
from flexsid.storage import queue
from flexsid.storage.database import DatabaseUnavailable
from flexsid.storage.store import Store

_log = logging.getLogger(__name__)

_POLL_S = 1.0  # runs may also be queued or cancelled by other processes
_PROGRESS_S = 0.2  # between writes of the progress of one run


class Dispatcher:
    """Carries out what is queued, until it is stopped.

    Parameters
    ----------
    store
        Where runs are queued and results are kept.
    steps
        How a run is carried out.
    count
        Worker processes; by default one less than there are cores.
    """

    def __init__(self, store: Store, steps: Steps, count: int | None = None) -> None:
        self._store = store
        self._steps = steps
        self._workers = LocalWorkers(steps.compute, count)
        self._thread = threading.Thread(target=self._run, name="dispatcher", daemon=True)
        self._stopping = threading.Event()
        self._news: deque[tuple[Key, News | Died]] = deque()
        self._last_written: dict[Key, float] = {}

    def start(self) -> None:
        """Take over what a server before this one left, then begin."""
        left = queue.take_over(self._store)
        if left:
            _log.info("%d runs that were under way when the server stopped start again", left)
        self._thread.start()

    def wake(self) -> None:
        """Look at the queue now: something was queued or cancelled."""
        if not self._stopping.is_set():
            self._workers.wake()

    def stop(self) -> None:
        """Kill the workers and queue their runs again, for the next server."""
        if self._stopping.is_set():
            return
        self._stopping.set()
        self._workers.wake()
        self._thread.join()
        under_way = self._workers.keys | {key for key, _ in self._news}
        self._workers.close()
        self._put_back(under_way)

    def _run(self) -> None:
        while not self._stopping.is_set():
            try:
                self._turn()
            except DatabaseUnavailable as error:
                _log.warning("%s; trying again", error.message)
                self._stopping.wait(_POLL_S)
            except Exception:
                _log.exception("the dispatcher goes on after an error")
                self._stopping.wait(_POLL_S)

    def _turn(self) -> None:
        while self._workers.room and self._assign_next():
            pass
        self._workers.warm_up()
        self._news.extend(self._workers.wait(_POLL_S))
        while self._news:
            key, news = self._news.popleft()
            try:
                self._take(key, news)
            except DatabaseUnavailable:
                self._news.appendleft((key, news))  # it waits until the database answers
                raise
        under_way = self._workers.keys
        if under_way:
            counting = queue.still_running(self._store, under_way)
            for key in under_way:
                if key[0] not in counting:
                    self._workers.cancel(key)
                    self._last_written.pop(key, None)

    def _assign_next(self) -> bool:
        run = queue.claim(self._store)
        if run is None or run.id is None:
            return False
        key = (run.id, run.attempt)
        try:
            self._workers.submit(key, self._steps.prepare(self._store, run))
        except DatabaseUnavailable:
            self._put_back({key})
            raise
        except FlexsidError as error:
            self._take(key, Failed(error.code, error.message))
        except Exception as error:
            self._take(key, unexpected(error))
        return True

    def _take(self, key: Key, news: News | Died) -> None:
        run_id, attempt = key
        if isinstance(news, Progressed):
            now = time.monotonic()
            if now - self._last_written.get(key, -_PROGRESS_S) >= _PROGRESS_S:
                self._last_written[key] = now
                queue.note_progress(self._store, run_id, attempt, _presentable(news.progress))
            return
        self._last_written.pop(key, None)
        if isinstance(news, Computed):
            news = self._keep(key, news) or news
        if isinstance(news, Failed):
            if news.trace:
                _log.error("run %d, attempt %d:\n%s", run_id, attempt, news.trace)
            queue.fail(self._store, run_id, attempt, news.code, news.message)
        elif isinstance(news, Died):
            _log.warning(
                "run %d, attempt %d: its worker died, exit code %s", run_id, attempt, news.exit_code
            )
            queue.retry_or_fail(
                self._store,
                run_id,
                attempt,
                f"the worker process died {attempt} times (exit code {news.exit_code}),"
                " perhaps for want of memory; try a smaller model",
            )

    def _keep(self, key: Key, news: Computed) -> Failed | None:
        run_id, attempt = key
        try:
            self._steps.keep(self._store, run_id, attempt, news.outcome)
        except queue.StaleAttempt as error:
            _log.info(error.message)
        except DatabaseUnavailable:
            raise
        except FlexsidError as error:
            return Failed(error.code, error.message)
        except Exception as error:
            return unexpected(error)
        return None

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
