"""All rows of a database in another one, of the same kind or not, with the ids that were given."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator
from contextlib import contextmanager

import sqlalchemy as sa
from sqlalchemy.dialects.postgresql import REGCLASS
from sqlalchemy.engine import Connection

from flexsid.storage.tables import arrays, metadata, row_seals, upload_files

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
