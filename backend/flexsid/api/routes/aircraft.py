"""Aircraft: geometry, mass, sensors."""

from __future__ import annotations

from fastapi import APIRouter

from flexsid.api.answers import AircraftList
from flexsid.api.context import TheStore
from flexsid.api.wire import Identity, Json
from flexsid.records.aircraft import Aircraft

router = APIRouter(prefix="/aircraft", tags=["aircraft"])


@router.get("", response_model=AircraftList)
def list_aircraft(store: TheStore) -> Json:
    """List all aircraft."""
    return Json(AircraftList(items=store.aircraft.find()))


@router.get("/{aircraft_id}", response_model=Aircraft)
def get_aircraft(store: TheStore, aircraft_id: Identity) -> Json:
    """Return one aircraft."""
    return Json(store.aircraft.get(aircraft_id))
