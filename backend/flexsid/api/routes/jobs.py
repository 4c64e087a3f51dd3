"""Jobs of all kinds: progress, log and cancellation."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from fastapi import Query, status

from flexsid.api.context import TheContext, TheStore
from flexsid.api.models.response_models import extend_record, response_of
from flexsid.api.router import make_router
from flexsid.api.serialization import After, Identity, Json, Limit, Reference
from flexsid.records.job import JobEvent
from flexsid.records.run import RunState
from flexsid.storage import job_list, job_log, leases, queue
from flexsid.storage.job_list import JobItem, Throughput
from flexsid.storage.paging import Items, Page
from flexsid.text import split_ids

router = make_router("/jobs", tag="jobs")


@dataclass(frozen=True, slots=True, kw_only=True)
class WorkerPool:
    """The dispatching server, its number of workers, and their jobs.

    ``without_workers_s`` is the time since the last worker was connected [s], ``valid_until`` the
    end of the certificate by which workers of a cluster are reached.
    """

    server: str
    location: str
    workers: int
    running: list[int]
    without_workers_s: float = 0.0
    valid_until: str | None = None


@response_of(Throughput)
class QueueStatus:
    """The queue: jobs by state, recently ended ones, and estimated time until it is empty.

    ``typical_s`` is the median computing time of recent jobs of each kind. [s]
    """

    remaining_s: float | None
    worker_pool: WorkerPool | None


@router.get("", response_model=Page[JobItem])
def list_jobs(
    store: TheStore,
    state: RunState | None = None,
    kind: Annotated[str | None, Query(max_length=32, description="Kind of job.")] = None,
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
            store, state=state, kind=kind, batch_id=batch_id, ids=only, limit=limit, after=after
        )
    )


@router.get("/status", response_model=QueueStatus)
def get_queue_status(store: TheStore) -> Json:
    """Return the state of the queue and its workers."""
    rate = job_list.count_throughput(store)
    pool = leases.status(store)
    return Json(
        extend_record(
            QueueStatus,
            rate,
            # A dispatcher of another version may report more.
            worker_pool=None
            if pool is None
            else WorkerPool(**{k: v for k, v in pool.items() if k in WorkerPool.__slots__}),
        )
    )


@router.get("/{job_id}", response_model=JobItem)
def get_job(store: TheStore, job_id: Identity) -> Json:
    """Return the progress of a job."""
    return Json(job_list.get(store, job_id))


@router.get("/{job_id}/log", response_model=Items[JobEvent])
def get_job_log(store: TheStore, job_id: Identity) -> Json:
    """Return the log of a job."""
    job_list.get(store, job_id)
    return Json(Items(items=job_log.read_log(store, job_id)))


@router.post("/{job_id}/cancel", response_model=JobItem, status_code=status.HTTP_202_ACCEPTED)
def cancel_job(context: TheContext, job_id: Identity) -> Json:
    """Cancel a job that has not ended."""
    queue.request_cancel(context.store, job_id)
    context.dispatcher.wake()
    return Json(job_list.get(context.store, job_id), status.HTTP_202_ACCEPTED)


@router.post("/{job_id}/retry", response_model=JobItem, status_code=status.HTTP_202_ACCEPTED)
def retry_job(context: TheContext, job_id: Identity) -> Json:
    """Queue a failed or cancelled job again."""
    with context.store.transaction():  # as it was queued; it may start at once
        queue.request_retry(context.store, job_id)
        queued = job_list.get(context.store, job_id)
    context.dispatcher.wake()
    return Json(queued, status.HTTP_202_ACCEPTED)
