"""Kind of a job: its request, its computation, and how its result is stored."""

from __future__ import annotations

import hashlib
import logging
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any, Generic, TypeVar

from flexsid.errors import Conflict
from flexsid.jobs.messages import ComputedMessage, FailedMessage, describe_error
from flexsid.records.job import NEW_JOB, Job
from flexsid.records.run import ReportProgress, RunState
from flexsid.request_models import check_request
from flexsid.storage.encoding import decode, describe_type, encode
from flexsid.storage.files import DatabaseUnavailable
from flexsid.storage.jobs import queue
from flexsid.storage.repository import read_once, reading_once
from flexsid.storage.store import Store
from flexsid.workflow.fits.estimation_task import METHODS, read_versions

_log = logging.getLogger(__name__)

Request = TypeVar("Request")
Result = TypeVar("Result")
Save = Callable[[Store, Job, Any, Any], object]


def save_result(store: Store, job: Job, request: object, outcome: object) -> None:
    """End a job with a result in the table.

    Raises
    ------
    StaleAttempt
        If the job was cancelled or started again.
    """
    assert job.id is not None
    queue.finish_job(store, job.id, job.attempt, encode(outcome), read_versions(), job.worker)


def save_records(add: Save) -> Save:
    """Return a function that stores the records of an outcome and ends its job, or neither.

    ``add`` stores the records and returns the result in the table.
    """

    def save(store: Store, job: Job, request: object, outcome: object) -> None:
        with store.transaction():
            save_result(store, job, request, add(store, job, request, outcome))

    return save


@dataclass(frozen=True, slots=True, kw_only=True)
class Kind(Generic[Request, Result]):
    """A kind of job; a worker calls only ``compute``.

    Parameters
    ----------
    name
        Name in the table of jobs.
    label
        Label on the page.
    request
        Type of the request in the table.
    prepare
        Reads the store for a job with its request, and returns a task that can be pickled.
    compute
        Pure function of the task, which reports its progress.
    save
        Stores the outcome of one attempt of a job with its request, and ends the job; by default
        the outcome is the result in the table.
    result
        Type of the result in the table; None if it is stored elsewhere.
    identify
        Checks a request, and returns all records on which the result depends; None for kinds
        whose result is never that of an earlier request.
    priority
        Jobs of higher priority start first.
    usual_s
        Time to expect until one has ended: that of the demonstration. None where it is short. [s]
    page
        Address of what a job works on, or of its result. ``{field}`` is a value of the request,
        ``{result.field}`` of the result, ``{id}`` the job; ``{fuel:percent}`` is 100 times a
        fraction, ``{delay:not}`` the contrary. A search parameter without value is left out.
    """

    name: str
    label: str
    request: type[Request]
    prepare: Callable[[Store, Job, Request], Any]
    compute: Callable[[Any, ReportProgress], Any]
    save: Save = save_result
    result: type[Result] | None = None
    identify: Callable[[Store, Request], tuple[object, ...]] | None = None
    priority: int = 0
    usual_s: float | None = None
    page: str = ""

    def read_request(self, job: Job) -> Request:
        """Return the request of a job."""
        return decode(self.request, job.request or {})

    def prepare_task(self, store: Store, job: Job) -> Any:
        """Return the task of a job; raises as ``prepare``."""
        return self.prepare(store, job, self.read_request(job))

    def save_outcome(self, store: Store, job: Job, message: ComputedMessage) -> None:
        """Store the outcome of a job and end it; if that is not possible, the job fails.

        Raises
        ------
        StaleAttempt
            If the job was cancelled or started again.
        """
        try:
            with queue.storing_result(store, job):
                job = replace(job, worker=message.worker)
                self.save(store, job, self.read_request(job), message.outcome)
        except (queue.StaleAttempt, DatabaseUnavailable):
            raise
        except Exception as error:
            fail_job(store, job, describe_error(error, message.worker))

    def read_result(self, job: Job) -> Result:
        """Return the result of a job that succeeded."""
        assert self.result is not None
        return decode(self.result, job.result)


