"""Content: hashes of the inputs of a run, computed without reading samples."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial, reduce
from typing import Any

import sqlalchemy as sa
from sqlalchemy.engine import Connection
from sqlalchemy.ext.compiler import compiles
from sqlalchemy.sql.compiler import SQLCompiler

from flexsid.storage.database import Database
from flexsid.storage.tables import (
    aircraft,
    channels,
    conditioning_steps,
    maneuvers,
    metadata,
    modal_tables,
    predictions,
)

_RECORDED = (
    *(channels.c.name, channels.c.unit, channels.c.role, channels.c.rate_hz),
    *(channels.c.start_s, channels.c.sensor, channels.c.array),
)
_NUMBERS = (channels.c.rate_hz, channels.c.start_s)
_FLOWN = (
    *(maneuvers.c.start_s, maneuvers.c.duration_s, maneuvers.c.condition),
    *(maneuvers.c.axis, maneuvers.c.excitation),
)
_ASSUMED = {"aircraft": aircraft, "modal table": modal_tables, "prediction": predictions}
_IN_FORCE = conditioning_steps.c.undone_at.is_(None)
_AT_ONCE = 500  # maneuvers in one query
_MOST_HASHES = 20_000  # of 200 bytes

# By a digest of the rows as text: lists ask for the same content at every read, and decoding
# and encoding it takes most of their time.
_hashes: dict[bytes, str] = {}


class _Quoted(sa.Function[str]):
    """A value as an SQL literal, which no other value has."""

    inherit_cache = True

    def __init__(self, column: sa.ColumnElement[Any]) -> None:
        super().__init__("quote", column, type_=sa.Text())


@compiles(_Quoted, "postgresql")
def _compile_quoted(element: _Quoted, compiler: SQLCompiler, **options: Any) -> str:
    (column,) = element.clauses
    return f"quote_nullable(CAST({compiler.process(column, **options)} AS TEXT))"


def _select_texts(
    key: sa.Column[int],
    columns: Iterable[sa.ColumnElement[Any]],
    condition: sa.ColumnElement[bool] | None = None,
    numbers: Sequence[sa.Column[float]] = (),
) -> sa.Select[*tuple[Any, ...]]:
    """Return the query of the rows of each ``ids``, as one text for each group of equal numbers.

    SQLite takes as long to write a number as to write five texts, and most are equal.
    """
    row = reduce(lambda one, other: one.concat(other), map(_Quoted, columns))
    texts = sa.func.aggregate_strings(row, ",")
    query = sa.select(key, *numbers, texts).where(key.in_(sa.bindparam("ids", expanding=True)))
    grouped = query.group_by(key, *numbers).order_by(key, *numbers)
    return grouped if condition is None else grouped.where(condition)


_MANEUVER_TEXTS = (
    _select_texts(maneuvers.c.id, _FLOWN),
    _select_texts(
        channels.c.maneuver_id,
        [column for column in _RECORDED if column not in _NUMBERS],
        numbers=_NUMBERS,
    ),
    _select_texts(
        conditioning_steps.c.maneuver_id,
        (conditioning_steps.c.id, conditioning_steps.c.correction),
        _IN_FORCE,
    ),
)
_ASSUMED_TEXTS = {noun: (_select_texts(table.c.id, table.c),) for noun, table in _ASSUMED.items()}


def hash_content(content: Any) -> str:
    """Return the SHA-256 of plain values."""
    text = json.dumps(content, sort_keys=True, separators=(",", ":"), ensure_ascii=False)
    return hashlib.sha256(text.encode()).hexdigest()


def hash_maneuvers(database: Database, ids: Sequence[int]) -> dict[int, tuple[int, str]]:
    """Return the aircraft of each maneuver, and a hash of its data and corrections.

    Sample arrays are included by their names, which are hashes of their content.
    """
    flew: dict[int, int] = {}
    hashes: dict[int, str] = {}
    with database.reading() as connection:
        for first in range(0, len(ids), _AT_ONCE):
            some = list(ids[first : first + _AT_ONCE])
            flown = sa.select(maneuvers.c.id, maneuvers.c.aircraft_id)
            for number, aircraft_id in connection.execute(flown.where(maneuvers.c.id.in_(some))):
                flew[number] = aircraft_id
            hashes |= _hash_rows(connection, _MANEUVER_TEXTS, some, _read_maneuvers)
    return {number: (flew[number], content) for number, content in hashes.items()}


def _read_maneuvers(connection: Connection, ids: Sequence[int]) -> dict[int, Any]:
    rows: dict[int, list[Any]] = {}
    for number, *values in connection.execute(
        sa.select(maneuvers.c.id, *_FLOWN).where(maneuvers.c.id.in_(ids))
    ):
        rows[number] = [values]
    for number, *values in connection.execute(
        sa.select(channels.c.maneuver_id, *_RECORDED)
        .where(channels.c.maneuver_id.in_(ids))
        .order_by(channels.c.maneuver_id, channels.c.name)
    ):
        rows[number].append(values)
    for number, correction in connection.execute(
        sa.select(conditioning_steps.c.maneuver_id, conditioning_steps.c.correction)
        .where(conditioning_steps.c.maneuver_id.in_(ids), _IN_FORCE)
        .order_by(conditioning_steps.c.id)
    ):
        rows[number].append(correction)
    return rows


def hash_records(database: Database, names: Iterable[str]) -> dict[str, str]:
    """Return the hash of each named record, e.g. "maneuver 3"; missing records are omitted."""
    requested: dict[str, list[int]] = {}
    for name in dict.fromkeys(names):
        noun, _, number = name.rpartition(" ")
        requested.setdefault(noun, []).append(int(number))
    with database.reading() as connection:
        flown = hash_maneuvers(database, requested.pop("maneuver", []))
        found = {f"maneuver {number}": content for number, (_, content) in flown.items()}
        for noun, numbers in requested.items():
            table = _ASSUMED[noun]
            hashes = _hash_rows(connection, _ASSUMED_TEXTS[noun], numbers, partial(_read, table))
            found |= {f"{noun} {number}": content for number, content in hashes.items()}
    return found


def _read(table: sa.Table, connection: Connection, ids: Sequence[int]) -> dict[int, Any]:
    rows = connection.execute(sa.select(table).where(table.c.id.in_(ids)))
    # Empty columns are omitted: a later release may add columns.
    return {
        row.id: {name: value for name, value in row._mapping.items() if value is not None}
        for row in rows
    }


def _hash_rows(
    connection: Connection,
    texts: Sequence[sa.Select[*tuple[Any, ...]]],
    ids: Sequence[int],
    read: Callable[[Connection, Sequence[int]], dict[int, Any]],
) -> dict[int, str]:
    """Return the hash of the content of each id; content that was hashed before is not read."""
    digests: dict[int, Any] = {}
    for query in texts:
        for number, *parts in connection.execute(query, {"ids": list(ids)}):
            text = "\0".join(map(str, parts))
            digests.setdefault(number, hashlib.sha256()).update(text.encode() + b"\0")
    keys = {number: digest.digest() for number, digest in digests.items()}
    hashes = {number: _hashes[key] for number, key in keys.items() if key in _hashes}
    if missing := [number for number in keys if number not in hashes]:
        for number, content in read(connection, missing).items():
            hashes[number] = hash_content(content)
            if len(_hashes) >= _MOST_HASHES:
                _hashes.clear()
            _hashes[keys[number]] = hashes[number]
    return hashes


def find_changes(
    database: Database, rested_on: Sequence[Mapping[str, str] | None]
) -> list[tuple[str, ...]]:
    """Return the input records of each run that changed since the run."""
    now = hash_records(database, [name for one in rested_on for name in one or ()])
    return [
        tuple(name for name, content in (one or {}).items() if now.get(name) != content)
        for one in rested_on
    ]


def hash_record(database: Database, table: str, ids: Iterable[int]) -> str:
    """Return the hash of an aircraft, modal tables or predictions."""
    source = metadata.tables[table]
    query = sa.select(source).where(source.c.id.in_(list(ids))).order_by(source.c.id)
    with database.reading() as connection:
        return hash_content([list(row) for row in connection.execute(query)])
