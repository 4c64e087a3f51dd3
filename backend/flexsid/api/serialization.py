"""JSON serialization of records, and parsing of ids and names in queries."""

from __future__ import annotations

from typing import Annotated, Any

import orjson
from fastapi import Path, Query, Response

from flexsid.errors import BadInput
from flexsid.storage.repository import LARGEST_ID

MAX_ITEMS = 1000
"""Largest page of a list."""


class Json(Response):
    """Records, lists and figures as JSON; NaN is written as null.

    The records are serialized directly: validating a list of a thousand against response
    models takes five times as long. ``tests/api`` checks the responses against the declared
    models.
    """

    media_type = "application/json"

    def render(self, content: Any) -> bytes:
        """Serialize the content."""
        return dump_json(content)


def dump_json(content: Any) -> bytes:
    """Serialize records, arrays and plain values as JSON."""
    options = orjson.OPT_SERIALIZE_NUMPY | orjson.OPT_NON_STR_KEYS | orjson.OPT_UTC_Z
    return orjson.dumps(content, option=options)


Identity = Annotated[int, Path(ge=1, le=LARGEST_ID, description="Id of the record.")]
Reference = Annotated[int | None, Query(ge=1, le=LARGEST_ID)]
Limit = Annotated[int, Query(ge=1, le=MAX_ITEMS, description="Maximum number of items.")]
After = Annotated[str | None, Query(description="`next` of the previous page.")]


def split_names(text: str | None) -> tuple[str, ...] | None:
    """Parse names separated by commas; None if none are given."""
    if text is None:
        return None
    return tuple(name for name in (part.strip() for part in text.split(",")) if name) or None


def split_ids(text: str | None, field: str) -> tuple[int, ...]:
    """Parse ids separated by commas."""
    ids: list[int] = []
    for part in split_names(text) or ():
        if not (part.isascii() and part.isdigit() and 1 <= int(part[:20]) <= LARGEST_ID):
            raise BadInput(f"{field}: {part!r} is not an id; give numbers separated by commas")
        ids.append(int(part))
    return tuple(ids)
