"""Data quality of the maneuvers of a campaign: list and assessment."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import UTC, datetime
from typing import Annotated

from fastapi import Depends, status

from flexsid.api.analyst import TheAnalyst
from flexsid.api.context import TheContext
from flexsid.api.models.requests import AssessRequest
from flexsid.api.models.responses import Assessing, QualityList
from flexsid.api.router import make_router
from flexsid.api.serialization import After, Json, Limit, describe_sort, read_query
from flexsid.jobs.kinds import QUALITY
from flexsid.records.job import Job
from flexsid.records.run import RunState
from flexsid.storage import job_list, queue
from flexsid.storage.access import storing_in_campaign
from flexsid.storage.encoding import encode
from flexsid.storage.quality_list import (
    SORT_FIELDS,
    QualityFilters,
    count_verdicts,
    list_unassessed,
    select_qualities,
)
from flexsid.storage.store import Store
from flexsid.workflow.quality.maneuver_quality import QualityRequest

router = make_router("/quality", tag="quality")

_KIND = QUALITY.name
_AT_ONCE = 100  # jobs in one transaction: others write between them


@router.get("", response_model=QualityList)
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


@router.post("/assess", response_model=Assessing, status_code=status.HTTP_202_ACCEPTED)
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
            Job(
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


@router.delete("/assess", response_model=Assessing)
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
