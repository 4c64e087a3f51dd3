"""Rows of a database: the seal of each, and their copy in another database.

Samples and results have hashes of their own; a bit of the disk that changes any other column would
not be noticed. PostgreSQL has checksums of its pages where they are enabled.
"""

from __future__ import annotations

import hashlib
import re
import sqlite3
from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import sqlalchemy as sa
from sqlalchemy.dialects.postgresql import REGCLASS
from sqlalchemy.engine import Connection
from sqlalchemy.exc import DatabaseError

from flexsid.storage.tables import arrays, metadata, row_seals, upload_files

# --- Row seals: a checksum of each row of an SQLite database, written by triggers -----------------

_FUNCTION = "flexsid_seal"
_TRIGGER = re.compile(
    rf"VALUES \('(?P<table>\w+)', (?P<key>.*), (?P<seal>{_FUNCTION}\(.*\))\) ON CONF"
)
_NO_SEAL = bytes(8)
_UNKNOWN = ""  # key of a row
# Named by their content, or changed each second.
_WITHOUT_SEALS = frozenset({"arrays", "leases", "upload_files", row_seals.name})


@dataclass(frozen=True, slots=True)
class ChangedRows:
    """Rows of a table that differ from their seals; a key is empty if it cannot be read."""

    table: str
    keys: tuple[str, ...]

    def __str__(self) -> str:
        """Describe table, number and first key."""
        first = f" (the first: {self.keys[0]})" if self.keys[0] else ""
        return f"{len(self.keys)} rows of {self.table}{first}"


def add_seal_function(connection: sqlite3.Connection) -> None:
    """Add the function of the triggers; without it a connection cannot write."""
    connection.create_function(_FUNCTION, -1, _compute_seal, deterministic=True)


def _compute_seal(*values: str | float | bytes | None) -> bytes:
    return hashlib.blake2b(repr(values).encode(), digest_size=8).digest()


def drop_seals(connection: Connection) -> dict[str, tuple[str, ...]]:
    """Drop all triggers of seals, before a migration; return the keys of changed rows by table."""
    if connection.dialect.name != "sqlite":
        return {}
    changed = {one.table: one.keys for one in find_changed_rows(connection)}
    query = f"SELECT name FROM sqlite_master WHERE type = 'trigger' AND sql LIKE '%{row_seals}%'"
    for name in connection.exec_driver_sql(query).scalars().all():
        connection.exec_driver_sql(f'DROP TRIGGER "{name}"')
    return changed


def seal_rows(connection: Connection, changed: Mapping[str, Sequence[str]] | None = None) -> None:
    """Seal all rows, and create the triggers that seal what changes, after a migration.

    Rows that were ``changed`` before, by table, remain so.
    """
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
    for table, keys in (changed or {}).items():
        for key in keys:
            connection.exec_driver_sql(
                f"INSERT OR REPLACE INTO {row_seals} VALUES (?, ?, ?)", (table, key, _NO_SEAL)
            )


def accept_changed_rows(connection: Connection) -> list[ChangedRows]:
    """Seal all rows as they are; return those that differed from their seals."""
    changed = list(find_changed_rows(connection))
    if changed:
        drop_seals(connection)
        seal_rows(connection)
    return changed


def find_changed_rows(connection: Connection) -> Iterator[ChangedRows]:
    """Find the tables of SQLite with rows that were changed, added or lost unnoticed.

    A database of an earlier schema is compared as its own triggers sealed it. Where these are
    lost, no row of the table is known to be as it was sealed: all are returned.
    """
    if connection.dialect.name != "sqlite":
        return
    compared = {name: (key, seal) for name, key, seal in _read_triggers(connection)}
    yield from _find_without_triggers(connection, compared)
    for name, (key, seal) in compared.items():
        seals = f"(SELECT key, seal FROM {row_seals} WHERE table_name = '{name}')"
        changed = (
            f"SELECT r.key FROM (SELECT {key} AS key, {seal} AS seal FROM {name}) AS r"
            f" LEFT JOIN {seals} AS s ON s.key = r.key WHERE s.seal IS NOT r.seal"
        )
        lost = f"SELECT key FROM {seals} WHERE key NOT IN (SELECT {key} FROM {name})"
        try:
            keys = connection.exec_driver_sql(f"{changed} UNION ALL {lost}").scalars().all()
        except DatabaseError:  # a number that has become a text, which is not UTF-8
            keys = [_UNKNOWN]
        if keys:
            yield ChangedRows(name, tuple(keys))


def _find_without_triggers(
    connection: Connection, compared: Collection[str]
) -> Iterator[ChangedRows]:
    """Find tables whose rows have seals, but whose triggers are lost."""
    query = f"SELECT name FROM sqlite_master WHERE name = '{row_seals}'"
    if connection.exec_driver_sql(query).first() is None:  # a schema before seals
        return
    query = f"SELECT DISTINCT table_name FROM {row_seals} ORDER BY table_name"
    for name in connection.exec_driver_sql(query).scalars().all():
        if name not in compared:
            keys = f"SELECT key FROM {row_seals} WHERE table_name = ? ORDER BY key"
            yield ChangedRows(name, tuple(connection.exec_driver_sql(keys, (name,)).scalars()))


