"""Quotas of a shared server: jobs of an analyst, recordings of a campaign, uploads."""

from __future__ import annotations

from dataclasses import dataclass

import sqlalchemy as sa
from sqlalchemy.engine import Connection

from flexsid.errors import BadInput, Conflict
from flexsid.records.run import RunState
from flexsid.storage.access import using_access
from flexsid.storage.tables import arrays, channels, flight_channels, flights, jobs, maneuvers

GIGABYTE = 10**9
_SAMPLE_BYTES = 8  # of float64, the largest type of a recorded sample
_UNFINISHED = jobs.c.state.in_((RunState.QUEUED.value, RunState.RUNNING.value))


@dataclass(frozen=True, slots=True, kw_only=True)
class Quotas:
    """Most that is accepted from requests; None without a limit.

    ``unfinished_jobs`` of an analyst wait or run; the samples of the flights and maneuvers of a
    campaign have ``recorded_bytes``. The content of uploaded files is at most ``expansion`` times
    as large as they are; uploads that are not imported take ``account_upload_bytes`` of an account,
    and ``upload_bytes`` in all. Jobs and streams store their results beyond: a quota never
    loses what was flown or computed.
    """

    unfinished_jobs: int | None = None
    recorded_bytes: int | None = None
    expansion: int | None = None
    account_upload_bytes: int | None = None
    upload_bytes: int | None = None


class QueueFull(Conflict):
    """The analyst has as many unfinished jobs as the server accepts."""

    code = "queue-full"


class CampaignFull(Conflict):
    """The recordings of a campaign would take more than its quota."""

    code = "campaign-full"


class AccountUploadsFull(BadInput):
    """The uploads of an account would take more than its quota."""

    code = "uploads-full"


def check_unfinished_jobs(connection: Connection, author: str, quotas: Quotas) -> None:
    """Refuse a further job of an analyst beyond the quota.

    Raises
    ------
    QueueFull
        If the analyst has as many unfinished jobs.
    """
    most = quotas.unfinished_jobs
    if most is None:
        return
    query = sa.select(sa.func.count()).select_from(jobs).where(jobs.c.author == author, _UNFINISHED)
    with using_access(None):  # those of all campaigns
        count = connection.execute(query).scalar_one()
    if count >= most:
        raise QueueFull(
            f"{count} jobs of {author or 'analysts without a name'} have not ended, and with this"
            f" request there would be more than {most}; wait until some have ended, cancel some, or"
            " ask for fewer runs at once"
        )


def check_recorded_bytes(
    connection: Connection, aircraft_id: int | None, added: int, quotas: Quotas
) -> None:
    """Refuse recordings beyond the quota of a campaign, given by its aircraft.

    Raises
    ------
    CampaignFull
        If there would be more.
    """
    most = quotas.recorded_bytes
    if most is None:
        return
    present = 0 if aircraft_id is None else count_recorded_bytes(connection, aircraft_id)
    if present + added > most:
        raise CampaignFull(
            f"the recordings of this campaign take {present / GIGABYTE:.3g} GB, these"
            f" {added / GIGABYTE:.3g} GB more, and its quota is {most / GIGABYTE:.3g} GB; delete"
            " recordings, or ask who operates this server"
        )


def count_recorded_bytes(connection: Connection, aircraft_id: int) -> int:
    """Return the size of all samples of the flights and maneuvers of an aircraft."""
    names = sa.union(
        sa.select(flight_channels.c.array)
        .join(flights, flights.c.id == flight_channels.c.flight_id)
        .where(flights.c.aircraft_id == aircraft_id),
        sa.select(channels.c.array)
        .join(maneuvers, maneuvers.c.id == channels.c.maneuver_id)
        .where(maneuvers.c.aircraft_id == aircraft_id),
    )
    total = sa.select(sa.func.sum(arrays.c.n_bytes)).where(arrays.c.hash.in_(names))
    in_chunks = (
        sa.select(sa.func.sum(flight_channels.c.n_samples))
        .join(flights, flights.c.id == flight_channels.c.flight_id)
        .where(flights.c.aircraft_id == aircraft_id)
        .where(flight_channels.c.samples_per_chunk.is_not(None))
    )
    n_samples = int(connection.execute(in_chunks).scalar_one() or 0)
    return (connection.execute(total).scalar_one() or 0) + _SAMPLE_BYTES * n_samples
