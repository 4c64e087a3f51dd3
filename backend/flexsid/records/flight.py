"""Flight: one sortie of an aircraft."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import date

from flexsid.records.maneuver import Role


@dataclass(frozen=True, slots=True, kw_only=True)
class Flight:
    """One flight; its maneuvers point back to it."""

    aircraft_id: int
    number: int
    flown_on: date | None = None
    description: str = ""
    id: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class FlightChannel:
    """One channel of a whole recording, from which maneuvers are cut.

    Native rate, unit and precision; the field and file that it came from.
    """

    flight_id: int
    name: str
    unit: str
    role: Role
    rate_hz: float
    start_s: float
    n_samples: int
    array: str
    sensor: str | None = None
    source_file: str | None = None
    source_hash: str | None = None
    source_field: str | None = None
    id: int | None = None
