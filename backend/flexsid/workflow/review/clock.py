"""Clock: whether that of this computer is behind what was already written."""

from __future__ import annotations

from datetime import UTC, datetime

import sqlalchemy as sa

from flexsid.storage.store import Store
from flexsid.storage.tables import decision_events, run_events

_APART_S = 5.0  # synchronised clocks differ by less


def find_clock_error(store: Store, now: datetime | None = None) -> str | None:
    """Return what is wrong where the clock is behind the last event; None where it is not.

    Nothing is decided by times; but what is written now would bear one before what it follows.
    """
    newest = (
        sa.select(table.c[moment]).order_by(table.c.id.desc()).limit(1)
        for table, moment in ((decision_events, "created_at"), (run_events, "at"))
    )
    with store.database.reading() as connection:
        known = [last for query in newest if (last := connection.scalar(query)) is not None]
    now = now or datetime.now(UTC)
    behind_s = (max(known, default=now) - now).total_seconds()
    if behind_s <= _APART_S:
        return None
    return (
        f"The clock of this computer is {behind_s:.0f} s behind the last stored event"
        f" ({max(known):%Y-%m-%d %H:%M:%S} UTC): what is written now bears a time before what it"
        " follows, while its order is kept. Set the clock, on every computer that serves."
    )
