"""Data quality of maneuvers, compatibility of their sensors, and corrections of channels."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from typing import Annotated

from fastapi import Depends, status

from flexsid.api.authorization import TheAnalyst
from flexsid.api.context import TheContext, TheStore
from flexsid.api.models.requests import AssessRequest, ConditioningRequest
from flexsid.api.models.responses import Assessing, QualityList
from flexsid.api.router import make_router
from flexsid.api.serialization import (
    After,
    Identity,
    Json,
    JsonRoute,
    Limit,
    describe_sort,
    read_query,
)
from flexsid.jobs.kinds import QUALITY
from flexsid.records.job import NEW_JOB, Job
from flexsid.records.maneuver import ConditioningStep, Correction
from flexsid.records.quality import ManeuverQuality
from flexsid.records.run import RunState
from flexsid.storage.access import storing_in_campaign
from flexsid.storage.encoding import encode
from flexsid.storage.jobs import job_list, queue
from flexsid.storage.lists.campaign_rows import (
    SORT_FIELDS,
    QualityFilters,
    count_verdicts,
    list_unassessed,
    select_qualities,
)
from flexsid.storage.lists.list_query import Items
from flexsid.storage.store import Store
from flexsid.workflow.measurements import maneuver_spectra
from flexsid.workflow.quality import maneuver_quality
from flexsid.workflow.quality.maneuver_quality import QualityRequest

# --- Data quality of the maneuvers of a campaign: list and assessment -----------------------------

quality_router = make_router("/quality", tag="quality")

_KIND = QUALITY.name
_AT_ONCE = 100  # jobs in one transaction: others write between them


@quality_router.get("", response_model=QualityList)
def list_qualities(
    context: TheContext,
    filters: Annotated[QualityFilters, Depends(read_query(QualityFilters))],
    sort: Annotated[str, describe_sort(SORT_FIELDS)] = "verdict",
    limit: Limit = 100,
    after: After = None,
) -> Json:
    """List maneuvers with their stored verdict, by default the worst first."""
    with context.store.database.reading() as connection:
        page = select_qualities(connection, filters, sort, limit, after)
        counts = count_verdicts(connection, filters)
    assessing = _count_assessments(context.store)
    return Json(QualityList(items=page.items, counts=counts, assessing=assessing, next=page.next))


@quality_router.post("/assess", response_model=Assessing, status_code=status.HTTP_202_ACCEPTED)
def assess_maneuvers(context: TheContext, body: AssessRequest, analyst: TheAnalyst) -> Json:
    """Queue assessments of the data quality of the given maneuvers, or of all unassessed ones."""
    store = context.store
    maneuver_ids = body.maneuver_ids
    if maneuver_ids is None:
        with store.database.reading() as connection:
            maneuver_ids = list_unassessed(connection)
    maneuvers = {number: store.maneuvers.get(number) for number in maneuver_ids}
    # Analysts wait for the maneuvers that they name.
    priority = QUALITY.priority if body.maneuver_ids is None else 0
    now = datetime.now(UTC)
    requests = [
        (
            maneuver.aircraft_id,
            replace(
                NEW_JOB,
                kind=_KIND,
                title=maneuver.label,
                author=analyst,
                request=encode(QualityRequest(maneuver_id=number)),
                priority=priority,
                created_at=now,
            ),
        )
        for number, maneuver in maneuvers.items()
    ]
    for first in range(0, len(requests), _AT_ONCE):
        _add_jobs(store, requests[first : first + _AT_ONCE])
        context.dispatcher.wake()
    return Json(_count_assessments(store), status.HTTP_202_ACCEPTED)


@quality_router.delete("/assess", response_model=Assessing)
def stop_assessment(context: TheContext) -> Json:
    """Cancel all assessments; their maneuvers stay unassessed."""
    queue.cancel(
        context.store, [number for number, _ in job_list.find_active(context.store, _KIND)]
    )
    context.dispatcher.wake()
    return Json(_count_assessments(context.store))


def _add_jobs(store: Store, requests: Sequence[tuple[int, Job]]) -> None:
    """Queue assessments by campaign, but for maneuvers that one waits for already."""
    with store.database.transaction() as connection:
        store.database.lock_writers(connection)
        waiting = [request for _, request in job_list.find_active(store, _KIND)]
        for campaign, job in requests:
            if job.request not in waiting:
                with storing_in_campaign(campaign):
                    queue.add_job(store, job)


def _count_assessments(store: Store) -> Assessing:
    states = job_list.count_latest(store, _KIND)
    waiting = states[RunState.QUEUED] + states[RunState.RUNNING]
    total = sum(states.values()) - states[RunState.CANCELLED]
    return Assessing(
        running=waiting > 0,
        done=total - waiting,
        total=total,
        failed=states[RunState.FAILED],
    )


# --- Data quality of one maneuver, and corrections of its channels --------------------------------

conditioning_router = make_router("/maneuvers", tag="quality", route_class=JsonRoute)


@dataclass(frozen=True, slots=True)
class StoredQuality:
    """Data quality of a maneuver, null if its present data are not assessed; newest assessment."""

    quality: ManeuverQuality | None
    job: job_list.JobItem | None


@conditioning_router.get("/{maneuver_id}/quality")
def get_quality(store: TheStore, maneuver_id: Identity) -> StoredQuality:
    """Return the stored data quality of a maneuver; ``/quality/assess`` computes it."""
    return StoredQuality(
        maneuver_quality.find_maneuver_quality(store, maneuver_id),
        job_list.find_newest(store, QUALITY.name, maneuver_id=maneuver_id),
    )


@conditioning_router.get("/{maneuver_id}/conditioning")
def list_conditioning(store: TheStore, maneuver_id: Identity) -> Items[ConditioningStep]:
    """List the corrections of a maneuver, including undone ones."""
    store.maneuvers.get(maneuver_id)
    return Items(items=store.conditioning.find(maneuver_id=maneuver_id))


@conditioning_router.post("/{maneuver_id}/conditioning", status_code=201)
def add_conditioning(
    store: TheStore, maneuver_id: Identity, body: ConditioningRequest, analyst: TheAnalyst
) -> Items[ConditioningStep]:
    """Apply corrections, all or none; the recorded data are not changed."""
    corrections = [item.make_record(Correction) for item in body.items]
    steps = maneuver_spectra.add_conditioning_steps(store, maneuver_id, corrections, analyst)
    return Items(items=steps)


@conditioning_router.delete("/{maneuver_id}/conditioning/{step_id}")
def undo_conditioning(
    store: TheStore, maneuver_id: Identity, step_id: Identity, analyst: TheAnalyst
) -> ConditioningStep:
    """Undo a correction; it remains in the list."""
    return maneuver_spectra.undo_step(store, maneuver_id, step_id, analyst)
