"""The audit log: events of all changes by accounts, oldest first."""

from __future__ import annotations

from collections.abc import Iterator

import sqlalchemy as sa

from flexsid.records.audit_event import AuditEvent
from flexsid.storage.paging import Page, read_cursor
from flexsid.storage.store import Store
from flexsid.storage.tables import audit_events

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
