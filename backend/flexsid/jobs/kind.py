"""Kind of a job: its request, its computation, and how its result is stored."""

from __future__ import annotations

import hashlib
import logging
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, fields, is_dataclass, replace
from typing import Any, Generic, TypeVar, get_type_hints

from flexsid.errors import Conflict
from flexsid.jobs.messages import ComputedMessage, FailedMessage, describe_error
from flexsid.records.job import NEW_JOB, Job
from flexsid.records.run import ReportProgress, RunState
from flexsid.request_models import check_request
from flexsid.storage.copies.snapshot import open_snapshot, take_snapshot
from flexsid.storage.encoding import decode, describe_type, encode
from flexsid.storage.files import DatabaseUnavailable
from flexsid.storage.jobs import queue
from flexsid.storage.repository import read_once, reading_once
from flexsid.storage.store import Store
from flexsid.text import count_noun
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


@dataclass(frozen=True, slots=True)
class SnapshotTask:
    """Request with all records that its computation needs."""

    snapshot: bytes
    request: Any


def send_records(store: Store, job: Job, request: Any) -> SnapshotTask:
    """Return a request with the maneuvers, runs and designs that its fields name."""
    named = (_list_ids(request, record) for record in ("maneuver", "run", "design"))
    return SnapshotTask(take_snapshot(store, *named), request)


def _list_ids(request: Any, record: str) -> tuple[int, ...]:
    """List the ids of records of a kind: runs are named ``run_ids``, ``other_run_id`` and so on."""
    names = [one.name for one in fields(request)]
    given = [getattr(request, one) for one in names if re.search(rf"(^|_){record}_ids?$", one)]
    parts = (one if isinstance(one, tuple) else (one,) for one in given if one is not None)
    return tuple(number for part in parts for number in part)


def in_snapshot(
    compute: Callable[[Store, Any, ReportProgress], Any],
) -> Callable[[SnapshotTask, ReportProgress], Any]:
    """Return the computation of a task from that of its request in a store."""
    return lambda task, report: compute(open_snapshot(task.snapshot), task.request, report)


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
        Reads the store for a job with its request, and returns a task that can be pickled; by
        default the request with the records that it names, for ``in_snapshot``.
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
    describe
        Returns the title of the job of a request that is given none.
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
    compute: Callable[[Any, ReportProgress], Any]
    prepare: Callable[[Store, Job, Request], Any] = send_records
    save: Save = save_result
    result: type[Result] | None = None
    identify: Callable[[Store, Request], tuple[object, ...]] | None = None
    describe: Callable[[Store, Request], str] = lambda store, request: ""
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


_NAMES: dict[str, Callable[[Store, int], str]] = {
    "design": lambda store, number: store.designs.get(number).name,
    "maneuver": lambda store, number: store.maneuvers.get(number).label,
    "prediction": lambda store, number: store.predictions.get(number).source,
    "responses": lambda store, number: store.measured_responses.get(number).name,
    "run": lambda store, number: f"run {number}",
}


def describe_records(store: Store, request: Any) -> str:
    """Return the name of the record of a request, or their number: those of its first field."""
    name = fields(request)[0].name
    value = getattr(request, name)
    if is_dataclass(value):
        return describe_records(store, value)
    record = re.sub("_ids?$", "", name)
    numbers = value if isinstance(value, tuple) else (value,)
    if len(numbers) != 1:
        return count_noun(len(numbers), record)
    return _NAMES[record](store, *numbers)


@dataclass(frozen=True, slots=True, kw_only=True)
class Analysis(Kind[Request, Result]):
    """A kind of job whose result is stored, with all its doors, which read this value.

    Requesting it needs the permission of an analyst, reading it that of a viewer.

    Parameters
    ----------
    path
        Address of the result below that of the interface; ids of the request are in braces, and
        all other fields in the query.
    tag
        Group of its routes in the documentation.
    about
        What ``GET`` of the address returns and the command prints, a sentence that continues
        "Return the stored", and remarks after it; empty where the result has routes of its own.
    shows
        Field of the result that is returned; the whole result by default.
    noun
        The routes are ``request_{noun}``, ``get_{noun}_job`` and ``get_{noun}``; the name by
        default.
    command
        Command line of its own, with the options of the request; without one by default.
    example
        Parameters of a request of the demonstration that differ from those usual for their names.
    """

    path: str
    tag: str
    about: str = ""
    shows: str = ""
    noun: str = ""
    describe: Callable[[Store, Request], str] = describe_records
    command: str = ""
    example: Mapping[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Name the routes."""
        object.__setattr__(self, "noun", self.noun or self.name.replace("-", "_"))

    @property
    def response(self) -> Any:
        """Type of what is returned."""
        return get_type_hints(self.result)[self.shows] if self.shows else self.result

    def show(self, result: Result) -> object:
        """Return what is returned of a result."""
        return getattr(result, self.shows) if self.shows else result

    @property
    def reading_routes(self) -> tuple[str, ...]:
        """Names of the routes that find its job and return its result."""
        return (f"get_{self.noun}_job", *((f"get_{self.noun}",) if self.about else ()))


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

    A job without title gets that of its kind.

    Raises
    ------
    BadInput, UnknownRecord
        As ``build_job``.
    """
    job = build_job(store, kind, request, author, title)
    job = replace(job, title=title or kind.describe(store, request))
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
