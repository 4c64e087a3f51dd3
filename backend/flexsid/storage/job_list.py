"""The list of jobs, newest first, and the throughput of the queue."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from typing import Any

import sqlalchemy as sa
from sqlalchemy.engine import RowMapping

from flexsid.errors import UnknownRecord
from flexsid.records.run import Method, Progress, RunState
from flexsid.storage.paging import Page, read_cursor
from flexsid.storage.store import Store
from flexsid.storage.tables import batch_runs, maneuvers, runs


@dataclass(frozen=True, slots=True, kw_only=True)
class JobError:
    """Why a run failed."""

    code: str
    message: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Job:
    """Progress of a run; a job has the id of its run."""

    id: int
    run_id: int
    maneuver_id: int
    maneuver_label: str
    method: Method
    state: RunState
    attempt: int
    priority: int
    after_run_id: int | None
    progress: Progress | None
    error: JobError | None
    worker: str | None
    author: str
    created_at: datetime
    started_at: datetime | None
    finished_at: datetime | None


_shown = (
    *(runs.c.id, runs.c.maneuver_id, maneuvers.c.label.label("maneuver_label"), runs.c.method),
    *(runs.c.state, runs.c.attempt, runs.c.priority, runs.c.after_run_id, runs.c.progress),
    *(runs.c.error, runs.c.worker, runs.c.author),
    *(runs.c.created_at, runs.c.started_at, runs.c.finished_at),
)
_jobs = sa.select(*_shown).join(maneuvers, maneuvers.c.id == runs.c.maneuver_id)


def read_page(
    store: Store,
    *,
    state: RunState | None = None,
    batch_id: int | None = None,
    ids: Sequence[int] | None = None,
    limit: int = 100,
    after: str | None = None,
) -> Page[Job]:
    """Return jobs, newest first."""
    query = _jobs.order_by(runs.c.id.desc()).limit(limit + 1)
    if state is not None:
        query = query.where(runs.c.state == state.value)
    if batch_id is not None:
        members = sa.select(batch_runs.c.run_id).where(batch_runs.c.batch_id == batch_id)
        query = query.where(runs.c.id.in_(members))
    if ids is not None:
        query = query.where(runs.c.id.in_(ids))
    if after is not None:
        query = query.where(runs.c.id < read_cursor(after))
    found = _read(store, query)
    shown = found[:limit]
    return Page(items=shown, next=str(shown[-1].id) if len(found) > limit else None)


def get(store: Store, run_id: int) -> Job:
    """Return one job."""
    found = _read(store, _jobs.where(runs.c.id == run_id))
    if not found:
        raise UnknownRecord(f"there is no run {run_id}")
    return found[0]


def list_running(store: Store) -> list[Job]:
    """Return the running jobs."""
    return _read(store, _jobs.where(runs.c.state == RunState.RUNNING.value))


@dataclass(frozen=True, slots=True, kw_only=True)
class Throughput:
    """Number of runs by state, and of those that ended in the last ``window_s`` seconds."""

    states: dict[RunState, int]
    ended: int
    window_s: float

    @property
    def remaining_s(self) -> float | None:
        """Time until the queue is empty at this rate; None if no run ended in the window. [s]"""
        left = self.states[RunState.QUEUED] + self.states[RunState.RUNNING]
        if left == 0:
            return 0.0
        return left * self.window_s / self.ended if self.ended else None


def count_throughput(store: Store, window_s: float = 60.0) -> Throughput:
    """Count runs by state, and those that ended in the window."""
    now = datetime.now(UTC)
    lately = runs.c.finished_at >= now - timedelta(seconds=window_s)
    query = sa.select(sa.func.count(), sa.func.min(runs.c.started_at)).where(lately)
    with store.database.reading() as connection:
        states = connection.execute(
            sa.select(runs.c.state, sa.func.count()).group_by(runs.c.state)
        ).all()
        ended, first = connection.execute(query).one()
    if first is not None:  # the first run may have started within the window
        window_s = max(1.0, min(window_s, (now - first).total_seconds()))
    return Throughput(states=count_states(states), ended=ended, window_s=window_s)


def count_states(rows: Iterable[Any]) -> dict[RunState, int]:
    """Return counts by state, zero for states without runs."""
    found = {state: count for state, count in rows}
    return {state: found.get(state.value, 0) for state in RunState}


def _read(store: Store, query: sa.Executable) -> list[Job]:
    with store.database.reading() as connection:
        return [_job(row) for row in connection.execute(query).mappings()]


def _job(row: RowMapping) -> Job:
    progress, error = row["progress"], row["error"]
    values = dict(row) | {
        "run_id": row["id"],
        "method": Method(row["method"]),
        "state": RunState(row["state"]),
        "progress": None if progress is None else Progress(**progress),
        "error": None if error is None else JobError(**error),
    }
    return Job(**values)
