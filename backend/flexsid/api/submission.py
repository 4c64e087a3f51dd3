"""Responses to requests that are computed in the background."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from fastapi import status

from flexsid.api.context import Context
from flexsid.api.serialization import Json
from flexsid.jobs.kind import Kind, find_job, submit
from flexsid.storage import job_list
from flexsid.storage.store import Store


def submit_job(
    context: Context, kind: Kind[Any, Any], request: object, author: str, title: str
) -> Json:
    """Queue a job, or find that of an equal request; ``Location`` is its address."""
    job = submit(context.store, kind, request, author, title)
    assert job.id is not None
    context.dispatcher.wake()
    location = {"Location": f"/api/v1/jobs/{job.id}"}
    return Json(job_list.get(context.store, job.id), status.HTTP_202_ACCEPTED, location)


@dataclass(frozen=True, slots=True)
class KnownJob:
    """The newest job of an equal request; null if there is none."""

    job: job_list.JobItem | None


def respond_with_job(store: Store, kind: Kind[Any, Any], request: object) -> Json:
    """Return the newest job of an equal request."""
    job = find_job(store, kind, request)
    return Json(KnownJob(None if job is None else job_list.get(store, job.id or 0)))
