"""Data quality of one maneuver, and corrections of its channels."""

from __future__ import annotations

from fastapi import APIRouter, status

from flexsid.api.analyst import TheAnalyst
from flexsid.api.context import TheStore
from flexsid.api.requests import ConditioningRequest
from flexsid.api.responses import ConditioningList
from flexsid.api.serialization import Identity, Json
from flexsid.records.conditioning import ConditioningStep
from flexsid.records.quality import ManeuverQuality
from flexsid.workflow.measurements import conditioning
from flexsid.workflow.quality import maneuver_quality

router = APIRouter(prefix="/maneuvers", tags=["quality"])


@router.get("/{maneuver_id}/quality", response_model=ManeuverQuality)
def get_quality(store: TheStore, maneuver_id: Identity) -> Json:
    """Return the data quality of a maneuver; it is assessed now if it was not before."""
    return Json(maneuver_quality.get_maneuver_quality(store, maneuver_id))


@router.get("/{maneuver_id}/conditioning", response_model=ConditioningList)
def list_conditioning(store: TheStore, maneuver_id: Identity) -> Json:
    """List the corrections of a maneuver, including undone ones."""
    store.maneuvers.get(maneuver_id)
    return Json(ConditioningList(items=store.conditioning.find(maneuver_id=maneuver_id)))


@router.post(
    "/{maneuver_id}/conditioning",
    response_model=ConditioningList,
    status_code=status.HTTP_201_CREATED,
)
def add_conditioning(
    store: TheStore, maneuver_id: Identity, body: ConditioningRequest, analyst: TheAnalyst
) -> Json:
    """Apply corrections, all or none; the recorded data are not changed."""
    steps = conditioning.add_conditioning_steps(store, maneuver_id, body.to_corrections(), analyst)
    return Json(ConditioningList(items=steps), status.HTTP_201_CREATED)


@router.delete("/{maneuver_id}/conditioning/{step_id}", response_model=ConditioningStep)
def undo_conditioning(
    store: TheStore, maneuver_id: Identity, step_id: Identity, analyst: TheAnalyst
) -> Json:
    """Undo a correction; it remains in the list."""
    return Json(conditioning.undo_step(store, maneuver_id, step_id, analyst))
