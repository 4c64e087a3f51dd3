"""Dispatchers and workers that are forked from a process which has the libraries loaded.

Importing the numerical libraries takes longer than most jobs of tests. These processes run the
same programs as those of ``flexsid.jobs.child``, which the tests of `jobs`, `cli` and `e2e` start.
"""

from __future__ import annotations

import multiprocessing
import os
from importlib import import_module
from multiprocessing.connection import Connection

import pytest

from flexsid.jobs import child, dispatcher_process
from flexsid.jobs.child import Program

_FORKING = multiprocessing.get_context("forkserver")
_FORKING.set_forkserver_preload(["flexsid.jobs.kinds", "flexsid.jobs.dispatcher_process"])


class PreloadedProgram(Program):
    """A module of flexsid in a forked process."""

    def __init__(self, module: str) -> None:
        self.connection, child_connection = multiprocessing.Pipe()
        child_lifeline, lifeline = multiprocessing.Pipe(duplex=False)
        self._lifeline = os.dup(lifeline.fileno())
        self._forked = _FORKING.Process(
            target=_run, args=(module, child_connection, child_lifeline), daemon=False
        )
        self._forked.start()
        for end in (child_connection, child_lifeline, lifeline):
            end.close()

    def kill(self) -> None:
        """Kill the process and wait for its end."""
        self._forked.kill()
        self._forked.join()

    def describe_exit(self) -> str:
        """Return how the process ended, as text."""
        self._forked.join(timeout=1.0)
        code = self._forked.exitcode
        if code is None:
            return "it no longer responds"
        return f"signal {-code}" if code < 0 else f"exit code {code}"


def use_preloaded(patch: pytest.MonkeyPatch) -> None:
    """Start dispatchers of this process, and their workers, from loaded libraries."""
    patch.setattr(dispatcher_process, "Program", PreloadedProgram)


def _run(module: str, connection: Connection, lifeline: Connection) -> None:
    child.Program = PreloadedProgram  # of the workers that a dispatcher starts
    import_module(module).main([str(connection.fileno()), str(lifeline.fileno())])
