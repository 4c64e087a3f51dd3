"""Columns: column types of the tables, and naming convention."""

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
    """A time, stored as UTC without zone (SQLite has none) and returned with it."""

    impl = sa.DateTime
    cache_ok = True

    def process_bind_param(self, value: datetime | None, dialect: Dialect) -> datetime | None:
        """Reject a time without zone."""
        if value is None:
            return None
        if value.tzinfo is None:
            raise ValueError(f"{value!r} has no time zone; expected UTC")
        return value.astimezone(UTC).replace(tzinfo=None)

    def process_result_value(self, value: datetime | None, dialect: Dialect) -> datetime | None:
        """Return the time in UTC."""
        return None if value is None else value.replace(tzinfo=UTC)


def table(name: str, *parts: sa.schema.SchemaItem) -> sa.Table:
    """Return a table whose ids are never reused: they are in addresses and fence results."""
    return sa.Table(name, metadata, *parts, sqlite_autoincrement=True)


def identity() -> sa.Column[int]:
    """Return the primary key."""
    return sa.Column("id", sa.Integer, primary_key=True)


def refers_to(
    name: str, table: str, *, required: bool = True, index: bool = True, ondelete: str | None = None
) -> sa.Column[int]:
    """Return a foreign key; indexed, else a deletion in the other table scans this one."""
    key = sa.ForeignKey(f"{table}.id", ondelete=ondelete)
    return sa.Column(name, sa.Integer, key, nullable=not required, index=index)


def of_campaign() -> sa.Column[int]:
    """Return the aircraft whose campaign a record belongs to, if that is not in the record.

    None for records of a workbench without accounts.
    """
    return refers_to("aircraft_id", "aircraft", required=False)


def key(name: str, table: str, *, index: bool = False) -> sa.Column[int]:
    """Return a part of the primary key that refers to a record, and is deleted with it."""
    reference = sa.ForeignKey(f"{table}.id", ondelete="CASCADE")
    return sa.Column(name, sa.Integer, reference, primary_key=True, index=index)


def tag() -> sa.Column[str]:
    """Return the tag of a record, the other part of the primary key."""
    return sa.Column("tag", sa.String, primary_key=True, index=True)


def array(name: str, *, required: bool = True) -> sa.Column[str]:
    """Return a column of names of arrays."""
    return sa.Column(
        name, sa.String(64), sa.ForeignKey("arrays.hash"), nullable=not required, index=True
    )


def json(name: str, *, required: bool = True) -> sa.Column[Any]:
    """Return a column of nested values."""
    return sa.Column(name, sa.JSON(none_as_null=True), nullable=not required)


def text(
    name: str, *, length: int | None = None, required: bool = True, index: bool = False
) -> sa.Column[str]:
    """Return a column of text."""
    return sa.Column(name, sa.String(length), nullable=not required, index=index)


def integer(
    name: str, *, required: bool = True, index: bool = False, default: int | None = None
) -> sa.Column[int]:
    """Return a column of integers; rows of earlier schemas have the default."""
    preset = None if default is None else str(default)
    return sa.Column(name, sa.Integer, nullable=not required, index=index, server_default=preset)


def number(name: str, *, required: bool = True, index: bool = False) -> sa.Column[float]:
    """Return a column of real numbers."""
    return sa.Column(name, sa.Double, nullable=not required, index=index)


def moment(name: str, *, required: bool = True, index: bool = False) -> sa.Column[datetime]:
    """Return a column of times."""
    return sa.Column(name, UtcDateTime, nullable=not required, index=index)
