"""The run table is the job queue: how a run passes from state to state.

Every passage is a conditional update. ``attempt`` counts the starts of a run
and fences it: what an earlier attempt still says, or says after the run was
cancelled, changes nothing.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from datetime import UTC, datetime
from typing import Any

import sqlalchemy as sa

from flexsid.errors import Conflict
from flexsid.records.run import EstimationRun, Method, Progress, RunResult, RunState
from flexsid.storage.paging import Page, read_cursor
from flexsid.storage.store import Store
from flexsid.storage.tables import runs

MOST_ATTEMPTS = 3


class StaleAttempt(Conflict):
    """The run was cancelled or started again; this result comes too late."""

    code = "stale-attempt"


def claim(store: Store, run_id: int | None = None) -> EstimationRun | None:
    """Start a queued run: the one asked for, else the oldest; None where none waits."""
    with store.database.transaction() as connection:
        query = sa.select(runs.c.id).where(runs.c.state == RunState.QUEUED.value)
        if run_id is not None:
            query = query.where(runs.c.id == run_id)
        found = connection.scalar(query.order_by(runs.c.id).limit(1))
        if found is None:
            return None
        claimed = _change(
            store,
            sa.and_(runs.c.id == found, runs.c.state == RunState.QUEUED.value),
            state=RunState.RUNNING,
            attempt=runs.c.attempt + 1,
            started_at=_now(),
            progress=None,
        )
        return store.runs.get(found) if claimed else None


def note_progress(store: Store, run_id: int, attempt: int, progress: Progress) -> bool:
    """Write how far a run is; False where this attempt no longer counts."""
    return _change(store, _is_attempt(run_id, attempt), progress=progress)


def finish(
    store: Store, run_id: int, attempt: int, result: RunResult, versions: Mapping[str, str]
) -> EstimationRun:
    """Keep the result of a run.

    Raises
    ------
    StaleAttempt
        If the run was cancelled or started again meanwhile.
    """
    with store.transaction():
        kept = _change(
            store,
            _is_attempt(run_id, attempt),
            state=RunState.SUCCEEDED,
            result=result,
            versions=dict(versions),
            finished_at=_now(),
            error=None,
        )
        run = store.runs.get(run_id)
        if not kept:
            raise StaleAttempt(
                f"attempt {attempt} of run {run_id} comes too late: the run is {run.state.value}"
                f" in attempt {run.attempt}"
            )
        return run


def fail(store: Store, run_id: int, attempt: int, code: str, message: str) -> bool:
    """Mark a run as failed; False where this attempt no longer counts."""
    return _change(
        store,
        _is_attempt(run_id, attempt),
        state=RunState.FAILED,
        error={"code": code, "message": message},
        finished_at=_now(),
    )


def put_back(store: Store, run_id: int, attempt: int) -> bool:
    """Queue a started run again, as when the server stops."""
    return _change(
        store, _is_attempt(run_id, attempt), state=RunState.QUEUED, started_at=None, progress=None
    )


def retry_or_fail(store: Store, run_id: int, attempt: int, message: str) -> bool:
    """Queue a run whose worker died again, or give it up after the last attempt."""
    if attempt >= MOST_ATTEMPTS:
        return fail(store, run_id, attempt, "worker-died", message)
    return put_back(store, run_id, attempt)


def take_over(store: Store) -> int:
    """Queue again, or give up, what a server that is gone left running; returns how many."""
    with store.transaction():
        left = store.runs.find(state=RunState.RUNNING)
        for run in left:
            assert run.id is not None
            retry_or_fail(
                store,
                run.id,
                run.attempt,
                f"the server stopped {run.attempt} times while it carried this run out",
            )
    return len(left)


def request_cancel(store: Store, run_id: int) -> EstimationRun:
    """Cancel a run that has not ended; whoever carries it out is to be stopped."""
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
        _change(store, runs.c.id == run_id, state=RunState.CANCELLED, finished_at=_now())
        return store.runs.get(run_id)


def delete(store: Store, run_id: int) -> None:
    """Forget a run that has ended."""
    with store.transaction():
        run = store.runs.get(run_id)
        if run.state in (RunState.QUEUED, RunState.RUNNING):
            raise Conflict(f"run {run_id} is {run.state.value}; cancel it first", code="run-active")
        store.runs.delete(run_id)


def still_running(store: Store, attempts: Iterable[tuple[int, int]]) -> set[int]:
    """Return which of these (run, attempt) still count."""
    wanted = dict(attempts)
    query = sa.select(runs.c.id, runs.c.attempt).where(
        runs.c.id.in_(wanted), runs.c.state == RunState.RUNNING.value
    )
    with store.database.reading() as connection:
        rows = connection.execute(query).all()
    return {run_id for run_id, attempt in rows if wanted[run_id] == attempt}


def page(
    store: Store,
    *,
    maneuver_id: int | None = None,
    method: Method | None = None,
    state: RunState | None = None,
    limit: int = 100,
    after: str | None = None,
) -> Page[EstimationRun]:
    """Return runs, newest first."""
    query = sa.select(runs).order_by(runs.c.id.desc()).limit(limit + 1)
    if maneuver_id is not None:
        query = query.where(runs.c.maneuver_id == maneuver_id)
    if method is not None:
        query = query.where(runs.c.method == method.value)
    if state is not None:
        query = query.where(runs.c.state == state.value)
    if after is not None:
        query = query.where(runs.c.id < read_cursor(after))
    with store.database.reading() as connection:
        found = store.runs.decode(connection.execute(query).mappings().all())
    shown = found[:limit]
    return Page(items=shown, next=str(shown[-1].id) if len(found) > limit else None)


def _change(store: Store, condition: sa.ColumnElement[bool], **values: Any) -> bool:
    row = {
        name: value if isinstance(value, sa.ColumnElement) else store.runs.encode_field(name, value)
        for name, value in values.items()
    }
    with store.database.transaction() as connection:
        return connection.execute(sa.update(runs).where(condition).values(row)).rowcount == 1


def _is_attempt(run_id: int, attempt: int) -> sa.ColumnElement[bool]:
    return sa.and_(
        runs.c.id == run_id,
        runs.c.attempt == attempt,
        runs.c.state == RunState.RUNNING.value,
    )


def _now() -> datetime:
    return datetime.now(UTC)
