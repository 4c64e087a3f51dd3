"""StoredMapping: meaning of recorded columns, saved for files of the same recorder."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime


@dataclass(frozen=True, slots=True, kw_only=True)
class StoredMapping:
    """A mapping under a name; ``text`` is the TOML as it was written."""

    name: str
    text: str
    note: str = ""
    created_at: datetime | None = None
    id: int | None = None
