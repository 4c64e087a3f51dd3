"""Audit event: what an account changed in one transaction."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime


@dataclass(frozen=True, slots=True, kw_only=True)
class Change:
    """One statement: rows of a table that were added, changed or deleted.

    ``before`` is the SHA-256 of the rows before, and ``after`` that of the new values;
    ``ids`` are those of at most a hundred rows.
    """

    table: str
    action: str  # "insert", "update" or "delete"
    count: int
    ids: tuple[int, ...] = ()
    before: str | None = None
    after: str | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class AuditEvent:
    """Who changed what, in which request and from where; sealed as events of decisions are."""

    number: int
    author: str
    address: str
    request_id: str
    operation: str
    aircraft_id: int | None
    changes: tuple[Change, ...]
    previous_hash: str
    sealed: str = ""
    hash: str = ""
    created_at: datetime | None = None
    id: int | None = None
