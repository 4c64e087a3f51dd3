"""Job: work in the background, from its request to its result, and the log of all jobs."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime
from typing import Any

from flexsid.records.run import Limits, Progress, RunState


@dataclass(frozen=True, slots=True, kw_only=True)
class Job:
    """One piece of work of a kind.

    ``request`` and ``result`` are of types that the kind defines; the request of an estimation is
    its run, which has the id of the job. ``request_hash`` names the request and all records that
    its result depends on: jobs of equal hash have equal results. Of those that wait the highest
    ``priority`` starts first, and none before ``after_job_id`` has succeeded. ``attempt`` counts
    the starts.
    """

    kind: str
    title: str = ""
    author: str = ""
    request: dict[str, Any] | None = None
    request_hash: str | None = None
    state: RunState = RunState.QUEUED
    attempt: int = 0
    priority: int = 0
    after_job_id: int | None = None
    limits: Limits | None = None
    progress: Progress | None = None
    error: dict[str, str] | None = None  # {"code", "message"}
    result: dict[str, Any] | None = None
    versions: dict[str, str] | None = None
    worker: str | None = None
    created_at: datetime | None = None
    started_at: datetime | None = None
    finished_at: datetime | None = None
    id: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class JobEvent:
    """An entry of the log of a job; ids increase, so that reading can be resumed.

    ``kind`` is ``queued``, ``started``, ``logged`` or the state that a job ended in.
    """

    id: int
    job_id: int
    at: datetime
    kind: str
    attempt: int
    message: str = ""
