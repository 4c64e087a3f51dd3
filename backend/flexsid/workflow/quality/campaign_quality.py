"""Data quality of a whole campaign, assessed in processes beside the server."""

from __future__ import annotations

import logging
import multiprocessing
import os
import threading
from collections.abc import Sequence
from concurrent.futures import Future, ProcessPoolExecutor
from dataclasses import dataclass

from threadpoolctl import threadpool_limits

from flexsid.errors import FlexsidError
from flexsid.storage.quality_list import list_unassessed
from flexsid.storage.store import Store
from flexsid.workflow.quality.maneuver_quality import get_maneuver_quality

_log = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True, kw_only=True)
class Assessing:
    """Progress of the assessment of a campaign."""

    running: bool
    done: int
    total: int
    failed: int


_MOST_PROCESSES = 8
_NICENESS = 10  # requests have priority


class CampaignAssessment:
    """Assesses maneuvers in processes beside the server, on all processors but one.

    Every result is stored at once, so that none is lost when the server stops.
    """

    def __init__(self, store: Store, url: str) -> None:
        self._store = store
        self._url = url
        self._lock = threading.Lock()
        self._pool: ProcessPoolExecutor | None = None
        self._released: list[ProcessPoolExecutor] = []
        self._waiting: set[int] = set()
        self._total = self._done = self._failed = 0

    def start(self, maneuver_ids: Sequence[int] | None = None) -> Assessing:
        """Assess these maneuvers, or all that are not assessed."""
        if maneuver_ids is None:
            with self._store.database.reading() as connection:
                maneuver_ids = list_unassessed(connection)
        with self._lock:
            new = [number for number in maneuver_ids if number not in self._waiting]
            if new and self._pool is None:
                context = multiprocessing.get_context("spawn")
                self._pool = ProcessPoolExecutor(
                    _processes(len(new)),
                    mp_context=context,
                    initializer=_prepare,
                    initargs=(self._url,),
                )
                self._total = self._done = self._failed = 0
            for number in new:
                assert self._pool is not None
                self._waiting.add(number)
                self._total += 1
                future = self._pool.submit(_assess, number)
                future.add_done_callback(lambda done, number=number: self._ended(number, done))
        return self.state()

    def state(self) -> Assessing:
        """Return the progress."""
        with self._lock:
            return Assessing(
                running=bool(self._waiting),
                done=self._done,
                total=self._total,
                failed=self._failed,
            )

    def cancel(self) -> None:
        """Cancel maneuvers that wait; running assessments still store their results."""
        with self._lock:
            pool, self._pool = self._pool, None
            self._waiting.clear()
        if pool is not None:
            pool.shutdown(wait=False, cancel_futures=True)
            self._released.append(pool)

    def stop(self) -> None:
        """Cancel maneuvers that wait, and end the processes."""
        self.cancel()
        for pool in self._released:
            pool.shutdown(wait=True)

    def _ended(self, number: int, future: Future[None]) -> None:
        with self._lock:
            if number not in self._waiting:
                return  # it was cancelled
            self._waiting.discard(number)
            self._done += 1
            if future.cancelled():
                return
            error = future.exception()
            if error is not None:
                self._failed += 1
                _log.warning("the quality of maneuver %d was not assessed: %s", number, error)
            idle = not self._waiting
            pool = self._pool if idle else None
            if idle:
                self._pool = None
        if pool is not None:
            pool.shutdown(wait=False)


def _processes(n_maneuvers: int) -> int:
    return max(1, min(_MOST_PROCESSES, n_maneuvers, (os.cpu_count() or 2) - 1))


_opened: list[Store] = []  # the store of an assessing process


def _prepare(url: str) -> None:
    """Open the store once in a process that has its own connection."""
    if hasattr(os, "nice"):
        os.nice(_NICENESS)
    threadpool_limits(1)
    _opened.append(Store.open(url))


def _assess(maneuver_id: int) -> None:
    """Assess one maneuver."""
    try:
        get_maneuver_quality(_opened[0], maneuver_id)
    except FlexsidError as error:
        raise RuntimeError(error.message) from error  # FlexsidError cannot be pickled
