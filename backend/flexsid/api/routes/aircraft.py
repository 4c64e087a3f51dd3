"""Aircraft: geometry, mass, sensors."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any

from fastapi import APIRouter
from pydantic import ConfigDict, Field

from flexsid.api.answers import AircraftList
from flexsid.api.context import TheStore
from flexsid.api.requests import LONGEST_TEXT, Line, Name
from flexsid.api.wire import Identity, Json
from flexsid.records.aircraft import Aircraft
from flexsid.workflow.aircraft.thrust import keep_thrust, parse_table

router = APIRouter(prefix="/aircraft", tags=["aircraft"])

_STRICT: Any = ConfigDict(extra="forbid")
_Name = Annotated[str, Field(min_length=1, max_length=100), Line]


@dataclass(frozen=True, slots=True, kw_only=True)
class ThrustRequest:
    """Thrust of one engine as a table of text, and the channels of the rotation speeds.

    The first row has a label and total temperatures; every other row has a rotation speed,
    then thrust. Without temperatures, two columns are enough.
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
def set_thrust(store: TheStore, aircraft_id: Identity, wanted: ThrustRequest) -> Json:
    """Give an aircraft the thrust table that new maneuvers take their thrust from."""
    table = parse_table(
        wanted.text,
        tuple(wanted.engines),
        (wanted.speed_unit, wanted.temperature_unit, wanted.thrust_unit),
        wanted.source,
    )
    return Json(keep_thrust(store, aircraft_id, table))


@router.delete("/{aircraft_id}/thrust", response_model=Aircraft)
def remove_thrust(store: TheStore, aircraft_id: Identity) -> Json:
    """Take the thrust table of an aircraft away; maneuvers keep the thrust that they have."""
    return Json(keep_thrust(store, aircraft_id, None))
