"""Processes of jobs: their interpreter, and messages of workers to the dispatcher."""

from __future__ import annotations

import gc
import sys
import traceback
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

from flexsid.errors import FlexsidError
from flexsid.records.run import Progress

# --- Messages of workers to the dispatcher --------------------------------------------------------

Key = tuple[int, int]
"""Id of a job and number of its attempt."""


@dataclass(frozen=True, slots=True)
class ProgressMessage:
    """Progress of a task; None when it starts, and its time limit counts from then."""

    progress: Progress | None = None


@dataclass(frozen=True, slots=True)
class ComputedMessage:
    """A task has been computed by this worker."""

    outcome: Any
    worker: str = ""


@dataclass(frozen=True, slots=True)
class FailedMessage:
    """A task has failed: message for the analyst, trace for the log."""

    code: str
    message: str
    trace: str = ""
    worker: str = ""


@dataclass(frozen=True, slots=True)
class WorkerDiedMessage:
    """The worker of a task has died: killed, out of memory, or crashed."""

    reason: str


@dataclass(frozen=True, slots=True)
class TaskLostMessage:
    """A task was dropped, e.g. because the connection to the scheduler was lost."""

    reason: str


WorkerMessage = (
    ProgressMessage | ComputedMessage | FailedMessage | WorkerDiedMessage | TaskLostMessage
)


def describe_error(error: BaseException, worker: str = "") -> FailedMessage:
    """Return the message for an error of a job; the trace of an internal one is for the log."""
    if isinstance(error, FlexsidError):
        return FailedMessage(error.code, error.message, worker=worker)
    if isinstance(error, MemoryError):
        message = (
            "the job needs more memory than its limit; use a smaller model or band,"
            " or raise the memory limit"
        )
        return FailedMessage("out-of-memory", message, worker=worker)
    return FailedMessage(
        "internal-error",
        f"the job stopped on an internal error ({type(error).__name__});"
        " the log of the server has the details",
        "".join(traceback.format_exception(error)),
        worker,
    )


# --- Interpreter settings of a process that starts fast, and serves requests ----------------------

_OLD_GENERATION = 200
_SWITCH_S = 5e-4  # default 5 ms, which each step of another thread would cost a request


@contextmanager
def loading() -> Iterator[None]:
    """Load modules and routes without the garbage collector, a quarter of the time.

    They are not garbage, and there are a million of them for each collection to check.
    """
    gc.disable()
    try:
        yield
    finally:
        gc.freeze()
        gc.enable()


def configure_interpreter() -> None:
    """Shorten the thread switch interval and freeze loaded objects for the garbage collector.

    A full collection takes a tenth of a second, during which no request is served; the
    oldest generation is collected less often.
    """
    sys.setswitchinterval(_SWITCH_S)
    gc.collect()
    gc.freeze()
    gc.set_threshold(*gc.get_threshold()[:2], _OLD_GENERATION)
