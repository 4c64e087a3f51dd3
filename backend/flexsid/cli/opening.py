"""Open the store of the settings, brought up to date first."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from flexsid.errors import BadInput
from flexsid.settings import Settings
from flexsid.storage.database import parse_url, sqlite_file
from flexsid.storage.migrate import upgrade
from flexsid.storage.store import Store


@contextmanager
def opened(settings: Settings, *, new: bool = False) -> Iterator[Store]:
    """Migrate the database, open it, and close it at the end; ``new`` may begin one.

    Raises
    ------
    BadInput
        If there is no such database.
    """
    file = sqlite_file(parse_url(settings.database))
    if not new and file is not None and not file.is_file():
        raise BadInput(
            f"there is no database {file}; flexsid import, demo or serve begin one",
            code="no-database",
        )
    upgrade(settings.database)
    store = Store.open(settings.database)
    try:
        yield store
    finally:
        store.close()
