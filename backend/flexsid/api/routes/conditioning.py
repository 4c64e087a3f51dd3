"""Quality of one maneuver, and the corrections that an analyst decides on."""

from __future__ import annotations

from fastapi import APIRouter, status

from flexsid.api.analyst import TheAnalyst
from flexsid.api.answers import ConditioningList
from flexsid.api.context import TheStore
from flexsid.api.requests import ConditioningRequest
from flexsid.api.wire import Identity, Json
from flexsid.records.conditioning import ConditioningStep
from flexsid.records.quality import ManeuverQuality
from flexsid.workflow.measurements import conditioning
from flexsid.workflow.quality import maneuver_quality

router = APIRouter(prefix="/maneuvers", tags=["quality"])


@router.get("/{maneuver_id}/quality", response_model=ManeuverQuality)
def get_quality(store: TheStore, maneuver_id: Identity) -> Json:
    """Return what was found about a maneuver; looked at now if it never was."""
    return Json(maneuver_quality.quality(store, maneuver_id))


@router.get("/{maneuver_id}/conditioning", response_model=ConditioningList)
def list_conditioning(store: TheStore, maneuver_id: Identity) -> Json:
    """List the corrections of a maneuver, those that were undone too."""
    store.maneuvers.get(maneuver_id)
    return Json(ConditioningList(items=store.conditioning.find(maneuver_id=maneuver_id)))


@router.post(
    "/{maneuver_id}/conditioning",
    response_model=ConditioningList,
    status_code=status.HTTP_201_CREATED,
)
def take_conditioning(
    store: TheStore, maneuver_id: Identity, wanted: ConditioningRequest, analyst: TheAnalyst
) -> Json:
    """Take corrections, all or none; what was recorded is not changed."""
    steps = conditioning.take_steps(store, maneuver_id, wanted.corrections(), analyst)
    return Json(ConditioningList(items=steps), status.HTTP_201_CREATED)


@router.delete("/{maneuver_id}/conditioning/{step_id}", response_model=ConditioningStep)
def undo_conditioning(
    store: TheStore, maneuver_id: Identity, step_id: Identity, analyst: TheAnalyst
) -> Json:
    """Undo a correction; that it was there stays in the record."""
    return Json(conditioning.undo_step(store, maneuver_id, step_id, analyst))
