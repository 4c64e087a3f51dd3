"""Chain of events: each is sealed with the hash of the one before, so that changes are noticed."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable
from dataclasses import replace
from typing import Any, Protocol, TypeVar

import orjson

from flexsid.records.sealed_names import with_sealed_names


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
    for number, event in enumerate(events, start=1):
        linked = (event.number, event.previous_hash) == (number, previous)
        if not linked or event.hash != _sha256(event.sealed):
            return False
        # A later release may have records with more fields than were sealed.
        if not _matches(_get_content(event), json.loads(event.sealed)):
            return False
        previous = event.hash
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
