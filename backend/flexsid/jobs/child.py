"""Child processes of flexsid, each with a message pipe and a lifeline pipe."""

from __future__ import annotations

import logging
import multiprocessing
import os
import pickle
import signal
import subprocess
import sys
from collections.abc import Callable
from contextlib import suppress
from typing import Any

from flexsid.jobs.fork_server import ForkedProcess, get_fork_server
from flexsid.jobs.messages import (
    ProgressMessage,
    TaskLostMessage,
    WorkerDiedMessage,
    WorkerMessage,
    describe_error,
)
from flexsid.jobs.worker import LoadKinds

_log = logging.getLogger(__name__)

_BLAS_THREADS = ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS")
_STOPS = (-signal.SIGTERM, -signal.SIGHUP)
"""Exit codes of processes that a system stops, all those of a service at a time."""
_CANCEL_CHECK_S = 0.05  # between checks whether a task was cancelled


class Program:
    """A module of flexsid run as a separate process that ends with its parent process.

    It imports from the installation only, whatever the folder and the ``PYTHONPATH`` of its parent.
    It is forked by the fork server of this process, if there is one, or is a ``subprocess`` rather
    than a ``multiprocessing`` process: any process, a daemon included, may start it, and it does
    not load the parent's main module. It receives the file descriptors of a connection and of a
    lifeline pipe, which closes with the parent.

    Parameters
    ----------
    module
        Name of the module, e.g. ``flexsid.jobs.worker``.
    """

    def __init__(self, module: str) -> None:
        self.connection, child_connection = multiprocessing.Pipe()
        child_lifeline, lifeline = os.pipe()
        self._lifeline: int | None = lifeline
        try:
            self._process = _start(module, child_connection.fileno(), child_lifeline)
        finally:
            # The child must hold the only copies; otherwise the pipe of a dead child stays open.
            child_connection.close()
            os.close(child_lifeline)

    def release_lifeline(self) -> None:
        """Close the lifeline; further calls do nothing."""
        lifeline, self._lifeline = self._lifeline, None
        if lifeline is not None:
            os.close(lifeline)

    @property
    def pid(self) -> int:
        """Number of the process."""
        return self._process.pid

    def signal(self, number: int) -> None:
        """Send a signal, unless the process has ended."""
        self._process.send_signal(number)

    def kill(self) -> None:
        """Kill the process and wait for its end."""
        self._process.kill()
        self._process.wait()

    def close(self) -> None:
        """Close both pipes."""
        self.connection.close()
        self.release_lifeline()

    def find_exit_code(self) -> int | None:
        """Return the exit code, negative for a signal; None if the process does not end."""
        try:
            return self._process.wait(timeout=1.0)
        except subprocess.TimeoutExpired:
            return None

    @property
    def is_stopped(self) -> bool:
        """Whether the process was stopped from outside, and not by what it computed."""
        return self.find_exit_code() in _STOPS

    def describe_exit(self) -> str:
        """Return how the process ended, as text."""
        code = self.find_exit_code()
        if code is None:
            return "it no longer responds"
        return f"signal {-code}" if code < 0 else f"exit code {code}"


def _start(module: str, connection: int, lifeline: int) -> subprocess.Popen[bytes] | ForkedProcess:
    server = get_fork_server()
    if server is not None:
        try:
            return server.fork(module, connection, lifeline)
        except OSError as error:
            _log.warning("the fork server does not respond (%s); a process is loaded anew", error)
    return subprocess.Popen(
        [
            # Without -P a module of the folder in which the server was started is imported
            # in place of any other of its name.
            *(sys.executable, "-P", "-m", module),
            *(str(connection), str(lifeline)),
        ],
        stdin=subprocess.DEVNULL,
        pass_fds=(connection, lifeline),
        env={
            **{name: value for name, value in os.environ.items() if name != "PYTHONPATH"},
            # The matrices are small, and all workers share the cores.
            **dict.fromkeys(_BLAS_THREADS, "1"),
        },
    )


def pickle_task(kind: str, task: Any, memory_mb: int | None) -> bytes:
    """Return a task of a kind, with a memory limit, as a worker receives it."""
    return pickle.dumps((kind, task, memory_mb), pickle.HIGHEST_PROTOCOL)


class Child:
    """A worker process, which computes one task at a time."""

    def __init__(self, load_kinds: LoadKinds) -> None:
        self.load_kinds = load_kinds
        self._program = Program("flexsid.jobs.worker")
        self.connection = self._program.connection
        self.connection.send(load_kinds)

    def receive(self) -> WorkerMessage:
        """Return the next message; none follows ``WorkerDiedMessage`` and ``TaskLostMessage``."""
        try:
            message: WorkerMessage = self.connection.recv()
        except (EOFError, OSError):
            if self._program.is_stopped:
                return TaskLostMessage("its worker was stopped")
            return WorkerDiedMessage(self._program.describe_exit())
        except Exception as error:  # unpickling a result may raise anything
            return describe_error(error)
        return message

    def kill(self) -> None:
        """Kill the worker and close its pipes."""
        self._program.kill()
        self._program.close()


def _take_child(idle: list[Child], load_kinds: LoadKinds) -> Child:
    """Return an idle worker with these kinds that is alive, or a new one."""
    while idle:
        child = idle.pop()
        if child.load_kinds is load_kinds and not child.connection.poll():
            return child
        child.kill()  # its pipe is readable since it died
    return Child(load_kinds)


def execute_in_child(
    load_kinds: LoadKinds,
    content: bytes,
    idle: list[Child],
    publish: Callable[[ProgressMessage], None],
    is_cancelled: Callable[[], bool],
) -> WorkerMessage:
    """Compute a task in an idle worker or a new one; return its last message.

    Parameters
    ----------
    load_kinds
        Function that returns the kinds of jobs.
    content
        Task, from ``pickle_task``.
    idle
        Idle workers, from which one is taken, and to which it returns unless it is killed.
    publish
        Called with the progress.
    is_cancelled
        Returns whether the task shall be stopped; called several times a second.
    """
    try:
        child = _take_child(idle, load_kinds)
    except OSError as error:  # the computer cannot start a further process
        return WorkerDiedMessage(str(error))
    with suppress(OSError):  # it was killed before it received the task, and has no message
        child.connection.send_bytes(content)
    while True:
        if not child.connection.poll(_CANCEL_CHECK_S):
            if is_cancelled():
                child.kill()
                return TaskLostMessage("the task was cancelled")
            continue
        message = child.receive()
        if isinstance(message, ProgressMessage):
            publish(message)
            continue
        if isinstance(message, WorkerDiedMessage | TaskLostMessage):
            child.kill()
        else:
            idle.append(child)
        return message
