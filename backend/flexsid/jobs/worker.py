"""Inside a worker process: take a task, compute, tell progress, hand back the outcome.

A worker has no database. It dies with the process that started it, which kills
it to cancel its task, so nothing here needs to be tidied up.
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
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

from flexsid.errors import FlexsidError
from flexsid.jobs.news import Begun, ComputedMessage, Failed, News, Progressed, unexpected
from flexsid.records.run import Progress

_NICE = 5  # whoever looks at a page comes before what is computed in the background
_PROGRESS_S = 0.2  # a fit tells of iterations that take a millisecond

Compute = Callable[[Any, Callable[[Progress], None]], Any]


def main(arguments: list[str]) -> None:
    """Serve the connection and die with the lifeline whose file numbers are given."""
    # Ctrl-C reaches the whole group of processes; the server decides what it means.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    if hasattr(os, "nice"):
        os.nice(_NICE)
    connection, lifeline = (int(number) for number in arguments)
    threading.Thread(target=_die_with, args=(lifeline,), daemon=True).start()
    work(Connection(connection))


def work(connection: Connection) -> None:
    """Carry out one task after the other until the other side hangs up."""
    me = f"{socket.gethostname()}/{os.getpid()}"
    try:
        compute: Compute = connection.recv()
        while True:
            # In two steps: a task that cannot be read is no reason to stop.
            content = connection.recv_bytes()
            try:
                task, memory_mb = pickle.loads(content)
                del content
            except Exception as error:
                connection.send(unexpected(error))
                continue
            connection.send(Begun())
            with _at_most(memory_mb):
                news = carry_out(compute, task, _telling(connection), me)
                del task
            try:
                connection.send(news)
            except (TypeError, AttributeError, ValueError, pickle.PicklingError) as error:
                connection.send(unexpected(error))  # it cannot be sent
    except (EOFError, BrokenPipeError, ConnectionResetError):
        return


def carry_out(
    compute: Compute, task: Any, report: Callable[[Progress], None], worker: str = ""
) -> News:
    """Compute; whatever it raises becomes news."""
    try:
        return ComputedMessage(compute(task, report), worker)
    except FlexsidError as error:
        return Failed(error.code, error.message, worker=worker)
    except MemoryError:
        return Failed(
            "out-of-memory",
            "the estimation needs more memory than it may take; take a smaller model or band,"
            " or raise its memory limit",
            worker=worker,
        )
    except Exception as error:
        return unexpected(error)


def _telling(connection: Connection) -> Callable[[Progress], None]:
    """Tell progress, at most as often as anybody can read it."""
    told = -_PROGRESS_S

    def tell(progress: Progress) -> None:
        nonlocal told
        now = time.monotonic()
        if now - told >= _PROGRESS_S:
            told = now
            connection.send(Progressed(progress))

    return tell


@contextmanager
def _at_most(memory_mb: int | None) -> Iterator[None]:
    """Let a task take this much memory beyond what the process has; then MemoryError."""
    if memory_mb is None:
        yield
        return
    _give_blas_its_buffers()
    present = _data_bytes()
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


def _give_blas_its_buffers() -> None:
    """Let the first products of matrices be made: OpenBLAS asks for its buffers then.

    Where it gets none it asks for ever, and the task hangs instead of failing. numpy and
    scipy have each their own.
    """
    import numpy as np
    from scipy.linalg.blas import dgemm

    matrix = np.ones((128, 128))
    dgemm(1.0, matrix, matrix @ matrix)


def _data_bytes() -> int | None:
    """Return the memory of this process that the limit counts; None where it cannot be told."""
    try:
        found = re.search(r"^VmData:\s*(\d+) kB", Path("/proc/self/status").read_text(), re.M)
    except OSError:
        return None
    return None if found is None else int(found[1]) * 1024


def _die_with(lifeline: int) -> None:
    """Leave at once when the other end is gone, even in the middle of a task."""
    os.read(lifeline, 1)
    os._exit(1)


if __name__ == "__main__":
    main(sys.argv[1:])
