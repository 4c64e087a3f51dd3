"""The list of maneuvers that an analyst filters: one query for any size of campaign."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from datetime import datetime
from typing import Annotated, Any, Literal, TypedDict

import sqlalchemy as sa
from pydantic import Field, TypeAdapter
from sqlalchemy.engine import Connection

from flexsid.records.maneuver import GROUND
from flexsid.records.quality import Figures, QualityVerdict
from flexsid.records.run import Method, RunState
from flexsid.storage.lists.list_query import (
    Choice,
    Conditions,
    Facet,
    Facets,
    ListQuery,
    Page,
    read_tags,
)
from flexsid.storage.tables import (
    aircraft,
    flights,
    maneuver_quality,
    maneuver_tags,
    maneuvers,
    runs,
)
from flexsid.text import LARGEST_ID

IdFilter = Annotated[int | None, Field(ge=1, le=LARGEST_ID)]
NumberFilter = Annotated[float | None, Field(allow_inf_nan=False)]


@dataclass(frozen=True, slots=True, kw_only=True)
class FlownItem:
    """Flight, aircraft and condition of the maneuver of an item."""

    flight_id: int
    flight_number: int
    aircraft_id: int
    aircraft_name: str
    fta: int | None
    airspeed_ratio: float | None
    fuel_fraction: float


@dataclass(frozen=True, slots=True, kw_only=True)
class LatestRun:
    """The newest run of one method."""

    id: int
    state: RunState


@dataclass(frozen=True, slots=True, kw_only=True)
class ManeuverItem(FlownItem):
    """One item of the list; verdict, summary and figures of its data are None until assessed."""

    id: int
    label: str
    axis: str
    duration_s: float
    airspeed_m_s: float
    dynamic_pressure_pa: float
    max_input_correlation: float | None
    n_runs: int
    runs: dict[Method, LatestRun | None]
    tags: tuple[str, ...]
    verdict: QualityVerdict | None
    summary: str | None
    figures: Figures | None
    created_at: datetime
    deleted_at: datetime | None


class FlownFilters(TypedDict, total=False):
    """Filters by aircraft, flight and condition; None is no filter."""

    aircraft_id: IdFilter
    flight_id: IdFilter
    fta: Annotated[int | None, Field(ge=0, le=10**9, description="Number of the flight-test aid.")]
    min_airspeed_ratio: Annotated[NumberFilter, Field(description="Least V/V_f.")]
    max_airspeed_ratio: Annotated[NumberFilter, Field(description="Largest V/V_f.")]
    min_fuel: NumberFilter
    max_fuel: NumberFilter


VerdictFilter = Annotated[
    Literal["good", "questionable", "bad", "unchecked", "missing"] | None,
    Field(description="`missing`: maneuvers not assessed yet."),
]


class ManeuverFilters(FlownFilters, total=False):
    """Filters of the list; None is no filter."""

    search: Annotated[
        str | None,
        Field(
            max_length=200,
            description="Text contained in label, note, file, aircraft or quality summary.",
        ),
    ]
    verdict: VerdictFilter
    method: Annotated[Method | None, Field(description="Only maneuvers with a run of this method.")]
    state: Annotated[
        RunState | None, Field(description="State of the newest run, of `method` or of any.")
    ]
    ground: Annotated[
        bool | None,
        Field(description="Mini-GVT records on the runway instead of flown maneuvers."),
    ]
    tag: Annotated[str | None, Field(max_length=64, description="Only maneuvers with this tag.")]
    deleted: Annotated[bool | None, Field(description="Deleted maneuvers instead.")]


_ended_badly = runs.c.state.in_([RunState.FAILED.value, RunState.CANCELLED.value])
_FIRST = len(RunState) * 2**58
"""Added to the keys of runs that come before those that ended badly; larger than any other key."""


def _newest(method: Method, column: sa.Column[Any]) -> sa.ScalarSelect[Any]:
    """Return one column of the newest run of a method, from the index alone.

    A failed or cancelled run does not hide one before it that is not.
    """
    return (
        sa.select(column)
        .where(
            runs.c.maneuver_id == maneuvers.c.id,
            runs.c.method == method.value,
            runs.c.deleted_at.is_(None),
            runs.c.derived_from_run_id.is_(None),
        )
        .order_by(sa.case((_ended_badly, 1), else_=0), runs.c.id.desc())
        .limit(1)
        .correlate(maneuvers)
        .scalar_subquery()
    )


_newest_id = {method: _newest(method, runs.c.id) for method in Method}
_newest_state = {method: _newest(method, runs.c.state) for method in Method}
_newest_columns = tuple(
    found[method].label(f"{method}_{name}")
    for method in Method
    for name, found in (("id", _newest_id), ("state", _newest_state))
)
_n_runs = (
    sa.select(sa.func.count())
    .where(runs.c.maneuver_id == maneuvers.c.id, runs.c.deleted_at.is_(None))
    .scalar_subquery()
    .label("n_runs")
)
FLOWN_COLUMNS = (
    *(maneuvers.c.flight_id, flights.c.number.label("flight_number")),
    *(maneuvers.c.aircraft_id, aircraft.c.name.label("aircraft_name")),
    *(maneuvers.c.fta, maneuvers.c.airspeed_ratio, maneuvers.c.fuel_fraction),
)
FLOWN_FILTERS = {
    "aircraft_id": maneuvers.c.aircraft_id.__eq__,
    "flight_id": maneuvers.c.flight_id.__eq__,
    "fta": maneuvers.c.fta.__eq__,
    "min_airspeed_ratio": maneuvers.c.airspeed_ratio.__ge__,
    "max_airspeed_ratio": maneuvers.c.airspeed_ratio.__le__,
    "min_fuel": maneuvers.c.fuel_fraction.__ge__,
    "max_fuel": maneuvers.c.fuel_fraction.__le__,
}
FLOWN_FACETS = {
    "aircraft_id": Facet(column=maneuvers.c.aircraft_id, label=aircraft.c.name),
    "flight_id": Facet(column=maneuvers.c.flight_id, label=flights.c.number),
    "fta": Facet(column=maneuvers.c.fta),
}
_on_ground = maneuvers.c.axis == GROUND
_is_deleted = maneuvers.c.deleted_at.is_not(None)
FLOWN_SWITCHES = {"ground": (_on_ground, ~_on_ground), "deleted": (_is_deleted, ~_is_deleted)}
FLOWN = maneuvers.join(flights, flights.c.id == maneuvers.c.flight_id).join(
    aircraft, aircraft.c.id == maneuvers.c.aircraft_id
)
# --- Data quality of maneuvers, the worst first ---------------------------------------------------

MISSING = "missing"
"""Verdict of a maneuver that is not checked."""

ASSESSED = FLOWN.outerjoin(maneuver_quality, maneuver_quality.c.maneuver_id == maneuvers.c.id)
ASSESSED_COLUMNS = tuple(maneuver_quality.c[name] for name in ("verdict", "summary", "figures"))
SEVERITY = sa.case(
    (maneuver_quality.c.verdict == QualityVerdict.BAD.value, 0),
    (maneuver_quality.c.verdict == QualityVerdict.QUESTIONABLE.value, 1),
    (maneuver_quality.c.verdict == QualityVerdict.UNCHECKED.value, 2),
    (maneuver_quality.c.verdict == QualityVerdict.GOOD.value, 4),
    else_=3,
)
FIGURES = {
    name: maneuver_quality.c.figures[name].as_float()
    for name in (
        *("signal_to_noise_db", "largest_skew_s", "least_coherence", "n_stretches", "saturated"),
        *("max_input_correlation", "fuel_change", "airspeed_drift"),
    )
}
SORTABLE_QUALITY = {
    **FIGURES,
    "verdict": SEVERITY,
    "largest_skew_s": sa.func.abs(FIGURES["largest_skew_s"]),
}
_read_figures = TypeAdapter(Figures)


def has_verdict(verdict: str) -> sa.ColumnElement[bool]:
    """Return the condition of a verdict, or that a maneuver has none."""
    if verdict == MISSING:
        return maneuver_quality.c.id.is_(None)
    return maneuver_quality.c.verdict == verdict


def read_assessment(row: sa.RowMapping) -> dict[str, Any]:
    """Return verdict, summary and figures of a row with ``ASSESSED_COLUMNS``."""
    verdict, figures = row["verdict"], row["figures"]
    return {
        "verdict": None if verdict is None else QualityVerdict(verdict),
        "summary": row["summary"],
        "figures": None if figures is None else _read_figures.validate_python(figures),
    }


# --- The list -------------------------------------------------------------------------------------

_shown = (
    *FLOWN_COLUMNS,
    *(maneuvers.c.id, maneuvers.c.label, maneuvers.c.axis, maneuvers.c.duration_s),
    *(maneuvers.c.airspeed_m_s, maneuvers.c.dynamic_pressure_pa),
    *(maneuvers.c.max_input_correlation, _n_runs),
    *(maneuvers.c.created_at, maneuvers.c.deleted_at),
)


def contains_text(text: str, *columns: sa.ColumnElement[Any]) -> sa.ColumnElement[bool]:
    """Return the condition that one of the columns contains a text, in upper or lower case."""
    return sa.or_(*(column.icontains(text, autoescape=True) for column in columns))


def _mentions(text: str) -> sa.ColumnElement[bool]:
    columns = maneuvers.c
    named = (columns.label, columns.note, columns.source_file, aircraft.c.name)
    return contains_text(text, *named, maneuver_quality.c.summary)


def _select_by_runs(filters: Mapping[str, Any]) -> Conditions:
    method, state = filters.get("method"), filters.get("state")
    states = list(_newest_state.values()) if method is None else [_newest_state[method]]
    if state is not None:
        return [sa.or_(*(found == state for found in states))]
    return [] if method is None else [_newest_id[method].is_not(None)]


_list = ListQuery(
    source=ASSESSED,
    key=maneuvers.c.id,
    filters={**FLOWN_FILTERS, "search": _mentions, "verdict": has_verdict},
    switches=FLOWN_SWITCHES,
    combined=_select_by_runs,
    sortable={
        **SORTABLE_QUALITY,
        **{
            column.name: column
            for column in _shown
            if column.name not in ("flight_id", "aircraft_id", "deleted_at")
        },
    },
    facets={
        **FLOWN_FACETS,
        # As text, not as a parameter: PostgreSQL takes two parameters for two expressions.
        "verdict": Facet(
            column=sa.func.coalesce(maneuver_quality.c.verdict, sa.literal_column(f"'{MISSING}'"))
        ),
    },
    tags=maneuver_tags,
)
SORT_FIELDS = _list.sort_fields


def select_maneuvers(
    connection: Connection,
    filters: ManeuverFilters,
    sort: str,
    limit: int | None,
    after: str | None,
) -> Page[ManeuverItem]:
    """Read one page of the list; see ``ListQuery.read_page``."""
    columns = (*_shown, *ASSESSED_COLUMNS, *_newest_columns)
    page = _list.read_page(connection, columns, filters, sort, limit, after)
    tags = read_tags(connection, maneuver_tags, [row["id"] for row in page.items])
    return Page(items=[_make_item(row, tags[row["id"]]) for row in page.items], next=page.next)


def count_maneuvers(connection: Connection, filters: ManeuverFilters) -> Facets:
    """Return the number of items, and that of each choice of a filter."""
    found = _list.count(connection, filters)
    return Facets(
        total=found.total, choices={**found.choices, **_count_by_runs(connection, filters)}
    )


def _count_by_runs(connection: Connection, filters: ManeuverFilters) -> dict[str, list[Choice]]:
    """Count by newest runs: a maneuver counts for the method and the state of each."""
    selected = (
        sa.select(maneuvers.c.id)
        .select_from(_list.source)
        .where(*_list.where({**filters, "method": None, "state": None}))
    )
    newest_states = (
        sa.select(*(_find_newest_state(method).label(method) for method in Method))
        .where(
            runs.c.maneuver_id.in_(selected),
            runs.c.deleted_at.is_(None),
            runs.c.derived_from_run_id.is_(None),
        )
        .group_by(runs.c.maneuver_id)
        .subquery()
    )
    query = sa.select(*newest_states.c, sa.func.count()).group_by(*newest_states.c)
    method, state = filters.get("method"), filters.get("state")
    methods: Counter[Method] = Counter()
    states: Counter[RunState] = Counter()
    every = list(RunState)
    for *numbers, count in connection.execute(query):
        newest = {
            one: every[number]
            for one, number in zip(Method, numbers, strict=True)
            if number is not None
        }
        for one, found in newest.items():
            if state in (None, found):
                methods[one] += count
        for found in {found for one, found in newest.items() if method in (None, one)}:
            states[found] += count
    return {"method": _list_choices(Method, methods), "state": _list_choices(RunState, states)}


def _find_newest_state(method: Method) -> sa.ColumnElement[int]:
    """Return the number of the state of the newest run of a method, an aggregate of runs.

    The largest id with the state in its last digits is found in one scan of an index, where a
    search for each maneuver takes three times as long.
    """
    number = sa.case({state.value: k for k, state in enumerate(RunState)}, value=runs.c.state)
    key = sa.cast(runs.c.id, sa.BigInteger) * len(RunState) + number
    key += sa.case((_ended_badly, 0), else_=sa.literal(_FIRST, sa.BigInteger))
    return sa.func.max(sa.case((runs.c.method == method.value, key))) % len(RunState)


def _list_choices(kinds: Iterable[str], counts: Mapping[Any, int]) -> list[Choice]:
    return [Choice(value=kind, label=kind, count=counts[kind]) for kind in kinds if counts[kind]]


def _make_item(row: sa.RowMapping, tags: list[str]) -> ManeuverItem:
    return ManeuverItem(
        **{column.name: row[column.name] for column in _shown},
        runs={
            method: None
            if row[f"{method}_id"] is None
            else LatestRun(id=row[f"{method}_id"], state=RunState(row[f"{method}_state"]))
            for method in Method
        },
        tags=tuple(tags),
        **read_assessment(row),
    )
