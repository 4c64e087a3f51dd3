"""Ground tests: mini-GVT records before and after each flight."""

from __future__ import annotations

from flexsid.api.context import TheStore
from flexsid.api.router import make_router
from flexsid.api.serialization import Identity, JsonRoute, Reference
from flexsid.records.quality import GroundTest
from flexsid.storage.paging import Items
from flexsid.workflow.quality import ground_records

router = make_router("/ground-tests", tag="flights", route_class=JsonRoute)


@router.get("")
def list_ground_tests(store: TheStore, aircraft_id: Reference = None) -> Items[GroundTest]:
    """Compare the mini-GVT records before and after every flight that has both."""
    return Items(items=ground_records.compare_all_ground_records(store, aircraft_id))


@router.get("/{flight_id}")
def get_ground_test(store: TheStore, flight_id: Identity) -> GroundTest:
    """Compare the mini-GVT records before and after one flight."""
    return ground_records.compare_ground_records(store, flight_id)
