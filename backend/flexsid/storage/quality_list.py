"""Data quality of a campaign: the maneuvers with their verdicts, worst first."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, TypedDict

import sqlalchemy as sa
from pydantic import TypeAdapter
from sqlalchemy.engine import Connection

from flexsid.errors import BadInput
from flexsid.records.maneuver import GROUND
from flexsid.records.quality import Figures, QualityVerdict
from flexsid.storage.paging import Page, read_cursor
from flexsid.storage.tables import aircraft, flights, maneuver_quality, maneuvers

MISSING = "missing"
"""Verdict of a maneuver that is not checked."""


@dataclass(frozen=True, slots=True, kw_only=True)
class QualityItem:
    """One item of the list; verdict, summary and figures are None until it is checked."""

    maneuver_id: int
    label: str
    flight_id: int
    flight_number: int
    aircraft_id: int
    aircraft_name: str
    fta: int | None
    airspeed_ratio: float | None
    fuel_fraction: float
    verdict: QualityVerdict | None
    summary: str | None
    figures: Figures | None


class QualityFilters(TypedDict, total=False):
    """Filters of the list; None is no filter."""

    aircraft_id: int | None
    flight_id: int | None
    verdict: str | None
    search: str | None


_joined = (
    maneuvers.join(flights, flights.c.id == maneuvers.c.flight_id)
    .join(aircraft, aircraft.c.id == maneuvers.c.aircraft_id)
    .outerjoin(maneuver_quality, maneuver_quality.c.maneuver_id == maneuvers.c.id)
)
_shown = (
    maneuvers.c.id.label("maneuver_id"),
    maneuvers.c.label,
    maneuvers.c.flight_id,
    flights.c.number.label("flight_number"),
    maneuvers.c.aircraft_id,
    aircraft.c.name.label("aircraft_name"),
    maneuvers.c.fta,
    maneuvers.c.airspeed_ratio,
    maneuvers.c.fuel_fraction,
)
_severity = sa.case(
    (maneuver_quality.c.verdict == QualityVerdict.BAD.value, 0),
    (maneuver_quality.c.verdict == QualityVerdict.QUESTIONABLE.value, 1),
    (maneuver_quality.c.verdict == QualityVerdict.UNCHECKED.value, 2),
    (maneuver_quality.c.verdict == QualityVerdict.GOOD.value, 4),
    else_=3,
)
_figure = {
    name: maneuver_quality.c.figures[name].as_float()
    for name in (
        *("signal_to_noise_db", "largest_skew_s", "least_coherence", "n_stretches", "saturated"),
        *("max_input_correlation", "fuel_change", "airspeed_drift"),
    )
}
_sortable: dict[str, sa.ColumnElement[Any]] = {
    "verdict": _severity,
    "label": maneuvers.c.label,
    "flight_number": flights.c.number,
    "airspeed_ratio": maneuvers.c.airspeed_ratio,
    **_figure,
    "largest_skew_s": sa.func.abs(_figure["largest_skew_s"]),
}
SORT_FIELDS = tuple(sorted(_sortable))
_read_figures = TypeAdapter(Figures)


def select_qualities(
    connection: Connection,
    filters: QualityFilters,
    sort: str,
    limit: int,
    after: str | None,
) -> Page[QualityItem]:
    """Read one page of the list.

    Parameters
    ----------
    connection
        A transaction to read in.
    filters
        Filters of the list.
    sort
        A field of ``SORT_FIELDS``, with ``-`` in front for falling order; maneuvers that
        lack the value come last.
    limit
        Most items to return.
    after
        ``next`` of the page before.
    """
    name = sort.removeprefix("-")
    if name not in _sortable:
        raise BadInput(
            f"the list cannot be sorted by {name!r}; expected one of {', '.join(SORT_FIELDS)}",
            code="bad-sort",
        )
    offset = 0 if after is None else read_cursor(after)
    column = _sortable[name]
    query = (
        sa.select(
            *_shown,
            maneuver_quality.c.verdict,
            maneuver_quality.c.summary,
            maneuver_quality.c.figures,
        )
        .select_from(_joined)
        .where(*_conditions(filters))
        .order_by(
            column.is_(None),
            column.desc() if sort.startswith("-") else column.asc(),
            _severity,
            maneuvers.c.id,
        )
        .offset(offset)
        .limit(limit + 1)
    )
    rows = connection.execute(query).mappings().all()
    items = [_item(row) for row in rows[:limit]]
    return Page(items=items, next=str(offset + limit) if len(rows) > limit else None)


def count_verdicts(connection: Connection, filters: QualityFilters) -> dict[str, int]:
    """Return the number of maneuvers by verdict, and without one."""
    rest: QualityFilters = {**filters, "verdict": None}
    query = (
        sa.select(maneuver_quality.c.verdict, sa.func.count())
        .select_from(_joined)
        .where(*_conditions(rest))
        .group_by(maneuver_quality.c.verdict)
    )
    found = {row[0] or MISSING: row[1] for row in connection.execute(query)}
    return {name: found.get(name, 0) for name in (*(v.value for v in QualityVerdict), MISSING)}


def list_unassessed(connection: Connection) -> list[int]:
    """Return the maneuvers that are not checked, in the order of the campaign."""
    query = (
        sa.select(maneuvers.c.id)
        .select_from(_joined)
        .where(*_conditions({"verdict": MISSING}))
        .order_by(maneuvers.c.id)
    )
    return list(connection.scalars(query))


def _conditions(filters: QualityFilters) -> list[sa.ColumnElement[bool]]:
    conditions = [maneuvers.c.axis != GROUND, maneuvers.c.deleted_at.is_(None)]
    for name, value in (
        ("aircraft_id", filters.get("aircraft_id")),
        ("flight_id", filters.get("flight_id")),
    ):
        if value is not None:
            conditions.append(maneuvers.c[name] == value)
    search = filters.get("search")
    if search is not None:
        conditions.append(
            sa.or_(
                maneuvers.c.label.icontains(search, autoescape=True),
                maneuver_quality.c.summary.icontains(search, autoescape=True),
            )
        )
    verdict = filters.get("verdict")
    if verdict == MISSING:
        conditions.append(maneuver_quality.c.id.is_(None))
    elif verdict is not None:
        conditions.append(maneuver_quality.c.verdict == verdict)
    return conditions


def _item(row: sa.RowMapping) -> QualityItem:
    verdict, figures = row["verdict"], row["figures"]
    return QualityItem(
        **{column.name: row[column.name] for column in _shown},
        verdict=None if verdict is None else QualityVerdict(verdict),
        summary=row["summary"],
        figures=None if figures is None else _read_figures.validate_python(figures),
    )
