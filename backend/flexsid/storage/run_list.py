"""The list of runs: summaries without the full results."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime
from typing import Annotated

import sqlalchemy as sa
from pydantic import Field
from sqlalchemy.engine import Connection

from flexsid.records.run import AdequacyState, Method, RunState
from flexsid.storage.content import find_changes
from flexsid.storage.database import Database
from flexsid.storage.list_query import Facet, Facets, ListQuery
from flexsid.storage.maneuver_list import (
    FLOWN_COLUMNS,
    FLOWN_FACETS,
    FLOWN_FILTERS,
    FlownFilters,
    FlownItem,
    IdFilter,
    contains_text,
)
from flexsid.storage.paging import Page
from flexsid.storage.tables import aircraft, flights, maneuvers, run_summaries, run_tags, runs
from flexsid.storage.tags import read_tags
from flexsid.sysid.model.longitudinal import LONGITUDINAL


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
