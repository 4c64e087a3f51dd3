"""Jobs: how far runs are, and a way to stop them."""

from __future__ import annotations

from fastapi import APIRouter, status

from flexsid.api.answers import Job, JobList, job_answer
from flexsid.api.context import TheContext, TheStore
from flexsid.api.wire import After, Identity, Json, Limit
from flexsid.records.run import RunState
from flexsid.storage import queue

router = APIRouter(prefix="/jobs", tags=["jobs"])


@router.get("", response_model=JobList)
def list_jobs(
    store: TheStore, state: RunState | None = None, limit: Limit = 100, after: After = None
) -> Json:
    """List jobs, newest first."""
    page = queue.page(store, state=state, limit=limit, after=after)
    return Json(JobList(items=[job_answer(run) for run in page.items], next=page.next))


@router.get("/{job_id}", response_model=Job)
def get_job(store: TheStore, job_id: Identity) -> Json:
    """Tell how far a job is."""
    return Json(job_answer(store.runs.get(job_id)))


@router.post("/{job_id}/cancel", response_model=Job, status_code=status.HTTP_202_ACCEPTED)
def cancel_job(context: TheContext, job_id: Identity) -> Json:
    """Stop a job that has not ended."""
    run = queue.request_cancel(context.store, job_id)
    context.dispatcher.wake()
    return Json(job_answer(run), status.HTTP_202_ACCEPTED)
