"""Flutter prediction from identified runs, for the next test point."""

from __future__ import annotations

from typing import Annotated

from fastapi import Depends, Query

from flexsid.api.context import TheStore
from flexsid.api.router import make_router
from flexsid.api.serialization import Json
from flexsid.api.submission import add_job_routes
from flexsid.figure_table import FlutterParameters, PredictedFlutterParameters
from flexsid.jobs.kind import get_result
from flexsid.jobs.kinds import FLUTTER, PREDICTED_FLUTTER
from flexsid.records.flutter import Flutter, PredictedFlutter
from flexsid.text import count_noun
from flexsid.workflow.flutter import flutter_analysis as workflow
from flexsid.workflow.flutter.predicted_flutter import PredictedFlutterQuery

router = make_router("/flutter", tag="flutter")


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


add_job_routes(
    *(router, "", FLUTTER, "flutter", _read_query),
    lambda store, query: count_noun(len(query.run_ids), "run"),
)
add_job_routes(
    *(router, "/predicted", PREDICTED_FLUTTER, "predicted_flutter", _read_predicted),
    lambda store, query: store.predictions.get(query.prediction_id).source,
)


@router.get("", response_model=Flutter)
def get_flutter(store: TheStore, query: TheFlutterQuery) -> Json:
    """Return the stored flutter speed of these runs, with its confidence interval."""
    return Json(get_result(store, FLUTTER, query).flutter)


@router.get("/predicted", response_model=PredictedFlutter)
def get_predicted_flutter(store: TheStore, query: ThePredictedQuery) -> Json:
    """Return the stored flutter speed of a prediction alone, by p-k and by rational functions."""
    return Json(get_result(store, PREDICTED_FLUTTER, query).flutter)
