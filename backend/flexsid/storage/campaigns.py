"""Records without a campaign, such as those of a personal workbench, and their adoption by one."""

from __future__ import annotations

import sqlalchemy as sa

from flexsid.storage.store import Store
from flexsid.storage.tables import metadata

_OF_CAMPAIGN = ("mappings", "designs", "saved_views", "frozen_figures", "jobs", "batches")


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
