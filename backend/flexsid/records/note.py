"""Notes of analysts on maneuvers, runs, modes and derivatives, and saved views."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime
from enum import StrEnum
from typing import Annotated

from flexsid.allowed import Allowed, Author, Name, Text

# --- Notes of analysts on maneuvers, runs, modes and derivatives ----------------------------------


class NoteSubject(StrEnum):
    """What a note is about."""

    MANEUVER = "maneuver"
    RUN = "run"
    MODE = "mode"
    DERIVATIVE = "derivative"


@dataclass(frozen=True, slots=True, kw_only=True)
class NoteRevision:
    """One revision of a note; revisions are only added.

    ``key`` is the id of the maneuver or run, the number of the mode or the name of the derivative,
    and ``text`` Markdown. ``original_id`` is the id of the first revision, None for that itself;
    the last revision of a deleted note has ``is_deleted`` and no text.
    """

    aircraft_id: int
    subject: NoteSubject
    key: str
    text: str
    author: str
    author_verified: bool = False
    revision: int = 1
    original_id: int | None = None
    is_deleted: bool = False
    created_at: datetime | None = None
    id: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Note:
    """A note in its newest revision, with all of them, oldest first.

    ``html`` is the text rendered without HTML of its own and without images.
    """

    id: int
    aircraft_id: int
    subject: NoteSubject
    key: str
    text: str
    html: str
    author: str
    author_verified: bool
    revision: int
    is_deleted: bool
    created_at: datetime | None
    changed_at: datetime | None
    revisions: tuple[NoteRevision, ...]


# --- SavedView: a named page state, visible to all users ------------------------------------------


@dataclass(frozen=True, slots=True, kw_only=True)
class SavedView:
    """``search`` is the query string of the page."""

    page: Annotated[str, Allowed(choices=("campaign", "runs", "compare", "flutter"))]
    name: Name
    search: Text
    author: Author = ""
    created_at: datetime | None = None
    id: int | None = None
