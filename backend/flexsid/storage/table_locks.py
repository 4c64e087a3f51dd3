"""The lock of all tables, for a transaction that replaces or migrates them beside servers."""

from __future__ import annotations

import time

import sqlalchemy as sa
from sqlalchemy.engine import Connection
from sqlalchemy.exc import OperationalError

from flexsid.storage.files import DatabaseUnavailable
from flexsid.storage.tables import metadata

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
