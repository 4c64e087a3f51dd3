"""Row seals: a checksum of each row of an SQLite database, written by triggers.

Samples and results have hashes of their own; a bit of the disk that changes any other column would
not be noticed. PostgreSQL has checksums of its pages where they are enabled.
"""

from __future__ import annotations

import hashlib
import sqlite3
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import sqlalchemy as sa
from sqlalchemy.engine import Connection
from sqlalchemy.exc import DatabaseError

from flexsid.storage.tables import metadata, row_seals

_FUNCTION = "flexsid_seal"
# Named by their content, or changed each second.
_WITHOUT_SEALS = frozenset({"arrays", "leases", row_seals.name})


@dataclass(frozen=True, slots=True)
class ChangedRows:
    """Rows of a table that differ from their seals; ``key`` is the id of the first, if known."""

    table: str
    count: int
    key: str | None


def add_seal_function(connection: sqlite3.Connection) -> None:
    """Add the function of the triggers; without it a connection cannot write."""
    connection.create_function(_FUNCTION, -1, _compute_seal, deterministic=True)


def _compute_seal(*values: str | float | bytes | None) -> bytes:
    return hashlib.blake2b(repr(values).encode(), digest_size=8).digest()


def drop_seals(connection: Connection) -> None:
    """Drop all triggers of seals, before a migration."""
    if connection.dialect.name != "sqlite":
        return
    query = f"SELECT name FROM sqlite_master WHERE type = 'trigger' AND sql LIKE '%{row_seals}%'"
    for name in connection.exec_driver_sql(query).scalars().all():
        connection.exec_driver_sql(f'DROP TRIGGER "{name}"')


def seal_rows(connection: Connection) -> None:
    """Seal all rows, and create the triggers that seal what changes, after a migration."""
    if connection.dialect.name != "sqlite":
        return
    connection.execute(sa.delete(row_seals))
    for table in _list_tables():
        connection.exec_driver_sql(
            f"INSERT INTO {row_seals} SELECT '{table}', {_key(table)}, {_seal(table)} FROM {table}"
        )
        for event, statement in _list_statements(table):
            connection.exec_driver_sql(
                f"CREATE TRIGGER {row_seals}_{table}_{event.lower()} AFTER {event} ON {table}"
                f" BEGIN {statement}; END"
            )


def find_changed_rows(connection: Connection) -> Iterator[ChangedRows]:
    """Find the tables of SQLite with rows that were changed, added or lost unnoticed."""
    if connection.dialect.name != "sqlite":
        return
    for table in _list_tables():
        query = (
            "SELECT count(s.key), sum(s.seal IS NOT r.seal),"
            " min(CASE WHEN s.seal IS NOT r.seal THEN r.key END) FROM"
            f" (SELECT {_key(table)} AS key, {_seal(table)} AS seal FROM {table}) AS r"
            f" LEFT JOIN {row_seals} AS s ON s.table_name = '{table}' AND s.key = r.key"
        )
        seals = f"SELECT count(*) FROM {row_seals} WHERE table_name = '{table}'"
        try:
            n_sealed, n_changed, key = connection.exec_driver_sql(query).one()
            n_lost = connection.exec_driver_sql(seals).scalar_one() - n_sealed
        except DatabaseError:  # a number that has become a text, which is not UTF-8
            n_changed, n_lost, key = 1, 0, None
        if n_changed or n_lost:
            yield ChangedRows(table.name, (n_changed or 0) + n_lost, key)


def _list_tables() -> Iterator[sa.Table]:
    return (table for table in metadata.sorted_tables if table.name not in _WITHOUT_SEALS)


def _list_statements(table: sa.Table) -> Iterator[tuple[str, str]]:
    """Yield what each event of a table does to its seals."""
    written = (
        f"INSERT INTO {row_seals} (table_name, key, seal)"
        f" VALUES ('{table}', {_key(table, 'NEW.')}, {_seal(table, 'NEW.')})"
        " ON CONFLICT (table_name, key) DO UPDATE SET seal = excluded.seal"
    )
    deleted = f"DELETE FROM {row_seals} WHERE table_name = '{table}' AND key = "
    yield "INSERT", written
    yield "UPDATE", written
    yield "DELETE", deleted + _key(table, "OLD.")


def _key(table: sa.Table, row: str = "") -> str:
    return " || ',' || ".join(f'CAST({row}"{one.name}" AS TEXT)' for one in table.primary_key)


def _seal(table: sa.Table, row: str = "") -> str:
    return f"{_FUNCTION}({', '.join(_read(one, row) for one in table.columns)})"


def _read(column: sa.Column[Any], row: str) -> str:
    """Read a value; a text as its bytes, which may be no valid text any more."""
    value = f'{row}"{column.name}"'
    if isinstance(column.type, sa.Integer | sa.Float | sa.Boolean | sa.LargeBinary):
        return value
    return f"CASE typeof({value}) WHEN 'text' THEN CAST({value} AS BLOB) ELSE {value} END"
