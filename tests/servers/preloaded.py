"""Servers, dispatchers, workers and streams forked from a process with the libraries loaded.

Importing the libraries takes longer than most tests of servers. These processes run the same
programs as those of ``flexsid.jobs.child`` and the command ``flexsid serve``, which the tests of
`jobs`, `cli` and `e2e/test_lost_server.py` start.
"""

from __future__ import annotations

import multiprocessing
import os
import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from importlib import import_module
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from pathlib import Path
from types import ModuleType

import pytest

from flexsid.jobs import child, dispatcher_process
from flexsid.jobs.child import Program
from flexsid.streams import live_streams, stream_process

_is_forked = False
_FORKING = multiprocessing.get_context("forkserver")
_FORKING.set_forkserver_preload(
    [
        *("flexsid.cli.serve", "flexsid.jobs.kinds"),
        *("flexsid.streams.stream_process", "flexsid.streams.estimate_process"),
    ]
)


class PreloadedProgram(Program):
    """A module of flexsid in a forked process."""

    def __init__(self, module: str) -> None:
        self.connection, child_connection = multiprocessing.Pipe()
        child_lifeline, lifeline = multiprocessing.Pipe(duplex=False)
        self._lifeline = os.dup(lifeline.fileno())
        # A forked process forks its programs itself: it has the libraries loaded, and another
        # fork server would import them again, for seconds.
        context = multiprocessing.get_context("fork") if _is_forked else _FORKING
        self._forked = context.Process(
            target=_run, args=(module, child_connection, child_lifeline), daemon=False
        )
        self._forked.start()
        for end in (child_connection, child_lifeline, lifeline):
            end.close()

    @property
    def pid(self) -> int:
        """Number of the process."""
        return self._forked.pid or 0

    def signal(self, number: int) -> None:
        """Send a signal, unless the process has ended."""
        if self._forked.is_alive():
            os.kill(self.pid, number)

    def kill(self) -> None:
        """Kill the process and wait for its end."""
        self._forked.kill()
        self._forked.join()

    def find_exit_code(self) -> int | None:
        """Return the exit code, negative for a signal; None if the process does not end."""
        self._forked.join(timeout=1.0)
        return self._forked.exitcode


def use_preloaded(patch: pytest.MonkeyPatch) -> None:
    """Start dispatchers of this process, and their workers, from loaded libraries."""
    patch.setattr(dispatcher_process, "Program", PreloadedProgram)
    patch.setattr(live_streams, "Program", PreloadedProgram)


def start_server(database: Path, port: int, log: Path) -> BaseProcess:
    """Start ``flexsid serve`` on a database and port."""
    server = _FORKING.Process(target=_serve, args=(database, port, log))
    server.start()
    return server


def _serve(database: Path, port: int, log: Path) -> None:
    global _is_forked
    _is_forked = True
    with log.open("ab") as output:
        for stream in (1, 2):
            os.dup2(output.fileno(), stream)
    os.environ["FLEXSID_PORT"] = str(port)
    from flexsid.cli.main import main

    with _programs_of(dispatcher_process, dispatcher_process.__name__, count=1):
        code = main(["serve", "--database", f"sqlite:///{database}"])
    sys.exit(code)


def _run(module: str, connection: Connection, lifeline: Connection) -> None:
    global _is_forked
    if _is_forked:
        _close_others(connection.fileno(), lifeline.fileno())
    _is_forked = True
    with ExitStack() as programs:
        if module == dispatcher_process.__name__:
            programs.enter_context(_programs_of(child, "flexsid.jobs.worker", count=6))
        elif module == stream_process.__name__:
            programs.enter_context(
                _programs_of(stream_process, "flexsid.streams.estimate_process", count=2)
            )
        import_module(module).main([str(connection.fileno()), str(lifeline.fileno())])


@contextmanager
def _programs_of(user: ModuleType, module: str, count: int) -> Iterator[None]:
    """Fork the first programs that a module will start, and start further ones as it does itself.

    They are forked while this process has one thread: a process that is forked later would wait
    for ever for a lock that another thread held at that moment.
    """
    ready = [PreloadedProgram(module) for _ in range(count)]
    setattr(  # noqa: B010
        user, "Program", lambda started: ready.pop() if ready else Program(started)
    )
    try:
        yield
    finally:
        for program in ready:
            program.kill()
            program.close()


def _close_others(*used: int) -> None:
    """Close the files of the dispatcher: its pipes would stay open when it is killed."""
    for name in os.listdir("/proc/self/fd"):
        if int(name) > 2 and int(name) not in used:
            with suppress(OSError):  # the one that listed them
                os.close(int(name))
