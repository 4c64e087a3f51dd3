"""Flight: one sortie of an aircraft."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import date


@dataclass(frozen=True, slots=True, kw_only=True)
class Flight:
    """One flight; its maneuvers point back to it."""

    aircraft_id: int
    number: int
    flown_on: date | None = None
    description: str = ""
    id: int | None = None
