"""Workers of a Dask cluster.

Each task runs in a child process of the Dask worker, as on a single computer: it can be
killed, its memory is limited, and a crash does not end the Dask worker.
"""

from __future__ import annotations

import logging
import queue
import threading
import time
import uuid
from contextlib import suppress
from dataclasses import asdict, replace
from typing import Any

from flexsid.errors import FlexsidError
from flexsid.jobs.child import Child, pickle_task, take_child
from flexsid.jobs.dispatcher import Workers
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
from flexsid.jobs.worker import LoadKinds
from flexsid.records.run import Progress

_log = logging.getLogger(__name__)

_CONNECT_S = 10.0
_POLL_S = 1.0  # between polls of the number of workers
_NO_WORKER_S = 5.0  # without a worker; a restart by the Dask nanny takes less
_FETCH_S = 30.0
_CLOSE_S = 2.0
_CANCEL_CHECK_S = 0.05  # between checks whether a task was cancelled


class ClusterWorkers(Workers):
    """Submits tasks to the threads of a Dask cluster, at most one task per thread.

    All methods except ``wake`` must be called from one thread.

    Parameters
    ----------
    load_kinds
        Function that returns the kinds of jobs; the workers of the cluster import it.
    address
        Address of the scheduler, e.g. ``tcp://127.0.0.1:8786``.

    Raises
    ------
    FlexsidError
        If Dask is not installed, or no scheduler responds.
    """

    def __init__(self, load_kinds: LoadKinds, address: str) -> None:
        self.location = f"Dask cluster {address}"
        self.count = 0
        self._load_kinds = load_kinds
        self._address = address
        self._messages: queue.SimpleQueue[tuple[Key, WorkerMessage] | None] = queue.SimpleQueue()
        self._futures: dict[Key, Any] = {}  # None: lost, not yet reported
        self._fetching = threading.Lock()
        self._topic = f"flexsid-{uuid.uuid4().hex}"
        self._updated = -_POLL_S
        self._no_worker_since: float | None = None
        self._client: Any = None
        self._connect()

    @property
    def free_slots(self) -> int:
        """Number of further tasks that can start now; none while the scheduler is unreachable."""
        self._update_count()
        return self.count - len(self._futures)

    @property
    def keys(self) -> set[Key]:
        """Keys of the running tasks."""
        return set(self._futures)

    def submit(self, key: Key, kind: str, task: Any, memory_mb: int | None) -> None:
        """Start a task; requires ``free_slots`` above zero."""
        future = self._client.submit(
            execute_in_child,
            self._load_kinds,
            pickle_task(kind, task, memory_mb),
            (self._topic, key),
            key=f"flexsid-{uuid.uuid4().hex}",
            pure=False,
        )
        self._futures[key] = future
        future.add_done_callback(lambda done: self._receive_result(key, done))

    def cancel(self, key: Key) -> None:
        """Stop a task; the Dask worker detects the released future."""
        future = self._futures.pop(key, None)
        if future is not None:
            future.release()

    def wait(self, timeout: float) -> list[tuple[Key, WorkerMessage]]:
        """Return new messages of the workers; return at once after ``wake``."""
        messages: list[tuple[Key, WorkerMessage]] = []
        with suppress(queue.Empty):
            message = self._messages.get(timeout > 0, timeout)
            while True:
                if message is not None and message[0] in self._futures:
                    messages.append(message)
                    if not isinstance(message[1], ProgressMessage):
                        del self._futures[message[0]]
                message = self._messages.get_nowait()
        return messages

    def wake(self) -> None:
        """End ``wait``; thread-safe."""
        self._messages.put(None)

    def close(self) -> None:
        """Release all tasks and close the connection."""
        self._futures.clear()
        self._disconnect(_CLOSE_S)

    def _connect(self) -> Any:
        try:
            from distributed import Client
        except ImportError as error:
            raise FlexsidError(
                "a Dask cluster needs the extra `dask`: pip install 'flexsid[dask]'",
                code="missing-extra",
            ) from error
        try:
            self._client = Client(
                self._address, timeout=_CONNECT_S, set_as_default=False, name="flexsid"
            )
            self._client.subscribe_topic(self._topic, self._receive_progress)
            return self._client
        except (OSError, TimeoutError, ValueError) as error:
            self._client = None
            raise FlexsidError(
                f"no Dask scheduler responds at {self._address} ({error}); start one with"
                " `dask scheduler --host 127.0.0.1`, or leave FLEXSID_DASK empty",
                code="no-scheduler",
            ) from error

    def _update_count(self) -> None:
        """Update the number of threads; reconnect if the connection was lost."""
        now = time.monotonic()
        if now - self._updated < _POLL_S:
            return
        self._updated = now
        try:
            client = self._client
            if client is None or client.status != "running":
                self._drop_connection()
                client = self._connect()
            self.count = sum(client.nthreads().values())
        except (FlexsidError, OSError, TimeoutError) as error:
            _log.warning("the Dask cluster is unreachable: %s", error)
            self.count = 0
        if self.count > 0:
            self._no_worker_since = None
        elif self._no_worker_since is None:
            self._no_worker_since = now
        elif now - self._no_worker_since >= _NO_WORKER_S:
            # The scheduler would hold them for a worker that may never connect.
            self._lose_tasks("the Dask cluster has no worker")

    def _drop_connection(self) -> None:
        """Report every task as lost and close the old connection."""
        self._lose_tasks("the connection to the Dask scheduler was lost")
        self._disconnect(0.0)

    def _lose_tasks(self, reason: str) -> None:
        for key, future in self._futures.items():
            if future is not None:
                self._futures[key] = None
                self._messages.put((key, TaskLostMessage(reason)))

    def _disconnect(self, timeout: float) -> None:
        """Close the connection after any result that is being fetched over it."""
        if self._client is None:
            return
        if self._fetching.acquire(timeout=timeout):
            self._fetching.release()
        self._client.close(timeout=timeout)
        self._client = None

    def _receive_result(self, key: Key, future: Any) -> None:
        """Fetch the result of a task that was not cancelled, on Dask's callback thread.

        Closing a connection ends all its futures, which must not be used afterwards.
        """
        with self._fetching:
            if self._futures.get(key) is future:
                self._messages.put((key, _fetch_result(future)))

    def _receive_progress(self, event: Any) -> None:
        """Queue a progress message of a worker, on Dask's event thread."""
        _, (job_id, attempt, progress) = event
        message = ProgressMessage(None if progress is None else Progress(**progress))
        self._messages.put(((job_id, attempt), message))


