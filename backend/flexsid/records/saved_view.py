"""SavedView: what a page shows, under a name that everybody who uses the workbench sees."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime


@dataclass(frozen=True, slots=True, kw_only=True)
class SavedView:
    """``search`` is the part of the page's address that says what is shown."""

    page: str
    name: str
    search: str
    author: str = ""
    created_at: datetime | None = None
    id: int | None = None
