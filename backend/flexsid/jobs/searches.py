"""Searches for structure: one after the other, each in a worker process of its own.

What must not be forgotten stands in the table of searches, so that a server that is
started anew goes on with what another left.
"""

from __future__ import annotations

import logging
import threading
import time
from concurrent.futures import ThreadPoolExecutor

from flexsid.errors import Cancelled, FlexsidError
from flexsid.jobs.local import LocalWorkers
from flexsid.jobs.news import ComputedMessage, Died, Failed, Progressed, unexpected
from flexsid.records.run import RunState
from flexsid.records.search import SearchResult, StructureSearch
from flexsid.storage.store import Store

_log = logging.getLogger(__name__)

_LOOK_S = 0.3  # between looks whether a search was cancelled, and writes of its progress


class Searches:
    """The searches of one server."""

    def __init__(self, store: Store) -> None:
        self._store = store
        self._stopping = threading.Event()
        self._thread = ThreadPoolExecutor(1, thread_name_prefix="search")

    def start(self) -> None:
        """Go on with what a server before this one left."""
        for state in (RunState.RUNNING, RunState.QUEUED):
            for left in self._store.searches.find(state=state):
                self.begin(left)

    def begin(self, wanted: StructureSearch) -> None:
        """Carry out a search as soon as those before it have ended."""
        if wanted.id is not None:
            self._thread.submit(self._carry_out, wanted.id)

    def stop(self) -> None:
        """Kill the worker; the search starts again with the next server."""
        self._stopping.set()
        self._thread.shutdown(wait=True, cancel_futures=True)

    def _carry_out(self, search_id: int) -> None:
        from flexsid.workflow.structure_determination import searches

        try:
            searches.carry_out_search(
                self._store, search_id, lambda task: self._in_worker(search_id, task)
            )
        except _Stopped:
            _log.info("search %d is left to the next server", search_id)
        except Cancelled:
            _log.info("search %d was cancelled", search_id)
        except FlexsidError as error:
            _log.warning("search %d: %s", search_id, error.message)
            searches.fail_search(self._store, search_id, error.code, error.message)
        except Exception as error:
            _log.exception("search %d", search_id)
            failed = unexpected(error)
            searches.fail_search(self._store, search_id, failed.code, failed.message)

    def _in_worker(self, search_id: int, task: object) -> SearchResult:
        from flexsid.workflow.structure_determination import searches

        workers = LocalWorkers(searches.search, 1)
        try:
            workers.submit((search_id, 1), task, None)
            told, waiting = None, True
            looked = time.monotonic()
            while waiting:
                for _, news in workers.wait(_LOOK_S):
                    if isinstance(news, ComputedMessage):
                        return news.outcome
                    if isinstance(news, Failed):
                        raise FlexsidError(news.message, code=news.code)
                    if isinstance(news, Died):
                        raise FlexsidError(
                            f"the worker process died ({news.how}), perhaps for want of memory; "
                            "search over fewer maneuvers",
                            code="worker-died",
                        )
                    if isinstance(news, Progressed):
                        told = news.progress
                if self._stopping.is_set():
                    raise _Stopped
                if time.monotonic() - looked >= _LOOK_S:
                    looked = time.monotonic()
                    if told is not None:
                        waiting = searches.note_progress(self._store, search_id, told)
                        told = None
                    else:
                        waiting = self._store.searches.get(search_id).state is RunState.RUNNING
            raise Cancelled("The search was cancelled.")
        finally:
            workers.close()


class _Stopped(Exception):
    """The server stops."""
