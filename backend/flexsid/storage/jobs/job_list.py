"""The list of jobs of all kinds, newest first, and the throughput of the queue."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from statistics import median
from typing import Any

import sqlalchemy as sa
from sqlalchemy.engine import RowMapping

from flexsid.errors import UnknownRecord
from flexsid.records.job import JobSummary
from flexsid.records.run import Method, Progress, RunState
from flexsid.storage.jobs.queue import JOB_CLASS
from flexsid.storage.lists.list_query import Page, read_cursor
from flexsid.storage.store import Store
from flexsid.storage.tables import batch_runs, jobs, maneuvers, runs

_RECENT = 300  # ended jobs from which typical times are computed
_SLOWEST = 3.0  # typical times of the slowest kind of job, in which the rate of jobs is counted
_DESIGN, _IMPORT, _GREY_BOX = "excitation-design", "import", "grey-box-fit"
_STORING = (
    *(_DESIGN, _IMPORT, "preflight-simulation", "derivative-prediction", "response-estimation"),
)


@dataclass(frozen=True, slots=True, kw_only=True)
class JobError:
    """Why a job failed."""

    code: str
    message: str


@dataclass(frozen=True, slots=True, kw_only=True)
class JobItem(JobSummary):
    """Progress of a job; the job of a run has its id, maneuver and method.

    ``position`` is the number of queued jobs that start before, without the fairness between
    analysts. ``request`` is omitted for designs, and has only the upload of imports, and no file of
    a model. ``result`` has the ids of the records that the job stored.
    """

    id: int
    created_at: datetime
    run_id: int | None
    maneuver_id: int | None
    method: Method | None
    position: int | None
    error: JobError | None


_is_import = jobs.c.kind == _IMPORT
_shown = (
    *(jobs.c.id, jobs.c.kind, jobs.c.title, maneuvers.c.label, runs.c.maneuver_id, runs.c.method),
    *(jobs.c.state, jobs.c.attempt, jobs.c.priority, jobs.c.after_job_id, jobs.c.progress),
    *(jobs.c.error, jobs.c.worker, jobs.c.author, runs.c.id.label("run_id")),
    *(jobs.c.created_at, jobs.c.started_at, jobs.c.finished_at),
    # Specifications of designs, mappings of imports and results of predictions are large.
    sa.case((jobs.c.kind.in_((_DESIGN, _IMPORT)), None), else_=jobs.c.request).label("request"),
    sa.case((_is_import, jobs.c.request["upload_id"].as_string())).label("upload_id"),
    sa.case((jobs.c.kind.in_(_STORING), jobs.c.result)).label("result"),
)
_jobs = sa.select(*_shown).select_from(
    jobs.outerjoin(runs, runs.c.id == jobs.c.id).outerjoin(
        maneuvers, maneuvers.c.id == runs.c.maneuver_id
    )
)


def read_page(
    store: Store,
    *,
    state: RunState | None = None,
    kind: str | None = None,
    batch_id: int | None = None,
    ids: Sequence[int] | None = None,
    limit: int = 100,
    after: str | None = None,
) -> Page[JobItem]:
    """Return jobs, newest first."""
    query = _jobs.order_by(jobs.c.id.desc()).limit(limit + 1)
    if state is not None:
        query = query.where(jobs.c.state == state.value)
    if kind is not None:
        query = query.where(jobs.c.kind == kind)
    if batch_id is not None:
        members = sa.select(batch_runs.c.run_id).where(batch_runs.c.batch_id == batch_id)
        query = query.where(jobs.c.id.in_(members))
    if ids is not None:
        query = query.where(jobs.c.id.in_(ids))
    if after is not None:
        query = query.where(jobs.c.id < read_cursor(after))
    found = _read(store, query)
    shown = found[:limit]
    return Page(items=shown, next=str(shown[-1].id) if len(found) > limit else None)


def get(store: Store, job_id: int) -> JobItem:
    """Return one job."""
    found = _read(store, _jobs.where(jobs.c.id == job_id))
    if not found:
        raise UnknownRecord(f"there is no job {job_id}")
    return found[0]


def list_running(store: Store) -> list[JobItem]:
    """Return the running jobs."""
    return _read(store, _jobs.where(jobs.c.state == RunState.RUNNING.value))


@dataclass(frozen=True, slots=True, kw_only=True)
class Throughput:
    """Number of jobs by state, and of those that ended in the last ``window_s`` seconds.

    ``typical_s`` is the median computing time of recent jobs of each kind. [s]
    """

    states: dict[RunState, int]
    ended: int
    window_s: float
    typical_s: dict[str, float]

    @property
    def remaining_s(self) -> float | None:
        """Time until the queue is empty at this rate; None if no job ended in the window. [s]"""
        left = self.states[RunState.QUEUED] + self.states[RunState.RUNNING]
        if left == 0:
            return 0.0
        return left * self.window_s / self.ended if self.ended else None


def count_throughput(store: Store, window_s: float = 60.0) -> Throughput:
    """Count jobs by state, and those that ended in the window.

    Where jobs take longer, the window is three times the typical time of the slowest kind.
    """
    recent = (
        sa.select(jobs.c.kind, jobs.c.started_at, jobs.c.finished_at)
        .where(jobs.c.state == RunState.SUCCEEDED.value, jobs.c.started_at.is_not(None))
        .order_by(jobs.c.finished_at.desc())
        .limit(_RECENT)
    )
    times: dict[str, list[float]] = {}
    with store.database.reading() as connection:
        states = connection.execute(
            sa.select(jobs.c.state, sa.func.count()).group_by(jobs.c.state)
        ).all()
        for kind, started, finished in connection.execute(recent):
            times.setdefault(kind, []).append((finished - started).total_seconds())
        typical = {kind: median(each) for kind, each in times.items()}
        window_s = max(window_s, _SLOWEST * max(typical.values(), default=0.0))
        now = datetime.now(UTC)
        lately = jobs.c.finished_at >= now - timedelta(seconds=window_s)
        query = sa.select(sa.func.count(), sa.func.min(jobs.c.started_at)).where(lately)
        ended, first = connection.execute(query).one()
    if first is not None:  # the first job may have started within the window
        window_s = max(1.0, min(window_s, (now - first).total_seconds()))
    return Throughput(
        states=count_states(states), ended=ended, window_s=window_s, typical_s=typical
    )


def count_states(rows: Iterable[Any]) -> dict[RunState, int]:
    """Return counts by state, zero for states without jobs."""
    found = {state: count for state, count in rows}
    return {state: found.get(state.value, 0) for state in RunState}


def count_latest(store: Store, kind: str) -> dict[RunState, int]:
    """Count by state the jobs of a kind since the request of the oldest that has not ended.

    If all have ended, those of the last request are counted.
    """
    of_kind = jobs.c.kind == kind
    active = jobs.c.state.in_((RunState.QUEUED.value, RunState.RUNNING.value))
    with store.database.reading() as connection:
        since = connection.scalar(sa.select(sa.func.min(jobs.c.created_at)).where(of_kind, active))
        if since is None:
            since = connection.scalar(sa.select(sa.func.max(jobs.c.created_at)).where(of_kind))
        if since is None:
            return count_states(())
        query = sa.select(jobs.c.state, sa.func.count()).where(of_kind, jobs.c.created_at >= since)
        return count_states(connection.execute(query.group_by(jobs.c.state)).all())


def find_newest(store: Store, kind: str, **request: int | str) -> JobItem | None:
    """Return the newest job of a kind whose request has these values."""
    equal = jobs.c.kind == kind, *_match(request)
    found = _read(store, _jobs.where(*equal).order_by(jobs.c.id.desc()).limit(1))
    return found[0] if found else None


def list_succeeded(store: Store, kind: str, **request: int | str) -> list[int]:
    """List the ids of succeeded jobs of a kind whose request has these values, newest first."""
    succeeded = jobs.c.kind == kind, jobs.c.state == RunState.SUCCEEDED.value
    query = sa.select(jobs.c.id).where(*succeeded, *_match(request)).order_by(jobs.c.id.desc())
    with store.database.reading() as connection:
        return list(connection.execute(query).scalars())


def _match(request: Mapping[str, int | str]) -> list[sa.ColumnElement[bool]]:
    return [
        (
            jobs.c.request[name].as_integer()
            if isinstance(value, int)
            else jobs.c.request[name].as_string()
        )
        == value
        for name, value in request.items()
    ]


def find_active(store: Store, kind: str) -> list[tuple[int, dict[str, Any]]]:
    """Return id and request of the queued and running jobs of a kind."""
    query = sa.select(jobs.c.id, jobs.c.request).where(
        jobs.c.kind == kind, jobs.c.state.in_((RunState.QUEUED.value, RunState.RUNNING.value))
    )
    with store.database.reading() as connection:
        return [(number, request) for number, request in connection.execute(query)]


def _read(store: Store, query: sa.Executable) -> list[JobItem]:
    with store.database.reading() as connection:
        rows = connection.execute(query).mappings().all()
        positions: dict[int, int] = {}
        queued = [row["id"] for row in rows if row["state"] == RunState.QUEUED.value]
        if queued:
            order = sa.func.row_number().over(
                order_by=(jobs.c.priority.desc(), JOB_CLASS, jobs.c.id)
            )
            waiting = (
                sa.select(jobs.c.id, order.label("number"))
                .where(jobs.c.state == RunState.QUEUED.value)
                .subquery()
            )
            found = sa.select(waiting.c.id, waiting.c.number).where(waiting.c.id.in_(queued))
            positions = {job_id: number - 1 for job_id, number in connection.execute(found)}
    return [_build_item(row, positions.get(row["id"])) for row in rows]


def _build_item(row: RowMapping, position: int | None) -> JobItem:
    values: dict[Any, Any] = dict(row)
    label, upload_id = values.pop("label"), values.pop("upload_id")
    if values["kind"] == _GREY_BOX:
        values["request"] = {k: v for k, v in values["request"].items() if k != "source"}
    progress, error = values["progress"], values["error"]
    values |= {
        "title": label or values["title"],
        "request": values["request"] if upload_id is None else {"upload_id": upload_id},
        "method": None if values["method"] is None else Method.restore(values["method"]),
        "state": RunState(values["state"]),
        "position": position,
        "progress": None if progress is None else Progress(**progress),
        "error": None if error is None else JobError(**error),
    }
    return JobItem(**values)
