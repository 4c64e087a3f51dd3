"""The list of runs: summaries without the full results."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime
from typing import Any, TypedDict, cast

import sqlalchemy as sa
from sqlalchemy.engine import Connection

from flexsid.errors import BadInput
from flexsid.records.run import Method, RunState
from flexsid.storage.content import find_changes
from flexsid.storage.database import Database
from flexsid.storage.facets import Facet, Facets, count_facets
from flexsid.storage.paging import Page, read_cursor
from flexsid.storage.tables import aircraft, flights, maneuvers, run_tags, runs
from flexsid.storage.tags import has_tag, read_tags


@dataclass(frozen=True, slots=True, kw_only=True)
class RunItem:
    """One item of the list of runs.

    ``worst_r_squared`` is the lowest R2 of all outputs; ``has_model`` is true if the
    estimates form a complete model, which has poles.
    """

    id: int
    maneuver_id: int
    maneuver_label: str
    flight_id: int
    flight_number: int
    aircraft_id: int
    aircraft_name: str
    fta: int | None
    airspeed_ratio: float | None
    dynamic_pressure_pa: float
    fuel_fraction: float
    method: Method
    state: RunState
    modes: tuple[int, ...]
    start: str
    prediction_id: int | None
    structure_id: int | None
    structure_version: int | None
    outcome: str | None
    n_iterations: int | None
    n_warnings: int | None
    worst_r_squared: float | None
    has_model: bool
    error_code: str | None
    author: str
    tags: tuple[str, ...]
    created_at: datetime
    started_at: datetime | None
    finished_at: datetime | None
    deleted_at: datetime | None
    changed_since: tuple[str, ...]


class RunFilters(TypedDict, total=False):
    """Filters of the list; None is no filter.

    ``deleted`` selects deleted runs.
    """

    aircraft_id: int | None
    flight_id: int | None
    maneuver_id: int | None
    structure_id: int | None
    fta: int | None
    min_airspeed_ratio: float | None
    max_airspeed_ratio: float | None
    min_fuel: float | None
    max_fuel: float | None
    method: Method | None
    state: RunState | None
    tag: str | None
    search: str | None
    deleted: bool | None


_joined = (
    runs.join(maneuvers, maneuvers.c.id == runs.c.maneuver_id)
    .join(flights, flights.c.id == maneuvers.c.flight_id)
    .join(aircraft, aircraft.c.id == maneuvers.c.aircraft_id)
)
_fit = runs.c.result["fit"]
_shown = (
    runs.c.id,
    runs.c.maneuver_id,
    maneuvers.c.label.label("maneuver_label"),
    maneuvers.c.flight_id,
    flights.c.number.label("flight_number"),
    maneuvers.c.aircraft_id,
    aircraft.c.name.label("aircraft_name"),
    maneuvers.c.fta,
    maneuvers.c.airspeed_ratio,
    maneuvers.c.dynamic_pressure_pa,
    maneuvers.c.fuel_fraction,
    runs.c.prediction_id,
    runs.c.structure_id,
    runs.c.structure_version,
    runs.c.author,
    runs.c.created_at,
    runs.c.started_at,
    runs.c.finished_at,
    runs.c.deleted_at,
)
_read = (
    runs.c.method,
    runs.c.state,
    runs.c.structure["modes"].label("modes"),
    runs.c.rests_on,
    runs.c.settings["start"].as_string().label("start"),
    runs.c.error["code"].as_string().label("error_code"),
    runs.c.result["poles"].label("poles"),
    _fit["outcome"].as_string().label("outcome"),
    _fit["iterations"].label("iterations"),
    _fit["warnings"].label("warnings"),
    _fit["r_squared"].label("r_squared"),
)
_sortable: dict[str, sa.ColumnElement[Any]] = {
    **{name: runs.c[name] for name in ("id", "method", "state", "created_at", "finished_at")},
    **{
        name: maneuvers.c[name]
        for name in ("fta", "airspeed_ratio", "dynamic_pressure_pa", "fuel_fraction")
    },
    "maneuver_label": maneuvers.c.label,
    "flight_number": flights.c.number,
    "author": runs.c.author,
}
RUN_SORT_FIELDS = tuple(sorted(_sortable))


def select_runs(
    database: Database, filters: RunFilters, sort: str, limit: int, after: str | None
) -> Page[RunItem]:
    """Read one page of the list, in one state of the database.

    Parameters
    ----------
    database
        The database.
    filters
        Filters of the list.
    sort
        A field of ``RUN_SORT_FIELDS``, with ``-`` in front for falling order;
        runs that lack the value come last.
    limit
        Most items to return.
    after
        ``next`` of the page before.

    Notes
    -----
    The ids of a page are found in an index alone; only the rows of the page are
    read, as each result has tens of kilobytes.
    """
    offset = 0 if after is None else read_cursor(after)
    selection = (
        sa.select(runs.c.id)
        .select_from(_joined)
        .where(*_conditions(filters))
        .order_by(*_order(sort))
        .offset(offset)
        .limit(limit + 1)  # one more item shows that there is a next page
    )
    with database.reading() as connection:
        found = connection.scalars(selection).all()
        ids = found[:limit]
        query = sa.select(*_shown, *_read).select_from(_joined).where(runs.c.id.in_(ids))
        rows = {row["id"]: row for row in connection.execute(query).mappings()}
        tags = read_tags(connection, run_tags, ids)
        changed = find_changes(database, [rows[identity]["rests_on"] for identity in ids])
    return Page(
        items=[
            _item(rows[identity], tags[identity], since)
            for identity, since in zip(ids, changed, strict=True)
        ],
        next=str(offset + limit) if len(found) > limit else None,
    )


def run_facets(connection: Connection, filters: RunFilters) -> Facets:
    """Return the number of items, and that of each choice of a filter."""
    method, state = filters.get("method"), filters.get("state")
    facets = {
        "aircraft_id": Facet(maneuvers.c.aircraft_id, aircraft.c.name, filters.get("aircraft_id")),
        "flight_id": Facet(maneuvers.c.flight_id, flights.c.number, filters.get("flight_id")),
        "fta": Facet(maneuvers.c.fta, maneuvers.c.fta, filters.get("fta")),
        "method": Facet(runs.c.method, runs.c.method, method and method.value),
        "state": Facet(runs.c.state, runs.c.state, state and state.value),
    }
    others = cast("RunFilters", {**filters, **dict.fromkeys(facets)})
    found = count_facets(connection, _joined, _conditions(others), facets)
    tagged = _joined.join(run_tags, run_tags.c.run_id == runs.c.id)
    tag = {"tag": Facet(run_tags.c.tag, run_tags.c.tag)}
    untagged = cast("RunFilters", {**filters, "tag": None})
    tags = count_facets(connection, tagged, _conditions(untagged), tag)
    return Facets(total=found.total, choices={**found.choices, **tags.choices})


def _conditions(filters: RunFilters) -> list[sa.ColumnElement[bool]]:
    candidates = (
        ("aircraft_id", lambda value: maneuvers.c.aircraft_id == value),
        ("flight_id", lambda value: maneuvers.c.flight_id == value),
        ("maneuver_id", lambda value: runs.c.maneuver_id == value),
        ("structure_id", lambda value: runs.c.structure_id == value),
        ("fta", lambda value: maneuvers.c.fta == value),
        ("min_airspeed_ratio", lambda value: maneuvers.c.airspeed_ratio >= value),
        ("max_airspeed_ratio", lambda value: maneuvers.c.airspeed_ratio <= value),
        ("min_fuel", lambda value: maneuvers.c.fuel_fraction >= value),
        ("max_fuel", lambda value: maneuvers.c.fuel_fraction <= value),
        ("method", lambda value: runs.c.method == value.value),
        # Prevents the use of the index of states, which would read every row.
        ("state", lambda value: sa.func.coalesce(runs.c.state, "") == value.value),
        ("tag", lambda value: has_tag(run_tags, runs.c.id, value)),
        ("search", _mentions),
    )
    conditions = [
        condition(filters[name]) for name, condition in candidates if filters.get(name) is not None
    ]
    if filters.get("deleted"):
        conditions.append(runs.c.deleted_at.is_not(None))
    else:
        conditions += [runs.c.deleted_at.is_(None), maneuvers.c.deleted_at.is_(None)]
    return conditions


def _mentions(text: str) -> sa.ColumnElement[bool]:
    named = [
        maneuvers.c.label.icontains(text, autoescape=True),
        runs.c.author.icontains(text, autoescape=True),
    ]
    if text.isascii() and text.isdigit() and len(text) <= 18:
        named.append(runs.c.id == int(text))
    return sa.or_(*named)


def _order(sort: str) -> list[sa.ColumnElement[Any]]:
    name = sort.removeprefix("-")
    if name not in _sortable:
        raise BadInput(
            f"the list cannot be sorted by {name!r}; expected one of {', '.join(RUN_SORT_FIELDS)}",
            code="bad-sort",
        )
    column = _sortable[name]
    falling = sort.startswith("-")
    if name == "id":
        return [column.desc() if falling else column.asc()]
    return [
        column.is_(None),
        column.desc() if falling else column.asc(),
        runs.c.id.desc() if falling else runs.c.id.asc(),
    ]


def _item(row: sa.RowMapping, tags: list[str], changed: tuple[str, ...]) -> RunItem:
    iterations = row["iterations"] or ()
    r_squared = (row["r_squared"] or {}).values()
    return RunItem(
        **{column.name: row[column.name] for column in _shown},
        method=Method(row["method"]),
        state=RunState(row["state"]),
        modes=tuple(row["modes"]),
        start=row["start"],
        error_code=row["error_code"],
        outcome=row["outcome"],
        n_iterations=iterations[-1]["iteration"] if iterations else None,
        n_warnings=None if row["warnings"] is None else len(row["warnings"]),
        worst_r_squared=min(r_squared, default=None),
        has_model=bool(row["poles"]),
        tags=tuple(tags),
        changed_since=changed,
    )
