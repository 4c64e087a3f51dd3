"""Open the store of the settings, brought up to date first."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from flexsid.settings import Settings
from flexsid.storage.migrate import upgrade
from flexsid.storage.store import Store


@contextmanager
def opened(settings: Settings) -> Iterator[Store]:
    """Migrate the database, open it, and close it at the end."""
    upgrade(settings.database)
    store = Store.open(settings.database)
    try:
        yield store
    finally:
        store.close()
