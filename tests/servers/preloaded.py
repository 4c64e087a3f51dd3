"""Commands, dispatchers and streams forked from a process with the libraries loaded.

Importing the libraries takes longer than most tests of servers. These processes run the same
programs as those of ``flexsid.jobs.child`` and the installed command, which the tests of `jobs`,
`cli` and `shipped`, `e2e/test_lost_server.py` and `docs/test_tutorials.py` start. Their workers are
forked by flexsid itself.
"""

from __future__ import annotations

import atexit
import multiprocessing
import os
import sys
import tempfile
import time
from collections.abc import Callable, Mapping, Sequence
from importlib import import_module
from multiprocessing import forkserver
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from pathlib import Path
from typing import Any

import pytest

from flexsid.jobs import dispatcher_process
from flexsid.jobs.child import Program
from flexsid.streams import live_streams

_FORKING = multiprocessing.get_context("forkserver")
_FORKING.set_forkserver_preload(["loaded_modules"])


def _fork(target: Callable[..., None], args: tuple[Any, ...]) -> BaseProcess:
    """Start a function in a process that is forked with the libraries loaded."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("PYTHONPATH", str(Path(__file__).parent))
        forkserver.ensure_running()
    forked = _FORKING.Process(target=target, args=args)
    forked.daemon = False
    forked.start()
    return forked


class PreloadedProgram(Program):
    """A module of flexsid in a forked process."""

    def __init__(self, module: str) -> None:
        self.connection, child_connection = multiprocessing.Pipe()
        child_lifeline, lifeline = multiprocessing.Pipe(duplex=False)
        self._lifeline = os.dup(lifeline.fileno())
        self._forked = _fork(_run, (module, child_connection, child_lifeline))
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


class ForkedCommand:
    """The command ``flexsid`` in a forked process, with the methods of ``subprocess.Popen``.

    Parameters
    ----------
    arguments
        Arguments of the command.
    folder
        Folder in which it is started.
    environment
        All variables of its environment.
    output, errors
        Files to which it appends its output and its errors, which may be the same.
    """

    def __init__(
        self,
        arguments: Sequence[str],
        folder: Path,
        environment: Mapping[str, str],
        output: Path,
        errors: Path,
    ) -> None:
        files = (str(output.resolve()), str(errors.resolve()))
        command = [str(one) for one in arguments]
        self._forked = _fork(_run_command, (command, str(folder), dict(environment), files))

    @property
    def pid(self) -> int:
        """Number of the process."""
        return self._forked.pid or 0

    def poll(self) -> int | None:
        """Return the exit code, negative for a signal; None while the process runs."""
        return self._forked.exitcode

    def wait(self, timeout: float | None = None) -> int | None:
        """Wait for the end of the process, and return its exit code."""
        self._forked.join(timeout)
        return self._forked.exitcode

    def terminate(self) -> None:
        """Ask the process to end."""
        self._forked.terminate()

    def kill(self) -> None:
        """Kill the process."""
        self._forked.kill()


def _run_command(
    arguments: list[str], folder: str, environment: dict[str, str], files: tuple[str, str]
) -> None:
    for stream, file in enumerate(files, start=1):
        opened = os.open(file, os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o666)
        os.dup2(opened, stream)
        os.close(opened)
    os.chdir(folder)
    os.environ.clear()
    os.environ.update(environment)
    tempfile.tempdir = None  # that of the environment, as the time zone
    time.tzset()
    sys.argv = ["flexsid", *arguments]
    from flexsid.cli.main import main

    code = main()
    # A process of ``multiprocessing`` ends without them.
    atexit._run_exitfuncs()
    sys.exit(code)


def _run(module: str, connection: Connection, lifeline: Connection) -> None:
    import_module(module).main([str(connection.fileno()), str(lifeline.fileno())])
