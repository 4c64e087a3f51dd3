"""Ground tests: mini-GVT records before and after each flight."""

from __future__ import annotations

from fastapi import APIRouter

from flexsid.api.context import TheStore
from flexsid.api.responses import GroundTestList
from flexsid.api.serialization import Identity, Json, Reference
from flexsid.records.ground_test import GroundTest
from flexsid.workflow.quality import ground_records

router = APIRouter(prefix="/ground-tests", tags=["flights"])


@router.get("", response_model=GroundTestList)
def list_ground_tests(store: TheStore, aircraft_id: Reference = None) -> Json:
    """Compare the mini-GVT records before and after every flight that has both."""
    return Json(GroundTestList(items=ground_records.compare_all_ground_records(store, aircraft_id)))


@router.get("/{flight_id}", response_model=GroundTest)
def get_ground_test(store: TheStore, flight_id: Identity) -> Json:
    """Compare the mini-GVT records before and after one flight."""
    return Json(ground_records.compare_ground_records(store, flight_id))
