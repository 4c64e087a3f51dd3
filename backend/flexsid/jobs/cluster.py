"""Workers of a Dask cluster.

Each task has a worker process of its own below the Dask worker, just as on one
computer: so it can be killed, is held to its memory, and a crash in it does not
take the Dask worker along.
"""

from __future__ import annotations

import logging
import pickle
import queue
import threading
import time
import uuid
from dataclasses import asdict, replace
from typing import Any

from flexsid.errors import FlexsidError
from flexsid.jobs.child import Child
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
from flexsid.jobs.worker import Compute
from flexsid.records.run import Progress

_log = logging.getLogger(__name__)

_CONNECT_S = 10.0
_LOOK_S = 1.0  # between looks at who is there
_ALONE_S = 5.0  # without a worker; one that is started again by its nanny is away for less
_FETCH_S = 30.0
_CLOSE_S = 2.0
_WATCH_S = 0.05  # between looks whether a task is still wanted


class ClusterWorkers:
    """Hands tasks to the threads of a cluster, never more than there are.

    All methods but ``wake`` are for one thread.

    Parameters
    ----------
    compute
        What a task is given to; the cluster's workers import it.
    address
        Of the scheduler, e.g. ``tcp://127.0.0.1:8786``.

    Raises
    ------
    FlexsidError
        If Dask is not installed, or no scheduler answers.
    """

    def __init__(self, compute: Compute, address: str) -> None:
        self.place = f"Dask cluster {address}"
        self.count = 0
        self._compute = compute
        self._address = address
        self._said: queue.SimpleQueue[tuple[Key, News] | None] = queue.SimpleQueue()
        self._futures: dict[Key, Any] = {}  # None: given up, which is still to be told
        self._fetching = threading.Lock()
        self._topic = f"flexsid-{uuid.uuid4().hex}"
        self._looked = -_LOOK_S
        self._alone_since: float | None = None
        self._client: Any = None
        self._connect()

    @property
    def room(self) -> int:
        """How many more tasks can start now; none while the scheduler is away."""
        self._look()
        return self.count - len(self._futures)

    @property
    def keys(self) -> set[Key]:
        """Tasks under way."""
        return set(self._futures)

    def warm_up(self) -> None:
        """Do nothing: the cluster keeps its processes."""

    def submit(self, key: Key, task: Any, memory_mb: int | None) -> None:
        """Begin a task; there must be ``room``."""
        future = self._client.submit(
            compute_in_child,
            self._compute,
            pickle.dumps((task, memory_mb), pickle.HIGHEST_PROTOCOL),
            (self._topic, key),
            key=f"flexsid-{uuid.uuid4().hex}",
            pure=False,
        )
        self._futures[key] = future
        future.add_done_callback(lambda done: self._take(key, done))

    def cancel(self, key: Key) -> None:
        """Stop a task; the Dask worker notices that it is no longer wanted."""
        future = self._futures.pop(key, None)
        if future is not None:
            future.release()

    def wait(self, timeout: float) -> list[tuple[Key, News]]:
        """Return what workers have to tell; at once when someone calls ``wake``."""
        news: list[tuple[Key, News]] = []
        try:
            said = self._said.get(timeout=timeout) if timeout > 0 else self._said.get_nowait()
            while True:
                if said is not None and said[0] in self._futures:
                    news.append(said)
                    if not isinstance(said[1], Begun | Progressed):
                        del self._futures[said[0]]
                said = self._said.get_nowait()
        except queue.Empty:
            return news

    def wake(self) -> None:
        """End ``wait``; may be called from any thread."""
        self._said.put(None)

    def close(self) -> None:
        """Let go of all tasks."""
        self._futures.clear()
        self._take_leave(_CLOSE_S)

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
            self._client.subscribe_topic(self._topic, self._hear)
            return self._client
        except (OSError, TimeoutError, ValueError) as error:
            self._client = None
            raise FlexsidError(
                f"no Dask scheduler answers at {self._address} ({error}); start one with"
                " `dask scheduler --host 127.0.0.1`, or leave FLEXSID_DASK empty",
                code="no-scheduler",
            ) from error

    def _look(self) -> None:
        """Count the threads that are there, and connect again where the scheduler was away."""
        now = time.monotonic()
        if now - self._looked < _LOOK_S:
            return
        self._looked = now
        try:
            client = self._client
            if client is None or client.status != "running":
                self._give_up_tasks()
                client = self._connect()
            self.count = sum(client.nthreads().values())
        except (FlexsidError, OSError, TimeoutError) as error:
            _log.warning("the cluster is away: %s", error)
            self.count = 0
        if self.count > 0:
            self._alone_since = None
        elif self._alone_since is None:
            self._alone_since = now
        elif now - self._alone_since >= _ALONE_S:
            # The scheduler would keep them for a worker that may never come.
            self._lose_tasks("the cluster has no worker")

    def _give_up_tasks(self) -> None:
        """Say of every task that it was lost, and take leave of the old connection."""
        self._lose_tasks("the scheduler of the cluster went away")
        self._take_leave(0.0)

    def _lose_tasks(self, why: str) -> None:
        for key, future in self._futures.items():
            if future is not None:
                self._futures[key] = None
                self._said.put((key, Lost(why)))

    def _take_leave(self, timeout: float) -> None:
        """Close the connection, but not below a result that is being fetched over it."""
        if self._client is None:
            return
        if self._fetching.acquire(timeout=timeout):
            self._fetching.release()
        self._client.close(timeout=timeout)
        self._client = None

    def _take(self, key: Key, future: Any) -> None:
        """Fetch what a task came to, on Dask's thread for that, if it is still wanted.

        Closing a connection ends all futures of it, and nothing may be asked of
        these any more.
        """
        with self._fetching:
            if self._futures.get(key) is future:
                self._said.put((key, _outcome(future)))

    def _hear(self, event: Any) -> None:
        """Take what a worker said of its progress, on Dask's own thread."""
        _, (run_id, attempt, progress) = event
        news = Begun() if progress is None else Progressed(Progress(**progress))
        self._said.put(((run_id, attempt), news))


