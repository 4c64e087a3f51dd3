"""Content: hashes of the inputs of a run, computed without reading samples."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import sqlalchemy as sa

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
_FLOWN = (
    *(maneuvers.c.start_s, maneuvers.c.duration_s, maneuvers.c.condition),
    *(maneuvers.c.axis, maneuvers.c.excitation),
)
_ASSUMED = {"aircraft": aircraft, "modal table": modal_tables, "prediction": predictions}
_AT_ONCE = 500  # maneuvers in one query


def hash_content(content: Any) -> str:
    """Return the SHA-256 of plain values."""
    text = json.dumps(content, sort_keys=True, separators=(",", ":"), ensure_ascii=False)
    return hashlib.sha256(text.encode()).hexdigest()


def hash_maneuvers(database: Database, ids: Sequence[int]) -> dict[int, tuple[int, str]]:
    """Return the aircraft of each maneuver, and a hash of its data and corrections.

    Sample arrays are included by their names, which are hashes of their content.
    """
    rows: dict[int, list[list[Any]]] = {}
    flew: dict[int, int] = {}
    with database.reading() as connection:
        for first in range(0, len(ids), _AT_ONCE):
            some = ids[first : first + _AT_ONCE]
            flown = sa.select(maneuvers.c.id, maneuvers.c.aircraft_id, *_FLOWN).where(
                maneuvers.c.id.in_(some)
            )
            for number, aircraft_id, *values in connection.execute(flown):
                flew[number] = aircraft_id
                rows[number] = [values]
            recorded = (
                sa.select(channels.c.maneuver_id, *_RECORDED)
                .where(channels.c.maneuver_id.in_(some))
                .order_by(channels.c.maneuver_id, channels.c.name)
            )
            for number, *values in connection.execute(recorded):
                rows[number].append(values)
            corrected = (
                sa.select(conditioning_steps.c.maneuver_id, conditioning_steps.c.correction)
                .where(conditioning_steps.c.maneuver_id.in_(some))
                .where(conditioning_steps.c.undone_at.is_(None))
                .order_by(conditioning_steps.c.id)
            )
            for number, correction in connection.execute(corrected):
                rows[number].append(correction)
    return {number: (flew[number], hash_content(values)) for number, values in rows.items()}


def hash_records(database: Database, names: Iterable[str]) -> dict[str, str]:
    """Return the hash of each named record, e.g. "maneuver 3"; missing records are omitted."""
    requested: dict[str, list[int]] = {}
    for name in dict.fromkeys(names):
        noun, _, number = name.rpartition(" ")
        requested.setdefault(noun, []).append(int(number))
    found = {
        f"maneuver {number}": content
        for number, (_, content) in hash_maneuvers(database, requested.pop("maneuver", [])).items()
    }
    with database.reading() as connection:
        for noun, numbers in requested.items():
            table = _ASSUMED[noun]
            for row in connection.execute(sa.select(table).where(table.c.id.in_(numbers))):
                # Empty columns are omitted: a later release may add columns.
                values = {name: value for name, value in row._mapping.items() if value is not None}
                found[f"{noun} {row.id}"] = hash_content(values)
    return found


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
