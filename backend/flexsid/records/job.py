"""Job: work in the background, from its request to its result, and the log of all jobs."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime
from typing import Any

from flexsid.records.run import Limits, Progress, RunState


@dataclass(frozen=True, slots=True, kw_only=True)
class JobSummary:
    """One piece of work of a kind, and its progress.

    ``request`` and ``result`` are of types that the kind defines; the request of an estimation is
    its run, which has the id of the job. Of those that wait the highest ``priority`` starts first,
    and none before ``after_job_id`` has succeeded. ``attempt`` counts the starts.
    """

    id: int | None
    kind: str
    title: str
    request: dict[str, Any] | None
    result: dict[str, Any] | None
    state: RunState
    attempt: int
    priority: int
    after_job_id: int | None
    progress: Progress | None
    worker: str | None
    author: str
    created_at: datetime | None
    started_at: datetime | None
    finished_at: datetime | None


@dataclass(frozen=True, slots=True, kw_only=True)
class Job(JobSummary):
    """A job as it is stored.

    ``request_hash`` names the request and all records that its result depends on: jobs of equal
    hash have equal results.
    """

    request_hash: str | None = None
    limits: Limits | None = None
    error: dict[str, str] | None = None  # {"code", "message"}
    versions: dict[str, str] | None = None


NEW_JOB = Job(
    id=None,
    kind="",
    title="",
    request=None,
    result=None,
    state=RunState.QUEUED,
    attempt=0,
    priority=0,
    after_job_id=None,
    progress=None,
    worker=None,
    author="",
    created_at=None,
    started_at=None,
    finished_at=None,
)
"""A job that is not queued yet; each new one is ``replace(NEW_JOB, kind=...)``."""


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
