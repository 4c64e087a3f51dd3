"""Check of the system clock against stored events."""

from __future__ import annotations

from datetime import UTC, datetime

import sqlalchemy as sa

from flexsid.storage.store import Store
from flexsid.storage.tables import decision_events, run_events

_TOLERANCE_S = 5.0  # largest difference of synchronised clocks


def find_clock_error(store: Store, now: datetime | None = None) -> str | None:
    """Describe the error of a clock behind the last event; None without error.

    No decision depends on times, but new events would have times before earlier ones.
    """
    newest = (
        sa.select(table.c[moment]).order_by(table.c.id.desc()).limit(1)
        for table, moment in ((decision_events, "created_at"), (run_events, "at"))
    )
    with store.database.reading() as connection:
        known = [last for query in newest if (last := connection.scalar(query)) is not None]
    now = now or datetime.now(UTC)
    behind_s = (max(known, default=now) - now).total_seconds()
    if behind_s <= _TOLERANCE_S:
        return None
    return (
        f"The clock of this computer is {behind_s:.0f} s behind the last stored event"
        f" ({max(known):%Y-%m-%d %H:%M:%S} UTC): new events would have times before"
        " earlier ones. Set the clock on every server."
    )
