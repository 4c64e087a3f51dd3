"""RunTemplate: settings of runs under a name in a campaign."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime

from flexsid.records.run import Method, RunSettings


@dataclass(frozen=True, slots=True, kw_only=True)
class RunTemplate:
    """One revision of a template; revisions are only added.

    ``settings`` have no values of a maneuver or of its condition: no additional maneuvers, no run
    to start from, no priors by value. Model structure, modal tables and prediction are not part
    of it: each run takes those of its maneuver. ``original_id`` is the id of the first revision,
    None for that itself; the last revision of a deleted template has ``is_deleted``.
    """

    aircraft_id: int
    name: str
    method: Method
    settings: RunSettings
    note: str = ""
    author: str = ""
    revision: int = 1
    original_id: int | None = None
    is_deleted: bool = False
    created_at: datetime | None = None
    id: int | None = None
