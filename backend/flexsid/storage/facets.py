"""Facets: how many lines of a list each choice of a filter would leave."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import sqlalchemy as sa
from sqlalchemy.engine import Connection

MOST_CHOICES = 500
"""Choices told per facet; a filter with more of them is searched, not picked from."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Choice:
    """One choice of a filter, and the lines that it would leave beside the other filters."""

    value: str
    label: str
    count: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Facets:
    """Lines that all filters together leave, and the choices of each filter by its name."""

    total: int
    choices: dict[str, list[Choice]]


def count_rows(
    connection: Connection, source: sa.FromClause, conditions: Sequence[sa.ColumnElement[bool]]
) -> int:
    """Count the lines of a list."""
    query = sa.select(sa.func.count()).select_from(source).where(*conditions)
    return connection.scalar(query) or 0


def count_choices(
    connection: Connection,
    source: sa.FromClause,
    conditions: Sequence[sa.ColumnElement[bool]],
    value: sa.ColumnElement[Any],
    label: sa.ColumnElement[Any] | None = None,
) -> list[Choice]:
    """Count the lines of a list by the value of a column; lines without one are left out."""
    shown = value if label is None else label
    query = (
        sa.select(value, sa.func.min(shown), sa.func.count())
        .select_from(source)
        .where(*conditions, value.is_not(None))
        .group_by(value)
        .order_by(sa.func.min(shown))
        .limit(MOST_CHOICES)
    )
    return [
        Choice(value=str(found), label=str(name), count=count)
        for found, name, count in connection.execute(query)
    ]
