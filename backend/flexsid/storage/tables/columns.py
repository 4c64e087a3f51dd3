"""Columns: what tables are made of, and how times and names are kept."""

from __future__ import annotations

from datetime import UTC, datetime
from typing import Any

import sqlalchemy as sa
from sqlalchemy.engine import Dialect

metadata = sa.MetaData(
    naming_convention={
        "pk": "pk_%(table_name)s",
        "fk": "fk_%(table_name)s_%(column_0_name)s",
        "ix": "ix_%(table_name)s_%(column_0_N_name)s",
        "uq": "uq_%(table_name)s_%(column_0_N_name)s",
    }
)


class UtcDateTime(sa.TypeDecorator[datetime]):
    """A moment, kept as UTC without zone (SQLite has none) and returned with it."""

    impl = sa.DateTime
    cache_ok = True

    def process_bind_param(self, value: datetime | None, dialect: Dialect) -> datetime | None:
        """Refuse a moment without zone: whose clock was it?"""
        if value is None:
            return None
        if value.tzinfo is None:
            raise ValueError(f"{value!r} has no time zone; give UTC")
        return value.astimezone(UTC).replace(tzinfo=None)

    def process_result_value(self, value: datetime | None, dialect: Dialect) -> datetime | None:
        """Put the zone back."""
        return None if value is None else value.replace(tzinfo=UTC)


def table(name: str, *parts: sa.schema.SchemaItem) -> sa.Table:
    """Make a table whose ids are never given twice: they stand in addresses and fence results."""
    return sa.Table(name, metadata, *parts, sqlite_autoincrement=True)


def identity() -> sa.Column[int]:
    """Make the primary key."""
    return sa.Column("id", sa.Integer, primary_key=True)


def refers_to(
    name: str, table: str, *, required: bool = True, index: bool = True, ondelete: str | None = None
) -> sa.Column[int]:
    """Make a foreign key; indexed, else deleting the other end scans this table."""
    key = sa.ForeignKey(f"{table}.id", ondelete=ondelete)
    return sa.Column(name, sa.Integer, key, nullable=not required, index=index)


def json(name: str, *, required: bool = True) -> sa.Column[Any]:
    """Make a column of nested values."""
    return sa.Column(name, sa.JSON(none_as_null=True), nullable=not required)


def text(name: str, *, required: bool = True) -> sa.Column[str]:
    """Make a column of words."""
    return sa.Column(name, sa.String, nullable=not required)


def number(name: str, *, required: bool = True, index: bool = False) -> sa.Column[float]:
    """Make a column of real numbers."""
    return sa.Column(name, sa.Double, nullable=not required, index=index)