def _fetch_result(future: Any) -> WorkerMessage:
    """Return the result of a task, or why it has none."""
    from distributed import KilledWorker
    from distributed.client import FutureCancelledError

    try:
        return future.result(timeout=_FETCH_S)
    except KilledWorker as error:
        return WorkerDiedMessage(f"on {error.last_worker.address}")
    except (FutureCancelledError, OSError, TimeoutError) as error:
        return TaskLostMessage(f"the Dask cluster dropped the task ({type(error).__name__})")
    except Exception as error:
        return describe_error(error)


_idle: list[Child] = []


def execute_in_child(load_kinds: LoadKinds, content: bytes, name: tuple[str, Key]) -> WorkerMessage:
    """Compute one task in a child process of this Dask worker.

    Returns when the task has ended or was cancelled.
    """
    from distributed import get_worker

    worker = get_worker()
    own = worker.get_current_task()
    topic, (job_id, attempt) = name
    child = take_child(_idle, load_kinds)
    child.connection.send_bytes(content)
    while True:
        if not child.connection.poll(_CANCEL_CHECK_S):
            present = worker.state.tasks.get(own)
            if present is None or present.state != "executing":
                child.kill()
                return TaskLostMessage("the task was cancelled")
            continue
        message = child.receive()
        if isinstance(message, ProgressMessage):
            progress = None if message.progress is None else asdict(message.progress)
            worker.log_event(topic, (job_id, attempt, progress))
            continue
        if isinstance(message, WorkerDiedMessage):
            child.kill()
            return message
        _idle.append(child)
        is_end = isinstance(message, ComputedMessage | FailedMessage)
        return replace(message, worker=worker.address) if is_end else message
