"""Worker processes on this computer."""

from __future__ import annotations

import multiprocessing
import os
import threading
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from typing import Any

from flexsid.jobs.child import Child
from flexsid.jobs.news import Begun, Died, Key, News, Progressed
from flexsid.jobs.worker import Compute

_MOST_WORKERS = 8


@dataclass(slots=True)
class _Worker:
    child: Child
    key: Key | None = None


class LocalWorkers:
    """Keeps worker processes, one task each.

    Our own processes rather than a ready-made pool: a pool shares one queue, whose
    lock dies with a killed child; here every worker has its own pipe, so it can be
    killed at any moment and nobody else notices. All methods but ``wake`` are for
    one thread.
    """

    def __init__(self, compute: Compute, count: int | None = None) -> None:
        self.count = count or default_count()
        self.place = "processes of this computer"
        self._compute = compute
        self._workers: list[_Worker] = []
        self._alarm, self._bell = multiprocessing.Pipe(duplex=False)
        self._rung = threading.Event()

    @property
    def room(self) -> int:
        """How many more tasks can start now."""
        return self.count - len(self.keys)

    @property
    def keys(self) -> set[Key]:
        """Tasks under way."""
        return {worker.key for worker in self._workers if worker.key is not None}

    def warm_up(self) -> None:
        """Have one idle worker more than tasks: loading the mathematics takes a second."""
        if self.room and all(worker.key is not None for worker in self._workers):
            self._start()

    def submit(self, key: Key, task: Any, memory_mb: int | None) -> None:
        """Give a task to an idle worker; there must be ``room``."""
        for worker in [w for w in self._workers if w.key is None]:
            try:
                worker.child.submit(task, memory_mb)
            except (BrokenPipeError, ConnectionResetError):  # it died while idle
                self._remove(worker)
            else:
                worker.key = key
                return
        worker = self._start()
        worker.child.submit(task, memory_mb)
        worker.key = key

    def cancel(self, key: Key) -> None:
        """Stop a task by killing its worker."""
        for worker in list(self._workers):
            if worker.key == key:
                self._remove(worker)

    def wait(self, timeout: float) -> list[tuple[Key, News]]:
        """Return what workers have to tell; at once when someone calls ``wake``."""
        by_connection = {worker.child.connection: worker for worker in self._workers}
        news: list[tuple[Key, News]] = []
        for ready in wait([self._alarm, *by_connection], timeout):
            if ready is self._alarm:
                self._rung.clear()
                self._alarm.recv_bytes()
                continue
            assert isinstance(ready, Connection)
            worker = by_connection[ready]
            key = worker.key
            said = worker.child.listen()
            if isinstance(said, Died):
                self._remove(worker)
            elif not isinstance(said, Begun | Progressed):
                worker.key = None
            if key is not None:
                news.append((key, said))
        return news

    def wake(self) -> None:
        """End ``wait``; may be called from any thread."""
        if not self._rung.is_set():
            self._rung.set()
            self._bell.send_bytes(b"wake")

    def close(self) -> None:
        """Kill all workers."""
        for worker in list(self._workers):
            self._remove(worker)
        self._alarm.close()
        self._bell.close()

    def _start(self) -> _Worker:
        worker = _Worker(Child(self._compute))
        self._workers.append(worker)
        return worker

    def _remove(self, worker: _Worker) -> None:
        self._workers.remove(worker)
        worker.child.kill()


def default_count() -> int:
    """Leave one core to the server."""
    affinity = getattr(os, "sched_getaffinity", None)
    cores = len(affinity(0)) if affinity is not None else os.cpu_count() or 1
    return max(1, min(cores - 1, _MOST_WORKERS))
