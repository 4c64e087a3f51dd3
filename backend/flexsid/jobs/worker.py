"""Inside a worker process: take a task, compute, tell progress, hand back the outcome.

A worker has no database. It dies with the server, and the server kills it to
cancel its task, so nothing here needs to be tidied up.
"""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
import traceback
from collections.abc import Callable
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from typing import Any

from flexsid.errors import FlexsidError
from flexsid.records.run import Progress


@dataclass(frozen=True, slots=True)
class Progressed:
    """A task is this far."""

    progress: Progress


@dataclass(frozen=True, slots=True)
class Computed:
    """A task is done."""

    outcome: Any


@dataclass(frozen=True, slots=True)
class Failed:
    """A task cannot be done: why, for the analyst, and the trace, for the log."""

    code: str
    message: str
    trace: str = ""


News = Progressed | Computed | Failed


def work(connection: Connection, compute: Callable[[Any, Callable[[Progress], None]], Any]) -> None:
    """Carry out one task after the other until the server hangs up."""
    # Ctrl-C reaches the whole group of processes; the server decides what it means.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_die_with_parent, daemon=True).start()
    while True:
        try:
            task = connection.recv()
        except EOFError:
            return
        news = _carry_out(compute, task, lambda progress: connection.send(Progressed(progress)))
        try:
            connection.send(news)
        except (TypeError, AttributeError, ValueError) as error:  # it cannot be pickled
            connection.send(unexpected(error))


def unexpected(error: Exception) -> Failed:
    """Return what an analyst is told of an error that is ours; the trace is for the log."""
    return Failed(
        "internal-error",
        f"the estimation stopped on an error of the software ({type(error).__name__});"
        " the log of the server has the details",
        "".join(traceback.format_exception(error)),
    )


def _carry_out(
    compute: Callable[[Any, Callable[[Progress], None]], Any],
    task: Any,
    report: Callable[[Progress], None],
) -> News:
    try:
        return Computed(compute(task, report))
    except FlexsidError as error:
        return Failed(error.code, error.message)
    except MemoryError:
        return Failed(
            "out-of-memory", "the estimation needs more memory than there is; take a smaller model"
        )
    except Exception as error:
        return unexpected(error)


def _die_with_parent() -> None:
    """Leave at once when the server is gone, even in the middle of a task."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        wait([parent.sentinel])
        os._exit(1)
