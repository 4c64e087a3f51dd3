"""Child: one worker process, and the two pipes that lead to it."""

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


class Child:
    """Carries out one task at a time in a process of its own.

    A plain program rather than a ``multiprocessing`` process: it may be started
    from any process, a daemon's too, and does not load that one's main module.
    """

    def __init__(self, compute: Compute) -> None:
        self.connection, theirs = multiprocessing.Pipe()
        end, self._lifeline = os.pipe()
        try:
            self._process = subprocess.Popen(
                [sys.executable, "-m", "flexsid.jobs.worker", str(theirs.fileno()), str(end)],
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
            # Theirs must be the only copies, or a dead worker's pipe would not end.
            theirs.close()
            os.close(end)
        self.connection.send(compute)

    def submit(self, task: Any, memory_mb: int | None) -> None:
        """Give it a task."""
        self.connection.send_bytes(pickle.dumps((task, memory_mb), pickle.HIGHEST_PROTOCOL))

    def listen(self) -> News:
        """Return what it says next; after ``Died`` it is of no use."""
        try:
            said: News = self.connection.recv()
        except (EOFError, OSError):
            return Died(self._how_it_ended())
        except Exception as error:  # whatever unpickling a foreign outcome raises
            return unexpected(error)
        return said

    def kill(self) -> None:
        """End it at once."""
        self._process.kill()
        self._process.wait()
        self.connection.close()
        os.close(self._lifeline)

    def _how_it_ended(self) -> str:
        try:
            code = self._process.wait(timeout=1.0)
        except subprocess.TimeoutExpired:
            return "it no longer answers"
        return f"signal {-code}" if code < 0 else f"exit code {code}"
