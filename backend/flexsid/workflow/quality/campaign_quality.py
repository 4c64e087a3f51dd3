"""Assessing: the quality of a whole campaign, one maneuver after the other beside the server."""

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
from flexsid.storage.quality_list import unassessed
from flexsid.storage.store import Store
from flexsid.workflow.quality.maneuver_quality import quality

_log = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True, kw_only=True)
class Assessing:
    """How far the assessment of a campaign is."""

    running: bool
    done: int
    total: int
    failed: int


_MOST_PROCESSES = 8
_NICENESS = 10  # who waits for an answer goes first


class Assessments:
    """Looks at maneuvers beside the server, on all processors but one.

    Everything found is kept at once, so that nothing is lost when the server stops.
    """

    def __init__(self, store: Store, url: str) -> None:
        self._store = store
        self._url = url
        self._lock = threading.Lock()
        self._pool: ProcessPoolExecutor | None = None
        self._left: list[ProcessPoolExecutor] = []
        self._waiting: set[int] = set()
        self._total = self._done = self._failed = 0

    def begin(self, maneuver_ids: Sequence[int] | None = None) -> Assessing:
        """Look at these maneuvers, or at all that nobody has looked at."""
        if maneuver_ids is None:
            with self._store.database.reading() as connection:
                maneuver_ids = unassessed(connection)
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
        """How far it is."""
        with self._lock:
            return Assessing(
                running=bool(self._waiting),
                done=self._done,
                total=self._total,
                failed=self._failed,
            )

    def leave(self) -> None:
        """Leave the rest for another time; what is being looked at is still kept."""
        with self._lock:
            pool, self._pool = self._pool, None
            self._waiting.clear()
        if pool is not None:
            pool.shutdown(wait=False, cancel_futures=True)
            self._left.append(pool)

    def stop(self) -> None:
        """Leave the rest for another time, and end the processes."""
        self.leave()
        for pool in self._left:
            pool.shutdown(wait=True)

    def _ended(self, number: int, future: Future[None]) -> None:
        with self._lock:
            if number not in self._waiting:
                return  # it was left
            self._waiting.discard(number)
            self._done += 1
            if future.cancelled():
                return
            error = future.exception()
            if error is not None:
                self._failed += 1
                _log.warning("the quality of maneuver %d was not found: %s", number, error)
            idle = not self._waiting
            pool = self._pool if idle else None
            if idle:
                self._pool = None
        if pool is not None:
            pool.shutdown(wait=False)


def _processes(n_maneuvers: int) -> int:
    return max(1, min(_MOST_PROCESSES, n_maneuvers, (os.cpu_count() or 2) - 1))


_opened: list[Store] = []  # the connection of a process that looks at maneuvers


def _prepare(url: str) -> None:
    """Open the store once in a process that has its own connection."""
    if hasattr(os, "nice"):
        os.nice(_NICENESS)
    threadpool_limits(1)
    _opened.append(Store.open(url))


def _assess(maneuver_id: int) -> None:
    """Look at one maneuver."""
    try:
        quality(_opened[0], maneuver_id)
    except FlexsidError as error:
        raise RuntimeError(error.message) from error  # ours do not survive the way back
