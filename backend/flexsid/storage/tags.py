"""Tags: short labels that an analyst assigns to maneuvers and runs."""

from __future__ import annotations

from collections.abc import Iterable

import sqlalchemy as sa
from sqlalchemy.engine import Connection


def read_tags(connection: Connection, table: sa.Table, ids: Iterable[int]) -> dict[int, list[str]]:
    """Return the tags of some records, in alphabetical order.

    Parameters
    ----------
    connection
        A transaction to read in.
    table
        ``maneuver_tags`` or ``run_tags``.
    ids
        Records on the page.
    """
    key = key_column(table)
    requested = list(ids)
    found: dict[int, list[str]] = {identity: [] for identity in requested}
    query = sa.select(key, table.c.tag).where(key.in_(requested)).order_by(table.c.tag)
    for identity, tag in connection.execute(query):
        found[identity].append(tag)
    return found


def add_tag(connection: Connection, table: sa.Table, ids: Iterable[int], tag: str) -> list[int]:
    """Add a tag to records; returns those that did not have it."""
    requested = list(ids)
    had = _find_tagged(connection, table, requested, tag)
    new = [identity for identity in requested if identity not in had]
    if new:
        name = key_column(table).name
        rows = [{name: identity, "tag": tag} for identity in new]
        connection.execute(sa.insert(table), rows)
    return new


def remove_tag(connection: Connection, table: sa.Table, ids: Iterable[int], tag: str) -> list[int]:
    """Remove a tag from records; returns those that had it."""
    requested = list(ids)
    had = _find_tagged(connection, table, requested, tag)
    connection.execute(sa.delete(table).where(key_column(table).in_(had), table.c.tag == tag))
    return [identity for identity in requested if identity in had]


def _find_tagged(connection: Connection, table: sa.Table, ids: list[int], tag: str) -> set[int]:
    query = sa.select(key_column(table)).where(key_column(table).in_(ids), table.c.tag == tag)
    return set(connection.scalars(query))


def key_column(table: sa.Table) -> sa.Column[int]:
    """Return the column of the tagged records."""
    return next(column for column in table.c if column.name != "tag")
