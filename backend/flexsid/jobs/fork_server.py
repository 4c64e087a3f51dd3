"""Process from which others are forked, with the libraries that its parent has loaded.

Loading them takes three seconds of computation per process, and each would hold its own copy of
them in memory. ``multiprocessing.forkserver`` loads them once more, into a new interpreter; here
the parent forks the server itself, before it has threads, files and connections.
"""

from __future__ import annotations

import gc
import multiprocessing
import os
import selectors
import signal
import socket
import subprocess
import sys
import threading
from collections.abc import Sequence
from contextlib import suppress
from importlib import import_module
from multiprocessing.connection import wait
from multiprocessing.process import BaseProcess
from pathlib import Path
from typing import NoReturn

_LONGEST_NAME = 256
_FAILED = -1
_STOPS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)

_servers: dict[int, ForkServer] = {}
"""The server of this process, by its number: a forked process has none."""


class ForkedProcess:
    """A forked process, with the methods of ``subprocess.Popen`` that a program needs.

    Its parent is the fork server, which reports its exit code.
    """

    def __init__(self, pid: int, status: int) -> None:
        self.pid = pid
        self._status: int | None = status
        self._code: int | None = None

    def poll(self) -> int | None:
        """Return the exit code, negative for a signal; None while the process runs."""
        return self._read(0.0)

    def wait(self, timeout: float | None = None) -> int:
        """Wait for the end of the process and return its exit code.

        Raises
        ------
        subprocess.TimeoutExpired
            If it does not end.
        """
        code = self._read(timeout)
        if code is None:
            raise subprocess.TimeoutExpired(str(self.pid), timeout or 0.0)
        return code

    def send_signal(self, number: int) -> None:
        """Send a signal, unless the process has ended."""
        if self.poll() is None:
            with suppress(ProcessLookupError):
                os.kill(self.pid, number)

    def kill(self) -> None:
        """Kill the process."""
        self.send_signal(signal.SIGKILL)

    def _read(self, timeout: float | None) -> int | None:
        if self._status is not None and wait([self._status], timeout):
            status, self._status = self._status, None
            text = os.read(status, 16)
            os.close(status)
            # Without a report the fork server was ended, as by a system that stops all processes.
            self._code = int(text) if text else -signal.SIGTERM
        return self._code


class ForkServer:
    """The parent's end of a fork server."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._requests, requests = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        if os.fork() == 0:
            try:
                _serve(requests)
            finally:
                os._exit(1)  # never as a second parent
        requests.close()

    def fork(self, module: str, connection: int, lifeline: int) -> ForkedProcess:
        """Run the function ``main`` of a module in a forked process.

        Parameters
        ----------
        module
            Name of the module.
        connection, lifeline
            File descriptors, whose numbers in the new process are the arguments.

        Raises
        ------
        OSError
            If the server has ended or cannot fork.
        """
        status, child_status = os.pipe()
        try:
            with self._lock:
                files = [connection, lifeline, child_status]
                socket.send_fds(self._requests, [module.encode()], files)
                pid = int(self._requests.recv(16) or _FAILED)
            if pid == _FAILED:
                raise OSError("the fork server cannot fork")
        except OSError:
            os.close(status)
            raise
        finally:
            os.close(child_status)
        return ForkedProcess(pid, status)


def start_fork_server() -> None:
    """Start a fork server for the programs of this process, where that is safe.

    It has what is loaded now. A process with threads is not forked: the new one would wait for ever
    for what another thread held. Nor is one of another system than Linux.
    """
    if not hasattr(os, "pidfd_open"):
        return
    with suppress(OSError):  # as where a container forbids it
        os.close(os.pidfd_open(os.getpid()))
        if len(os.listdir("/proc/self/task")) == 1:
            _servers[os.getpid()] = ForkServer()


def get_fork_server() -> ForkServer | None:
    """Return the fork server of this process, if there is one."""
    return _servers.get(os.getpid())


def _serve(requests: socket.socket) -> NoReturn:
    """Fork processes and report their ends, until the parent has ended."""
    for number in _STOPS:
        signal.signal(number, signal.SIG_IGN)
    _close_files_except(requests.fileno())
    _import_from_installation_only()
    gc.freeze()  # a collection in a forked process would copy all that is loaded
    with selectors.DefaultSelector() as running:
        running.register(requests, selectors.EVENT_READ)
        while True:
            for key, _ in running.select():
                if key.data is not None:
                    running.unregister(key.fileobj)
                    _report_end(key.fd, *key.data)
                    continue
                content, files, _, _ = socket.recv_fds(requests, _LONGEST_NAME, 3)
                if not content:
                    os._exit(0)  # not its processes, which end by their lifelines
                *pipes, status = files
                process = _fork(content.decode(), pipes)
                for one in pipes:
                    os.close(one)
                if process is None:
                    os.close(status)
                else:
                    ended = os.pidfd_open(process.pid or 0)
                    running.register(ended, selectors.EVENT_READ, (process, status))
                requests.send(str(_FAILED if process is None else process.pid).encode())


def _fork(module: str, pipes: Sequence[int]) -> BaseProcess | None:
    process = multiprocessing.get_context("fork").Process(target=_run, args=(module, pipes))
    process.daemon = False
    try:
        process.start()
    except OSError:
        return None
    return process


def _report_end(ended: int, process: BaseProcess, status: int) -> None:
    process.join()
    with suppress(BrokenPipeError):  # nobody waits for it
        os.write(status, str(process.exitcode).encode())
    process.close()
    os.close(status)
    os.close(ended)


def _run(module: str, pipes: Sequence[int]) -> None:
    for number in _STOPS:
        signal.signal(number, signal.SIG_DFL)
    _close_files_except(*pipes)
    import_module(module).main([str(one) for one in pipes])


def _close_files_except(*used: int) -> None:
    """Close what the parent has opened: its pipes would stay open when it is killed."""
    for name in os.listdir("/proc/self/fd"):
        if int(name) > 2 and int(name) not in used:
            with suppress(OSError):  # the one that listed them
                os.close(int(name))


def _import_from_installation_only() -> None:
    """Remove what the folder and the ``PYTHONPATH`` of the parent have added to the imports."""
    if not sys.flags.safe_path and sys.path[0] in ("", str(Path.cwd())):
        del sys.path[0]
    variables = Path("/proc/self/environ").read_bytes().split(b"\0")  # before the parent changed it
    given = next((one for one in variables if one.startswith(b"PYTHONPATH=")), b"")
    for folder in os.fsdecode(given).partition("=")[2].split(os.pathsep):
        with suppress(ValueError):
            sys.path.remove(str(Path(folder).absolute()))
