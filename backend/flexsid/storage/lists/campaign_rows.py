"""Rows of one campaign: its dashboard, data quality, and what decisions use as evidence."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, TypedDict

import sqlalchemy as sa
from pydantic import Field
from sqlalchemy.engine import Connection

from flexsid.errors import Conflict
from flexsid.records.decision import DecisionState
from flexsid.records.maneuver import GROUND
from flexsid.records.quality import Figures, QualityVerdict
from flexsid.records.run import RunState
from flexsid.storage.lists.list_query import ListQuery, Page
from flexsid.storage.lists.maneuver_list import (
    ASSESSED,
    ASSESSED_COLUMNS,
    FIGURES,
    FLOWN_COLUMNS,
    FLOWN_FILTERS,
    FLOWN_SWITCHES,
    MISSING,
    SEVERITY,
    SORTABLE_QUALITY,
    FlownItem,
    IdFilter,
    VerdictFilter,
    contains_text,
    has_verdict,
    read_assessment,
)
from flexsid.storage.tables import decisions, flights, jobs, maneuver_quality, maneuvers, runs

# --- Rows of one campaign for its dashboard: flown maneuvers and failed jobs ----------------------


@dataclass(frozen=True, slots=True)
class ManeuverCondition:
    """A flown maneuver and its condition."""

    id: int
    label: str
    flight_number: int
    airspeed_m_s: float
    fuel_fraction: float


@dataclass(frozen=True, slots=True)
class FailedJob:
    """A failed job and the message of its error."""

    id: int
    kind: str
    title: str
    message: str


def list_flown_maneuvers(connection: Connection, aircraft_id: int) -> list[ManeuverCondition]:
    """List the flown maneuvers of a campaign that are not deleted, oldest first."""
    columns = maneuvers.c
    query = (
        sa.select(
            *(columns.id, columns.label, flights.c.number),
            *(columns.airspeed_m_s, columns.fuel_fraction),
        )
        .select_from(maneuvers.join(flights, flights.c.id == columns.flight_id))
        .where(
            columns.aircraft_id == aircraft_id,
            columns.deleted_at.is_(None),
            columns.axis != GROUND,
        )
        .order_by(columns.id)
    )
    return [ManeuverCondition(*row) for row in connection.execute(query)]


def list_failed_jobs(
    connection: Connection, aircraft_id: int, limit: int
) -> tuple[int, list[FailedJob]]:
    """Return the number of failed jobs of a campaign, and the newest of them.

    Jobs of deleted and derived runs are excluded; those that belong to no campaign, as of a
    workbench without accounts, are included.
    """
    failed = (
        jobs.c.state == RunState.FAILED.value,
        (jobs.c.aircraft_id == aircraft_id) | jobs.c.aircraft_id.is_(None),
        runs.c.deleted_at.is_(None),
        runs.c.derived_from_run_id.is_(None),
    )
    source = jobs.outerjoin(runs, runs.c.id == jobs.c.id)
    total = connection.scalar(sa.select(sa.func.count()).select_from(source).where(*failed))
    message = jobs.c.error["message"].as_string()
    query = (
        sa.select(
            jobs.c.id,
            jobs.c.kind,
            sa.func.coalesce(maneuvers.c.label, jobs.c.title),
            sa.func.coalesce(message, ""),
        )
        .select_from(source.outerjoin(maneuvers, maneuvers.c.id == runs.c.maneuver_id))
        .where(*failed)
        .order_by(jobs.c.id.desc())
        .limit(limit)
    )
    return total or 0, [FailedJob(*row) for row in connection.execute(query)]


# --- Data quality of a campaign: the maneuvers with their verdicts, worst first -------------------


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
    verdict: VerdictFilter
    search: Annotated[str | None, Field(max_length=200)]


_shown = (*FLOWN_COLUMNS, maneuvers.c.id.label("maneuver_id"), maneuvers.c.label)

_list = ListQuery(
    source=ASSESSED,
    key=maneuvers.c.id,
    filters={
        **FLOWN_FILTERS,
        "verdict": has_verdict,
        "search": lambda text: contains_text(text, maneuvers.c.label, maneuver_quality.c.summary),
    },
    switches=FLOWN_SWITCHES,
    sortable={
        **SORTABLE_QUALITY,
        "label": maneuvers.c.label,
        "flight_number": flights.c.number,
        "airspeed_ratio": maneuvers.c.airspeed_ratio,
    },
    ties=(SEVERITY, maneuvers.c.id),
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
    page = _list.read_page(connection, (*_shown, *ASSESSED_COLUMNS), filters, sort, limit, after)
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
    change = FIGURES["fuel_change"]
    query = (
        sa.select(change / maneuvers.c.duration_s)
        .join_from(maneuvers, maneuver_quality, maneuver_quality.c.maneuver_id == maneuvers.c.id)
        .where(maneuvers.c.aircraft_id == aircraft_id, change.is_not(None))
        .order_by(maneuvers.c.id.desc())
        .limit(most)
    )
    return list(connection.scalars(query))


def _make_item(row: sa.RowMapping) -> QualityItem:
    return QualityItem(
        **{column.name: row[column.name] for column in _shown}, **read_assessment(row)
    )


# --- Decisions that use runs and maneuvers as evidence, which must not be deleted -----------------

_STANDING = (DecisionState.OPEN, DecisionState.CHANGES_REQUESTED, DecisionState.APPROVED)


def refuse_evidence(connection: Connection, noun: str, ids: Sequence[int]) -> None:
    """Reject the deletion of runs or maneuvers that are evidence of a decision in force.

    Raises
    ------
    Conflict
        If one of them is evidence; names the first, and the decision.
    """
    standing = [state.value for state in _STANDING]
    columns = (decisions.c.id, decisions.c.state, decisions.c.proposal)
    query = sa.select(*columns).where(decisions.c.state.in_(standing)).order_by(decisions.c.id)
    for number, state, proposal in connection.execute(query):
        evidence = set(proposal["run_ids"])
        for comparison in proposal["comparisons"]:
            evidence |= set(comparison["run_ids"])
        if noun == "maneuver":
            evidence = _maneuvers_of(connection, evidence)
        used = [one for one in ids if one in evidence]
        if not used:
            continue
        what = "is evidence of" if noun == "run" else "was estimated from for"
        raise Conflict(
            f"{noun} {used[0]} {what} decision {number}, '{proposal['title']}', which is {state};"
            " it cannot be deleted while the decision is in force. Revise or withdraw the"
            " proposal, or approve one that supersedes it",
            code="is-evidence",
            id=used[0],
            decision_id=number,
        )


def _maneuvers_of(connection: Connection, run_ids: set[int]) -> set[int]:
    query = sa.select(runs.c.maneuver_id, runs.c.settings).where(runs.c.id.in_(run_ids))
    return {
        number
        for first, settings in connection.execute(query)
        for number in (first, *settings.get("additional_maneuver_ids", ()))
    }
