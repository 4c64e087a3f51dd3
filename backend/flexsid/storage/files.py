"""Files of an SQLite database, complete, synced and private, and the lock of all tables."""

from __future__ import annotations

import logging
import os
import sqlite3
import tempfile
import time
from collections.abc import Iterator
from contextlib import closing, contextmanager, suppress
from pathlib import Path

import sqlalchemy as sa
from sqlalchemy.engine import Connection
from sqlalchemy.exc import OperationalError

from flexsid.errors import FlexsidError
from flexsid.storage.tables import metadata

# --- Files of an SQLite database: created complete and synced, and private to one user ------------

_log = logging.getLogger(__name__)

_PRIVATE = 0o600
_OTHERS = 0o077  # permissions of group and others
PAGE_BYTES = 32768
"""Samples are most of a database; larger pages write and read them faster."""


class DatabaseUnavailable(FlexsidError):
    """The database cannot be opened or does not respond."""

    code = "database-unavailable"


def create_database(file: Path) -> None:
    """Create a database if there is none, and make it private to its user.

    Raises
    ------
    DatabaseUnavailable
        If the file is empty, or missing while its log or mark exists: both are damage.
    """
    if file.exists():
        if file.stat().st_size == 0:
            raise DatabaseUnavailable(
                f"the database {file} is empty (0 bytes): its content is lost."
                " Restore a backup with `flexsid restore`, or move the empty"
                " file away to create a new database",
                code="database-empty",
            )
        restrict_access(file)
        return
    refuse_deleted(file)
    try:
        file.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
        with new_file(file) as partial, closing(sqlite3.connect(partial)) as begun:
            # Without effect later, and they would need the write lock on every connection.
            begun.execute(f"PRAGMA page_size = {PAGE_BYTES}")
            begun.execute("PRAGMA auto_vacuum = INCREMENTAL")
            begun.execute("PRAGMA journal_mode = WAL")
    except FileExistsError:
        if file.is_dir() or not file.exists():
            raise DatabaseUnavailable(
                f"{file} is not a regular file; name a file for the database"
            ) from None
        return  # another server created it
    except OSError as error:
        raise DatabaseUnavailable(
            f"the folder of the database {file} cannot be written to: {error.strerror}"
        ) from error


def refuse_deleted(file: Path) -> None:
    """Refuse a missing database that has left its log, or the mark of its last transactions.

    Raises
    ------
    DatabaseUnavailable
        If there are any.
    """
    for end in ("wal", "mark"):
        beside = file.with_name(f"{file.name}-{end}")
        if not file.exists() and beside.exists() and beside.stat().st_size > 0:
            raise DatabaseUnavailable(
                f"the database {file} is missing, but {beside.name} exists: its content is"
                " lost. Restore a backup with `flexsid restore`, or move that file away to create a"
                " new database",
                code="database-gone",
            )


@contextmanager
def new_file(target: Path) -> Iterator[Path]:
    """Yield a temporary file, which is synced and then renamed to the target.

    Raises
    ------
    FileExistsError
        If the target exists; it is not changed.
    """
    number, name = tempfile.mkstemp(prefix=f"{target.name}.", suffix=".partial", dir=target.parent)
    os.close(number)  # its mode is 0600
    partial = Path(name)
    try:
        yield partial
        sync(partial)
        _rename(partial, target)
        sync(target.parent)
    finally:
        partial.unlink(missing_ok=True)


def sync(path: Path) -> None:
    """Wait until a file, or the names in a folder, are on disk."""
    if path.is_dir() and os.name == "nt":  # not supported
        return
    number = os.open(path, os.O_RDONLY if path.is_dir() else os.O_RDWR)
    try:
        os.fsync(number)
    finally:
        os.close(number)


def restrict_access(file: Path) -> None:
    """Make a database, its log and its copies private to their user, and log the change."""
    beside = (
        one
        for end in ("-wal", "-shm", "-mark", "-losses", ".backup-*", ".before-restore-*")
        for one in file.parent.glob(f"{_escape_pattern(file.name)}{end}")
    )
    for one in (file, *beside):
        with suppress(FileNotFoundError):
            mode = one.stat().st_mode & 0o777
            if os.name == "nt" or not mode & _OTHERS:
                continue
            try:
                one.chmod(_PRIVATE)
            except PermissionError:
                _log.warning(
                    "%s is readable by other users (mode %o); change its mode to 600", one, mode
                )
            else:
                _log.warning("%s was readable by other users (mode %o); changed to 600", one, mode)


def make_private_folder(folder: Path) -> None:
    """Create a private folder, or check an existing one.

    Raises
    ------
    DatabaseUnavailable
        If it belongs to another user, as any user can create one in a temporary folder.
    """
    folder.mkdir(parents=True, exist_ok=True, mode=0o700)
    if os.name == "nt":
        return
    if folder.is_symlink() or folder.stat().st_uid != os.geteuid():
        raise DatabaseUnavailable(
            f"{folder} belongs to another user; nothing is stored there. Remove it",
            code="foreign-folder",
        )
    if folder.stat().st_mode & _OTHERS:
        folder.chmod(0o700)
        _log.warning("%s was accessible to other users; changed to mode 700", folder)


def _rename(partial: Path, target: Path) -> None:
    try:
        os.link(partial, target)  # unlike rename, never replaces a file
    except FileExistsError:
        raise
    except OSError:  # a file system without links
        if target.exists():
            raise FileExistsError(f"{target} exists") from None
        partial.rename(target)


def _escape_pattern(name: str) -> str:
    return "".join(f"[{letter}]" if letter in "*?[" else letter for letter in name)


# --- The lock of all tables, for a transaction that replaces or migrates them beside servers ------

_ATTEMPTS = 600
_ATTEMPT_MS = 250
"""Shorter than after which PostgreSQL looks for deadlocks (1 s), and ends one of the two."""
_PAUSE_S = 0.25
_NOT_FREE = ("55P03", "40P01")  # lock_not_available, deadlock_detected


def lock_tables(connection: Connection) -> None:
    """Wait for all other transactions; others wait until the present one ends.

    Other transactions lock tables in any order: all locks are released and taken again until all
    are free. On SQLite a transaction that writes is the only one.

    Raises
    ------
    DatabaseUnavailable
        If other transactions do not end within minutes.
    """
    if connection.dialect.name != "postgresql":
        return
    present = set(sa.inspect(connection).get_table_names())
    tables = ", ".join(table.name for table in metadata.sorted_tables if table.name in present)
    # The transaction pauses while files are written.
    connection.exec_driver_sql("SET LOCAL idle_in_transaction_session_timeout = 0")
    for _ in range(_ATTEMPTS):
        try:
            with connection.begin_nested():
                connection.exec_driver_sql(f"SET LOCAL lock_timeout = {_ATTEMPT_MS}")
                connection.exec_driver_sql(f"LOCK TABLE {tables} IN ACCESS EXCLUSIVE MODE")
                connection.exec_driver_sql("SET LOCAL lock_timeout = 0")
        except OperationalError as error:
            if getattr(error.orig, "sqlstate", None) not in _NOT_FREE:
                raise
            time.sleep(_PAUSE_S)
        else:
            return
    raise DatabaseUnavailable("other transactions on the database do not end; stop its servers")
