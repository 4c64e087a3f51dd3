"""SavedView: a named page state, visible to all users."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime
from typing import Annotated

from flexsid.allowed import Allowed, Author, Name, Text


@dataclass(frozen=True, slots=True, kw_only=True)
class SavedView:
    """``search`` is the query string of the page."""

    page: Annotated[str, Allowed(choices=("campaign", "runs", "compare", "flutter"))]
    name: Name
    search: Text
    author: Author = ""
    created_at: datetime | None = None
    id: int | None = None
