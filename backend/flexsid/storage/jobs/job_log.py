"""The log of jobs: an append-only table, read from the last event of a reader."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import UTC, datetime
from typing import Any

import sqlalchemy as sa
from sqlalchemy.engine import Connection, RowMapping

from flexsid.records.job import JobEvent
from flexsid.storage.store import Store
from flexsid.storage.tables import job_events


def write(
    connection: Connection, job_ids: Sequence[int], kind: str, attempt: int = 0, message: str = ""
) -> None:
    """Add an entry to the log of each of these jobs, in the transaction of the caller."""
    row: dict[str, Any] = {
        "at": datetime.now(UTC),
        "kind": kind,
        "attempt": attempt,
        "message": message,
    }
    if job_ids:
        connection.execute(sa.insert(job_events), [{"job_id": number, **row} for number in job_ids])


def read_log(store: Store, job_id: int) -> list[JobEvent]:
    """Return the log of one job, oldest first."""
    return _read(store, job_events.c.job_id == job_id)


def read_since(store: Store, event_id: int, limit: int = 1000) -> list[JobEvent]:
    """Return the events after an event, oldest first."""
    return _read(store, job_events.c.id > event_id, limit)


def find_newest(store: Store) -> int:
    """Return the id of the last event; zero if there is none."""
    with store.database.reading() as connection:
        return connection.scalar(sa.select(sa.func.max(job_events.c.id))) or 0


def _read(store: Store, which: sa.ColumnElement[bool], limit: int | None = None) -> list[JobEvent]:
    query = sa.select(job_events).where(which).order_by(job_events.c.id).limit(limit)
    with store.database.reading() as connection:
        return [_event(row) for row in connection.execute(query).mappings()]


def _event(row: RowMapping) -> JobEvent:
    # pyrefly: ignore[bad-unpacking, missing-argument]
    return JobEvent(**row)
