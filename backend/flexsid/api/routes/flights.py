"""Flights of an aircraft."""

from __future__ import annotations

from fastapi import APIRouter

from flexsid.api.answers import FlightChannelList, FlightList
from flexsid.api.context import TheStore
from flexsid.api.wire import Identity, Json, Reference
from flexsid.records.flight import Flight

router = APIRouter(prefix="/flights", tags=["flights"])


@router.get("", response_model=FlightList)
def list_flights(store: TheStore, aircraft_id: Reference = None) -> Json:
    """List flights, of one aircraft or of all."""
    chosen = {} if aircraft_id is None else {"aircraft_id": aircraft_id}
    return Json(FlightList(items=store.flights.find(**chosen)))


@router.get("/{flight_id}", response_model=Flight)
def get_flight(store: TheStore, flight_id: Identity) -> Json:
    """Return one flight."""
    return Json(store.flights.get(flight_id))


@router.get("/{flight_id}/channels", response_model=FlightChannelList)
def list_flight_channels(store: TheStore, flight_id: Identity) -> Json:
    """List the channels of a whole flight, from which maneuvers are cut."""
    store.flights.get(flight_id)
    return Json(FlightChannelList(items=store.flight_channels.find(flight_id=flight_id)))