def _read_triggers(connection: Connection) -> Iterator[tuple[str, str, str]]:
    """Yield each sealed table with the expressions of key and seal of a row.

    The triggers of inserted and updated rows state the same.
    """
    query = "SELECT sql FROM sqlite_master WHERE type = 'trigger' ORDER BY name"
    for trigger in connection.exec_driver_sql(query).scalars().all():
        found = _TRIGGER.search(trigger)
        if found is not None:
            key, seal = (found[part].replace("NEW.", "") for part in ("key", "seal"))
            yield found["table"], key, seal


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


# --- All rows of a database in another one, of the same kind or not, with the ids that were given

_ROWS = 500
_ARRAYS = 4  # of up to hundreds of megabytes
_NO_DATA = sa.literal(b"", sa.LargeBinary).label("data")


def copy_rows(source: Connection, target: Connection, *, has_samples: bool = True) -> None:
    """Replace the rows of the target by those of the source, and continue the ids of both.

    Files of uploads, which are stored until they are imported, are neither copied nor deleted.

    Parameters
    ----------
    source
        Connection to a database with the newest schema, in one consistent state.
    target
        A transaction on another one; on SQLite without foreign keys, to be checked afterwards.
    has_samples
        Arrays are copied with their data.
    """
    omitted = (row_seals, upload_files)
    tables = [table for table in metadata.sorted_tables if table not in omitted]
    _delete_rows(target, tables)
    with _keys_checked_at_the_end(target):
        for table in tables:
            count = _ARRAYS if table is arrays else _ROWS
            columns = [
                column if has_samples or column is not arrays.c.data else _NO_DATA
                for column in table.c
            ]
            options = {"yield_per": count}  # of the statement: the connection may be written, too
            found = source.execute(sa.select(*columns), execution_options=options)
            for rows in found.mappings().partitions():
                # pyrefly: ignore[no-matching-overload]
                target.execute(table.insert(), [dict(row) for row in rows])
    present = _read_given_ids(target)
    for name, given in _read_given_ids(source).items():
        _give_ids_from(target, name, max(given, present.get(name, 0)))


def replace_tables(connection: sqlite3.Connection, source: str) -> None:
    """Replace all tables of a database of SQLite by those of an attached one.

    Parameters
    ----------
    connection
        In a transaction that writes, without foreign keys.
    source
        Name of the attached database.
    """
    is_own = "name NOT LIKE 'sqlite~_%' ESCAPE '~'"
    query = f"SELECT name FROM main.sqlite_master WHERE type = 'table' AND {is_own}"
    for (name,) in connection.execute(query).fetchall():
        connection.execute(f'DROP TABLE main."{name}"')  # with its indices and triggers
    query = f"SELECT type = 'table', name, sql FROM {source}.sqlite_master WHERE sql IS NOT NULL"
    made = connection.execute(f"{query} AND {is_own} ORDER BY type <> 'table'").fetchall()
    for is_table, name, sql in made:
        connection.execute(sql)
        if is_table:
            connection.execute(f'INSERT INTO main."{name}" SELECT * FROM {source}."{name}"')
    connection.execute("DELETE FROM main.sqlite_sequence")
    connection.execute(f"INSERT INTO main.sqlite_sequence SELECT * FROM {source}.sqlite_sequence")


def _read_given_ids(connection: Connection) -> dict[str, int]:
    """Return the largest id that each table has given; tables without any are missing."""
    if connection.dialect.name == "sqlite":
        query = "SELECT name, seq FROM sqlite_sequence WHERE seq > 0"
        return {name: given for name, given in connection.exec_driver_sql(query)}
    given = {
        table.name: connection.scalar(sa.select(sa.func.pg_sequence_last_value(_sequence(table))))
        for table in metadata.sorted_tables
        if "id" in table.c
    }
    return {name: number for name, number in given.items() if number is not None}


def _give_ids_from(connection: Connection, name: str, given: int) -> None:
    table = metadata.tables[name]
    if connection.dialect.name == "sqlite":
        values = (name, given)
        connection.exec_driver_sql("DELETE FROM sqlite_sequence WHERE name = ?", (name,))
        connection.exec_driver_sql("INSERT INTO sqlite_sequence (name, seq) VALUES (?, ?)", values)
    else:
        connection.execute(sa.select(sa.func.setval(_sequence(table), given)))


def _sequence(table: sa.Table) -> sa.ColumnElement[object]:
    name = sa.func.pg_get_serial_sequence(table.name, "id")
    return sa.cast(name, REGCLASS)


def _delete_rows(connection: Connection, tables: list[sa.Table]) -> None:
    """Empty all tables, also of what only additions may change."""
    if connection.dialect.name == "postgresql":
        connection.exec_driver_sql(f"TRUNCATE {', '.join(table.name for table in tables)}")
        return
    for table in reversed(tables):
        connection.execute(table.delete())


@contextmanager
def _keys_checked_at_the_end(connection: Connection) -> Iterator[None]:
    """Let rows refer to later ones until the end: to others of their own table, for example."""
    if connection.dialect.name != "postgresql":
        yield
        return
    keys = [
        f"ALTER TABLE {table} ALTER CONSTRAINT {key['name']}"
        for (_, table), found in sa.inspect(connection).get_multi_foreign_keys().items()
        if table in metadata.tables
        for key in found
    ]
    for key in keys:
        connection.exec_driver_sql(f"{key} DEFERRABLE INITIALLY DEFERRED")
    yield
    connection.exec_driver_sql("SET CONSTRAINTS ALL IMMEDIATE")
    for key in keys:
        connection.exec_driver_sql(f"{key} NOT DEFERRABLE")
