"""Runs: their results with a hash, and the list of their summaries."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from datetime import datetime
from functools import lru_cache
from typing import Annotated, Any

import orjson
import sqlalchemy as sa
from pydantic import Field
from sqlalchemy.engine import Connection
from sqlalchemy.exc import IntegrityError

from flexsid.records.job import NEW_JOB, Job
from flexsid.records.maneuver import GROUND
from flexsid.records.run import AdequacyState, EstimationRun, Method, ParameterEstimate, RunState
from flexsid.records.search import ACCURATE
from flexsid.storage.access import storing_in_campaign
from flexsid.storage.content import find_changes, hash_content
from flexsid.storage.database import Database
from flexsid.storage.lists.list_query import Facet, Facets, ListQuery, Page, read_tags
from flexsid.storage.lists.maneuver_list import (
    FLOWN_COLUMNS,
    FLOWN_FACETS,
    FLOWN_FILTERS,
    FlownFilters,
    FlownItem,
    IdFilter,
    contains_text,
)
from flexsid.storage.repository import Repository
from flexsid.storage.tables import aircraft, flights, maneuvers, run_summaries, run_tags, runs
from flexsid.sysid.model.derivatives import is_derivative
from flexsid.sysid.model.longitudinal import LONGITUDINAL

# --- Results of runs: stored with a hash, so that later alterations are detected ------------------

SEALED: tuple[str, ...] = ("maneuver_id", "method", "structure", "settings", "result", "versions")
"""Columns that the hash covers: the request, the result, and the software versions.

