"""Content: what a run rests on, as one hash, read without its samples."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Sequence
from typing import Any

import sqlalchemy as sa

from flexsid.storage.store import Store
from flexsid.storage.tables import (
    aircraft,
    channels,
    conditioning_steps,
    maneuvers,
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
_AT_ONCE = 500  # maneuvers in one query


def hash_of(content: Any) -> str:
    """SHA-256 of plain values."""
    text = json.dumps(content, sort_keys=True, separators=(",", ":"), ensure_ascii=False)
    return hashlib.sha256(text.encode()).hexdigest()


def maneuver_hashes(store: Store, ids: Sequence[int]) -> dict[int, tuple[int, str]]:
    """Aircraft of each maneuver, and hash of what was recorded, corrected and flown.

    Sample arrays stand in it by their names, which are hashes of what they hold.
    """
    rows: dict[int, list[list[Any]]] = {}
    flew: dict[int, int] = {}
    with store.database.reading() as connection:
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
    return {number: (flew[number], hash_of(values)) for number, values in rows.items()}


def record_hash(store: Store, table: str, ids: Iterable[int]) -> str:
    """Hash of an aircraft, modal tables or predictions."""
    kept = {"aircraft": aircraft, "modal_tables": modal_tables, "predictions": predictions}[table]
    query = sa.select(kept).where(kept.c.id.in_(list(ids))).order_by(kept.c.id)
    with store.database.reading() as connection:
        return hash_of([list(row) for row in connection.execute(query)])
