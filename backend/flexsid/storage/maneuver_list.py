"""The list of maneuvers that an analyst filters: one query for any size of campaign."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from datetime import datetime
from typing import Any, TypedDict, cast

import sqlalchemy as sa
from sqlalchemy.engine import Connection

from flexsid.errors import BadInput
from flexsid.records.maneuver import GROUND
from flexsid.records.run import Method, RunState
from flexsid.storage.facets import Choice, Facet, Facets, count_facets
from flexsid.storage.paging import Page, read_cursor
from flexsid.storage.tables import aircraft, flights, maneuver_tags, maneuvers, runs
from flexsid.storage.tags import has_tag, read_tags


@dataclass(frozen=True, slots=True, kw_only=True)
class LatestRun:
    """The newest run of one method."""

    id: int
    state: RunState


@dataclass(frozen=True, slots=True, kw_only=True)
class ManeuverItem:
    """One item of the list."""

    id: int
    label: str
    flight_id: int
    flight_number: int
    aircraft_id: int
    aircraft_name: str
    fta: int | None
    axis: str
    duration_s: float
    airspeed_m_s: float
    dynamic_pressure_pa: float
    airspeed_ratio: float | None
    fuel_fraction: float
    max_input_correlation: float | None
    n_runs: int
    runs: dict[Method, LatestRun | None]
    tags: tuple[str, ...]
    created_at: datetime
    deleted_at: datetime | None


class ManeuverFilters(TypedDict, total=False):
    """Filters of the list; None is no filter.

    Ground records are not maneuvers of a flight and are listed only with
    ``ground``. ``method`` alone selects maneuvers with a run of this method; ``state``
    is that of the newest run, of that method or of any. ``deleted`` selects deleted
    maneuvers.
    """

    aircraft_id: int | None
    flight_id: int | None
    fta: int | None
    min_airspeed_ratio: float | None
    max_airspeed_ratio: float | None
    min_fuel: float | None
    max_fuel: float | None
    search: str | None
    method: Method | None
    state: RunState | None
    ground: bool | None
    tag: str | None
    deleted: bool | None


def _newest(method: Method, column: sa.Column[Any]) -> sa.ScalarSelect[Any]:
    """Return one column of the newest run of a method, from the index alone."""
    return (
        sa.select(column)
        .where(
            runs.c.maneuver_id == maneuvers.c.id,
            runs.c.method == method.value,
            runs.c.deleted_at.is_(None),
        )
        .order_by(runs.c.id.desc())
        .limit(1)
        .correlate(maneuvers)
        .scalar_subquery()
    )


_newest_id = {method: _newest(method, runs.c.id) for method in Method}
_newest_state = {method: _newest(method, runs.c.state) for method in Method}
_n_runs = (
    sa.select(sa.func.count())
    .where(runs.c.maneuver_id == maneuvers.c.id, runs.c.deleted_at.is_(None))
    .scalar_subquery()
    .label("n_runs")
)
_shown = (
    maneuvers.c.id,
    maneuvers.c.label,
    maneuvers.c.flight_id,
    flights.c.number.label("flight_number"),
    maneuvers.c.aircraft_id,
    aircraft.c.name.label("aircraft_name"),
    maneuvers.c.fta,
    maneuvers.c.axis,
    maneuvers.c.duration_s,
    maneuvers.c.airspeed_m_s,
    maneuvers.c.dynamic_pressure_pa,
    maneuvers.c.airspeed_ratio,
    maneuvers.c.fuel_fraction,
    maneuvers.c.max_input_correlation,
    _n_runs,
    maneuvers.c.created_at,
    maneuvers.c.deleted_at,
)
_newest_columns = tuple(
    found[method].label(f"{method}_{name}")
    for method in Method
    for name, found in (("id", _newest_id), ("state", _newest_state))
)
_joined = maneuvers.join(flights, flights.c.id == maneuvers.c.flight_id).join(
    aircraft, aircraft.c.id == maneuvers.c.aircraft_id
)
_sortable: dict[str, sa.ColumnElement[Any]] = {
    **{
        name: maneuvers.c[name]
        for name in (
            *("id", "label", "fta", "axis", "duration_s", "airspeed_m_s", "dynamic_pressure_pa"),
            *("airspeed_ratio", "fuel_fraction", "max_input_correlation", "created_at"),
        )
    },
    "flight_number": flights.c.number,
    "aircraft_name": aircraft.c.name,
    "n_runs": _n_runs,
}
SORT_FIELDS = tuple(sorted(_sortable))


def select_maneuvers(
    connection: Connection,
    filters: ManeuverFilters,
    sort: str,
    limit: int | None,
    after: str | None,
) -> Page[ManeuverItem]:
    """Read one page of the list.

    Parameters
    ----------
    connection
        A transaction to read in.
    filters
        Filters of the list.
    sort
        A field of ``SORT_FIELDS``, with ``-`` in front for falling order;
        maneuvers that lack the value come last.
    limit
        Most items to return; None for all.
    after
        ``next`` of the page before.
    """
    offset = 0 if after is None else read_cursor(after)
    query = sa.select(*_shown, *_newest_columns).select_from(_joined)
    query = query.where(*_conditions(filters)).order_by(*_order(sort)).offset(offset)
    if limit is not None:
        query = query.limit(limit + 1)  # one more item shows that there is a next page
    rows = connection.execute(query).mappings().all()
    shown = rows if limit is None else rows[:limit]
    tags = read_tags(connection, maneuver_tags, [row["id"] for row in shown])
    items = [_item(row, tags[row["id"]]) for row in shown]
    more = limit is not None and len(rows) > limit
    return Page(items=items, next=str(offset + len(items)) if more else None)


def maneuver_facets(connection: Connection, filters: ManeuverFilters) -> Facets:
    """Return the number of items, and that of each choice of a filter."""
    facets = {
        "aircraft_id": Facet(maneuvers.c.aircraft_id, aircraft.c.name, filters.get("aircraft_id")),
        "flight_id": Facet(maneuvers.c.flight_id, flights.c.number, filters.get("flight_id")),
        "fta": Facet(maneuvers.c.fta, maneuvers.c.fta, filters.get("fta")),
    }
    others = cast("ManeuverFilters", {**filters, **dict.fromkeys(facets)})
    found = count_facets(connection, _joined, _conditions(others), facets)
    tagged = _joined.join(maneuver_tags, maneuver_tags.c.maneuver_id == maneuvers.c.id)
    tag = {"tag": Facet(maneuver_tags.c.tag, maneuver_tags.c.tag)}
    untagged = cast("ManeuverFilters", {**filters, "tag": None})
    tags = count_facets(connection, tagged, _conditions(untagged), tag)
    of_runs = _run_choices(connection, filters)
    return Facets(total=found.total, choices={**found.choices, **tags.choices, **of_runs})


def _run_choices(connection: Connection, filters: ManeuverFilters) -> dict[str, list[Choice]]:
    """Count by newest runs: a maneuver counts for the method and the state of each."""
    asked = cast("ManeuverFilters", {**filters, "method": None, "state": None})
    query = (
        sa.select(*_newest_state.values(), sa.func.count())
        .select_from(_joined)
        .where(*_conditions(asked))
        .group_by(*_newest_state.values())
    )
    requested = (filters.get("method"), filters.get("state"))
    methods: Counter[Method] = Counter()
    states: Counter[RunState] = Counter()
    for *newest, count in connection.execute(query):
        by_method = dict(zip(Method, newest, strict=True))
        for method, state in by_method.items():
            if state is not None and requested[1] in (None, state):
                methods[method] += count
        of_method = newest if requested[0] is None else [by_method[requested[0]]]
        for state in {one for one in of_method if one is not None}:
            states[RunState(state)] += count
    return {"method": _counted(Method, methods), "state": _counted(RunState, states)}


def _counted(kinds: Iterable[str], counts: Mapping[Any, int]) -> list[Choice]:
    return [Choice(value=kind, label=kind, count=counts[kind]) for kind in kinds if counts[kind]]


def _conditions(filters: ManeuverFilters) -> list[sa.ColumnElement[bool]]:
    candidates = (
        ("aircraft_id", lambda value: maneuvers.c.aircraft_id == value),
        ("flight_id", lambda value: maneuvers.c.flight_id == value),
        ("fta", lambda value: maneuvers.c.fta == value),
        ("min_airspeed_ratio", lambda value: maneuvers.c.airspeed_ratio >= value),
        ("max_airspeed_ratio", lambda value: maneuvers.c.airspeed_ratio <= value),
        ("min_fuel", lambda value: maneuvers.c.fuel_fraction >= value),
        ("max_fuel", lambda value: maneuvers.c.fuel_fraction <= value),
        ("tag", lambda value: has_tag(maneuver_tags, maneuvers.c.id, value)),
        ("search", _mentions),
    )
    conditions = [
        condition(filters[name]) for name, condition in candidates if filters.get(name) is not None
    ]
    on_ground = maneuvers.c.axis == GROUND
    conditions.append(on_ground if filters.get("ground") else ~on_ground)
    deleted = maneuvers.c.deleted_at.is_not(None)
    conditions.append(deleted if filters.get("deleted") else ~deleted)
    return conditions + _of_runs(filters)


def _of_runs(filters: ManeuverFilters) -> list[sa.ColumnElement[bool]]:
    method, state = filters.get("method"), filters.get("state")
    states = list(_newest_state.values()) if method is None else [_newest_state[method]]
    if state is not None:
        return [sa.or_(*(found == state.value for found in states))]
    return [] if method is None else [_newest_id[method].is_not(None)]


def _mentions(text: str) -> sa.ColumnElement[bool]:
    return sa.or_(
        maneuvers.c.label.icontains(text, autoescape=True),
        maneuvers.c.note.icontains(text, autoescape=True),
        maneuvers.c.source_file.icontains(text, autoescape=True),
        aircraft.c.name.icontains(text, autoescape=True),
    )


def _order(sort: str) -> list[sa.ColumnElement[Any]]:
    name = sort.removeprefix("-")
    if name not in _sortable:
        raise BadInput(
            f"the list cannot be sorted by {name!r}; expected one of {', '.join(SORT_FIELDS)}",
            code="bad-sort",
        )
    column = _sortable[name]
    falling = sort.startswith("-")
    return [
        column.is_(None),
        column.desc() if falling else column.asc(),
        maneuvers.c.id.desc() if falling else maneuvers.c.id.asc(),
    ]


def _item(row: sa.RowMapping, tags: list[str]) -> ManeuverItem:
    return ManeuverItem(
        **{column.name: row[column.name] for column in _shown},
        runs={
            method: None
            if row[f"{method}_id"] is None
            else LatestRun(id=row[f"{method}_id"], state=RunState(row[f"{method}_state"]))
            for method in Method
        },
        tags=tuple(tags),
    )
