"""What a team changes: campaigns, the audit log, and numbers that differ after every change."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import sqlalchemy as sa

from flexsid.records.account import AuditEvent
from flexsid.storage.access import OPTIONAL
from flexsid.storage.database import Database
from flexsid.storage.lists.list_query import Page, read_cursor
from flexsid.storage.store import Store
from flexsid.storage.tables import (
    accounts,
    audit_events,
    decisions,
    live_acknowledgements,
    live_streams,
    live_test_points,
    metadata,
    model_structures,
    notes,
    review_rules,
)

# --- Records without a campaign, such as those of a personal workbench, and their adoption by one

# Events of the audit log are sealed, and some concern every campaign.
_OF_CAMPAIGN = sorted(OPTIONAL - {"audit_events"})


def adopt_records(store: Store, aircraft_id: int) -> dict[str, int]:
    """Put all records without a campaign into that of an aircraft; return their numbers."""
    counts: dict[str, int] = {}
    with store.database.transaction() as connection:
        store.aircraft.get(aircraft_id)
        for name in _OF_CAMPAIGN:
            table = metadata.tables[name]
            without = sa.update(table).where(table.c.aircraft_id.is_(None))
            counts[name] = connection.execute(without.values(aircraft_id=aircraft_id)).rowcount
    return counts


def count_without_campaign(database: Database) -> dict[str, int]:
    """Return by table how many records no member of a campaign sees; none without accounts."""
    counts: dict[str, int] = {}
    with database.reading() as connection:
        if connection.scalar(sa.select(sa.func.count()).select_from(accounts)):
            for name in _OF_CAMPAIGN:
                table = metadata.tables[name]
                is_without = table.c.aircraft_id.is_(None)
                if name == "jobs":  # backups concern every campaign
                    is_without &= table.c.kind != "backup"
                query = sa.select(sa.func.count()).select_from(table).where(is_without)
                counts[name] = connection.scalar(query) or 0
    return {name: count for name, count in counts.items() if count}


# --- What a team changes, as numbers that differ after every change of a campaign -----------------

Totals = Mapping[tuple[str, int], object]
"""Numbers of a sort of records in a campaign, given by its aircraft."""

_Query = sa.Select[*tuple[Any, ...]]


def _of_stream(table: sa.Table, column: sa.ColumnElement[object]) -> _Query:
    campaign = live_streams.c.aircraft_id
    joined = sa.select(campaign, column, sa.func.count()).join_from(table, live_streams)
    return joined.group_by(campaign, column).order_by(campaign, column)


def _of_campaign(column: sa.Column[int], number: sa.ColumnElement[int]) -> _Query:
    return sa.select(column, number, sa.func.count()).group_by(column)


# Versions and ids only grow; streams and their test points change their status.
_QUERIES = {
    "decisions": (_of_campaign(decisions.c.aircraft_id, sa.func.sum(decisions.c.version)),),
    "model_structures": (
        _of_campaign(model_structures.c.aircraft_id, sa.func.sum(model_structures.c.version)),
    ),
    "notes": (_of_campaign(notes.c.aircraft_id, sa.func.max(notes.c.id)),),
    "review_rules": (_of_campaign(review_rules.c.aircraft_id, sa.func.max(review_rules.c.id)),),
    "live_streams": (
        _of_campaign(live_streams.c.aircraft_id, sa.func.count(live_streams.c.stopped_at)),
        _of_stream(live_test_points, live_test_points.c.status),
        _of_stream(live_acknowledgements, live_acknowledgements.c.kind),
    ),
}


def read_totals(store: Store) -> Totals:
    """Return the numbers of every sort of records in every campaign."""
    totals: dict[tuple[str, int], list[object]] = {}
    with store.database.reading() as connection:
        for name, queries in _QUERIES.items():
            for number, query in enumerate(queries):
                for campaign, *counts in connection.execute(query):
                    totals.setdefault((name, campaign), []).append((number, *counts))
    return totals


def find_changed(before: Totals, now: Totals) -> frozenset[tuple[str, int]]:
    """Return the sorts of records, with their campaigns, whose numbers differ."""
    keys = before.keys() | now.keys()
    return frozenset(key for key in keys if before.get(key) != now.get(key))


# --- The audit log: events of all changes by accounts, oldest first -------------------------------

_AT_ONCE = 1000


def read_events(store: Store) -> Iterator[AuditEvent]:
    """Yield all events that the account may read."""
    after = "0"
    while True:
        page = read_page(store, limit=_AT_ONCE, after=after)
        yield from page.items
        if page.next is None:
            return
        after = page.next


def read_page(store: Store, *, limit: int = 100, after: str | None = None) -> Page[AuditEvent]:
    """Return one page of the events that the account may read."""
    query = sa.select(audit_events).order_by(audit_events.c.number).limit(limit + 1)
    query = query.where(audit_events.c.number > (0 if after is None else read_cursor(after)))
    with store.database.reading() as connection:
        rows = connection.execute(query).mappings().all()
    found = store.audit_events.decode(rows[:limit])
    return Page(items=found, next=str(found[-1].number) if len(rows) > limit else None)
