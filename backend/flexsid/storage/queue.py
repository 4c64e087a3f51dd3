"""The run table is the job queue: state transitions of runs.

Every transition is a conditional update, written to the log in the same
transaction. ``attempt`` counts the starts of a run and fences it: messages of an
earlier attempt, or of a cancelled run, have no effect.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import asdict
from datetime import UTC, datetime
from typing import Any

import sqlalchemy as sa

from flexsid.errors import Conflict
from flexsid.records.run import EstimationRun, Progress, Provenance, RunResult, RunState
from flexsid.storage import leases, run_log, run_results
from flexsid.storage.store import Store
from flexsid.storage.tables import runs

MOST_DEATHS = 3
"""Number of worker deaths after which a run fails."""

_QUEUED = runs.c.state == RunState.QUEUED.value
_first = runs.alias("first")
_may_start = sa.or_(
    runs.c.after_run_id.is_(None),
    sa.exists().where(
        _first.c.id == runs.c.after_run_id, _first.c.state == RunState.SUCCEEDED.value
    ),
)


class StaleAttempt(Conflict):
    """The run was cancelled or started again before this result."""

    code = "stale-attempt"


def add(store: Store, run: EstimationRun) -> EstimationRun:
    """Queue a run."""
    with store.database.transaction() as connection:
        added = store.runs.add(run)
        assert added.id is not None
        run_log.write(connection, [added.id], "queued", message=_describe_request(run.author))
        return added


def claim(
    store: Store,
    run_id: int | None = None,
    *,
    process_id: str | None = None,
    epoch: int | None = None,
) -> EstimationRun | None:
    """Start a queued run: the given one, else that of highest priority; None if none may start.

    Parameters
    ----------
    store
        Store of the runs.
    run_id
        Id of the run.
    process_id
        The process that executes it.
    epoch
        Epoch of the lease; without the lease no run is started.
    """
    with store.database.transaction() as connection:
        query = sa.select(runs.c.id).where(_QUEUED, _may_start)
        if run_id is not None:
            query = query.where(runs.c.id == run_id)
        query = query.order_by(runs.c.priority.desc(), runs.c.id).limit(1)
        found = connection.scalar(query)
        if found is None:
            return None
        condition = sa.and_(runs.c.id == found, _QUEUED)
        if epoch is not None:
            condition = sa.and_(condition, leases.is_held(epoch))
        claimed = _change(
            store,
            condition,
            state=RunState.RUNNING,
            attempt=runs.c.attempt + 1,
            started_at=_now(),
            progress=None,
            process_id=process_id,
        )
        if not claimed:
            return None
        run = store.runs.get(found)
        run_log.write(connection, [found], "started", run.attempt)
        return run


def note_progress(store: Store, run_id: int, attempt: int, progress: Progress) -> bool:
    """Store the progress of a run; False if this attempt is outdated."""
    return _change(store, _is_attempt(run_id, attempt), lax=True, progress=progress)


def log_message(store: Store, run_id: int, attempt: int, message: str) -> None:
    """Add a message to the log of a run."""
    with store.database.transaction(lax=True) as connection:
        if connection.scalar(sa.select(sa.exists().where(runs.c.id == run_id))):
            run_log.write(connection, [run_id], "logged", attempt, message)


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
    with store.database.transaction() as connection:
        is_stored = _change(
            store,
            _is_attempt(run_id, attempt),
            state=RunState.SUCCEEDED,
            result=result,
            versions=dict(versions),
            finished_at=_now(),
            error=None,
            worker=worker,
            **({} if provenance is None else asdict(provenance)),
        )
        if not is_stored:
            run = store.runs.get(run_id)
            raise StaleAttempt(
                f"attempt {attempt} of run {run_id} is outdated: the run is {run.state.value}"
                f" in attempt {run.attempt}"
            )
        run_results.store_hash(connection, run_id)
        run_log.write(connection, [run_id], "succeeded", attempt, worker or "")
        return store.runs.get(run_id)


def fail(
    store: Store, run_id: int, attempt: int, code: str, message: str, worker: str | None = None
) -> bool:
    """Mark a run and those that wait for it as failed; False if the attempt is outdated."""
    with store.database.transaction() as connection:
        failed = _change(
            store,
            _is_attempt(run_id, attempt),
            state=RunState.FAILED,
            error={"code": code, "message": message},
            finished_at=_now(),
            worker=worker,
        )
        if failed:
            run_log.write(connection, [run_id], "failed", attempt, message)
            _end_those_waiting(store, [run_id], RunState.FAILED)
        return failed


def requeue(store: Store, run_id: int, attempt: int, why: str = "the server stopped") -> bool:
    """Queue a started run again, e.g. when the server stops."""
    with store.database.transaction() as connection:
        done = _change(
            store,
            _is_attempt(run_id, attempt),
            state=RunState.QUEUED,
            started_at=None,
            progress=None,
            process_id=None,
        )
        if done:
            run_log.write(connection, [run_id], "queued", attempt, why)
        return done


def retry_or_fail(store: Store, run_id: int, attempt: int, message: str) -> bool:
    """Queue a run again after its worker died, or fail it after ``MOST_DEATHS``.

    ``message`` is the reason; ``{deaths}`` in it is replaced by the number of deaths.
    """
    with store.database.transaction() as connection:
        died = _change(store, _is_attempt(run_id, attempt), deaths=runs.c.deaths + 1)
        if not died:
            return False
        deaths = connection.scalar(sa.select(runs.c.deaths).where(runs.c.id == run_id))
        message = message.format(deaths=deaths)
        if deaths is None or deaths >= MOST_DEATHS:
            return fail(store, run_id, attempt, "worker-died", message)
        return requeue(store, run_id, attempt, message)


def requeue_orphans(
    store: Store, is_gone: Callable[[str | None], bool] = lambda process_id: True
) -> int:
    """Queue again, or fail, running runs of processes that ended; returns their number."""
    query = sa.select(runs.c.id, runs.c.attempt, runs.c.process_id).where(
        runs.c.state == RunState.RUNNING.value
    )
    with store.database.transaction() as connection:
        left = [row for row in connection.execute(query) if is_gone(row.process_id)]
        for row in left:
            retry_or_fail(
                store,
                row.id,
                row.attempt,
                "the server stopped {deaths} times during this run",
            )
    return len(left)


def requeue_unknown(store: Store, process_id: str, known: Iterable[int]) -> int:
    """Queue runs again that are stored as started by a process that does not execute them.

    This happens if the connection to the database fails after a start is stored.
    """
    query = sa.select(runs.c.id, runs.c.attempt).where(
        runs.c.state == RunState.RUNNING.value, runs.c.process_id == process_id
    )
    executed = set(known)
    with store.database.transaction() as connection:
        strays = [row for row in connection.execute(query) if row.id not in executed]
        for row in strays:
            requeue(store, row.id, row.attempt, "the database did not respond")
    return len(strays)


def request_cancel(store: Store, run_id: int) -> EstimationRun:
    """Cancel a queued or running run; its worker is stopped by the dispatcher."""
    with store.transaction():
        run = store.runs.get(run_id)
        if run.state is RunState.CANCELLED:
            return run
        if run.state not in (RunState.QUEUED, RunState.RUNNING):
            raise Conflict(
                f"run {run_id} has {run.state.value}; only a queued or running one can be"
                " cancelled",
                code="run-ended",
            )
        cancel(store, [run_id])
        return store.runs.get(run_id)


def cancel(store: Store, run_ids: Sequence[int]) -> None:
    """Cancel the queued and running runs of these, and the runs that wait for them."""
    active = (RunState.QUEUED.value, RunState.RUNNING.value)
    which = sa.and_(runs.c.id.in_(run_ids), runs.c.state.in_(active))
    with store.database.transaction() as connection:
        found = list(connection.scalars(sa.select(runs.c.id).where(which)))
        _change(store, which, state=RunState.CANCELLED, finished_at=_now())
        run_log.write(connection, found, "cancelled")
        _end_those_waiting(store, found, RunState.CANCELLED)


def request_retry(store: Store, run_id: int) -> None:
    """Queue a failed or cancelled run again.

    Raises
    ------
    Conflict
        If the run is in another state.
    """
    with store.transaction():
        run = store.runs.get(run_id)
        if not retry(store, [run_id]):
            raise Conflict(
                f"run {run_id} is {run.state.value}; only a failed or cancelled one can be"
                " queued again",
                code="run-not-over",
            )


def retry(store: Store, run_ids: Sequence[int]) -> int:
    """Queue the failed and cancelled runs of these again; returns their number."""
    ended = (RunState.FAILED.value, RunState.CANCELLED.value)
    which = sa.and_(runs.c.id.in_(run_ids), runs.c.state.in_(ended))
    with store.database.transaction() as connection:
        found = list(connection.scalars(sa.select(runs.c.id).where(which)))
        _change(
            store,
            which,
            state=RunState.QUEUED,
            error=None,
            progress=None,
            started_at=None,
            finished_at=None,
            deaths=0,
        )
        run_log.write(connection, found, "queued", message="requested again")
    return len(found)


def find_running(store: Store, attempts: Iterable[tuple[int, int]]) -> set[int]:
    """Return the runs of these (run, attempt) that are running in this attempt."""
    requested = dict(attempts)
    query = sa.select(runs.c.id, runs.c.attempt).where(
        runs.c.id.in_(requested), runs.c.state == RunState.RUNNING.value
    )
    with store.database.reading() as connection:
        rows = connection.execute(query).all()
    return {run_id for run_id, attempt in rows if requested[run_id] == attempt}


def _end_those_waiting(store: Store, run_ids: Sequence[int], state: RunState) -> None:
    """End the queued runs that start from the result of failed or cancelled runs."""
    waiting = sa.and_(runs.c.after_run_id.in_(run_ids), _QUEUED)
    which = f"run {run_ids[0]}" if len(run_ids) == 1 else "the run"
    message = f"{which}, whose result it starts from, was cancelled"
    if state is RunState.FAILED:
        message = f"{which}, whose result it starts from, failed; queue both again"
    with store.database.transaction() as connection:
        found = list(connection.scalars(sa.select(runs.c.id).where(waiting)))
        if not found:
            return
        error = {"code": "start-missing", "message": message}
        _change(
            store,
            runs.c.id.in_(found),
            state=state,
            finished_at=_now(),
            error=error if state is RunState.FAILED else None,
        )
        run_log.write(connection, found, state.value, message=message)
        _end_those_waiting(store, found, state)


def _change(
    store: Store, condition: sa.ColumnElement[bool], *, lax: bool = False, **values: Any
) -> bool:
    row = {
        name: value
        if isinstance(value, sa.ColumnElement) or name not in store.runs.fields
        else store.runs.encode_field(name, value)
        for name, value in values.items()
    }
    with store.database.transaction(lax=lax) as connection:
        return connection.execute(sa.update(runs).where(condition).values(row)).rowcount >= 1


def _is_attempt(run_id: int, attempt: int) -> sa.ColumnElement[bool]:
    return sa.and_(
        runs.c.id == run_id,
        runs.c.attempt == attempt,
        runs.c.state == RunState.RUNNING.value,
    )


def _describe_request(author: str) -> str:
    return f"requested by {author}" if author else "requested"


def _now() -> datetime:
    return datetime.now(UTC)
