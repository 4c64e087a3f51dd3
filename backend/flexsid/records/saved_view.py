"""SavedView: a named page state, visible to all users."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime


@dataclass(frozen=True, slots=True, kw_only=True)
class SavedView:
    """``search`` is the query string of the page."""

    page: str
    name: str
    search: str
    author: str = ""
    created_at: datetime | None = None
    id: int | None = None
