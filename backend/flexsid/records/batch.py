"""Batch: runs that were asked for together."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime


@dataclass(frozen=True, slots=True, kw_only=True)
class Batch:
    """Runs requested together."""

    name: str
    author: str = ""
    created_at: datetime | None = None
    id: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class RunEvent:
    """An entry of the log of a run; ids increase, so that reading can be resumed.

    ``kind`` is ``queued``, ``started``, ``logged`` or the state that a run ended in.
    """

    id: int
    run_id: int
    at: datetime
    kind: str
    attempt: int
    message: str = ""
