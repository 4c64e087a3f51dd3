"""Jobs: progress, log and cancellation of runs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from fastapi import APIRouter, Query, status

from flexsid.api.context import TheContext, TheStore
from flexsid.api.serialization import After, Identity, Json, Limit, Reference, split_ids
from flexsid.records.batch import RunEvent
from flexsid.records.run import RunState
from flexsid.storage import job_list, leases, queue, run_log
from flexsid.storage.job_list import Job

router = APIRouter(prefix="/jobs", tags=["jobs"])


@dataclass(frozen=True, slots=True, kw_only=True)
class JobList:
    """A page of jobs."""

    items: list[Job]
    next: str | None


@dataclass(frozen=True, slots=True, kw_only=True)
class JobLog:
    """The log of a job, oldest entry first."""

    items: list[RunEvent]


@dataclass(frozen=True, slots=True, kw_only=True)
class WorkerPool:
    """The dispatching server, its number of workers, and their runs.

    ``without_workers_s`` is the time since the last worker was connected. [s]
    """

    server: str
    place: str
    workers: int
    running: list[int]
    without_workers_s: float = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class QueueStatus:
    """The queue: runs by state, recently ended ones, and estimated time until it is empty."""

    states: dict[RunState, int]
    ended: int
    window_s: float
    remaining_s: float | None
    worker_pool: WorkerPool | None


@router.get("", response_model=JobList)
def list_jobs(
    store: TheStore,
    state: RunState | None = None,
    batch_id: Reference = None,
    ids: Annotated[
        str | None,
        Query(
            max_length=20_000,
            pattern="^[0-9, ]*$",
            description="Ids of jobs, separated by commas.",
        ),
    ] = None,
    limit: Limit = 100,
    after: After = None,
) -> Json:
    """List jobs, newest first."""
    only = None if ids is None else split_ids(ids, "ids")
    return Json(
        job_list.read_page(
            store, state=state, batch_id=batch_id, ids=only, limit=limit, after=after
        )
    )


@router.get("/status", response_model=QueueStatus)
def get_queue_status(store: TheStore) -> Json:
    """Return the state of the queue and its workers."""
    rate = job_list.count_throughput(store)
    pool = leases.status(store)
    return Json(
        QueueStatus(
            states=rate.states,
            ended=rate.ended,
            window_s=rate.window_s,
            remaining_s=rate.remaining_s,
            worker_pool=None if pool is None else WorkerPool(**pool),
        )
    )


@router.get("/{job_id}", response_model=Job)
def get_job(store: TheStore, job_id: Identity) -> Json:
    """Return the progress of a job."""
    return Json(job_list.get(store, job_id))


@router.get("/{job_id}/log", response_model=JobLog)
def get_job_log(store: TheStore, job_id: Identity) -> Json:
    """Return the log of a job."""
    job_list.get(store, job_id)
    return Json(JobLog(items=run_log.read_log(store, job_id)))


@router.post("/{job_id}/cancel", response_model=Job, status_code=status.HTTP_202_ACCEPTED)
def cancel_job(context: TheContext, job_id: Identity) -> Json:
    """Cancel a job that has not ended."""
    queue.request_cancel(context.store, job_id)
    context.dispatcher.wake()
    return Json(job_list.get(context.store, job_id), status.HTTP_202_ACCEPTED)


@router.post("/{job_id}/retry", response_model=Job, status_code=status.HTTP_202_ACCEPTED)
def retry_job(context: TheContext, job_id: Identity) -> Json:
    """Queue a failed or cancelled job again."""
    queue.request_retry(context.store, job_id)
    context.dispatcher.wake()
    return Json(job_list.get(context.store, job_id), status.HTTP_202_ACCEPTED)
