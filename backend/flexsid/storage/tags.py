"""Tags: short words that an analyst puts on maneuvers and runs to find them again."""

from __future__ import annotations

from collections.abc import Iterable

import sqlalchemy as sa
from sqlalchemy.engine import Connection


def tags_of(connection: Connection, table: sa.Table, ids: Iterable[int]) -> dict[int, list[str]]:
    """Read the tags of some records, in the order of the alphabet.

    Parameters
    ----------
    connection
        A transaction to read in.
    table
        ``maneuver_tags`` or ``run_tags``.
    ids
        Records on the page.
    """
    owner = _owner(table)
    wanted = list(ids)
    found: dict[int, list[str]] = {identity: [] for identity in wanted}
    query = sa.select(owner, table.c.tag).where(owner.in_(wanted)).order_by(table.c.tag)
    for identity, tag in connection.execute(query):
        found[identity].append(tag)
    return found


def has_tag(table: sa.Table, identity: sa.ColumnElement[int], tag: str) -> sa.ColumnElement[bool]:
    """Ask for records with a tag."""
    return identity.in_(sa.select(_owner(table)).where(table.c.tag == tag))


def put_tag(connection: Connection, table: sa.Table, ids: Iterable[int], tag: str) -> list[int]:
    """Tag records; returns those that did not have the tag."""
    wanted = list(ids)
    had = _tagged(connection, table, wanted, tag)
    new = [identity for identity in wanted if identity not in had]
    if new:
        name = _owner(table).name
        rows = [{name: identity, "tag": tag} for identity in new]
        connection.execute(sa.insert(table), rows)
    return new


def take_tag(connection: Connection, table: sa.Table, ids: Iterable[int], tag: str) -> list[int]:
    """Take a tag off records; returns those that had it."""
    wanted = list(ids)
    had = _tagged(connection, table, wanted, tag)
    connection.execute(sa.delete(table).where(_owner(table).in_(had), table.c.tag == tag))
    return [identity for identity in wanted if identity in had]


def _tagged(connection: Connection, table: sa.Table, ids: list[int], tag: str) -> set[int]:
    query = sa.select(_owner(table)).where(_owner(table).in_(ids), table.c.tag == tag)
    return set(connection.scalars(query))


def _owner(table: sa.Table) -> sa.Column[int]:
    return next(column for column in table.c if column.name != "tag")
