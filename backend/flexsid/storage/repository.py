"""Repository: storage of one kind of record, and what one request reads once."""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import fields, replace
from datetime import UTC, datetime
from enum import Enum
from functools import cache
from typing import Any, ClassVar, Generic, Protocol, TypeVar

import sqlalchemy as sa
from pydantic import TypeAdapter
from sqlalchemy.engine import Connection
from sqlalchemy.exc import IntegrityError

from flexsid.errors import Conflict, UnknownRecord
from flexsid.records.run import Method
from flexsid.storage.database import Database, NotFinite
from flexsid.storage.encoding import get_hints
from flexsid.text import LARGEST_ID

# --- Reading once: what several functions of one request read is read and decoded once ------------

T = TypeVar("T")

_known: ContextVar[dict[Hashable, Any] | None] = ContextVar("read_once", default=None)


@contextmanager
def reading_once() -> Iterator[None]:
    """Read every record at most once, for what changes nothing."""
    if _known.get() is not None:
        yield
        return
    token = _known.set({})
    try:
        yield
    finally:
        _known.reset(token)


def read_once(key: Hashable, read: Callable[[], T]) -> T:
    """Return what was read under this key in ``reading_once``; without that, or before, read it."""
    known = _known.get()
    if known is None:
        return read()
    if key not in known:
        known[key] = read()
    return known[key]


# --- Repository: storage of one kind of record ----------------------------------------------------


class Record(Protocol):
    """A frozen dataclass with an id that is None until it is stored."""

    __dataclass_fields__: ClassVar[dict[str, Any]]

    @property
    def id(self) -> int | None:
        """Row number."""
        ...


R = TypeVar("R", bound=Record)


