"""Page: some items of a list, and the cursor of the next page."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Generic, TypeVar

from flexsid.errors import BadInput

T = TypeVar("T")


@dataclass(frozen=True, slots=True, kw_only=True)
class Page(Generic[T]):
    """Some items of a list; ``next`` is None at its end."""

    items: list[T]
    next: str | None


def read_cursor(after: str) -> int:
    """Return the position of a cursor, ``next`` of the previous page."""
    if not (after.isascii() and after.isdigit() and len(after) <= 18):
        raise BadInput(
            f"after={after!r} is not a cursor; use `next` of the previous page",
            code="bad-cursor",
        )
    return int(after)
