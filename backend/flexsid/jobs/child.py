"""Child: a program of ours in a process of its own, and the two pipes that lead to it."""

from __future__ import annotations

import multiprocessing
import os
import pickle
import subprocess
import sys
from typing import Any

from flexsid.jobs.news import Died, News, unexpected
from flexsid.jobs.worker import Compute

_BLAS_THREADS = ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS")


class Program:
    """A module of ours that runs as a program of its own, and dies with whoever started it.

    A plain program rather than a ``multiprocessing`` process: it may be started
    from any process, a daemon's too, and does not load that one's main module. It is
    given the file numbers of a connection, and of a lifeline that ends when this end does.

    Parameters
    ----------
    module
        Its name, e.g. ``flexsid.jobs.worker``.
    """

    def __init__(self, module: str) -> None:
        self.connection, theirs = multiprocessing.Pipe()
        end, lifeline = os.pipe()
        self._lifeline: int | None = lifeline
        try:
            self._process = subprocess.Popen(
                [sys.executable, "-m", module, str(theirs.fileno()), str(end)],
                stdin=subprocess.DEVNULL,
                pass_fds=(theirs.fileno(), end),
                env={
                    **os.environ,
                    # The matrices are small and the cores are shared.
                    **dict.fromkeys(_BLAS_THREADS, "1"),
                    "PYTHONPATH": os.pathsep.join(path for path in sys.path if path),
                },
            )
        finally:
            # Theirs must be the only copies, or a dead program's pipe would not end.
            theirs.close()
            os.close(end)

    def let_go(self) -> None:
        """End the lifeline; once is enough."""
        lifeline, self._lifeline = self._lifeline, None
        if lifeline is not None:
            os.close(lifeline)

    def kill(self) -> None:
        """End it at once."""
        self._process.kill()
        self._process.wait()

    def close(self) -> None:
        """Close both pipes."""
        self.connection.close()
        self.let_go()

    def how_it_ended(self) -> str:
        """Say in words how it ended."""
        try:
            code = self._process.wait(timeout=1.0)
        except subprocess.TimeoutExpired:
            return "it no longer answers"
        return f"signal {-code}" if code < 0 else f"exit code {code}"


class Child:
    """A worker: carries out one task at a time."""

    def __init__(self, compute: Compute) -> None:
        self._program = Program("flexsid.jobs.worker")
        self.connection = self._program.connection
        self.connection.send(compute)

    def submit(self, task: Any, memory_mb: int | None) -> None:
        """Give it a task."""
        self.connection.send_bytes(pickle.dumps((task, memory_mb), pickle.HIGHEST_PROTOCOL))

    def listen(self) -> News:
        """Return what it says next; after ``Died`` it is of no use."""
        try:
            said: News = self.connection.recv()
        except (EOFError, OSError):
            return Died(self._program.how_it_ended())
        except Exception as error:  # whatever unpickling a foreign outcome raises
            return unexpected(error)
        return said

    def kill(self) -> None:
        """End it at once."""
        self._program.kill()
        self._program.close()
