"""Execution of model structure searches, one at a time, each in a worker process.

Their state is in the table of searches, so that the next server resumes unfinished ones.
"""

from __future__ import annotations

import logging
import threading
import time
from concurrent.futures import ThreadPoolExecutor

from flexsid.errors import Cancelled, FlexsidError
from flexsid.jobs.local import LocalWorkers
from flexsid.jobs.messages import (
    ComputedMessage,
    FailedMessage,
    ProgressMessage,
    WorkerDiedMessage,
    describe_unexpected_error,
)
from flexsid.records.run import RunState
from flexsid.records.search import SearchResult, StructureSearch
from flexsid.storage.store import Store

_log = logging.getLogger(__name__)

_POLL_S = 0.3  # between checks for cancellation and updates of the progress


class Searches:
    """Executor of the model structure searches of one server."""

    def __init__(self, store: Store) -> None:
        self._store = store
        self._stopping = threading.Event()
        self._thread = ThreadPoolExecutor(1, thread_name_prefix="search")

    def start(self) -> None:
        """Resume the searches that a previous server left unfinished."""
        for state in (RunState.RUNNING, RunState.QUEUED):
            for search in self._store.searches.find(state=state):
                self.submit(search)

    def submit(self, search: StructureSearch) -> None:
        """Queue a search behind those submitted before."""
        if search.id is not None:
            self._thread.submit(self._execute, search.id)

    def stop(self) -> None:
        """Kill the worker; the next server restarts the search."""
        self._stopping.set()
        self._thread.shutdown(wait=True, cancel_futures=True)

    def _execute(self, search_id: int) -> None:
        from flexsid.workflow.structure_determination import searches

        try:
            searches.run_search(
                self._store, search_id, lambda task: self._compute_in_worker(search_id, task)
            )
        except _Stopped:
            _log.info("search %d is resumed by the next server", search_id)
        except Cancelled:
            _log.info("search %d was cancelled", search_id)
        except FlexsidError as error:
            _log.warning("search %d: %s", search_id, error.message)
            searches.fail_search(self._store, search_id, error.code, error.message)
        except Exception as error:
            _log.exception("search %d", search_id)
            failed = describe_unexpected_error(error)
            searches.fail_search(self._store, search_id, failed.code, failed.message)

    def _compute_in_worker(self, search_id: int, task: object) -> SearchResult:
        from flexsid.workflow.structure_determination import searches

        workers = LocalWorkers(searches.compute_search, 1)
        try:
            workers.submit((search_id, 1), task, None)
            progress, is_running = None, True
            checked = time.monotonic()
            while is_running:
                for _, message in workers.wait(_POLL_S):
                    if isinstance(message, ComputedMessage):
                        return message.outcome
                    if isinstance(message, FailedMessage):
                        raise FlexsidError(message.message, code=message.code)
                    if isinstance(message, WorkerDiedMessage):
                        raise FlexsidError(
                            f"the worker process died ({message.reason}), possibly for lack of"
                            " memory; search over fewer maneuvers",
                            code="worker-died",
                        )
                    if isinstance(message, ProgressMessage):
                        progress = message.progress
                if self._stopping.is_set():
                    raise _Stopped
                if time.monotonic() - checked >= _POLL_S:
                    checked = time.monotonic()
                    if progress is not None:
                        is_running = searches.store_progress(self._store, search_id, progress)
                        progress = None
                    else:
                        is_running = self._store.searches.get(search_id).state is RunState.RUNNING
            raise Cancelled("The search was cancelled.")
        finally:
            workers.close()


class _Stopped(Exception):
    """The server is stopping."""
