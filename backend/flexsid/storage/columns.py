"""Columns: tables of records, column types by the annotations of fields, and naming convention."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import UTC, date, datetime
from enum import Enum
from types import NoneType, UnionType
from typing import Any, Union, get_args, get_origin

import sqlalchemy as sa
from sqlalchemy.engine import Dialect

from flexsid.storage.encoding import get_hints

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


_TYPES: dict[type, type[sa.types.TypeEngine[Any]]] = {
    bool: sa.Boolean,
    int: sa.Integer,
    float: sa.Double,
    datetime: UtcDateTime,
    date: sa.Date,
}
"""Types of single values beside texts; other values are JSON."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Stored:
    """What a column has beside the type and the optionality of its field.

    ``refers_to`` is another column, whose deletion does ``ondelete``; ``length`` that of a text.
    Rows of earlier schemas have the ``default``. With ``required`` no row lacks a value although
    a record may.
    """

    refers_to: str | None = None
    ondelete: str | None = None
    index: bool = False
    unique: bool = False
    length: int | None = None
    default: str | None = None
    required: bool = False


ARRAY = Stored(refers_to="arrays.hash", index=True, length=64)
"""Name of an array."""

HASH = Stored(length=64)
"""SHA-256."""


def refers_to(
    table: str, *, index: bool = True, ondelete: str | None = None, required: bool = False
) -> Stored:
    """Return a foreign key; indexed, else a deletion in the other table scans this one."""
    return Stored(refers_to=f"{table}.id", index=index, ondelete=ondelete, required=required)


def of_record(
    name: str,
    record: type,
    /,
    *parts: sa.schema.SchemaItem,
    **stored: Stored | sa.Column[Any] | None,
) -> sa.Table:
    """Return the table of a record: a column per field, by its annotation.

    The repository states ``created_at`` of a record that has none.

    Parameters
    ----------
    name
        Name of the table.
    record
        A dataclass.
    parts
        Constraints, indices, and columns that are not in the record.
    stored
        By the names of fields: what columns have beside, or a column in place of the usual one;
        None for a field that is computed as a row is read.
    """
    hints = get_hints(record)
    assert stored.keys() <= hints.keys(), (name, stored.keys() - hints.keys())
    usual = {"id": identity(), "created_at": Stored(required=True), **stored}
    columns = [
        own if isinstance(own, sa.Column) else column(field, kind, own)
        for field, kind in hints.items()
        if (own := usual.get(field, Stored())) is not None
    ]
    return table(name, *columns, *parts)


def table(name: str, *parts: sa.schema.SchemaItem) -> sa.Table:
    """Return a table whose ids are never reused: they are in addresses and fence results."""
    return sa.Table(name, metadata, *parts, sqlite_autoincrement=True)


def column(name: str, kind: Any, stored: Stored = Stored()) -> sa.Column[Any]:
    """Return the column of a field with this annotation; nested values are JSON."""
    alternatives = get_args(kind) if get_origin(kind) in (Union, UnionType) else (kind,)
    kinds = [one for one in alternatives if one is not NoneType]
    keys = [sa.ForeignKey(stored.refers_to, ondelete=stored.ondelete)] if stored.refers_to else []
    return sa.Column(
        name,
        _find_type(kinds[0] if len(kinds) == 1 else None, stored.length),
        *keys,
        nullable=len(kinds) < len(alternatives) and not stored.required,
        index=stored.index,
        unique=stored.unique,
        server_default=stored.default,
    )


def _find_type(kind: Any, length: int | None) -> sa.types.TypeEngine[Any]:
    if isinstance(kind, type) and issubclass(kind, str | Enum):
        return sa.String(length)
    return _TYPES[kind]() if kind in _TYPES else sa.JSON(none_as_null=True)


def identity() -> sa.Column[int]:
    """Return the primary key."""
    return sa.Column("id", sa.Integer, primary_key=True)


def of_campaign() -> sa.Column[int]:
    """Return the aircraft whose campaign a record belongs to, if that is not in the record.

    None for records of a workbench without accounts.
    """
    return column("aircraft_id", int | None, refers_to("aircraft"))


def key(name: str, table: str, *, index: bool = False) -> sa.Column[int]:
    """Return a part of the primary key that refers to a record, and is deleted with it."""
    reference = sa.ForeignKey(f"{table}.id", ondelete="CASCADE")
    return sa.Column(name, sa.Integer, reference, primary_key=True, index=index)


def tag() -> sa.Column[str]:
    """Return the tag of a record, the other part of the primary key."""
    return sa.Column("tag", sa.String, primary_key=True, index=True)
