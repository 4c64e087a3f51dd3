"""Page: some items of a list, and where to go on."""

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
    """Read ``next`` of the page before."""
    if not (after.isascii() and after.isdigit() and len(after) <= 18):
        raise BadInput(
            f"after={after!r} is not a place in the list; give `next` of the page before",
            code="bad-cursor",
        )
    return int(after)
