"""Flutter: what identified runs say of the next test point."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Depends, Query, status

from flexsid.api.context import TheContext, TheStore
from flexsid.api.wire import Json, split_ids
from flexsid.records.flutter import Flutter
from flexsid.workflow.background_tasks import Report, TaskProgress
from flexsid.workflow.flutter import flutter_analysis as workflow

router = APIRouter(prefix="/flutter", tags=["flutter"])


def _question(
    run_ids: Annotated[str, Query(description="Runs that succeeded, separated by commas.")],
    fuel: Annotated[
        float | None, Query(ge=0.0, le=1.0, description="Fuel fraction; the fastest point's.")
    ] = None,
    altitude_m: Annotated[
        float | None,
        Query(ge=-1000.0, le=11_000.0, description="Standard altitude; the fastest point's air."),
    ] = None,
    next_m_s: Annotated[
        float | None,
        Query(ge=0.1, le=1000.0, description="Airspeed of the next point; 3 % above the fastest."),
    ] = None,
    others: Annotated[
        workflow.Others,
        Query(description="Modes the runs left out: as predicted, or their static response."),
    ] = workflow.Others.PREDICTED,
    trend: Annotated[
        bool, Query(description="Derivatives drift linearly with dynamic pressure.")
    ] = False,
) -> workflow.FlutterQuery:
    return workflow.FlutterQuery(
        run_ids=tuple(split_ids(run_ids, "run_ids")),
        fuel=fuel,
        altitude_m=altitude_m,
        next_m_s=next_m_s,
        others=others,
        trend=trend,
    )


TheQuestion = Annotated[workflow.FlutterQuery, Depends(_question)]


@router.post("/answers", response_model=TaskProgress, status_code=status.HTTP_202_ACCEPTED)
def find_flutter(context: TheContext, question: TheQuestion) -> Json:
    """Begin to find the answer and its figures for many runs; then they are there at once."""

    def work(report: Report) -> None:
        workflow.foretell(context.store, question, report)

    known = len(question.run_ids)
    title = f"{known} run{'' if known == 1 else 's'}"
    begun = context.tasks.begin("flutter", title, work)
    return Json(begun, status.HTTP_202_ACCEPTED, {"Location": f"/api/v1/tasks/{begun.id}"})


@router.get("", response_model=Flutter)
def get_flutter(store: TheStore, question: TheQuestion) -> Json:
    """Say where the aircraft of these runs loses stability, and how sure that is."""
    return Json(workflow.flutter(store, question))
