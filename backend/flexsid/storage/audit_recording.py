"""Recording of changes: every transaction of an account ends with a sealed event of the audit log.

The event is written in the transaction of the changes, so that neither exists without the other.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import asdict, replace
from datetime import UTC, datetime
from typing import Any, Protocol, TypeVar

import orjson
import sqlalchemy as sa
from sqlalchemy import event
from sqlalchemy.engine import Connection, CursorResult, Engine

from flexsid.records.account import AuditEvent, Change
from flexsid.records.sealed_names import with_sealed_names
from flexsid.storage.access import get_access, using_access
from flexsid.storage.tables import audit_events

# --- Chain of events: each is sealed with the hash of the one before, so that changes are noticed


class SealedEvent(Protocol):
    """A frozen dataclass with its place in the chain, its canonical text and the hash of that."""

    @property
    def number(self) -> int:
        """Position in the chain, from 1."""
        ...

    @property
    def previous_hash(self) -> str:
        """Hash of the event before."""
        ...

    @property
    def sealed(self) -> str:
        """The event as JSON."""
        ...

    @property
    def hash(self) -> str:
        """SHA-256 of ``sealed``."""
        ...


E = TypeVar("E", bound=SealedEvent)


def seal(event: E) -> E:
    """Add the canonical text of an event and its hash."""
    sealed = _to_canonical(_get_content(event))
    values: dict[str, Any] = {"sealed": sealed, "hash": _sha256(sealed)}
    return replace(event, **values)  # type: ignore[type-var]


def is_chain_intact(events: Iterable[SealedEvent]) -> bool:
    """Return whether every event is unchanged and none is missing."""
    previous = ""
    for number, one in enumerate(events, start=1):
        linked = (one.number, one.previous_hash) == (number, previous)
        if not linked or one.hash != _sha256(one.sealed):
            return False
        # A later release may have records with more fields than were sealed.
        if not _matches(_get_content(one), json.loads(one.sealed)):
            return False
        previous = one.hash
    return True


def hash_value(value: Any) -> str:
    """Compute SHA-256 of a value as JSON with sorted keys, without blanks and empty values.

    Empty values are omitted because a later release may add fields, which are empty in records
    stored before.
    """
    return _sha256(_to_canonical(_remove_empty(_to_plain(value))))


def _get_content(event: SealedEvent) -> Any:
    content = _to_plain(event)
    for name in ("id", "hash", "sealed"):
        del content[name]
    return content


def _matches(found: Any, sealed: Any) -> bool:
    if isinstance(sealed, dict) and isinstance(found, dict):
        return all(key in found and _matches(found[key], value) for key, value in sealed.items())
    if isinstance(sealed, list) and isinstance(found, list):
        return len(found) == len(sealed) and all(map(_matches, found, sealed))
    return found == sealed


def _remove_empty(value: Any) -> Any:
    if isinstance(value, dict):
        items = {key: _remove_empty(item) for key, item in value.items()}
        return {key: item for key, item in items.items() if not _is_empty(item)}
    if isinstance(value, list):
        return [_remove_empty(item) for item in value]
    return value


def _is_empty(value: Any) -> bool:
    # A zero is not empty.
    return value is None or value is False or (isinstance(value, str | list | dict) and not value)


def _to_plain(value: Any) -> Any:
    plain = orjson.loads(orjson.dumps(value, option=orjson.OPT_NON_STR_KEYS | orjson.OPT_UTC_Z))
    return with_sealed_names(plain)


def _to_canonical(content: Any) -> str:
    return json.dumps(content, sort_keys=True, separators=(",", ":"), ensure_ascii=False)


def _sha256(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()


# --- Recording of changes: every transaction of an account ends with an event of the audit log

_LOCK = 0x666C6175  # any number not used by other advisory locks
_MOST_IDS = 100
# Named by their content, copied from what is recorded, or not what an account has changed.
_OMITTED = frozenset(
    {
        *("arrays", "leases", "looks", "job_events", "login_places", "login_failures"),
        *("audit_events", "run_summaries", "upload_files"),
    }
)
_changes: ContextVar[list[Change] | None] = ContextVar("changes", default=None)


@contextmanager
def recording_changes(connection: Connection) -> Iterator[None]:
    """Write an event of all changes in the block, if an account makes them."""
    access = get_access()
    if access is None:
        yield
        return
    made: list[Change] = []
    token = _changes.set(made)
    try:
        yield
    finally:
        _changes.reset(token)
    if not made:
        return
    with using_access(None):
        if connection.dialect.name == "postgresql":  # SQLite has one writer
            connection.execute(sa.select(sa.func.pg_advisory_xact_lock(_LOCK)))
        newest = sa.select(audit_events.c.number, audit_events.c.hash)
        last = connection.execute(newest.order_by(audit_events.c.number.desc()).limit(1)).first()
        sealed = seal(
            AuditEvent(
                number=1 if last is None else last.number + 1,
                author=access.author,
                address=access.address,
                request_id=access.request_id,
                operation=access.operation,
                aircraft_id=access.campaign,
                changes=tuple(made),
                previous_hash="" if last is None else last.hash,
                created_at=datetime.now(UTC),
            )
        )
        row = {name: value for name, value in asdict(sealed).items() if name != "id"}
        connection.execute(sa.insert(audit_events).values(row))


def add_recording(engine: Engine) -> None:
    """Note every change of an engine within ``recording_changes``."""

    @event.listens_for(engine, "before_execute")
    def _note_previous(
        connection: Connection, statement: Any, _many: object, _given: object, _options: object
    ) -> None:
        if not _is_recorded(statement) or isinstance(statement, sa.Insert):
            return
        table = statement.table
        query = sa.select(table).where(*statement._where_criteria).order_by(*table.primary_key)
        with using_access(None):
            rows = [dict(row) for row in connection.execute(query).mappings()]
        after = None if isinstance(statement, sa.Delete) else hash_value(_read_values(statement))
        _note(
            Change(
                table=table.name,
                action="delete" if isinstance(statement, sa.Delete) else "update",
                count=len(rows),
                ids=tuple(row["id"] for row in rows[:_MOST_IDS] if "id" in row),
                before=hash_value(_make_plain(rows)),
                after=after,
            )
        )

    @event.listens_for(engine, "after_execute")
    def _note_insert(
        _connection: Connection,
        statement: Any,
        many: Sequence[Mapping[str, Any]],
        given: Mapping[str, Any],
        _options: object,
        result: CursorResult[Any],
    ) -> None:
        if not _is_recorded(statement) or not isinstance(statement, sa.Insert):
            return
        table: Any = statement.table
        rows = list(many) or [{**_read_values(statement), **given}]
        is_single = not result.context.executemany and result.inserted_primary_key is not None
        key = result.inserted_primary_key if is_single else None
        _note(
            Change(
                table=table.name,
                action="insert",
                count=len(rows),
                ids=() if key is None or not isinstance(key[0], int) else (key[0],),
                after=hash_value(_make_plain(rows)),
            )
        )


def _is_recorded(statement: Any) -> bool:
    if _changes.get() is None or not isinstance(statement, sa.Insert | sa.Update | sa.Delete):
        return False
    table: Any = statement.table
    return table.name not in _OMITTED


def _note(change: Change) -> None:
    made = _changes.get()
    if made is not None and change.count:
        made.append(change)


def _read_values(statement: Any) -> dict[str, Any]:
    values = statement._values or {}
    return {
        getattr(column, "key", column): _make_plain(getattr(value, "value", value))
        for column, value in values.items()
    }


def _make_plain(value: Any) -> Any:
    """Return what JSON can hold; expressions of SQL by their text."""
    if isinstance(value, dict):
        return {str(key): _make_plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_make_plain(item) for item in value]
    if isinstance(value, bytes):
        return value.hex()
    if isinstance(value, sa.ClauseElement):
        return str(value)
    return value
