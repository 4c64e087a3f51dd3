"""Flights of an aircraft, and maneuvers cut from their recordings."""

from __future__ import annotations

from flexsid.api.context import TheStore
from flexsid.api.models.requests import CutRequest
from flexsid.api.models.responses import ManeuverDetail
from flexsid.api.router import make_router
from flexsid.api.routes.maneuvers import build_maneuver_detail
from flexsid.api.serialization import Identity, Json, JsonRoute, Reference, drop_none
from flexsid.records.maneuver import Cut, Flight, FlightChannel, ManeuverProposal
from flexsid.storage.paging import Items, Page
from flexsid.workflow.importing import maneuver_cutting

router = make_router("/flights", tag="flights", route_class=JsonRoute)


@router.get("")
def list_flights(store: TheStore, aircraft_id: Reference = None) -> Page[Flight]:
    """List flights, of one aircraft or of all."""
    return Page(items=store.flights.find(**drop_none(aircraft_id=aircraft_id)))


@router.get("/{flight_id}")
def get_flight(store: TheStore, flight_id: Identity) -> Flight:
    """Return one flight."""
    return store.flights.get(flight_id)


@router.get("/{flight_id}/channels")
def list_flight_channels(store: TheStore, flight_id: Identity) -> Items[FlightChannel]:
    """List the channels of the recording of a flight."""
    store.flights.get(flight_id)
    return Items(items=store.flight_channels.find(flight_id=flight_id))


@router.get("/{flight_id}/maneuver-proposals")
def find_maneuvers(store: TheStore, flight_id: Identity) -> Items[ManeuverProposal]:
    """Detect maneuvers in the recording of a flight; nothing is stored."""
    return Items(items=list(maneuver_cutting.find_maneuvers(store, flight_id)))


@router.post("/{flight_id}/maneuvers", response_model=ManeuverDetail, status_code=201)
def cut_maneuver(store: TheStore, flight_id: Identity, body: CutRequest) -> Json:
    """Cut a maneuver from a window of the recording, which is not changed."""
    stored = maneuver_cutting.cut_maneuver(store, flight_id, body.make_record(Cut))
    location = {"Location": f"/api/v1/maneuvers/{stored.id}"}
    return Json(build_maneuver_detail(store, stored), 201, location)
