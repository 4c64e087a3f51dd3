"""Main loop of a worker process: receive a task, compute, report progress, send the outcome.

A worker has no database. It ends with its parent process, which kills it to cancel a
task, so that no cleanup is required.
"""

from __future__ import annotations

import os
import pickle
import re
import signal
import socket
import sys
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

from flexsid.jobs.messages import (
    ComputedMessage,
    FailedMessage,
    ProgressMessage,
    describe_error,
    loading,
)
from flexsid.records.run import Progress, ReportProgress

_NICE = 5  # requests of pages have priority over computation in the background
_PROGRESS_S = 0.2  # iterations may take a millisecond

LoadKinds = Callable[[], Mapping[str, Any]]
"""Returns the kinds of jobs by name, of which a worker uses ``compute`` alone."""


def main(arguments: list[str]) -> None:
    """Serve the connection until the lifeline closes; both are given by file descriptor."""
    # Ctrl-C reaches the whole process group; the server handles it.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    if hasattr(os, "nice"):
        os.nice(_NICE)
    connection, lifeline = (int(number) for number in arguments)
    threading.Thread(target=_exit_with, args=(lifeline,), daemon=True).start()
    work(Connection(connection))


def work(connection: Connection) -> None:
    """Compute tasks until the connection closes."""
    worker = f"{socket.gethostname()}/{os.getpid()}"
    try:
        with loading():
            load_kinds: LoadKinds = connection.recv()
            kinds = load_kinds()
        while True:
            # In two steps: a task that cannot be unpickled must not end the worker.
            content = connection.recv_bytes()
            try:
                kind, task, memory_mb = pickle.loads(content)
                del content
            except Exception as error:
                connection.send(describe_error(error))
                continue
            connection.send(ProgressMessage())
            with _limit_memory(memory_mb):
                message = _compute(kinds[kind], task, _make_reporter(connection), worker)
                del task
            try:
                connection.send(message)
            except (TypeError, AttributeError, ValueError, pickle.PicklingError) as error:
                connection.send(describe_error(error))  # it cannot be pickled
    except (EOFError, BrokenPipeError, ConnectionResetError):
        return


def _compute(
    kind: Any, task: Any, report: ReportProgress, worker: str
) -> ComputedMessage | FailedMessage:
    """Compute a task; exceptions become messages."""
    try:
        return ComputedMessage(kind.compute(task, report), worker)
    except Exception as error:
        return describe_error(error, worker)


def _make_reporter(connection: Connection) -> ReportProgress:
    """Return a function that sends progress, at most every ``_PROGRESS_S``."""
    sent_at = -_PROGRESS_S

    def report(progress: Progress) -> None:
        nonlocal sent_at
        now = time.monotonic()
        if now - sent_at >= _PROGRESS_S:
            sent_at = now
            connection.send(ProgressMessage(progress))

    return report


@contextmanager
def _limit_memory(memory_mb: int | None) -> Iterator[None]:
    """Limit the memory that a task may use; beyond it raises MemoryError."""
    if memory_mb is None:
        yield
        return
    _reserve_blas_buffers()
    present = _read_data_bytes()
    if present is None:
        yield
        return
    import resource

    before = resource.getrlimit(resource.RLIMIT_DATA)
    resource.setrlimit(resource.RLIMIT_DATA, (present + memory_mb * 1024**2, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_DATA, before)


def _reserve_blas_buffers() -> None:
    """Compute a matrix product, so that OpenBLAS reserves its buffers before the limit.

    If that fails, OpenBLAS retries without end and the task hangs instead of
    failing. numpy and scipy each have their own OpenBLAS.
    """
    import numpy as np
    from scipy.linalg.blas import dgemm

    matrix = np.ones((128, 128))
    dgemm(1.0, matrix, matrix @ matrix)


def _read_data_bytes() -> int | None:
    """Return the memory of this process that counts towards the limit; None if unknown."""
    try:
        match = re.search(r"^VmData:\s*(\d+) kB", Path("/proc/self/status").read_text(), re.M)
    except OSError:
        return None
    return None if match is None else int(match[1]) * 1024


def _exit_with(lifeline: int) -> None:
    """Exit at once when the lifeline closes, even during a task."""
    os.read(lifeline, 1)
    os._exit(1)


if __name__ == "__main__":
    main(sys.argv[1:])
