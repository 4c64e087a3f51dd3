"""Lists: all items, or a page of them with the cursor of the next page."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Generic, TypeVar

from flexsid.errors import BadInput

T = TypeVar("T")


@dataclass(frozen=True, slots=True, kw_only=True)
class Items(Generic[T]):
    """All items of a list."""

    items: list[T]


@dataclass(frozen=True, slots=True, kw_only=True)
class Page(Items[T]):
    """Some items of a list; ``next`` is None at its end."""

    next: str | None = None


def read_cursor(after: str) -> int:
    """Return the position of a cursor, ``next`` of the previous page."""
    if not (after.isascii() and after.isdigit() and len(after) <= 18):
        raise BadInput(
            f"after={after!r} is not a cursor; use `next` of the previous page",
            code="bad-cursor",
        )
    return int(after)
