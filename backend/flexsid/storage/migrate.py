"""Migrate a database to the schema of this software, after a copy of its file.

Alembic and the migrations are loaded where there is something to migrate: that takes longer than
all else that a command does with a database of the newest schema.
"""

from __future__ import annotations

import filecmp
import logging
import sqlite3
import tempfile
from contextlib import closing
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

import sqlalchemy as sa
from sqlalchemy.engine import Connection

import flexsid
from flexsid.errors import FlexsidError
from flexsid.storage.database import (
    get_driver_connection,
    make_engine,
    parse_url,
    sqlite_file,
    translate_errors,
)
from flexsid.storage.files import DatabaseUnavailable, create_database, lock_tables, new_file
from flexsid.storage.rows import drop_seals, seal_rows
from flexsid.storage.tables import metadata
from flexsid.storage.write_mark import find_losses

if TYPE_CHECKING:
    from alembic.script import ScriptDirectory

_log = logging.getLogger(__name__)
_MIGRATING = 0x666C6D67  # any number not used by other advisory locks


class DatabaseTooNew(FlexsidError):
    """A newer release of the software has migrated this database."""

    code = "database-too-new"


def upgrade(url: str) -> str:
    """Migrate a database to the newest schema.

    A database of SQLite that holds an older schema is first copied to
    ``<name>.backup-<revision>`` beside it.

    Parameters
    ----------
    url
        Address of the database; a missing SQLite file is created.

    Returns
    -------
    str
        The present revision.

    Raises
    ------
    DatabaseTooNew
        If a newer release has migrated it; nothing is changed.
    DatabaseUnavailable
        If it cannot be opened.
    """
    return migrate_to(url, "head")


@cache
def build_empty_database() -> tuple[str, bytes]:
    """Build a file of SQLite with the newest schema and without rows; return revision and file.

    The migrations take about a second, which a server needs once and not for each backup.
    """
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "empty.db"
        return upgrade(f"sqlite:///{file}"), file.read_bytes()


def migrate_to(url: str, target: str) -> str:
    """Migrate a database to one revision, up or down; see ``upgrade``."""
    parsed = parse_url(url)
    file = sqlite_file(parsed)
    if file is not None:
        create_database(file)
    engine = make_engine(parsed, foreign_keys=False)
    writing = engine.execution_options(flexsid_writes=True)
    copy: Path | None = None
    try:
        # One write transaction: of two servers that start at the same time
        # the second waits here and then finds the newest schema.
        with translate_errors(), writing.begin() as connection:
            if connection.dialect.name == "postgresql":
                connection.execute(sa.select(sa.func.pg_advisory_xact_lock(_MIGRATING)))
            if file is not None:
                find_losses(file, get_driver_connection(connection))  # before anything is written
            present = _read_revision(connection)
            if target == "head" and present == find_newest():
                return present
            from alembic import command
            from alembic.config import Config
            from alembic.script import ScriptDirectory

            config = Config()
            config.set_main_option("script_location", str(find_migrations()).replace("%", "%%"))
            scripts = ScriptDirectory.from_config(config)
            _check_revision(present, scripts)
            requested = scripts.get_current_head() if target == "head" else target
            if present == requested and present is not None:
                return present
            if present is None:
                _reject_foreign(connection)
            else:
                lock_tables(connection)  # what servers write meanwhile is migrated, too
                if file is not None:
                    copy = _copy_database(file, present)
            config.attributes["connection"] = connection
            damaged = drop_seals(connection)
            going_down = target == "base" or (
                present is not None
                and requested in {s.revision for s in scripts.iterate_revisions(present, "base")}
            )
            (command.downgrade if going_down else command.upgrade)(config, target)
            reached = _read_revision(connection)
            if reached == scripts.get_current_head():
                seal_rows(connection, damaged)
            return reached or "base"
    except BaseException:
        if copy is not None:  # the transaction has left the database as it was
            copy.unlink(missing_ok=True)
        raise
    finally:
        engine.dispose()


def find_migrations() -> Path:
    """Return the folder of the migrations: in the installed package, or in the source tree."""
    package = Path(flexsid.__file__).parent
    for folder in (package / "migrations", package.parents[1] / "migrations"):
        if (folder / "env.py").is_file():
            return folder
    raise FlexsidError(
        f"the migrations are neither in {package} nor beside the source; install flexsid again",
        code="broken-installation",
    )


def find_newest() -> str:
    """Return the newest revision, by the names of the migrations: ``0051_...`` is ``0051``."""
    files = (find_migrations() / "versions").glob("[0-9]*_*.py")
    return max(file.name.partition("_")[0] for file in files)


def _reject_foreign(connection: Connection) -> None:
    """Reject a database with tables of another program, or without its alembic_version."""
    present = set(sa.inspect(connection).get_table_names()) - {"alembic_version"}
    if connection.dialect.name == "postgresql":  # may be shared with other programs
        present &= set(metadata.tables)
    if present:
        raise DatabaseUnavailable(
            f"the database has tables ({', '.join(sorted(present)[:3])}, ...) but no schema of"
            " flexsid: it belongs to another program, or its table alembic_version is missing."
            " Name another database, or restore a backup",
            code="foreign-database",
        )


def _read_revision(connection: Connection) -> str | None:
    if not sa.inspect(connection).has_table("alembic_version"):
        return None
    return connection.scalar(sa.text("SELECT version_num FROM alembic_version"))


def _check_revision(revision: str | None, scripts: ScriptDirectory) -> None:
    """Refuse a revision of a newer release."""
    from alembic.script.revision import ResolutionError
    from alembic.util import CommandError

    if revision is None:
        return
    try:
        scripts.get_revision(revision)
    except (CommandError, ResolutionError) as error:
        raise DatabaseTooNew(
            f"the database has schema {revision}, which flexsid {flexsid.__version__} does not"
            f" support (newest: {scripts.get_current_head()}); use a newer flexsid"
        ) from error


def _copy_database(file: Path, revision: str) -> Path | None:
    """Copy an SQLite file with its log, which a copy by the file system would miss.

    Returns
    -------
    pathlib.Path or None
        The copy; None if an upgrade that was interrupted has left an equal one.
    """
    copy = file.with_name(f"{file.name}.backup-{revision}")
    number, earlier = 1, []
    while copy.exists():
        earlier.append(copy)
        number += 1
        copy = file.with_name(f"{file.name}.backup-{revision}-{number}")
    try:
        with new_file(copy) as partial:
            with (
                closing(sqlite3.connect(file)) as source,
                closing(sqlite3.connect(partial)) as target,
            ):
                source.backup(target, pages=-1)
            for one in earlier:
                if filecmp.cmp(one, partial, shallow=False):
                    raise _IsCopied(one)
    except _IsCopied as found:
        _log.info("%s has the database before its schema changes", found)
        return None
    _log.info("copied the database to %s before its schema changes", copy)
    return copy


class _IsCopied(Exception):
    """An equal copy exists."""
