"""Data quality of one maneuver, and corrections of its channels."""

from __future__ import annotations

from dataclasses import dataclass

from flexsid.api.analyst import TheAnalyst
from flexsid.api.context import TheStore
from flexsid.api.models.requests import ConditioningRequest
from flexsid.api.router import make_router
from flexsid.api.serialization import Identity, JsonRoute
from flexsid.jobs.kinds import QUALITY
from flexsid.records.maneuver import ConditioningStep, Correction
from flexsid.records.quality import ManeuverQuality
from flexsid.storage import job_list
from flexsid.storage.paging import Items
from flexsid.workflow.measurements import conditioning
from flexsid.workflow.quality import maneuver_quality

router = make_router("/maneuvers", tag="quality", route_class=JsonRoute)


@dataclass(frozen=True, slots=True)
class StoredQuality:
    """Data quality of a maneuver, null if its present data are not assessed; newest assessment."""

    quality: ManeuverQuality | None
    job: job_list.JobItem | None


@router.get("/{maneuver_id}/quality")
def get_quality(store: TheStore, maneuver_id: Identity) -> StoredQuality:
    """Return the stored data quality of a maneuver; ``/quality/assess`` computes it."""
    return StoredQuality(
        maneuver_quality.find_maneuver_quality(store, maneuver_id),
        job_list.find_newest(store, QUALITY.name, maneuver_id=maneuver_id),
    )


@router.get("/{maneuver_id}/conditioning")
def list_conditioning(store: TheStore, maneuver_id: Identity) -> Items[ConditioningStep]:
    """List the corrections of a maneuver, including undone ones."""
    store.maneuvers.get(maneuver_id)
    return Items(items=store.conditioning.find(maneuver_id=maneuver_id))


@router.post("/{maneuver_id}/conditioning", status_code=201)
def add_conditioning(
    store: TheStore, maneuver_id: Identity, body: ConditioningRequest, analyst: TheAnalyst
) -> Items[ConditioningStep]:
    """Apply corrections, all or none; the recorded data are not changed."""
    corrections = [item.make_record(Correction) for item in body.items]
    steps = conditioning.add_conditioning_steps(store, maneuver_id, corrections, analyst)
    return Items(items=steps)


@router.delete("/{maneuver_id}/conditioning/{step_id}")
def undo_conditioning(
    store: TheStore, maneuver_id: Identity, step_id: Identity, analyst: TheAnalyst
) -> ConditioningStep:
    """Undo a correction; it remains in the list."""
    return conditioning.undo_step(store, maneuver_id, step_id, analyst)
