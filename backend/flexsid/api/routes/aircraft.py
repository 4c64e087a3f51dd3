"""Aircraft: geometry, mass, sensors, thrust table."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any

from fastapi import APIRouter
from pydantic import ConfigDict, Field

from flexsid.api.context import TheStore
from flexsid.api.requests import LONGEST_TEXT, Line, Name
from flexsid.api.responses import AircraftList
from flexsid.api.serialization import Identity, Json
from flexsid.records.aircraft import Aircraft
from flexsid.workflow.aircraft.thrust import parse_thrust_table, set_thrust_table

router = APIRouter(prefix="/aircraft", tags=["aircraft"])

_STRICT: Any = ConfigDict(extra="forbid")
_Name = Annotated[str, Field(min_length=1, max_length=100), Line]


@dataclass(frozen=True, slots=True, kw_only=True)
class ThrustRequest:
    """Thrust table of one engine as CSV text, and the channels of the rotation speeds.

    The first row has a label and total temperatures, every other row a rotation speed and the
    thrust at each temperature. Without temperatures the table has two columns.
    """

    engines: Annotated[list[_Name], Field(min_length=1, max_length=16)]
    text: Annotated[str, Field(max_length=LONGEST_TEXT)]
    speed_unit: Name = "rpm"
    temperature_unit: Name = "K"
    thrust_unit: Name = "N"
    source: Annotated[str, Field(max_length=500), Line] = ""

    __pydantic_config__ = _STRICT


@router.get("", response_model=AircraftList)
def list_aircraft(store: TheStore) -> Json:
    """List all aircraft."""
    return Json(AircraftList(items=store.aircraft.find()))


@router.get("/{aircraft_id}", response_model=Aircraft)
def get_aircraft(store: TheStore, aircraft_id: Identity) -> Json:
    """Return one aircraft."""
    return Json(store.aircraft.get(aircraft_id))


@router.put("/{aircraft_id}/thrust", response_model=Aircraft)
def set_thrust(store: TheStore, aircraft_id: Identity, body: ThrustRequest) -> Json:
    """Set the thrust table of an aircraft, from which the thrust of new maneuvers is computed."""
    table = parse_thrust_table(
        body.text,
        tuple(body.engines),
        (body.speed_unit, body.temperature_unit, body.thrust_unit),
        body.source,
    )
    return Json(set_thrust_table(store, aircraft_id, table))


@router.delete("/{aircraft_id}/thrust", response_model=Aircraft)
def remove_thrust(store: TheStore, aircraft_id: Identity) -> Json:
    """Delete the thrust table of an aircraft; the thrust of existing maneuvers is unchanged."""
    return Json(set_thrust_table(store, aircraft_id, None))
