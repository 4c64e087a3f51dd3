"""What goes over the wire: JSON of records as they are, and the numbers of a request."""

from __future__ import annotations

from typing import Annotated, Any

import orjson
from fastapi import Path, Query, Response

from flexsid.errors import BadInput
from flexsid.storage.repository import LARGEST_ID

MOST_ITEMS = 1000
"""Largest page of a list."""


class Json(Response):
    """Records, lists and figures as JSON; what is not a number is null.

    The records are written as they stand: passing a list of a thousand through
    response models takes five times as long. ``tests/api`` checks them against
    the models that the interface promises.
    """

    media_type = "application/json"

    def render(self, content: Any) -> bytes:
        """Write the content."""
        return dump(content)


def dump(content: Any) -> bytes:
    """Write records, arrays and plain values as JSON."""
    options = orjson.OPT_SERIALIZE_NUMPY | orjson.OPT_NON_STR_KEYS | orjson.OPT_UTC_Z
    return orjson.dumps(content, option=options)


Identity = Annotated[int, Path(ge=1, le=LARGEST_ID, description="Id of the record.")]
Reference = Annotated[int | None, Query(ge=1, le=LARGEST_ID)]
Limit = Annotated[int, Query(ge=1, le=MOST_ITEMS, description="Most items to answer.")]
After = Annotated[str | None, Query(description="`next` of the page before.")]


def split_names(text: str | None) -> tuple[str, ...] | None:
    """Read names separated by commas; None and nothing stand for no choice."""
    if text is None:
        return None
    return tuple(name for name in (part.strip() for part in text.split(",")) if name) or None


def split_ids(text: str | None, field: str) -> tuple[int, ...]:
    """Read ids separated by commas."""
    ids: list[int] = []
    for part in split_names(text) or ():
        if not (part.isascii() and part.isdigit() and 1 <= int(part[:20]) <= LARGEST_ID):
            raise BadInput(f"{field}: {part!r} is not an id; give numbers separated by commas")
        ids.append(int(part))
    return tuple(ids)
