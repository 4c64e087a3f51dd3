"""Flutter prediction from identified runs, for the next test point."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Depends, Query, status

from flexsid.api.context import TheContext, TheStore
from flexsid.api.serialization import Json, split_ids
from flexsid.records.flutter import Flutter
from flexsid.workflow.background_tasks import Report, TaskProgress
from flexsid.workflow.flutter import flutter_analysis as workflow

router = APIRouter(prefix="/flutter", tags=["flutter"])


def _read_query(
    run_ids: Annotated[str, Query(description="Ids of succeeded runs, separated by commas.")],
    fuel: Annotated[
        float | None,
        Query(
            ge=0.0, le=1.0, description="Fuel fraction; by default that of the fastest test point."
        ),
    ] = None,
    altitude_m: Annotated[
        float | None,
        Query(
            ge=-1000.0,
            le=11_000.0,
            description="Standard altitude; by default the air of the fastest test point.",
        ),
    ] = None,
    next_m_s: Annotated[
        float | None,
        Query(
            ge=0.1,
            le=1000.0,
            description="Airspeed of the next test point; by default 3 % above the fastest.",
        ),
    ] = None,
    others: Annotated[
        workflow.UnmodelledModes,
        Query(
            description="Modes not modelled by the runs: with predicted dynamics, or residualised."
        ),
    ] = workflow.UnmodelledModes.PREDICTED,
    trend: Annotated[
        bool, Query(description="Linear trend of the derivatives with dynamic pressure.")
    ] = False,
) -> workflow.FlutterQuery:
    return workflow.FlutterQuery(
        run_ids=tuple(split_ids(run_ids, "run_ids")),
        fuel=fuel,
        altitude_m=altitude_m,
        next_m_s=next_m_s,
        unmodelled_modes=others,
        trend=trend,
    )


TheFlutterQuery = Annotated[workflow.FlutterQuery, Depends(_read_query)]


@router.post("/results", response_model=TaskProgress, status_code=status.HTTP_202_ACCEPTED)
def start_flutter_prediction(context: TheContext, query: TheFlutterQuery) -> Json:
    """Start the flutter prediction and its figures as a task; the results are cached."""

    def work(report: Report) -> None:
        workflow.compute_flutter(context.store, query, report)

    n_runs = len(query.run_ids)
    title = f"{n_runs} run{'' if n_runs == 1 else 's'}"
    task = context.tasks.begin("flutter", title, work)
    return Json(task, status.HTTP_202_ACCEPTED, {"Location": f"/api/v1/tasks/{task.id}"})


@router.get("", response_model=Flutter)
def get_flutter(store: TheStore, query: TheFlutterQuery) -> Json:
    """Return the predicted flutter speed of these runs, with its confidence interval."""
    return Json(workflow.analyse_flutter(store, query))
