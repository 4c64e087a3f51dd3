"""Flight conditions, and the sheet of evidence of each."""

from __future__ import annotations

from flexsid.api.context import TheStore
from flexsid.api.router import make_router
from flexsid.api.serialization import Identity, JsonRoute, Reference
from flexsid.jobs.stored_results import read_condition_sheet
from flexsid.records.condition_sheet import ConditionItem, ConditionSheet
from flexsid.storage.paging import Items
from flexsid.workflow.review import condition_sheet

router = make_router("/conditions", tag="conditions", route_class=JsonRoute)


@router.get("")
def list_conditions(store: TheStore, aircraft_id: Reference = None) -> Items[ConditionItem]:
    """List flight conditions: maneuvers of one aircraft and axis at one airspeed and fuel."""
    return Items(items=condition_sheet.list_conditions(store, aircraft_id))


@router.get("/{condition_id}/sheet")
def get_condition_sheet(store: TheStore, condition_id: Identity) -> ConditionSheet:
    """Return the evidence for the model of a condition, from stored results.

    The id of any maneuver of a condition names it; nothing is computed but comparisons.
    """
    return read_condition_sheet(store, condition_id)