class Repository(Generic[R]):
    """Stores records of one type in one table, with one column per field.

    Parameters
    ----------
    database
        The database.
    table
        Has a column for every field; nested fields are JSON columns.
    record
        The dataclass.
    noun
        Name of the record in messages.
    copied
        Further columns, computed from the record so that SQL can filter by them.
    derived
        Fields without a column, computed from the row as it is read.
    """

    def __init__(
        self,
        database: Database,
        table: sa.Table,
        record: type[R],
        noun: str,
        copied: Callable[[R], Mapping[str, Any]] | None = None,
        derived: Mapping[str, Callable[[Mapping[str, Any]], Any]] | None = None,
    ) -> None:
        self.table = table
        self._database = database
        self._noun = noun
        self._copied = copied
        self._record = record
        self._derived = derived or {}
        names = (field.name for field in fields(record))
        self.fields = tuple(name for name in names if name not in self._derived)
        self._methods = [n for n, kind in get_hints(record).items() if kind is Method]
        self._nested = {name for name in self.fields if isinstance(table.c[name].type, sa.JSON)}

    def add(self, record: R) -> R:
        """Store a new record; return it with its id (and its time, if it has one)."""
        row = self.encode(record)
        del row["id"]
        if "created_at" in row and row["created_at"] is None:
            row["created_at"] = datetime.now(UTC)
            record = replace(record, **{"created_at": row["created_at"]})
        with self._writing() as connection:
            result = connection.execute(sa.insert(self.table).values(row))
        primary_key = result.inserted_primary_key
        assert primary_key is not None
        return replace(record, **{"id": primary_key[0]})

    def add_many(self, records: Sequence[R]) -> None:
        """Store new records in one statement; their ids are not returned."""
        rows = [self.encode(record) for record in records]
        for row in rows:
            del row["id"]
        if rows:
            with self._writing() as connection:
                connection.execute(sa.insert(self.table), rows)

    def get(self, identity: int) -> R:
        """Return the record with this id; a transaction locks it against changes."""
        if self._database.in_transaction:
            return self._get(identity, lock=True)
        return read_once((self.table.name, identity), lambda: self._get(identity))

    def find(self, **equals: Any) -> list[R]:
        """Return the records whose fields have these values, oldest first."""
        conditions = [self.table.c[name] == _plain(value) for name, value in equals.items()]
        if self._database.in_transaction:
            return self._select(*conditions)
        key = (self.table.name, *sorted(equals.items()))
        return list(read_once(key, lambda: self._select(*conditions)))

    def advance(self, record: R) -> bool:
        """Replace the previous version; False if another replacement was earlier."""
        row = self.encode(record)
        before = sa.and_(self._is(row.pop("id")), self.table.c.version == row["version"] - 1)
        with self._database.transaction() as connection:
            done = connection.execute(sa.update(self.table).where(before).values(row))
        return done.rowcount == 1

    def replace(self, record: R) -> R:
        """Replace the record with the same id."""
        row = self.encode(record)
        identity = row.pop("id")
        with self._writing() as connection:
            result = connection.execute(sa.update(self.table).where(self._is(identity)).values(row))
        if result.rowcount == 0:
            raise self._unknown(identity)
        return record

    def delete(self, identity: int) -> None:
        """Delete a record; rejected while others refer to it."""
        with self._database.transaction() as connection:
            try:
                result = connection.execute(sa.delete(self.table).where(self._is(identity)))
            except IntegrityError as error:
                raise Conflict(
                    f"{self._noun} {identity} is used by other records; delete those first",
                    code="in-use",
                ) from error
        if result.rowcount == 0:
            raise self._unknown(identity)

    def encode(self, record: R) -> dict[str, Any]:
        """Return the row of a record."""
        row = {name: self.encode_field(name, getattr(record, name)) for name in self.fields}
        if self._copied is not None:
            row.update(self._copied(record))
        return row

    def encode_field(self, name: str, value: Any) -> Any:
        """Return the column value of one field."""
        if name in self._nested:
            if value is None:
                return None
            adapter = _adapt_field(self._record, name)
            return adapter.dump_python(value, mode="json", warnings="error")
        if isinstance(value, float) and not math.isfinite(value):
            raise NotFinite(f"{name} of {self._noun} is {value}; an unknown number must be None")
        return _plain(value)

    def decode(self, rows: Sequence[sa.RowMapping]) -> list[R]:
        """Return the records of rows."""
        adapter = _adapt(self._record)
        return [adapter.validate_python(self._values(row)) for row in rows]

    @contextmanager
    def _writing(self) -> Iterator[Connection]:
        with self._database.transaction() as connection:
            try:
                yield connection
            except IntegrityError as error:
                raise self._refused(error) from error

    def _values(self, row: sa.RowMapping) -> dict[str, Any]:
        values = {name: row[name] for name in self.fields}
        values |= {name: Method.restore(values[name]) for name in self._methods}
        return values | {name: derive(values) for name, derive in self._derived.items()}

    def _get(self, identity: int, *, lock: bool = False) -> R:
        found = self._select(self._is(identity), lock=lock)
        if not found:
            raise self._unknown(identity)
        return found[0]

    def _select(self, *conditions: sa.ColumnElement[bool], lock: bool = False) -> list[R]:
        columns = [self.table.c[name] for name in self.fields]
        query = sa.select(*columns).where(*conditions).order_by(self.table.c.id)
        if lock:  # SQLite has one writer
            query = query.with_for_update(key_share=True)
        with self._database.reading() as connection:
            return self.decode(connection.execute(query).mappings().all())

    def _is(self, identity: int | None) -> sa.ColumnElement[bool]:
        # A larger number than an integer column holds is no record's id.
        if identity is None or not 1 <= identity <= LARGEST_ID:
            raise self._unknown(identity)
        return self.table.c.id == identity

    def _unknown(self, identity: int | None) -> UnknownRecord:
        return UnknownRecord(f"there is no {self._noun} {identity}")

    def _refused(self, error: IntegrityError) -> Conflict | UnknownRecord:
        reason = str(error.orig)
        if "foreign key" in reason.lower():
            return UnknownRecord(f"the {self._noun} refers to a record that does not exist")
        if "unique" in reason.lower():
            return Conflict(f"this {self._noun} already exists", code="already-exists")
        return Conflict(f"the {self._noun} cannot be stored: {reason}")


# Adapters take milliseconds to build: one per type and process, when it is first used.
@cache
def _adapt(record: type[Record]) -> TypeAdapter[Any]:
    return TypeAdapter(record)


@cache
def _adapt_field(record: type[Record], name: str) -> TypeAdapter[Any]:
    return TypeAdapter(get_hints(record)[name])


def _plain(value: Any) -> Any:
    return value.value if isinstance(value, Enum) else value
