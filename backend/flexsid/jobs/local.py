"""Worker processes on this computer."""

from __future__ import annotations

import multiprocessing
import os
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from multiprocessing.context import SpawnProcess
from typing import Any

from flexsid.jobs.worker import News, Progressed, unexpected, work
from flexsid.records.run import Progress

Key = tuple[int, int]
"""Which run, which attempt."""

_MOST_WORKERS = 8
_BLAS_THREADS = ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS")


@dataclass(frozen=True, slots=True)
class Died:
    """The worker of a task is gone: killed from outside, out of memory, or crashed."""

    exit_code: int | None


@dataclass(slots=True)
class _Worker:
    process: SpawnProcess
    connection: Connection
    key: Key | None = None


class LocalWorkers:
    """Keeps worker processes, one task each.

    Our own processes rather than a ready-made pool: a pool shares one queue, whose
    lock dies with a killed child; here every worker has its own pipe, so it can be
    killed at any moment and nobody else notices. All methods but ``wake`` are for
    one thread.
    """

    def __init__(
        self,
        compute: Callable[[Any, Callable[[Progress], None]], Any],
        count: int | None = None,
    ) -> None:
        self.count = count or default_count()
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

    def submit(self, key: Key, task: Any) -> None:
        """Give a task to an idle worker; there must be ``room``."""
        worker = next((w for w in self._workers if w.key is None), None)
        while worker is not None:
            try:
                worker.connection.send(task)
            except (BrokenPipeError, ConnectionResetError):  # it died while idle
                self._remove(worker)
                worker = next((w for w in self._workers if w.key is None), None)
            else:
                worker.key = key
                return
        worker = self._start()
        worker.connection.send(task)
        worker.key = key

    def cancel(self, key: Key) -> None:
        """Stop a task by killing its worker."""
        for worker in list(self._workers):
            if worker.key == key:
                self._remove(worker)

    def wait(self, timeout: float) -> list[tuple[Key, News | Died]]:
        """Return what workers have to tell; at once when someone calls ``wake``."""
        by_connection = {worker.connection: worker for worker in self._workers}
        news: list[tuple[Key, News | Died]] = []
        for ready in wait([self._alarm, *by_connection], timeout):
            if ready is self._alarm:
                self._rung.clear()
                self._alarm.recv_bytes()
                continue
            assert isinstance(ready, Connection)
            worker = by_connection[ready]
            key = worker.key
            said = self._listen(worker)
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

    def _listen(self, worker: _Worker) -> News | Died:
        try:
            said: News = worker.connection.recv()
        except (EOFError, OSError):
            worker.process.join(timeout=1.0)
            exit_code = worker.process.exitcode
            self._remove(worker)
            return Died(exit_code)
        except Exception as error:  # whatever unpickling a foreign outcome raises
            worker.key = None
            return unexpected(error)
        if not isinstance(said, Progressed):
            worker.key = None
        return said

    def _start(self) -> _Worker:
        context = multiprocessing.get_context("spawn")
        ours, theirs = context.Pipe()
        process = context.Process(
            target=work, args=(theirs, self._compute), name="flexsid-worker", daemon=True
        )
        with _one_blas_thread():
            process.start()
        # Ours must be the only copies, or a dead worker's pipe would not end.
        theirs.close()
        worker = _Worker(process, ours)
        self._workers.append(worker)
        return worker

    def _remove(self, worker: _Worker) -> None:
        self._workers.remove(worker)
        worker.process.kill()
        worker.process.join()
        worker.process.close()
        worker.connection.close()


def default_count() -> int:
    """Leave one core to the server."""
    affinity = getattr(os, "sched_getaffinity", None)
    cores = len(affinity(0)) if affinity is not None else os.cpu_count() or 1
    return max(1, min(cores - 1, _MOST_WORKERS))


@contextmanager
def _one_blas_thread() -> Iterator[None]:
    """Let processes that start here use one BLAS thread: their matrices are small.

    It must stand in the environment before numpy is loaded, which may be as
    soon as the child imports our main module.
    """
    before = {name: os.environ.get(name) for name in _BLAS_THREADS}
    os.environ.update(dict.fromkeys(_BLAS_THREADS, "1"))
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value
