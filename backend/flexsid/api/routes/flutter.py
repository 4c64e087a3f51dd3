"""Flutter prediction from identified runs, for the next test point."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Depends, Query, status

from flexsid.api.analyst import TheAnalyst
from flexsid.api.context import TheContext, TheStore
from flexsid.api.serialization import Json
from flexsid.api.submission import KnownJob, respond_with_job, submit_job
from flexsid.figure_table import FlutterParameters, PredictedFlutterParameters
from flexsid.jobs.kind import get_result
from flexsid.jobs.kinds import FLUTTER, PREDICTED_FLUTTER
from flexsid.records.flutter import Flutter, PredictedFlutter
from flexsid.storage.job_list import JobItem
from flexsid.workflow.flutter import flutter_analysis as workflow
from flexsid.workflow.flutter.predicted_flutter import PredictedFlutterQuery

router = APIRouter(prefix="/flutter", tags=["flutter"])


async def _read_query(
    parameters: Annotated[FlutterParameters, Query()],
) -> workflow.FlutterQuery:
    return workflow.FlutterQuery(**dict(parameters))


TheFlutterQuery = Annotated[workflow.FlutterQuery, Depends(_read_query)]


async def _read_predicted(
    parameters: Annotated[PredictedFlutterParameters, Query()],
) -> PredictedFlutterQuery:
    return PredictedFlutterQuery(**dict(parameters))


ThePredictedQuery = Annotated[PredictedFlutterQuery, Depends(_read_predicted)]


@router.post("/results", response_model=JobItem, status_code=status.HTTP_202_ACCEPTED)
def request_flutter(context: TheContext, query: TheFlutterQuery, analyst: TheAnalyst) -> Json:
    """Queue the flutter prediction of these runs, or return the job of an equal request."""
    return submit_job(context, FLUTTER, query, analyst, title_runs(query))


@router.get("/results", response_model=KnownJob)
def get_flutter_job(store: TheStore, query: TheFlutterQuery) -> Json:
    """Return the newest job of an equal request; null if there is none."""
    return respond_with_job(store, FLUTTER, query)


@router.get("", response_model=Flutter)
def get_flutter(store: TheStore, query: TheFlutterQuery) -> Json:
    """Return the stored flutter speed of these runs, with its confidence interval."""
    return Json(get_result(store, FLUTTER, query).flutter)


@router.post("/predicted/results", response_model=JobItem, status_code=status.HTTP_202_ACCEPTED)
def request_predicted_flutter(
    context: TheContext, query: ThePredictedQuery, analyst: TheAnalyst
) -> Json:
    """Queue the flutter analysis of a prediction, or return the job of an equal request."""
    title = context.store.predictions.get(query.prediction_id).source
    return submit_job(context, PREDICTED_FLUTTER, query, analyst, title)


@router.get("/predicted/results", response_model=KnownJob)
def get_predicted_flutter_job(store: TheStore, query: ThePredictedQuery) -> Json:
    """Return the newest job of an equal request; null if there is none."""
    return respond_with_job(store, PREDICTED_FLUTTER, query)


@router.get("/predicted", response_model=PredictedFlutter)
def get_predicted_flutter(store: TheStore, query: ThePredictedQuery) -> Json:
    """Return the stored flutter speed of a prediction alone, by p-k and by rational functions."""
    return Json(get_result(store, PREDICTED_FLUTTER, query).flutter)


def title_runs(query: workflow.FlutterQuery) -> str:
    """Return the title of a job on these runs."""
    n_runs = len(query.run_ids)
    return f"{n_runs} run{'' if n_runs == 1 else 's'}"
