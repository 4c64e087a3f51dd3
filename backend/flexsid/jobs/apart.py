"""Apart: the dispatcher in a process of its own.

Preparing tasks and keeping results takes time of an interpreter; in the server's own
process every page would wait for it.
"""

from __future__ import annotations

import logging
import queue
import signal
import sys
import threading
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from types import FrameType
from typing import Any

from flexsid.errors import FlexsidError
from flexsid.jobs.child import Program
from flexsid.jobs.dispatcher import Dispatcher
from flexsid.jobs.executors import make_workers
from flexsid.jobs.prompt import be_prompt
from flexsid.jobs.steps import Steps
from flexsid.storage.store import Store

_log = logging.getLogger(__name__)

_SETTLE_S = 2.0  # pages come first when a server has just started
_AGAIN_S = 1.0
_LEAVE_S = 10.0  # more than it takes to kill the workers and to queue their runs again
_MOST_UNSAID = 16  # beyond that it does not listen; all it needs stands in the database

_Said = tuple[int, Any] | None
"""A run and its task, or that something was queued or cancelled."""


@dataclass(frozen=True, slots=True)
class Duty:
    """Whose runs, how they are carried out, and by whom (see ``make_workers``)."""

    database: str
    load_steps: Callable[[], Steps]
    dask: str | None = None
    workers: int | None = None


class DispatcherApart:
    """A dispatcher in a process of its own, which is started again should it end.

    Parameters
    ----------
    duty
        What it does.
    on_change
        Called, from a thread of its own, after runs have changed.
    """

    def __init__(self, duty: Duty, on_change: Callable[[], None] = lambda: None) -> None:
        self._duty = duty
        self._on_change = on_change
        self._due = threading.Event()
        self._stopping = threading.Event()
        self._starting = threading.Lock()
        self._line = threading.Lock()  # held while something is said, or the pipe is closed
        self._program: Program | None = None
        self._has_begun = False
        self._unsaid: queue.SimpleQueue[_Said] = queue.SimpleQueue()
        self._threads = [
            threading.Thread(target=target, name=f"dispatcher-{k}", daemon=True)
            for k, target in enumerate((self._hear, self._say))
        ]

    def start(self) -> None:
        """Begin when something is to be done, at the latest after the first pages.

        Raises
        ------
        FlexsidError
            If no scheduler of a cluster answers.
        """
        if self._duty.dask is not None:
            make_workers(self._duty.load_steps().compute, self._duty.dask).close()
        for thread in self._threads:
            thread.start()

    def wake(self) -> None:
        """Look at the queue now: something was queued or cancelled."""
        self._put(None)

    def expect(self, run_id: int, task: Any) -> None:
        """Take over the task of a run that was prepared to see whether it can be done."""
        self._put((run_id, task))

    def stop(self) -> None:
        """Kill the workers and queue their runs again, for the next server."""
        with self._starting:
            self._stopping.set()
            program = self._program
        self._due.set()
        self._unsaid.put(None)
        if program is not None:
            program.let_go()
            self._threads[0].join(_LEAVE_S if self._has_begun else 0.0)
            program.kill()
        for thread in self._threads:
            thread.join()
        if program is not None:
            program.close()

    def _put(self, said: _Said) -> None:
        self._due.set()
        if self._unsaid.qsize() < _MOST_UNSAID:
            self._unsaid.put(said)

    def _say(self) -> None:
        """Pass on what is said; only this thread waits if nobody listens."""
        while not self._stopping.is_set():
            said = self._unsaid.get()
            # Where it ended, the next one looks at the queue by itself.
            with self._line, suppress(OSError):
                if self._program is not None:
                    self._program.connection.send(said)

    def _hear(self) -> None:
        """Start the process, hear of changes until it ends, and start the next."""
        self._due.wait(_SETTLE_S)
        while (program := self._begin()) is not None:
            with suppress(EOFError, OSError):
                while True:
                    program.connection.recv_bytes()
                    self._has_begun = True
                    self._on_change()
            if not self._stopping.is_set():
                _log.warning("the dispatcher ended (%s); another starts", program.how_it_ended())
                program.kill()
                with self._line:
                    self._program, self._has_begun = None, False
                    program.close()
                self._stopping.wait(_AGAIN_S)

    def _begin(self) -> Program | None:
        with self._starting:
            if self._stopping.is_set():
                return None
            program = Program(__name__)
            with suppress(OSError):
                program.connection.send(self._duty)
            self._program = program
            return program


def main(arguments: list[str]) -> None:
    """Dispatch until the lifeline ends; connection and lifeline are given by file number."""
    # Ctrl-C reaches the whole group of processes; the server decides what it means.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, _leave)
    number, lifeline = (int(argument) for argument in arguments)
    connection = Connection(number)
    try:
        duty: Duty = connection.recv()
        store = Store.open(duty.database)
        steps = duty.load_steps()
        workers = make_workers(steps.compute, duty.dask, duty.workers)
    except EOFError:
        return
    except FlexsidError as error:
        _log.warning("the dispatcher cannot start: %s", error.message)
        sys.exit(1)
    dispatcher = Dispatcher(store, steps, workers, on_change=lambda: _ring(connection))
    be_prompt()
    _ring(connection)
    dispatcher.start()
    try:
        while lifeline not in wait([connection, lifeline]):
            said: _Said = connection.recv()
            if said is None:
                dispatcher.wake()
            else:
                dispatcher.expect(*said)
    except (EOFError, ConnectionResetError):
        pass
    finally:
        dispatcher.stop()
        store.close()


def _leave(number: int, frame: FrameType | None) -> None:
    sys.exit(0)


def _ring(connection: Connection) -> None:
    with suppress(OSError):  # the server is gone, and so will this process be
        connection.send_bytes(b"")


if __name__ == "__main__":
    main(sys.argv[1:])
