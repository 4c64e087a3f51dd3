"""Execution of one job in this process, without server and workers."""

from __future__ import annotations

import logging
from collections.abc import Callable
from typing import Any, TypeVar

from flexsid.errors import FlexsidError
from flexsid.jobs.kind import Kind, build_job
from flexsid.jobs.messages import describe_unexpected_error
from flexsid.jobs.process_id import get_process_id, shorten_process_id
from flexsid.jobs.worker import Report
from flexsid.records.job import Job
from flexsid.records.run import EstimationRun, RunState
from flexsid.storage import queue
from flexsid.storage.store import Store
from flexsid.workflow.runs.run_identity import add_hashes

_log = logging.getLogger(__name__)

Request = TypeVar("Request")


def execute_run(
    store: Store, requested: EstimationRun, kind: Kind[Any, Any], report: Report
) -> EstimationRun:
    """Store a run, execute it at once and return it, succeeded or failed; see ``execute_job``."""

    def add() -> int:
        return queue.add(store, add_hashes(store, requested)).id or 0

    return store.runs.get(execute_job(store, kind, add, report).id or 0)


def execute_request(
    store: Store, kind: Kind[Request, Any], request: Request, report: Report
) -> Job:
    """Return the job of an equal request that succeeded, or execute it; see ``execute_job``."""
    job = build_job(store, kind, request)
    known = None if job.request_hash is None else queue.find_equal(store, job.request_hash)
    if known is not None and known.state is RunState.SUCCEEDED:
        return known
    return execute_job(store, kind, lambda: queue.add_job(store, job).id or 0, report)


def execute_job(store: Store, kind: Kind[Any, Any], add: Callable[[], int], report: Report) -> Job:
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
    try:
        outcome = kind.compute(kind.prepare(store, job, kind.read_request(job)), report)
        with queue.storing_result(store, job):
            kind.save(store, job, outcome, shorten_process_id(get_process_id()))
    except queue.StaleAttempt:
        raise
    except FlexsidError as error:
        queue.fail(store, job_id, job.attempt, error.code, error.message)
    except KeyboardInterrupt:
        queue.request_cancel(store, job_id)
        raise
    except Exception as error:
        _log.exception("job %d", job_id)
        failed = describe_unexpected_error(error)
        queue.fail(store, job_id, job.attempt, failed.code, failed.message)
    return store.jobs.get(job_id)
