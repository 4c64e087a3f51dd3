"""Data quality of the maneuvers of a campaign: list and assessment."""

from __future__ import annotations

from typing import Annotated, Literal

from fastapi import APIRouter, Query, status

from flexsid.api.context import TheContext, TheStore
from flexsid.api.requests import AssessRequest
from flexsid.api.responses import QualityList
from flexsid.api.serialization import After, Json, Limit
from flexsid.storage.quality_list import (
    SORT_FIELDS,
    QualityFilters,
    count_verdicts,
    select_qualities,
)
from flexsid.storage.repository import LARGEST_ID
from flexsid.workflow.quality.campaign_quality import Assessing

router = APIRouter(prefix="/quality", tags=["quality"])

_Verdict = Literal["good", "questionable", "bad", "unchecked", "missing"]


@router.get("", response_model=QualityList)
def list_qualities(
    context: TheContext,
    aircraft_id: Annotated[int | None, Query(ge=1, le=LARGEST_ID)] = None,
    flight_id: Annotated[int | None, Query(ge=1, le=LARGEST_ID)] = None,
    verdict: Annotated[
        _Verdict | None, Query(description="`missing`: maneuvers not assessed yet.")
    ] = None,
    search: Annotated[str | None, Query(max_length=200)] = None,
    sort: Annotated[
        str, Query(description=f"`-` for descending order, then one of {', '.join(SORT_FIELDS)}.")
    ] = "verdict",
    limit: Limit = 100,
    after: After = None,
) -> Json:
    """List maneuvers with their stored verdict, by default the worst first."""
    filters: QualityFilters = {
        "aircraft_id": aircraft_id,
        "flight_id": flight_id,
        "verdict": verdict,
        "search": search,
    }
    with context.store.database.reading() as connection:
        page = select_qualities(connection, filters, sort, limit, after)
        counts = count_verdicts(connection, filters)
    assessing = context.assessments.state()
    return Json(QualityList(items=page.items, counts=counts, assessing=assessing, next=page.next))


@router.post("/assess", response_model=Assessing, status_code=status.HTTP_202_ACCEPTED)
def assess_maneuvers(context: TheContext, store: TheStore, body: AssessRequest) -> Json:
    """Start assessing the data quality of the given maneuvers, or of all unassessed ones."""
    for number in body.maneuver_ids or ():
        store.maneuvers.get(number)
    return Json(context.assessments.start(body.maneuver_ids), status.HTTP_202_ACCEPTED)


@router.delete("/assess", response_model=Assessing)
def stop_assessment(context: TheContext) -> Json:
    """Stop the assessment; remaining maneuvers stay unassessed."""
    context.assessments.cancel()
    return Json(context.assessments.state())
