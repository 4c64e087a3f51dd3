"""Flutter prediction from identified runs, for the next test point."""

from __future__ import annotations

from typing import Annotated

from fastapi import Depends

from flexsid.api.context import TheStore
from flexsid.api.parameters import query_as
from flexsid.api.router import make_router
from flexsid.api.serialization import Json
from flexsid.api.submission import add_job_routes
from flexsid.jobs.kind import get_result
from flexsid.jobs.kinds import FLUTTER, PREDICTED_FLUTTER
from flexsid.records.flutter import Flutter, PredictedFlutter
from flexsid.text import count_noun
from flexsid.workflow.flutter.flutter_models import FlutterQuery
from flexsid.workflow.flutter.predicted_flutter import PredictedFlutterQuery

router = make_router("/flutter", tag="flutter")


TheFlutterQuery = Annotated[FlutterQuery, Depends(query_as(FlutterQuery))]
ThePredictedQuery = Annotated[PredictedFlutterQuery, Depends(query_as(PredictedFlutterQuery))]

add_job_routes(
    *(router, "", FLUTTER, "flutter"),
    lambda store, query: count_noun(len(query.run_ids), "run"),
)
add_job_routes(
    *(router, "/predicted", PREDICTED_FLUTTER, "predicted_flutter"),
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