A migration that rewrites one of them must update the hashes.
"""


def hash_result(row: Mapping[str, Any]) -> str:
    """SHA-256 of the sealed columns as JSON, keys sorted and no blanks."""
    return hash_content([row[name] for name in SEALED])


def is_altered(row: Mapping[str, Any]) -> bool:
    """Return whether a run was altered after its result was stored."""
    stored = row["result_hash"]
    if stored is None:
        return False
    sealed = orjson.dumps([row[name] for name in SEALED], option=orjson.OPT_SORT_KEYS)
    return not _matches(sealed, stored)


@lru_cache(maxsize=256)  # of some 30 kB; the hash takes ten times longer than this key
def _matches(sealed: bytes, stored: str) -> bool:
    return hash_content(orjson.loads(sealed)) == stored


def store_hash(connection: Connection, run_id: int) -> None:
    """Store the hash of a new result."""
    this = runs.c.id == run_id
    query = sa.select(*(runs.c[name] for name in SEALED)).where(this)
    row = connection.execute(query).one()
    sealed = dict(zip(SEALED, row, strict=True))
    connection.execute(sa.update(runs).where(this).values(result_hash=hash_result(sealed)))


# --- Runs: each has the id of its job, whose state it repeats for lists ---------------------------

ESTIMATION = "estimation"
"""Kind of the jobs that are runs."""

STATE = (
    *("author", "state", "attempt", "priority", "limits", "progress", "error", "worker"),
    *("created_at", "started_at", "finished_at"),
)
"""Fields of a run that are those of its job."""


class Runs(Repository[EstimationRun]):
    """Stores runs, each with its job."""

    def __init__(self, database: Database, jobs: Repository[Job]) -> None:
        super().__init__(database, runs, EstimationRun, "run", derived={"altered": is_altered})
        self._jobs = jobs

    def add(self, record: EstimationRun) -> EstimationRun:
        """Store a new run and its job; return it with its id."""
        with self._database.transaction() as connection:
            of_maneuver = sa.select(maneuvers.c.aircraft_id).where(
                maneuvers.c.id == record.maneuver_id
            )
            with storing_in_campaign(connection.scalar(of_maneuver)):
                job = self._jobs.add(_build_job(record))
            stored = replace(record, id=job.id, created_at=job.created_at)
            try:
                connection.execute(sa.insert(self.table).values(self.encode(stored)))
            except IntegrityError as error:
                raise self._refused(error) from error
        return stored

    def replace(self, record: EstimationRun) -> EstimationRun:
        """Replace the run with the same id, and the state of its job."""
        with self._database.transaction():
            super().replace(record)
            self._jobs.replace(replace(_build_job(record), id=record.id))
        return record

    def delete(self, identity: int) -> None:
        """Delete a run and its job."""
        with self._database.transaction():
            super().delete(identity)
            self._jobs.delete(identity)


def _build_job(run: EstimationRun) -> Job:
    state = {name: getattr(run, name) for name in STATE}
    title = ""
    if run.derivation is not None:
        title = f"derived from run {run.derived_from_run_id}, to {run.derivation.purpose}"
    return replace(NEW_JOB, kind=ESTIMATION, title=title, after_job_id=run.after_run_id, **state)


# --- The list of runs: summaries without the full results -----------------------------------------


@dataclass(frozen=True, slots=True, kw_only=True)
class RunItem(FlownItem):
    """One item of the list of runs.

    ``worst_r_squared`` is the lowest R2 of all outputs; ``has_model`` is true if the
    estimates form a complete model, which has poles. ``adequacy`` is the result of the tests for
    remaining model error, of runs that succeeded.
    """

    id: int
    maneuver_id: int
    maneuver_label: str
    dynamic_pressure_pa: float
    method: Method
    state: RunState
    axis: str
    modes: tuple[int, ...]
    start: str
    prediction_id: int | None
    structure_id: int | None
    structure_version: int | None
    outcome: str | None
    n_iterations: int | None
    n_warnings: int | None
    worst_r_squared: float | None
    adequacy: AdequacyState | None
    has_model: bool
    error_code: str | None
    author: str
    tags: tuple[str, ...]
    created_at: datetime
    started_at: datetime | None
    finished_at: datetime | None
    deleted_at: datetime | None
    changed_since: tuple[str, ...]
    derived_from_run_id: int | None


class RunFilters(FlownFilters, total=False):
    """Filters of the list; None is no filter."""

    maneuver_id: IdFilter
    structure_id: IdFilter
    method: Method | None
    state: RunState | None
    adequacy: Annotated[
        AdequacyState | None, Field(description="Result of the tests for remaining model error.")
    ]
    tag: Annotated[str | None, Field(max_length=64, description="Only runs with this tag.")]
    search: Annotated[
        str | None,
        Field(max_length=200, description="Text contained in maneuver or author, or an id."),
    ]
    deleted: Annotated[bool | None, Field(description="Deleted runs instead.")]
    derived: Annotated[
        bool | None, Field(description="Runs derived from others for a prediction instead.")
    ]
    derived_from_run_id: IdFilter


_shown = (
    *FLOWN_COLUMNS,
    *(runs.c.id, runs.c.maneuver_id, maneuvers.c.label.label("maneuver_label")),
    *(maneuvers.c.dynamic_pressure_pa, runs.c.prediction_id),
    *(runs.c.structure_id, runs.c.structure_version, runs.c.author),
    *(runs.c.created_at, runs.c.started_at, runs.c.finished_at, runs.c.deleted_at),
    runs.c.derived_from_run_id,
    *(run_summaries.c.outcome, run_summaries.c.n_iterations, run_summaries.c.n_warnings),
    run_summaries.c.worst_r_squared,
)
_read = (
    runs.c.method,
    runs.c.state,
    runs.c.structure["modes"].label("modes"),
    runs.c.rests_on,
    runs.c.settings["start"].as_string().label("start"),
    runs.c.structure["axis"].as_string().label("axis"),
    runs.c.error["code"].as_string().label("error_code"),
    run_summaries.c.adequacy,
    run_summaries.c.n_poles,
)


def _mentions(text: str) -> sa.ColumnElement[bool]:
    """Search maneuvers and authors first, which are fewer than runs by far."""
    labelled = sa.select(maneuvers.c.id).where(contains_text(text, maneuvers.c.label))
    authors = _list_authors()
    of_author = sa.select(authors.c.author).where(contains_text(text, authors.c.author))
    named = runs.c.maneuver_id.in_(labelled) | runs.c.author.in_(of_author)
    if text.isascii() and text.isdigit() and len(text) <= 18:
        return named | (runs.c.id == int(text))
    return named


def _list_authors() -> sa.CTE:
    """Select each author of runs once, by one search of the index for each."""
    first = sa.select(sa.func.min(runs.c.author).label("author")).cte("authors", recursive=True)
    after = sa.select(sa.func.min(runs.c.author)).where(runs.c.author > first.c.author)
    return first.union_all(sa.select(after.scalar_subquery()).where(first.c.author.is_not(None)))


def _has_adequacy(state: str) -> sa.ColumnElement[bool]:
    summarised = sa.select(run_summaries.c.run_id).where(run_summaries.c.adequacy == state)
    # As the filter by state, without the index of states.
    succeeded = sa.func.coalesce(runs.c.state, "") == RunState.SUCCEEDED.value
    return succeeded & runs.c.id.in_(summarised)


_list = ListQuery(
    source=runs.join(maneuvers, maneuvers.c.id == runs.c.maneuver_id)
    .join(flights, flights.c.id == maneuvers.c.flight_id)
    .join(aircraft, aircraft.c.id == maneuvers.c.aircraft_id),
    key=runs.c.id,
    filters={
        **FLOWN_FILTERS,
        "maneuver_id": runs.c.maneuver_id.__eq__,
        "structure_id": runs.c.structure_id.__eq__,
        "derived_from_run_id": runs.c.derived_from_run_id.__eq__,
        "method": runs.c.method.__eq__,
        # Prevents the use of the index of states, which would read every row.
        "state": sa.func.coalesce(runs.c.state, "").__eq__,
        "adequacy": _has_adequacy,
        "search": _mentions,
    },
    switches={
        "deleted": (
            runs.c.deleted_at.is_not(None),
            runs.c.deleted_at.is_(None) & maneuvers.c.deleted_at.is_(None),
        ),
        "derived": (
            runs.c.derived_from_run_id.is_not(None),
            runs.c.derived_from_run_id.is_(None),
        ),
    },
    sortable={
        "maneuver_label": maneuvers.c.label,
        "flight_number": flights.c.number,
        **{
            name: maneuvers.c[name]
            for name in ("fta", "airspeed_ratio", "dynamic_pressure_pa", "fuel_fraction")
        },
        **{
            name: runs.c[name]
            for name in ("id", "method", "state", "author", "created_at", "finished_at")
        },
    },
    facets={
        **FLOWN_FACETS,
        "method": Facet(column=runs.c.method),
        "state": Facet(column=runs.c.state),
    },
    tags=run_tags,
)
RUN_SORT_FIELDS = _list.sort_fields
_summarised = _list.source.outerjoin(run_summaries, run_summaries.c.run_id == runs.c.id)


def select_runs(
    database: Database, filters: RunFilters, sort: str, limit: int, after: str | None
) -> Page[RunItem]:
    """Read one page of the list; see ``ListQuery.read_page``.

    Notes
    -----
    The ids of a page are found in an index alone; only the rows of the page are
    read. What a result contributes is read from its summary, since it has a hundred kilobytes.
    """
    with database.reading() as connection:
        page = _list.read_page(connection, (runs.c.id,), filters, sort, limit, after)
        ids = [row["id"] for row in page.items]
        query = sa.select(*_shown, *_read).select_from(_summarised).where(runs.c.id.in_(ids))
        rows = {row["id"]: row for row in connection.execute(query).mappings()}
        tags = read_tags(connection, run_tags, ids)
        changed = find_changes(database, [rows[identity]["rests_on"] for identity in ids])
    return Page(
        items=[
            _make_item(rows[identity], tags[identity], since)
            for identity, since in zip(ids, changed, strict=True)
        ],
        next=page.next,
    )


def count_runs(connection: Connection, filters: RunFilters) -> Facets:
    """Return the number of items, and that of each choice of a filter."""
    return _list.count(connection, filters)


def _make_item(row: sa.RowMapping, tags: list[str], changed: tuple[str, ...]) -> RunItem:
    return RunItem(
        **{column.name: row[column.name] for column in _shown},
        method=Method.restore(row["method"]),
        state=RunState(row["state"]),
        axis=row["axis"] or LONGITUDINAL.axis,  # not stored by earlier releases
        modes=tuple(row["modes"]),
        start=row["start"],
        error_code=row["error_code"],
        adequacy=None if row["adequacy"] is None else AdequacyState(row["adequacy"]),
        has_model=bool(row["n_poles"]),
        tags=tuple(tags),
        changed_since=changed,
    )


# --- Summaries of the results of runs: a campaign is read without its results of 100 kB each ------

_AT_ONCE = 500  # runs in one query


@dataclass(frozen=True, slots=True)
class RunRow:
    """A run of a campaign; adequacy and number of accurate derivatives if it succeeded."""

    id: int
    maneuver_id: int
    method: str
    axis: str | None
    adequacy: AdequacyState | None
    n_accurate: int | None


@dataclass(frozen=True, slots=True)
class RunSummary:
    """Maneuvers and derivatives of a run that succeeded.

    ``std_errors`` and ``insensitivities`` are over the size of the estimates, in the order of
    ``names``; three digits, None where there is none.
    """

    maneuver_ids: list[int]
    names: list[str]
    std_errors: list[float | None]
    insensitivities: list[float | None]


def store_summary(connection: Connection, run: EstimationRun) -> None:
    """Store the summary of a run that has a result, in place of an earlier one."""
    if run.result is None:
        return
    derivatives = [one for one in run.result.parameters if is_derivative(one.name)]
    errors = [_divide_by_size(one.std_error, one) for one in derivatives]
    accurate = [error for error in errors if error is not None and error <= ACCURATE]
    fit = run.result.fit
    connection.execute(sa.delete(run_summaries).where(run_summaries.c.run_id == run.id))
    connection.execute(
        sa.insert(run_summaries).values(
            run_id=run.id,
            axis=run.structure.axis,
            adequacy=run.result.adequacy.state.value,
            n_accurate=len(accurate),
            estimates={
                "maneuver_ids": [run.maneuver_id, *run.settings.additional_maneuver_ids],
                "names": [one.name for one in derivatives],
                "std_errors": errors,
                "insensitivities": [_divide_by_size(one.insensitivity, one) for one in derivatives],
            },
            outcome=fit.outcome,
            n_iterations=fit.iterations[-1].iteration if fit.iterations else None,
            n_warnings=len(fit.warnings),
            worst_r_squared=min(fit.r_squared.values(), default=None),
            n_poles=len(run.result.poles),
        )
    )


def _divide_by_size(error: float | None, one: ParameterEstimate) -> float | None:
    # Without insignificant digits, which take half the time to read.
    return None if error is None or one.value == 0.0 else float(f"{error / abs(one.value):.3g}")


def list_runs(connection: Connection, aircraft_id: int) -> list[RunRow]:
    """List the runs of a campaign, oldest first; deleted, derived and ground ones are excluded."""
    succeeded = (run_summaries.c.run_id == runs.c.id) & (runs.c.state == RunState.SUCCEEDED.value)
    summary = (run_summaries.c.axis, run_summaries.c.adequacy, run_summaries.c.n_accurate)
    query = (
        sa.select(runs.c.id, runs.c.maneuver_id, runs.c.method, *summary)
        .select_from(
            runs.join(maneuvers, maneuvers.c.id == runs.c.maneuver_id).outerjoin(
                run_summaries, succeeded
            )
        )
        .where(
            maneuvers.c.aircraft_id == aircraft_id,
            maneuvers.c.deleted_at.is_(None),
            maneuvers.c.axis != GROUND,
            runs.c.deleted_at.is_(None),
            # Not by the index of derived runs, which would read every row.
            sa.func.coalesce(runs.c.derived_from_run_id, 0) == 0,
        )
        .order_by(runs.c.id)
    )
    return [
        RunRow(
            *(number, maneuver_id, method, axis),
            None if adequacy is None else AdequacyState(adequacy),
            n_accurate,
        )
        for number, maneuver_id, method, axis, adequacy, n_accurate in connection.execute(query)
    ]


def read_summaries(connection: Connection, run_ids: Iterable[int]) -> dict[int, RunSummary]:
    """Read the summaries of these runs by id."""
    columns = run_summaries.c
    ordered = list(run_ids)
    found: dict[int, RunSummary] = {}
    for first in range(0, len(ordered), _AT_ONCE):
        some = columns.run_id.in_(ordered[first : first + _AT_ONCE])
        query = sa.select(columns.run_id, columns.estimates).where(some)
        found.update((number, RunSummary(**read)) for number, read in connection.execute(query))
    return found