def fail_job(store: Store, job: Job, failure: FailedMessage) -> None:
    """End a job that failed; the trace of an internal error is written to the log."""
    assert job.id is not None
    if failure.trace:
        _log.error("job %d, attempt %d:\n%s", job.id, job.attempt, failure.trace)
    queue.fail(store, job.id, job.attempt, failure.code, failure.message, failure.worker or None)


@dataclass(frozen=True, slots=True, kw_only=True)
class Analysis(Kind[Request, Result]):
    """A kind of job whose result is stored, with its routes: all doors read it.

    Requesting it needs the permission of an analyst, reading it that of a viewer.

    Parameters
    ----------
    path
        Address of the result below that of the interface; ids of the request are in braces, and
        all other fields in the query.
    noun
        The routes are ``request_{noun}``, ``get_{noun}_job`` and ``get_{noun}``.
    describe
        Returns the title of the job of a request.
    response
        Type that ``GET`` of the address returns; None where a route of its own does.
    show
        Returns that from the result in the table.
    about
        Description of ``GET``.
    """

    path: str
    noun: str
    describe: Callable[[Store, Request], str]
    response: type | None = None
    show: Callable[[Result], object] = lambda result: result
    about: str = ""


Kinds = Mapping[str, Kind[Any, Any]]


def build_job(
    store: Store, kind: Kind[Request, Any], request: Request, author: str = "", title: str = ""
) -> Job:
    """Build the job of a request, with the hash of all that its result depends on.

    A result of another form, by another version, is that of another request.

    Raises
    ------
    BadInput, UnknownRecord
        If a value of the request is not allowed, or one of its records does not exist.
    """
    check_request(request)
    digest = None
    if kind.identify is not None:
        form = describe_type(kind.result)
        content = (METHODS, kind.name, form, request, kind.identify(store, request))
        digest = hashlib.sha256(repr(content).encode()).hexdigest()
    return replace(
        NEW_JOB,
        kind=kind.name,
        title=title,
        author=author,
        request=encode(request),
        request_hash=digest,
        priority=kind.priority,
    )


def submit(
    store: Store, kind: Kind[Request, Any], request: Request, author: str = "", title: str = ""
) -> Job:
    """Queue a job, or return that of an equal request that has not failed.

    An analysis without title gets that of its kind.

    Raises
    ------
    BadInput, UnknownRecord
        As ``build_job``.
    """
    job = build_job(store, kind, request, author, title)
    if not title and isinstance(kind, Analysis):
        job = replace(job, title=kind.describe(store, request))
    with store.database.transaction() as connection:
        store.database.lock_writers(connection)
        return queue.find_equal(store, job.request_hash) or queue.add_job(store, job)


def find_job(store: Store, kind: Kind[Request, Any], request: Request) -> Job | None:
    """Find the newest job of an equal request, one that has not failed if there is one.

    Raises
    ------
    BadInput, UnknownRecord
        As ``build_job``.
    """
    with reading_once():
        digest = build_job(store, kind, request).request_hash
    assert digest is not None
    return queue.find_equal(store, digest) or queue.find_newest(store, digest)


def get_result(store: Store, kind: Kind[Request, Result], request: Request) -> Result:
    """Return the stored result of a request; nothing is computed.

    Raises
    ------
    BadInput, UnknownRecord
        As ``build_job``.
    Conflict
        If the request has not been made, its job has not ended, or it failed.
    """
    with reading_once():
        return read_once((kind.name, repr(request)), lambda: _read_result(store, kind, request))


def _read_result(store: Store, kind: Kind[Request, Result], request: Request) -> Result:
    job = find_job(store, kind, request)
    if job is None or job.state is RunState.CANCELLED:
        raise Conflict(
            f"No result of this request is stored. POST the request to compute it"
            f" ({kind.label.lower()}), and wait for its job.",
            code="not-computed",
        )
    if job.error is not None:
        raise Conflict(job.error["message"], code=job.error["code"], job_id=job.id)
    if job.state is not RunState.SUCCEEDED:
        raise Conflict(
            f"Job {job.id} computes this result and is {job.state.value}; wait until it has ended.",
            code="not-ready",
            job_id=job.id,
        )
    return kind.read_result(job)