def _outcome(future: Any) -> News:
    """What became of a task."""
    from distributed import KilledWorker
    from distributed.client import FutureCancelledError

    try:
        return future.result(timeout=_FETCH_S)
    except KilledWorker as error:
        return Died(f"on {error.last_worker.address}")
    except (FutureCancelledError, OSError, TimeoutError) as error:
        return Lost(f"the cluster dropped it ({type(error).__name__})")
    except Exception as error:
        return unexpected(error)


_idle: list[tuple[Compute, Child]] = []


def compute_in_child(compute: Compute, content: bytes, name: tuple[str, Key]) -> News:
    """Carry out one task in a process below this Dask worker.

    It ends when the task does, or as soon as nobody waits for it any more.
    """
    from distributed import get_worker

    worker = get_worker()
    own = worker.get_current_task()
    topic, (run_id, attempt) = name
    child = _idle_child(compute)
    child.connection.send_bytes(content)
    while True:
        if not child.connection.poll(_WATCH_S):
            present = worker.state.tasks.get(own)
            if present is None or present.state != "executing":
                child.kill()
                return Lost("nobody waits for it")
            continue
        news = child.listen()
        if isinstance(news, Begun | Progressed):
            said = asdict(news.progress) if isinstance(news, Progressed) else None
            worker.log_event(topic, (run_id, attempt, said))
            continue
        if isinstance(news, Died):
            child.kill()
            return news
        _idle.append((compute, child))
        return (
            replace(news, worker=worker.address)
            if isinstance(news, ComputedMessage | Failed)
            else news
        )


def _idle_child(compute: Compute) -> Child:
    while _idle:
        known, child = _idle.pop()
        if known is compute and not child.connection.poll():
            return child
        child.kill()
    return Child(compute)
