"""Rows of one campaign for its dashboard: flown maneuvers and failed jobs."""

from __future__ import annotations

from dataclasses import dataclass

import sqlalchemy as sa
from sqlalchemy.engine import Connection

from flexsid.records.maneuver import GROUND
from flexsid.records.run import RunState
from flexsid.storage.tables import flights, jobs, maneuvers, runs


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
