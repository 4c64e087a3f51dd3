"""Records without a campaign, such as those of a personal workbench, and their adoption by one."""

from __future__ import annotations

import sqlalchemy as sa

from flexsid.storage.access import OPTIONAL
from flexsid.storage.database import Database
from flexsid.storage.store import Store
from flexsid.storage.tables import accounts, metadata

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
