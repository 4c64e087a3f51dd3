"""Results of runs: kept with a hash, so that one that is altered later is noticed."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from typing import Any

import sqlalchemy as sa
from sqlalchemy.engine import Connection

from flexsid.storage.tables import runs

SEALED: tuple[str, ...] = ("maneuver_id", "method", "structure", "settings", "result", "versions")
"""Columns that the hash covers: what was asked for, what came out, and of which software.

A migration that rewrites one of them must seal the runs again.
"""


def result_hash(row: Mapping[str, Any]) -> str:
    """SHA-256 of the sealed columns as JSON, keys sorted and no blanks."""
    content = [row[name] for name in SEALED]
    text = json.dumps(content, sort_keys=True, separators=(",", ":"), ensure_ascii=False)
    return hashlib.sha256(text.encode()).hexdigest()


def is_altered(row: Mapping[str, Any]) -> bool:
    """Whether a run is not what it was when its result was kept."""
    kept = row["result_hash"]
    return kept is not None and result_hash(row) != kept


def seal(connection: Connection, run_id: int) -> None:
    """Keep the hash of a result that was just written."""
    this = runs.c.id == run_id
    query = sa.select(*(runs.c[name] for name in SEALED)).where(this)
    row = connection.execute(query).one()
    kept = dict(zip(SEALED, row, strict=True))
    connection.execute(sa.update(runs).where(this).values(result_hash=result_hash(kept)))
