"""Ground tests: what the mini-GVT around each flight says of the structure."""

from __future__ import annotations

from fastapi import APIRouter

from flexsid.api.answers import GroundTestList
from flexsid.api.context import TheStore
from flexsid.api.wire import Identity, Json, Reference
from flexsid.records.ground_test import GroundTest
from flexsid.workflow.quality import ground_records

router = APIRouter(prefix="/ground-tests", tags=["flights"])


@router.get("", response_model=GroundTestList)
def list_ground_tests(store: TheStore, aircraft_id: Reference = None) -> Json:
    """Compare the records before and after every flight that has both."""
    return Json(GroundTestList(items=ground_records.ground_tests(store, aircraft_id)))


@router.get("/{flight_id}", response_model=GroundTest)
def get_ground_test(store: TheStore, flight_id: Identity) -> Json:
    """Compare the records before and after one flight."""
    return Json(ground_records.ground_test(store, flight_id))
