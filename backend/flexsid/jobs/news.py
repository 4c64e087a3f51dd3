"""News: what workers have to tell, wherever they run."""

from __future__ import annotations

import traceback
from dataclasses import dataclass
from typing import Any

from flexsid.records.run import Progress

Key = tuple[int, int]
"""Which run, which attempt."""


@dataclass(frozen=True, slots=True)
class Begun:
    """A worker took up a task; its time counts from now."""


@dataclass(frozen=True, slots=True)
class Progressed:
    """A task is this far."""

    progress: Progress


@dataclass(frozen=True, slots=True)
class ComputedMessage:
    """A task is done, by this worker."""

    outcome: Any
    worker: str = ""


@dataclass(frozen=True, slots=True)
class Failed:
    """A task cannot be done: why, for the analyst, and the trace, for the log."""

    code: str
    message: str
    trace: str = ""
    worker: str = ""


@dataclass(frozen=True, slots=True)
class Died:
    """The worker of a task is gone: killed from outside, out of memory, or crashed."""

    how: str


@dataclass(frozen=True, slots=True)
class Lost:
    """A task was dropped through no fault of its own, as when a scheduler went away."""

    why: str


News = Begun | Progressed | ComputedMessage | Failed | Died | Lost


def unexpected(error: BaseException) -> Failed:
    """Return what an analyst is told of an error that is ours; the trace is for the log."""
    return Failed(
        "internal-error",
        f"the estimation stopped on an error of the software ({type(error).__name__});"
        " the log of the server has the details",
        "".join(traceback.format_exception(error)),
    )
