"""Flights of an aircraft, and maneuvers cut from their recordings."""

from __future__ import annotations

from fastapi import APIRouter, status

from flexsid.api.context import TheStore
from flexsid.api.requests import CutRequest
from flexsid.api.responses import FlightChannelList, FlightList, FoundManeuverList, ManeuverDetail
from flexsid.api.routes.maneuvers import build_maneuver_detail
from flexsid.api.serialization import Identity, Json, Reference
from flexsid.records.flight import Flight
from flexsid.workflow.importing import maneuver_cutting

router = APIRouter(prefix="/flights", tags=["flights"])


@router.get("", response_model=FlightList)
def list_flights(store: TheStore, aircraft_id: Reference = None) -> Json:
    """List flights, of one aircraft or of all."""
    filters = {} if aircraft_id is None else {"aircraft_id": aircraft_id}
    return Json(FlightList(items=store.flights.find(**filters)))


@router.get("/{flight_id}", response_model=Flight)
def get_flight(store: TheStore, flight_id: Identity) -> Json:
    """Return one flight."""
    return Json(store.flights.get(flight_id))


@router.get("/{flight_id}/channels", response_model=FlightChannelList)
def list_flight_channels(store: TheStore, flight_id: Identity) -> Json:
    """List the channels of the recording of a flight."""
    store.flights.get(flight_id)
    return Json(FlightChannelList(items=store.flight_channels.find(flight_id=flight_id)))


@router.get("/{flight_id}/found-maneuvers", response_model=FoundManeuverList)
def find_maneuvers(store: TheStore, flight_id: Identity) -> Json:
    """Detect maneuvers in the recording of a flight; nothing is stored."""
    return Json(FoundManeuverList(items=list(maneuver_cutting.find_maneuvers(store, flight_id))))


@router.post(
    "/{flight_id}/maneuvers", response_model=ManeuverDetail, status_code=status.HTTP_201_CREATED
)
def cut_maneuver(store: TheStore, flight_id: Identity, body: CutRequest) -> Json:
    """Cut a maneuver from a window of the recording, which is not changed."""
    stored = maneuver_cutting.cut_maneuver(store, flight_id, body.to_record())
    location = {"Location": f"/api/v1/maneuvers/{stored.id}"}
    return Json(build_maneuver_detail(store, stored), status.HTTP_201_CREATED, location)
