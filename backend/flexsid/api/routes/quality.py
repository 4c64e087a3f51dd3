"""Quality of a campaign: the list that finds bad maneuvers, and looking at what is new."""

from __future__ import annotations

from typing import Annotated, Literal

from fastapi import APIRouter, Query, status

from flexsid.api.answers import QualityList
from flexsid.api.context import TheContext, TheStore
from flexsid.api.requests import AssessRequest
from flexsid.api.wire import After, Json, Limit
from flexsid.storage.quality_list import (
    SORT_FIELDS,
    QualityFilters,
    count_verdicts,
    select_qualities,
)
from flexsid.storage.repository import LARGEST_ID
from flexsid.workflow.quality.campaign_quality import Assessing

router = APIRouter(prefix="/quality", tags=["quality"])

_Verdict = Literal["good", "doubtful", "bad", "unchecked", "missing"]


@router.get("", response_model=QualityList)
def list_qualities(
    context: TheContext,
    aircraft_id: Annotated[int | None, Query(ge=1, le=LARGEST_ID)] = None,
    flight_id: Annotated[int | None, Query(ge=1, le=LARGEST_ID)] = None,
    verdict: Annotated[
        _Verdict | None, Query(description="`missing` for maneuvers nobody has looked at.")
    ] = None,
    search: Annotated[str | None, Query(max_length=200)] = None,
    sort: Annotated[
        str, Query(description=f"`-` for falling order, then one of {', '.join(SORT_FIELDS)}.")
    ] = "verdict",
    limit: Limit = 100,
    after: After = None,
) -> Json:
    """List maneuvers with their verdict, the worst first; nothing is computed here."""
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
def assess_maneuvers(context: TheContext, store: TheStore, wanted: AssessRequest) -> Json:
    """Begin to look at maneuvers: at these, or at all that nobody has looked at."""
    for number in wanted.maneuver_ids or ():
        store.maneuvers.get(number)
    return Json(context.assessments.begin(wanted.maneuver_ids), status.HTTP_202_ACCEPTED)


@router.delete("/assess", response_model=Assessing)
def stop_assessing(context: TheContext) -> Json:
    """Leave the maneuvers that were not looked at yet for another time."""
    context.assessments.leave()
    return Json(context.assessments.state())
