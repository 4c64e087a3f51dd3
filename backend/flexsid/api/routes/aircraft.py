"""Aircraft: geometry, mass, sensors, thrust table."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from flexsid.api.context import TheStore
from flexsid.api.models.requests import LONGEST_TEXT, Line, MappingText, Name, Request
from flexsid.api.router import make_router
from flexsid.api.serialization import Identity, Json, JsonRoute
from flexsid.records.aircraft import Aircraft
from flexsid.records.dashboard import CampaignDashboard
from flexsid.storage.paging import Page
from flexsid.workflow.aircraft import aircraft_definition
from flexsid.workflow.aircraft.thrust import parse_thrust_table, set_thrust_table
from flexsid.workflow.views.dashboard import read_dashboard

router = make_router("/aircraft", tag="aircraft", route_class=JsonRoute)

_Name = Annotated[str, Field(min_length=1, max_length=100), Line]


class ThrustRequest(Request):
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


class AircraftRequest(Request):
    """Definition of an aircraft as TOML text: the ``[aircraft]`` part of a mapping."""

    text: MappingText


@router.get("")
def list_aircraft(store: TheStore) -> Page[Aircraft]:
    """List all aircraft."""
    return Page(items=store.aircraft.find())


@router.post("", response_model=Aircraft, status_code=201)
def add_aircraft(store: TheStore, body: AircraftRequest) -> Json:
    """Add an aircraft before its first flight; modal data and predictions can then be imported."""
    added = aircraft_definition.add_aircraft(store, body.text)
    return Json(added, 201, {"Location": f"/api/v1/aircraft/{added.id}"})


@router.get("/{aircraft_id}")
def get_aircraft(store: TheStore, aircraft_id: Identity) -> Aircraft:
    """Return one aircraft."""
    return store.aircraft.get(aircraft_id)


@router.get("/{aircraft_id}/dashboard")
def get_dashboard(store: TheStore, aircraft_id: Identity) -> CampaignDashboard:
    """Return coverage of the envelope, identified derivatives and open warnings of a campaign."""
    return read_dashboard(store, aircraft_id)


@router.put("/{aircraft_id}")
def replace_aircraft(store: TheStore, aircraft_id: Identity, body: AircraftRequest) -> Aircraft:
    """Correct the definition of an aircraft; surfaces and sensors of recordings must remain."""
    return aircraft_definition.replace_aircraft(store, aircraft_id, body.text)


@router.put("/{aircraft_id}/thrust")
def set_thrust(store: TheStore, aircraft_id: Identity, body: ThrustRequest) -> Aircraft:
    """Set the thrust table of an aircraft, from which the thrust of new maneuvers is computed."""
    table = parse_thrust_table(
        body.text,
        tuple(body.engines),
        (body.speed_unit, body.temperature_unit, body.thrust_unit),
        body.source,
    )
    return set_thrust_table(store, aircraft_id, table)


@router.delete("/{aircraft_id}/thrust")
def remove_thrust(store: TheStore, aircraft_id: Identity) -> Aircraft:
    """Delete the thrust table of an aircraft; the thrust of existing maneuvers is unchanged."""
    return set_thrust_table(store, aircraft_id, None)
