"""Worker processes on this computer."""

from __future__ import annotations

import multiprocessing
import os
import threading
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from typing import Any

from flexsid.jobs.child import Child
from flexsid.jobs.messages import (
    Key,
    ProgressMessage,
    StartedMessage,
    WorkerDiedMessage,
    WorkerMessage,
)
from flexsid.jobs.worker import LoadKinds

_MOST_WORKERS = 8


@dataclass(slots=True)
class _Worker:
    child: Child
    key: Key | None = None


class LocalWorkers:
    """Pool of worker processes, one task each.

    Not a pool of the standard library: such a pool shares one queue, whose lock is lost
    with a killed child. Here every worker has its own pipe, so that it can be killed at
    any moment without effect on the others. All methods except ``wake`` must be called
    from one thread.
    """

    def __init__(self, load_kinds: LoadKinds, count: int | None = None) -> None:
        self.count = count or default_count()
        self.location = "processes of this computer"
        self._load_kinds = load_kinds
        self._workers: list[_Worker] = []
        self._wake_receiver, self._wake_sender = multiprocessing.Pipe(duplex=False)
        self._is_woken = threading.Event()

    @property
    def free_slots(self) -> int:
        """Number of further tasks that can start now."""
        return self.count - len(self.keys)

    @property
    def extra_slots(self) -> int:
        """Number of tasks that can start beyond; the processes then share the cores."""
        return 2 * self.count - len(self.keys)

    @property
    def keys(self) -> set[Key]:
        """Keys of the running tasks."""
        return {worker.key for worker in self._workers if worker.key is not None}

    def warm_up(self) -> None:
        """Start a spare worker: loading the numerical libraries takes a second."""
        if self.free_slots > 0 and all(worker.key is not None for worker in self._workers):
            self._start()

    def submit(self, key: Key, kind: str, task: Any, memory_mb: int | None) -> None:
        """Start a task on an idle worker, or on a further one."""
        for worker in [w for w in self._workers if w.key is None]:
            try:
                worker.child.submit(kind, task, memory_mb)
            except (BrokenPipeError, ConnectionResetError):  # it died while idle
                self._remove(worker)
            else:
                worker.key = key
                return
        worker = self._start()
        worker.child.submit(kind, task, memory_mb)
        worker.key = key

    def cancel(self, key: Key) -> None:
        """Stop a task by killing its worker."""
        for worker in list(self._workers):
            if worker.key == key:
                self._remove(worker)

    def wait(self, timeout: float) -> list[tuple[Key, WorkerMessage]]:
        """Return new messages of the workers; return at once after ``wake``."""
        by_connection = {worker.child.connection: worker for worker in self._workers}
        messages: list[tuple[Key, WorkerMessage]] = []
        for ready in wait([self._wake_receiver, *by_connection], timeout):
            if ready is self._wake_receiver:
                self._is_woken.clear()
                self._wake_receiver.recv_bytes()
                continue
            assert isinstance(ready, Connection)
            worker = by_connection[ready]
            key = worker.key
            message = worker.child.receive()
            if isinstance(message, WorkerDiedMessage):
                self._remove(worker)
            elif not isinstance(message, StartedMessage | ProgressMessage):
                worker.key = None
                if len(self._workers) > self.count:
                    self._remove(worker)
            if key is not None:
                messages.append((key, message))
        return messages

    def wake(self) -> None:
        """End ``wait``; thread-safe."""
        if not self._is_woken.is_set():
            self._is_woken.set()
            self._wake_sender.send_bytes(b"wake")

    def close(self) -> None:
        """Kill all workers."""
        for worker in list(self._workers):
            self._remove(worker)
        self._wake_receiver.close()
        self._wake_sender.close()

    def _start(self) -> _Worker:
        worker = _Worker(Child(self._load_kinds))
        self._workers.append(worker)
        return worker

    def _remove(self, worker: _Worker) -> None:
        self._workers.remove(worker)
        worker.child.kill()


def default_count() -> int:
    """Return the number of workers: one core is left to the server."""
    affinity = getattr(os, "sched_getaffinity", None)
    cores = len(affinity(0)) if affinity is not None else os.cpu_count() or 1
    return max(1, min(cores - 1, _MOST_WORKERS))
