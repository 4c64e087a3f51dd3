"""Executor of tasks: what local worker processes and a Dask cluster share."""

from __future__ import annotations

import queue
from abc import ABC, abstractmethod
from contextlib import suppress
from datetime import datetime
from typing import Any, Generic, TypeVar

from flexsid.jobs.messages import Key, ProgressMessage, WorkerMessage
from flexsid.jobs.worker import LoadKinds

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
