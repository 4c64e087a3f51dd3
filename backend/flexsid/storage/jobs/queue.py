"""The table of jobs is the queue: state transitions of jobs.

Every transition is a conditional update, written to the log in the same
transaction. ``attempt`` counts the starts of a job and fences it: messages of an
earlier attempt, or of a cancelled job, have no effect.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import asdict
from datetime import UTC, datetime
from typing import Any

import sqlalchemy as sa
from sqlalchemy.engine import Connection

from flexsid.errors import Conflict
from flexsid.records.job import Job
from flexsid.records.run import EstimationRun, Progress, Provenance, RunResult, RunState
from flexsid.storage.access import Access, check_unfinished_jobs, storing_in_campaign, using_access
from flexsid.storage.jobs import job_log, leases
from flexsid.storage.lists import run_list
from flexsid.storage.lists.run_list import ESTIMATION, store_summary
from flexsid.storage.store import Store
from flexsid.storage.tables import batch_runs, jobs, runs, searches

MOST_DEATHS = 3
"""Number of worker deaths after which a job fails."""

SEARCH = "structure-search"
"""Kind of the jobs that are model structure searches."""

ENDED = (RunState.SUCCEEDED, RunState.FAILED, RunState.CANCELLED)

# Records that repeat the state of their job, and their column with its id.
_RECORDS = {ESTIMATION: (runs, runs.c.id), SEARCH: (searches, searches.c.job_id)}
_QUEUED = jobs.c.state == RunState.QUEUED.value
_RUNNING = jobs.c.state == RunState.RUNNING.value
_UNSUCCESSFUL = (RunState.FAILED.value, RunState.CANCELLED.value)
_first = jobs.alias("first")
_may_start = sa.or_(
    jobs.c.after_job_id.is_(None),
    sa.exists().where(
        _first.c.id == jobs.c.after_job_id, _first.c.state == RunState.SUCCEEDED.value
    ),
)

JOB_CLASS = sa.case(
    (jobs.c.kind != ESTIMATION, 0),
    (sa.exists().where(batch_runs.c.run_id == jobs.c.id), 2),
    else_=1,
)
"""Class of a job among those of its analyst, the first that starts: computations whose result
somebody waits for, single runs, runs of batches."""


class StaleAttempt(Conflict):
    """The job was cancelled or started again before this result."""

    code = "stale-attempt"


def add(store: Store, run: EstimationRun) -> EstimationRun:
    """Queue a run; raises QueueFull beyond the quota of its author."""
    with store.database.transaction() as connection:
        check_unfinished_jobs(connection, run.author, store.quotas)
        added = store.runs.add(run)
        assert added.id is not None
        job_log.write(connection, [added.id], "queued", message=_describe_request(run.author))
        return added


def add_job(store: Store, job: Job) -> Job:
    """Queue a job; raises QueueFull beyond the quota of its author."""
    with store.database.transaction() as connection:
        check_unfinished_jobs(connection, job.author, store.quotas)
        added = store.jobs.add(job)
        assert added.id is not None
        job_log.write(connection, [added.id], "queued", message=_describe_request(job.author))
        return added


@contextmanager
def storing_result(store: Store, job: Job) -> Iterator[None]:
    """Store the result of a job in its campaign, and audit it as a change by its author.

    Authors without an account, as in the personal mode, are not audited.
    """
    with store.database.reading() as connection:
        campaign = connection.scalar(sa.select(jobs.c.aircraft_id).where(jobs.c.id == job.id))
    author = store.accounts.find(name=job.author)
    access = (
        Access(
            account_id=author[0].id,
            author=job.author,
            operation=f"job {job.id}",
            campaign=campaign,
        )
        if author
        else None
    )
    with storing_in_campaign(campaign), using_access(access):
        yield


def find_next(
    store: Store, served: Mapping[str, float], *, idle_authors_only: bool = False
) -> int | None:
    """Return the id of the job that should start next; None if none may start.

    Of the highest priority, analysts with the fewest running jobs come first, then those who
    have waited longest since their last start, then those of the earliest request. Of the jobs of
    this analyst those start first that are no runs, then single runs, then those of batches.

    Parameters
    ----------
    store
        Store of the jobs.
    served
        Time of the last start of a job of each analyst.
    idle_authors_only
        Only jobs of analysts without a running job.
    """
    counts = sa.select(jobs.c.author, sa.func.count()).where(_RUNNING).group_by(jobs.c.author)
    with store.database.reading() as connection:
        running: dict[str, int] = {author: n for author, n in connection.execute(counts)}
        candidates = [
            (-priority, running.get(author, 0), served.get(author, 0.0), number, author)
            for priority, author, number in _list_earliest(connection)
            if not (idle_authors_only and running.get(author))
        ]
        if not candidates:
            return None
        priority, *_, author = min(candidates)
        return connection.scalar(
            sa.select(jobs.c.id)
            .where(_QUEUED, jobs.c.priority == -priority, jobs.c.author == author, _may_start)
            .order_by(JOB_CLASS, jobs.c.id)
            .limit(1)
        )


def _list_earliest(connection: Connection) -> Iterator[tuple[int, str, int]]:
    """List priority, analyst and id of the earliest job that may start of each of these pairs.

    By searches of the index: grouping reads every queued job, and so does comparing pairs.
    """
    columns = (jobs.c.priority, jobs.c.author, jobs.c.id)
    query = sa.select(*columns).where(_QUEUED, _may_start).order_by(*columns).limit(1)
    row = connection.execute(query).one_or_none()
    while row is not None:
        yield row.priority, row.author, row.id
        same = query.where(jobs.c.priority == row.priority, jobs.c.author > row.author)
        higher = query.where(jobs.c.priority > row.priority)
        found = connection.execute(same).one_or_none()
        row = connection.execute(higher).one_or_none() if found is None else found


def claim(
    store: Store,
    job_id: int | None = None,
    *,
    process_id: str | None = None,
    epoch: int | None = None,
) -> Job | None:
    """Start a queued job: the given one, else the next; None if it may not start.

    Parameters
    ----------
    store
        Store of the jobs.
    job_id
        Id of the job.
    process_id
        The process that executes it.
    epoch
        Epoch of the lease; without the lease no job is started.
    """
    with store.database.transaction() as connection:
        found = find_next(store, {}) if job_id is None else job_id
        if found is None:
            return None
        condition = sa.and_(jobs.c.id == found, _QUEUED, _may_start)
        if epoch is not None:
            leases.lock(connection)
            condition = sa.and_(condition, leases.is_held(epoch))
        claimed = _change(
            store,
            condition,
            state=RunState.RUNNING,
            attempt=jobs.c.attempt + 1,
            started_at=_now(),
            progress=None,
            process_id=process_id,
        )
        if not claimed:
            return None
        job = store.jobs.get(found)
        job_log.write(connection, [found], "started", job.attempt)
        return job


def note_progress(store: Store, job_id: int, attempt: int, progress: Progress) -> bool:
    """Store the progress of a job; False if this attempt is outdated."""
    return bool(_change(store, _is_attempt(job_id, attempt), lax=True, progress=progress))


def log_message(store: Store, job_id: int, attempt: int, message: str) -> None:
    """Add a message to the log of a job."""
    with store.database.transaction(lax=True) as connection:
        if connection.scalar(sa.select(sa.exists().where(jobs.c.id == job_id))):
            job_log.write(connection, [job_id], "logged", attempt, message)


def finish_job(
    store: Store,
    job_id: int,
    attempt: int,
    result: dict[str, Any] | None,
    versions: Mapping[str, str],
    worker: str | None = None,
) -> None:
    """Store the result of a job.

    Raises
    ------
    StaleAttempt
        If the job was cancelled or started again.
    """
    with store.database.transaction() as connection:
        is_stored = _change(
            store,
            _is_attempt(job_id, attempt),
            state=RunState.SUCCEEDED,
            result=result,
            versions=dict(versions),
            finished_at=_now(),
            error=None,
            worker=worker,
        )
        if not is_stored:
            job = store.jobs.get(job_id)
            raise StaleAttempt(
                f"attempt {attempt} of job {job_id} is outdated: the job is {job.state.value}"
                f" in attempt {job.attempt}"
            )
        job_log.write(connection, [job_id], "succeeded", attempt, worker or "")


def finish(
    store: Store,
    run_id: int,
    attempt: int,
    result: RunResult,
    versions: Mapping[str, str],
    worker: str | None = None,
    provenance: Provenance | None = None,
) -> EstimationRun:
    """Store the result of a run, its provenance, and the hash of both.

    Raises
    ------
    StaleAttempt
        If the run was cancelled or started again.
    """
    values = {"result": result, "versions": dict(versions)}
    values |= {} if provenance is None else asdict(provenance)
    row = {name: store.runs.encode_field(name, value) for name, value in values.items()}
    with store.database.transaction() as connection:
        finish_job(store, run_id, attempt, None, versions, worker)
        connection.execute(sa.update(runs).where(runs.c.id == run_id).values(row))
        run_list.store_hash(connection, run_id)
        run = store.runs.get(run_id)
        store_summary(connection, run)
        return run


def fail(
    store: Store, job_id: int, attempt: int, code: str, message: str, worker: str | None = None
) -> bool:
    """Mark a job and those that wait for it as failed; False if the attempt is outdated."""
    with store.database.transaction() as connection:
        failed = _change(
            store,
            _is_attempt(job_id, attempt),
            state=RunState.FAILED,
            error={"code": code, "message": message},
            finished_at=_now(),
            worker=worker,
        )
        if failed:
            job_log.write(connection, failed, "failed", attempt, message)
            _end_those_waiting(store, failed, RunState.FAILED)
        return bool(failed)


def requeue(store: Store, job_id: int, attempt: int, why: str = "the server stopped") -> bool:
    """Queue a started job again, e.g. when the server stops."""
    with store.database.transaction() as connection:
        done = _change(
            store,
            _is_attempt(job_id, attempt),
            state=RunState.QUEUED,
            started_at=None,
            progress=None,
            process_id=None,
        )
        job_log.write(connection, done, "queued", attempt, why)
        return bool(done)


def retry_or_fail(store: Store, job_id: int, attempt: int, message: str) -> bool:
    """Queue a job again after its worker died, or fail it after ``MOST_DEATHS``.

    ``message`` is the reason; ``{deaths}`` in it is replaced by the number of deaths.
    """
    with store.database.transaction() as connection:
        if not _change(store, _is_attempt(job_id, attempt), deaths=jobs.c.deaths + 1):
            return False
        deaths = connection.scalar(sa.select(jobs.c.deaths).where(jobs.c.id == job_id))
        message = message.replace("{deaths}", str(deaths))
        if deaths is None or deaths >= MOST_DEATHS:
            return fail(store, job_id, attempt, "worker-died", message)
        return requeue(store, job_id, attempt, message)


def requeue_orphans(
    store: Store, is_gone: Callable[[str | None], bool] = lambda process_id: True
) -> int:
    """Queue again, or fail, running jobs of processes that ended; returns their number."""
    query = sa.select(jobs.c.id, jobs.c.attempt, jobs.c.process_id).where(_RUNNING)
    with store.database.transaction() as connection:
        left = [row for row in connection.execute(query) if is_gone(row.process_id)]
        for row in left:
            message = "the server stopped {deaths} times during this job"
            retry_or_fail(store, row.id, row.attempt, message)
    return len(left)


def requeue_unknown(store: Store, process_id: str, known: Collection[int]) -> int:
    """Queue jobs again that are stored as started by a process that does not execute them.

    This happens if the connection to the database fails after a start is stored.
    """
    query = sa.select(jobs.c.id, jobs.c.attempt).where(_RUNNING, jobs.c.process_id == process_id)
    with store.database.transaction() as connection:
        unknown = [row for row in connection.execute(query) if row.id not in known]
        for row in unknown:
            requeue(store, row.id, row.attempt, "the database did not respond")
    return len(unknown)


def request_cancel(store: Store, job_id: int) -> Job:
    """Cancel a queued or running job; its worker is stopped by the dispatcher."""
    with store.transaction():
        job = store.jobs.get(job_id)
        if job.state is RunState.CANCELLED:
            return job
        if job.state in ENDED:
            raise Conflict(
                f"job {job_id} has {job.state.value}; only a queued or running one can be"
                " cancelled",
                code="job-ended",
            )
        cancel(store, [job_id])
        return store.jobs.get(job_id)


def cancel(store: Store, job_ids: Sequence[int]) -> None:
    """Cancel the queued and running jobs of these, and the jobs that wait for them."""
    which = sa.and_(jobs.c.id.in_(job_ids), sa.or_(_QUEUED, _RUNNING))
    with store.database.transaction() as connection:
        found = _change(store, which, state=RunState.CANCELLED, finished_at=_now())
        job_log.write(connection, found, "cancelled")
        _end_those_waiting(store, found, RunState.CANCELLED)


def request_retry(store: Store, job_id: int) -> None:
    """Queue a failed or cancelled job again.

    Raises
    ------
    Conflict
        If the job is in another state.
    """
    with store.transaction():
        job = store.jobs.get(job_id)
        if not retry(store, [job_id]):
            raise Conflict(
                f"job {job_id} is {job.state.value}; only a failed or cancelled one can be"
                " queued again",
                code="job-not-over",
            )


def retry(store: Store, job_ids: Sequence[int]) -> int:
    """Queue the failed and cancelled jobs of these again; returns their number."""
    which = sa.and_(jobs.c.id.in_(job_ids), jobs.c.state.in_(_UNSUCCESSFUL))
    with store.database.transaction() as connection:
        found = _change(
            store,
            which,
            state=RunState.QUEUED,
            error=None,
            progress=None,
            started_at=None,
            finished_at=None,
            deaths=0,
        )
        job_log.write(connection, found, "queued", message="requested again")
    return len(found)


def find_running(store: Store, attempts: Iterable[tuple[int, int]]) -> set[int]:
    """Return the jobs of these (job, attempt) that are running in this attempt."""
    requested = dict(attempts)
    query = sa.select(jobs.c.id, jobs.c.attempt).where(jobs.c.id.in_(requested), _RUNNING)
    with store.database.reading() as connection:
        rows = connection.execute(query).all()
    return {job_id for job_id, attempt in rows if requested[job_id] == attempt}


def find_equal(store: Store, request_hash: str | None) -> Job | None:
    """Return the newest job with this request that has not failed or been cancelled.

    Without a hash no job is equal.
    """
    if request_hash is None:
        return None
    is_equal = jobs.c.request_hash == request_hash
    return _find_newest(store, is_equal, jobs.c.state.not_in(_UNSUCCESSFUL))


def find_newest(store: Store, request_hash: str) -> Job | None:
    """Return the newest job with this request, in any state."""
    return _find_newest(store, jobs.c.request_hash == request_hash)


def _find_newest(store: Store, *conditions: sa.ColumnElement[bool]) -> Job | None:
    with store.database.reading() as connection:
        found = connection.scalar(sa.select(sa.func.max(jobs.c.id)).where(*conditions))
        return None if found is None else store.jobs.get(found)


def _end_those_waiting(store: Store, job_ids: Sequence[int], state: RunState) -> None:
    """End the queued jobs that start from the result of failed or cancelled jobs."""
    if not job_ids:
        return
    which = f"run {job_ids[0]}" if len(job_ids) == 1 else "the run"
    message = f"{which}, whose result it starts from, was cancelled"
    if state is RunState.FAILED:
        message = f"{which}, whose result it starts from, failed; queue both again"
    error = {"code": "start-missing", "message": message}
    with store.database.transaction() as connection:
        found = _change(
            store,
            sa.and_(jobs.c.after_job_id.in_(job_ids), _QUEUED),
            state=state,
            finished_at=_now(),
            error=error if state is RunState.FAILED else None,
        )
        job_log.write(connection, found, state.value, message=message)
        _end_those_waiting(store, found, state)


def _change(
    store: Store, condition: sa.ColumnElement[bool], *, lax: bool = False, **values: Any
) -> list[int]:
    """Change the jobs that meet a condition, and their records; return the ids of the jobs."""
    row = {
        name: value
        if isinstance(value, sa.ColumnElement) or name not in store.jobs.fields
        else store.jobs.encode_field(name, value)
        for name, value in values.items()
    }
    update = sa.update(jobs).where(condition).values(row).returning(jobs.c.id, jobs.c.kind)
    changed: dict[str, list[int]] = {}
    with store.database.transaction(lax=lax) as connection:
        for number, kind in connection.execute(update):
            changed.setdefault(kind, []).append(number)
        for kind, ids in changed.items():
            if kind not in _RECORDS:
                continue
            table, key = _RECORDS[kind]
            repeated = {
                name: sa.select(jobs.c[name]).where(jobs.c.id == key).scalar_subquery()
                if isinstance(value, sa.ColumnElement)
                else value
                for name, value in row.items()
                if name in table.c and name not in ("result", "versions")
            }
            if repeated:
                connection.execute(sa.update(table).where(key.in_(ids)).values(repeated))
    return sorted(number for ids in changed.values() for number in ids)


def _is_attempt(job_id: int, attempt: int) -> sa.ColumnElement[bool]:
    return sa.and_(jobs.c.id == job_id, jobs.c.attempt == attempt, _RUNNING)


def _describe_request(author: str) -> str:
    return f"requested by {author}" if author else "requested"


def _now() -> datetime:
    return datetime.now(UTC)
