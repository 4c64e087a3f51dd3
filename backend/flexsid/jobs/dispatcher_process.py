"""Dispatcher in a separate process.

Preparing tasks and storing results would block the interpreter of the server and delay
every page.
"""

from __future__ import annotations

import logging
import os
import signal
import sys
import threading
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from multiprocessing.connection import Connection
from pathlib import Path
from types import FrameType
from typing import Any

from flexsid.errors import FlexsidError
from flexsid.jobs.child import Program
from flexsid.jobs.dispatcher import Dispatcher
from flexsid.jobs.fork_server import start_fork_server
from flexsid.jobs.local import LocalWorkers, Workers
from flexsid.jobs.messages import configure_interpreter
from flexsid.jobs.notifier import Notifier, read_channels
from flexsid.jobs.worker import LoadKinds
from flexsid.storage.store import Store

_log = logging.getLogger(__name__)

_SETTLE_S = 2.0  # the first pages have priority after the start of a server
_RESTART_S = 1.0
_STOP_S = 10.0  # longer than killing the workers and queueing their jobs again
_WAKE = signal.SIGUSR1


@dataclass(frozen=True, slots=True)
class DispatcherSettings:
    """Database, kinds of jobs and workers of a dispatcher (see ``make_workers``).

    ``url`` is the address of its server in a browser; the file ``notifications`` states where
    messages are sent (None: nowhere).
    """

    database: str
    load_kinds: LoadKinds
    dask: str | None = None
    workers: int | None = None
    url: str | None = None
    notifications: Path | None = None


class DispatcherProcess:
    """A dispatcher in a separate process, which is restarted if it ends.

    Parameters
    ----------
    settings
        Database, kinds of jobs and workers.
    on_change
        Called on a separate thread after jobs have changed.
    """

    def __init__(
        self, settings: DispatcherSettings, on_change: Callable[[], None] = lambda: None
    ) -> None:
        self._settings = settings
        self._on_change = on_change
        self._has_request = threading.Event()
        self._stopping = threading.Event()
        self._starting = threading.Lock()
        self._program: Program | None = None
        self._is_ready = False
        self._has_started = False
        self._thread = threading.Thread(target=self._run, name="dispatcher", daemon=True)

    def start(self) -> None:
        """Start the process with the first request, at the latest after ``_SETTLE_S``.

        Raises
        ------
        FlexsidError
            If the scheduler of the cluster does not respond.
        """
        if self._settings.dask is not None:
            make_workers(self._settings.load_kinds, self._settings.dask).close()
        self._thread.start()

    @property
    def is_starting(self) -> bool:
        """Whether the first process has neither begun to dispatch nor ended."""
        return not self._has_started

    def wake(self) -> None:
        """Check the queue now: a job was queued or cancelled."""
        self._has_request.set()
        program = self._program
        if program is not None and self._is_ready:  # at its start it checks the queue itself
            # Unlike a message, a signal never blocks if the process does not respond.
            program.signal(_WAKE)

    def stop(self) -> None:
        """Kill the workers and queue their jobs again, for the next server."""
        with self._starting:
            self._stopping.set()
            program = self._program
        self._has_request.set()
        if program is not None:
            program.release_lifeline()
            self._thread.join(_STOP_S if self._is_ready else 0.0)
            program.kill()
        self._thread.join()
        if program is not None:
            program.close()

    def _run(self) -> None:
        """Start the process, receive its notifications until it ends, and restart it."""
        self._has_request.wait(_SETTLE_S)
        while (program := self._begin()) is not None:
            with suppress(EOFError, OSError):
                while True:
                    program.connection.recv_bytes()
                    self._is_ready = self._has_started = True
                    self._on_change()
            self._has_started = True
            if not self._stopping.is_set():
                _log.warning("the dispatcher ended (%s) and is restarted", program.describe_exit())
                self._program, self._is_ready = None, False
                program.kill()
                program.close()
                self._stopping.wait(_RESTART_S)

    def _begin(self) -> Program | None:
        with self._starting:
            if self._stopping.is_set():
                return None
            program = Program(__name__)
            with suppress(OSError):
                program.connection.send(self._settings)
            self._program = program
            return program


def make_workers(
    load_kinds: LoadKinds, dask: str | None = None, count: int | None = None
) -> Workers[Any]:
    """Return the workers of a Dask cluster, or worker processes of this computer.

    Parameters
    ----------
    load_kinds
        Function that returns the kinds of jobs, in every worker.
    dask
        Address of a Dask scheduler.
    count
        Number of processes of this computer; default: one less than the number of cores.
    """
    if dask is None:
        return LocalWorkers(load_kinds, count)
    from flexsid.jobs.cluster import ClusterWorkers

    return ClusterWorkers(load_kinds, dask)


def main(arguments: list[str]) -> None:
    """Dispatch until the lifeline closes; both pipes are given by file descriptor."""
    # Ctrl-C reaches the whole process group; the server handles it.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, _exit)
    number, lifeline = (int(argument) for argument in arguments)
    connection = Connection(number)
    try:
        settings: DispatcherSettings = connection.recv()
        kinds = settings.load_kinds()
        start_fork_server()  # of the workers
        store = Store.open(settings.database)
        workers = make_workers(settings.load_kinds, settings.dask, settings.workers)
    except EOFError:
        return
    except FlexsidError as error:
        _log.warning("the dispatcher cannot start: %s", error.message)
        sys.exit(1)
    notifier = None
    if settings.notifications is not None:
        channels = read_channels(settings.notifications)
        notifier = Notifier(store, channels, settings.url or "", lambda: dispatcher.is_leading)
    dispatcher = Dispatcher(
        *(store, kinds, workers),
        on_change=lambda: _notify(connection),
        url=settings.url,
        get_failure=None if notifier is None else lambda: notifier.failure,
    )
    configure_interpreter()
    signal.signal(_WAKE, lambda number, frame: dispatcher.wake())
    _notify(connection)
    dispatcher.start()
    if notifier is not None:
        notifier.start()
    try:
        os.read(lifeline, 1)
    finally:
        if notifier is not None:
            notifier.stop()
        dispatcher.stop()
        store.close()


def _exit(number: int, frame: FrameType | None) -> None:
    sys.exit(0)


def _notify(connection: Connection) -> None:
    with suppress(OSError):  # the server has ended, and this process will end too
        connection.send_bytes(b"")


if __name__ == "__main__":
    main(sys.argv[1:])
