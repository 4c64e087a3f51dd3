"""Executor of tasks, and worker processes on this computer."""

from __future__ import annotations

import os
import queue
import threading
from abc import ABC, abstractmethod
from contextlib import suppress
from datetime import datetime
from typing import Any, Generic, TypeVar

from flexsid.jobs.child import Child, execute_in_child, pickle_task
from flexsid.jobs.messages import Key, ProgressMessage, WorkerMessage
from flexsid.jobs.worker import LoadKinds

# --- Executor of tasks: what local worker processes and a Dask cluster share ----------------------

Running = TypeVar("Running")


class Workers(ABC, Generic[Running]):
    """Executor of tasks, each in a process of its own, whose messages arrive on other threads.

    All methods except ``wake`` must be called from one thread.

    Parameters
    ----------
    load_kinds
        Function that returns the kinds of jobs, in every worker.
    location
        Where the workers are.

    Attributes
    ----------
    valid_until
        End of validity of the certificate by which they are reached, if any.
    """

    def __init__(self, load_kinds: LoadKinds, location: str) -> None:
        self.location = location
        self.count = 0
        self.valid_until: datetime | None = None
        self._load_kinds = load_kinds
        self._tasks: dict[Key, Running] = {}
        self._messages: queue.SimpleQueue[tuple[Key, WorkerMessage] | None] = queue.SimpleQueue()

    @property
    def keys(self) -> set[Key]:
        """Keys of the running tasks."""
        return set(self._tasks)

    @property
    def free_slots(self) -> int:
        """Number of further tasks that can start now."""
        return self.count - len(self._tasks)

    @property
    def extra_slots(self) -> int:
        """Number of tasks that can start beyond, for analysts without a running job."""
        return 0

    @property
    def absent_s(self) -> float:
        """Time for which there has been no worker. [s]"""
        return 0.0

    def warm_up(self) -> None:
        """Prepare for the next task."""

    @abstractmethod
    def submit(self, key: Key, kind: str, task: Any, memory_mb: int | None) -> None:
        """Start a task; requires a free or extra slot."""

    @abstractmethod
    def cancel(self, key: Key) -> None:
        """Stop a task; no further message of it follows."""

    @abstractmethod
    def close(self) -> None:
        """Stop all tasks."""

    def wait(self, timeout: float) -> list[tuple[Key, WorkerMessage]]:
        """Return new messages of the running tasks; return at once after ``wake``."""
        messages: list[tuple[Key, WorkerMessage]] = []
        with suppress(queue.Empty):
            message = self._messages.get(timeout > 0, timeout)
            while True:
                if message is not None and message[0] in self._tasks:
                    messages.append(message)
                    if not isinstance(message[1], ProgressMessage):
                        del self._tasks[message[0]]
                message = self._messages.get_nowait()
        return messages

    def wake(self) -> None:
        """End ``wait``; may be called from any thread and from signal handlers."""
        self._messages.put(None)


# --- Worker processes on this computer ------------------------------------------------------------

_MOST_WORKERS = 8


class LocalWorkers(Workers[threading.Thread]):
    """Pool of worker processes, one task each, with a thread that waits for its messages.

    Not a pool of the standard library: such a pool shares one queue, whose lock is lost
    with a killed child. Here every worker has its own pipe, so that it can be killed at
    any moment without effect on the others.
    """

    def __init__(self, load_kinds: LoadKinds, count: int | None = None) -> None:
        super().__init__(load_kinds, "processes of this computer")
        self.count = count or default_count()
        self._idle: list[Child] = []

    @property
    def extra_slots(self) -> int:
        """Number of tasks that can start beyond; the processes then share the cores."""
        return 2 * self.count - len(self._tasks)

    def warm_up(self) -> None:
        """Start a spare worker: loading the numerical libraries takes a second."""
        if self.free_slots > 0 and not self._idle:
            self._idle.append(Child(self._load_kinds))

    def submit(self, key: Key, kind: str, task: Any, memory_mb: int | None) -> None:
        """Start a task on an idle worker, or on a further one."""
        content = pickle_task(kind, task, memory_mb)  # may fail, and then no worker is busy
        thread = threading.Thread(target=self._execute, args=(key, content), daemon=True)
        self._tasks[key] = thread
        thread.start()

    def cancel(self, key: Key) -> None:
        """Stop a task; its thread kills the worker."""
        self._tasks.pop(key, None)

    def close(self) -> None:
        """Kill all workers."""
        threads = list(self._tasks.values())
        self._tasks.clear()
        for thread in threads:
            thread.join()
        while self._idle:
            self._idle.pop().kill()

    def _execute(self, key: Key, content: bytes) -> None:
        message = execute_in_child(
            self._load_kinds,
            content,
            self._idle,
            publish=lambda progress: self._messages.put((key, progress)),
            is_cancelled=lambda: key not in self._tasks,
        )
        if len(self._idle) > self.count:  # workers beyond the free slots ended
            self._idle.pop().kill()
        self._messages.put((key, message))


def default_count() -> int:
    """Return the number of workers: one core is left to the server."""
    affinity = getattr(os, "sched_getaffinity", None)
    cores = len(affinity(0)) if affinity is not None else os.cpu_count() or 1
    return max(1, min(cores - 1, _MOST_WORKERS))
