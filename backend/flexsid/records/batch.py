"""Batch: runs that were asked for together."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime


@dataclass(frozen=True, slots=True, kw_only=True)
class Batch:
    """What many runs have in common: that somebody wanted them at once."""

    name: str
    author: str = ""
    created_at: datetime | None = None
    id: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class RunEvent:
    """A line of the log of a run; ids grow, so that a reader can go on where it stopped.

    ``kind`` is ``queued``, ``started``, ``said`` or the state that a run ended in.
    """

    id: int
    run_id: int
    at: datetime
    kind: str
    attempt: int
    message: str = ""
