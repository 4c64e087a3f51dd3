"""Execution of one job in this process, without server and workers."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

from flexsid.jobs.kind import Kind, build_job, fail_job
from flexsid.jobs.messages import ComputedMessage, describe_error
from flexsid.jobs.process_id import get_process_id, shorten_process_id
from flexsid.records.job import Job
from flexsid.records.run import EstimationRun, ReportProgress, RunState
from flexsid.storage import queue
from flexsid.storage.queue import StaleAttempt
from flexsid.storage.store import Store
from flexsid.workflow.runs.run_identity import add_hashes

Request = TypeVar("Request")


def execute_run(
    store: Store, requested: EstimationRun, kind: Kind[Any, Any], report: ReportProgress
) -> EstimationRun:
    """Store a run, execute it at once and return it, succeeded or failed; see ``execute_job``."""

    def add() -> int:
        return queue.add(store, add_hashes(store, requested)).id or 0

    return store.runs.get(execute_job(store, kind, add, report).id or 0)


def execute_request(
    store: Store, kind: Kind[Request, Any], request: Request, report: ReportProgress
) -> Job:
    """Return the job of an equal request that succeeded, or execute it; see ``execute_job``."""
    job = build_job(store, kind, request)
    known = queue.find_equal(store, job.request_hash)
    if known is not None and known.state is RunState.SUCCEEDED:
        return known
    return execute_job(store, kind, lambda: queue.add_job(store, job).id or 0, report)


def execute_job(
    store: Store, kind: Kind[Any, Any], add: Callable[[], int], report: ReportProgress
) -> Job:
    """Queue a job, execute it at once and return it, succeeded or failed.

    Parameters
    ----------
    store
        Store of the jobs.
    kind
        Kind of the job.
    add
        Queues the job and returns its id.
    report
        Called with the progress.

    Raises
    ------
    StaleAttempt
        If the job was cancelled, or taken over by a server that started meanwhile.
    """
    with store.transaction():  # no server claims it
        job_id = add()
        job = queue.claim(store, job_id, process_id=get_process_id())
    assert job is not None
    worker = shorten_process_id(get_process_id())
    try:
        outcome = kind.compute(kind.prepare_task(store, job), report)
        kind.save_outcome(store, job, ComputedMessage(outcome, worker))
    except StaleAttempt:
        raise
    except Exception as error:
        fail_job(store, job, describe_error(error, worker))
    except KeyboardInterrupt:
        queue.request_cancel(store, job_id)
        raise
    return store.jobs.get(job_id)
