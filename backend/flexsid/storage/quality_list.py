"""Data quality of a campaign: the maneuvers with their verdicts, worst first."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal, TypedDict

import sqlalchemy as sa
from pydantic import Field, TypeAdapter
from sqlalchemy.engine import Connection

from flexsid.records.quality import Figures, QualityVerdict
from flexsid.storage.list_query import ListQuery
from flexsid.storage.maneuver_list import (
    FLOWN,
    FLOWN_COLUMNS,
    FLOWN_FILTERS,
    FLOWN_SWITCHES,
    FlownItem,
    IdFilter,
    contains_text,
)
from flexsid.storage.paging import Page
from flexsid.storage.tables import flights, maneuver_quality, maneuvers

MISSING = "missing"
"""Verdict of a maneuver that is not checked."""


@dataclass(frozen=True, slots=True, kw_only=True)
class QualityItem(FlownItem):
    """One item of the list; verdict, summary and figures are None until it is checked."""

    maneuver_id: int
    label: str
    verdict: QualityVerdict | None
    summary: str | None
    figures: Figures | None


class QualityFilters(TypedDict, total=False):
    """Filters of the list; None is no filter."""

    aircraft_id: IdFilter
    flight_id: IdFilter
    verdict: Annotated[
        Literal["good", "questionable", "bad", "unchecked", "missing"] | None,
        Field(description="`missing`: maneuvers not assessed yet."),
    ]
    search: Annotated[str | None, Field(max_length=200)]


_shown = (*FLOWN_COLUMNS, maneuvers.c.id.label("maneuver_id"), maneuvers.c.label)
_assessed = (maneuver_quality.c.verdict, maneuver_quality.c.summary, maneuver_quality.c.figures)
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
_read_figures = TypeAdapter(Figures)


def _has_verdict(verdict: str) -> sa.ColumnElement[bool]:
    if verdict == MISSING:
        return maneuver_quality.c.id.is_(None)
    return maneuver_quality.c.verdict == verdict


_list = ListQuery(
    source=FLOWN.outerjoin(maneuver_quality, maneuver_quality.c.maneuver_id == maneuvers.c.id),
    key=maneuvers.c.id,
    filters={
        **FLOWN_FILTERS,
        "verdict": _has_verdict,
        "search": lambda text: contains_text(text, maneuvers.c.label, maneuver_quality.c.summary),
    },
    switches=FLOWN_SWITCHES,
    sortable={
        "verdict": _severity,
        "label": maneuvers.c.label,
        "flight_number": flights.c.number,
        "airspeed_ratio": maneuvers.c.airspeed_ratio,
        **_figure,
        "largest_skew_s": sa.func.abs(_figure["largest_skew_s"]),
    },
    ties=(_severity, maneuvers.c.id),
)
SORT_FIELDS = _list.sort_fields


def select_qualities(
    connection: Connection,
    filters: QualityFilters,
    sort: str,
    limit: int,
    after: str | None,
) -> Page[QualityItem]:
    """Read one page of the list; see ``ListQuery.read_page``."""
    page = _list.read_page(connection, (*_shown, *_assessed), filters, sort, limit, after)
    return Page(items=[_make_item(row) for row in page.items], next=page.next)


def count_verdicts(connection: Connection, filters: QualityFilters) -> dict[str, int]:
    """Return the number of maneuvers by verdict, and without one."""
    query = (
        sa.select(maneuver_quality.c.verdict, sa.func.count())
        .select_from(_list.source)
        .where(*_list.where({**filters, "verdict": None}))
        .group_by(maneuver_quality.c.verdict)
    )
    found = {row[0] or MISSING: row[1] for row in connection.execute(query)}
    return {name: found.get(name, 0) for name in (*(v.value for v in QualityVerdict), MISSING)}


def list_unassessed(connection: Connection) -> list[int]:
    """Return the maneuvers that are not checked, in the order of the campaign."""
    missing = _list.where({"verdict": MISSING})
    query = sa.select(maneuvers.c.id).select_from(_list.source).where(*missing)
    return list(connection.scalars(query.order_by(maneuvers.c.id)))


def list_fuel_rates(connection: Connection, aircraft_id: int, most: int = 100) -> list[float]:
    """List the fuel burnt per second in the latest assessed maneuvers of an aircraft. [1/s]"""
    change = _figure["fuel_change"]
    query = (
        sa.select(change / maneuvers.c.duration_s)
        .join_from(maneuvers, maneuver_quality, maneuver_quality.c.maneuver_id == maneuvers.c.id)
        .where(maneuvers.c.aircraft_id == aircraft_id, change.is_not(None))
        .order_by(maneuvers.c.id.desc())
        .limit(most)
    )
    return list(connection.scalars(query))


def _make_item(row: sa.RowMapping) -> QualityItem:
    verdict, figures = row["verdict"], row["figures"]
    return QualityItem(
        **{column.name: row[column.name] for column in _shown},
        verdict=None if verdict is None else QualityVerdict(verdict),
        summary=row["summary"],
        figures=None if figures is None else _read_figures.validate_python(figures),
    )
