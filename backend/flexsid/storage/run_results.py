"""Results of runs: stored with a hash, so that later alterations are detected."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from typing import Any

import orjson
import sqlalchemy as sa
from sqlalchemy.engine import Connection

from flexsid.storage.content import hash_content
from flexsid.storage.tables import runs

SEALED: tuple[str, ...] = ("maneuver_id", "method", "structure", "settings", "result", "versions")
"""Columns that the hash covers: the request, the result, and the software versions.

A migration that rewrites one of them must update the hashes.
"""


def hash_result(row: Mapping[str, Any]) -> str:
    """SHA-256 of the sealed columns as JSON, keys sorted and no blanks."""
    return hash_content([row[name] for name in SEALED])


def is_altered(row: Mapping[str, Any]) -> bool:
    """Return whether a run was altered after its result was stored."""
    stored = row["result_hash"]
    if stored is None:
        return False
    sealed = orjson.dumps([row[name] for name in SEALED], option=orjson.OPT_SORT_KEYS)
    return not _matches(sealed, stored)


@lru_cache(maxsize=256)  # of some 30 kB; the hash takes ten times longer than this key
def _matches(sealed: bytes, stored: str) -> bool:
    return hash_content(orjson.loads(sealed)) == stored


def store_hash(connection: Connection, run_id: int) -> None:
    """Store the hash of a new result."""
    this = runs.c.id == run_id
    query = sa.select(*(runs.c[name] for name in SEALED)).where(this)
    row = connection.execute(query).one()
    sealed = dict(zip(SEALED, row, strict=True))
    connection.execute(sa.update(runs).where(this).values(result_hash=hash_result(sealed)))
