"""Worker processes on this computer."""

from __future__ import annotations

import multiprocessing
import os
import threading
from multiprocessing.connection import Connection, wait
from typing import Any

from flexsid.jobs.child import Child, pickle_task, take_child
from flexsid.jobs.dispatcher import Workers
from flexsid.jobs.messages import Key, ProgressMessage, WorkerDiedMessage, WorkerMessage
from flexsid.jobs.worker import LoadKinds

_MOST_WORKERS = 8


class LocalWorkers(Workers):
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
        self._idle: list[Child] = []
        self._busy: dict[Key, Child] = {}
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
        return set(self._busy)

    def warm_up(self) -> None:
        """Start a spare worker: loading the numerical libraries takes a second."""
        if self.free_slots > 0 and not self._idle:
            self._idle.append(Child(self._load_kinds))

    def submit(self, key: Key, kind: str, task: Any, memory_mb: int | None) -> None:
        """Start a task on an idle worker, or on a further one."""
        content = pickle_task(kind, task, memory_mb)  # may fail, and then no worker is busy
        child = self._busy[key] = take_child(self._idle, self._load_kinds)
        child.connection.send_bytes(content)

    def cancel(self, key: Key) -> None:
        """Stop a task by killing its worker."""
        child = self._busy.pop(key, None)
        if child is not None:
            child.kill()

    def wait(self, timeout: float) -> list[tuple[Key, WorkerMessage]]:
        """Return new messages of the workers; return at once after ``wake``."""
        by_connection = {child.connection: key for key, child in self._busy.items()}
        messages: list[tuple[Key, WorkerMessage]] = []
        for ready in wait([self._wake_receiver, *by_connection], timeout):
            if ready is self._wake_receiver:
                self._is_woken.clear()
                self._wake_receiver.recv_bytes()
                continue
            assert isinstance(ready, Connection)
            key = by_connection[ready]
            message = self._busy[key].receive()
            messages.append((key, message))
            if not isinstance(message, ProgressMessage):
                child = self._busy.pop(key)
                is_spare = len(self._idle) + len(self._busy) >= self.count
                if is_spare or isinstance(message, WorkerDiedMessage):
                    child.kill()
                else:
                    self._idle.append(child)
        return messages

    def wake(self) -> None:
        """End ``wait``; thread-safe."""
        if not self._is_woken.is_set():
            self._is_woken.set()
            self._wake_sender.send_bytes(b"wake")

    def close(self) -> None:
        """Kill all workers."""
        for child in (*self._idle, *self._busy.values()):
            child.kill()
        self._wake_receiver.close()
        self._wake_sender.close()


def default_count() -> int:
    """Return the number of workers: one core is left to the server."""
    affinity = getattr(os, "sched_getaffinity", None)
    cores = len(affinity(0)) if affinity is not None else os.cpu_count() or 1
    return max(1, min(cores - 1, _MOST_WORKERS))
