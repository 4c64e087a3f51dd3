"""Messages of workers to the dispatcher."""

from __future__ import annotations

import traceback
from dataclasses import dataclass
from typing import Any

from flexsid.records.run import Progress

Key = tuple[int, int]
"""Id of a job and number of its attempt."""


@dataclass(frozen=True, slots=True)
class StartedMessage:
    """A worker has started a task; its time limit counts from now."""


@dataclass(frozen=True, slots=True)
class ProgressMessage:
    """Progress of a task."""

    progress: Progress


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
    StartedMessage
    | ProgressMessage
    | ComputedMessage
    | FailedMessage
    | WorkerDiedMessage
    | TaskLostMessage
)


def describe_unexpected_error(error: BaseException) -> FailedMessage:
    """Return the message for an internal error; the trace is for the log."""
    return FailedMessage(
        "internal-error",
        f"the job stopped on an internal error ({type(error).__name__});"
        " the log of the server has the details",
        "".join(traceback.format_exception(error)),
    )
