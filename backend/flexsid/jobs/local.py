"""Worker processes on this computer."""

from __future__ import annotations

import os
import threading
from typing import Any

from flexsid.jobs.child import Child, execute_in_child, pickle_task
from flexsid.jobs.executors import Workers
from flexsid.jobs.messages import Key
from flexsid.jobs.worker import LoadKinds

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
