"""Access to the database of the settings."""

from __future__ import annotations

import getpass
from collections.abc import Iterator
from contextlib import contextmanager

from flexsid.errors import BadInput
from flexsid.settings import Mode, Settings
from flexsid.storage.access import Access, using_access
from flexsid.storage.database import parse_url, sqlite_file
from flexsid.storage.files import refuse_deleted
from flexsid.storage.migrate import upgrade
from flexsid.storage.store import Store


@contextmanager
def open_store(settings: Settings, *, new: bool = False, of_team: bool = False) -> Iterator[Store]:
    """Migrate and open the database, and close it at the end; ``new`` allows to create it.

    Changes are in the audit log if the settings, the database (it has accounts) or the command
    (``of_team``) are those of a team.

    Raises
    ------
    BadInput
        If the database does not exist.
    DatabaseUnavailable
        If it existed, or cannot be opened.
    """
    file = sqlite_file(parse_url(settings.database))
    if not new and file is not None and not file.is_file():
        refuse_deleted(file)
        raise BadInput(
            f"there is no database {file}; flexsid import, demo or serve create one",
            code="no-database",
        )
    upgrade(settings.database)
    store = Store.open(settings.database, settings.site_key, recordings=settings.recordings)
    access = None
    if of_team or settings.mode is not Mode.PERSONAL or store.accounts.find():
        # Of the account of the operating system, which may change everything.
        access = Access(account_id=None, author=f"{getpass.getuser()} (command line)")
    try:
        with using_access(access):
            yield store
    finally:
        store.close()
