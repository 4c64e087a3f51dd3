"""Global aerodynamic model: derivatives over the envelope from the estimates of all runs."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Depends, Query, Response

from flexsid.api.context import TheStore
from flexsid.api.prediction_requests import SaveGlobalPredictionRequest
from flexsid.api.serialization import Json
from flexsid.api.submission import add_job_routes
from flexsid.figure_table import GlobalModelParameters
from flexsid.jobs.kind import get_result
from flexsid.jobs.kinds import GLOBAL_MODEL
from flexsid.records.aircraft import DerivativePrediction
from flexsid.records.global_model import GlobalModelSummary
from flexsid.text import count_noun
from flexsid.workflow.global_model.dave_ml import write_dave_ml
from flexsid.workflow.global_model.estimates import GlobalModelQuery
from flexsid.workflow.global_model.stored_prediction import store_global_prediction

router = APIRouter(prefix="/global-models", tags=["global model"])


async def _read_query(
    parameters: Annotated[GlobalModelParameters, Query()],
) -> GlobalModelQuery:
    return GlobalModelQuery(**dict(parameters))


TheGlobalModelQuery = Annotated[GlobalModelQuery, Depends(_read_query)]


add_job_routes(
    *(router, "", GLOBAL_MODEL, "global_model", _read_query),
    lambda store, query: count_noun(len(query.run_ids), "run"),
)


@router.get("", response_model=GlobalModelSummary)
def get_global_model(store: TheStore, query: TheGlobalModelQuery) -> Json:
    """Return the stored global model of these runs: derivatives, scores and outlying runs.

    The figures ``global-slice`` and ``global-coverage`` have its values over the envelope.
    """
    return Json(get_result(store, GLOBAL_MODEL, query).summary)


@router.get(
    "/dave-ml",
    response_class=Response,
    responses={200: {"content": {"application/xml": {"schema": {"type": "string"}}}}},
)
def get_global_model_dave_ml(store: TheStore, query: TheGlobalModelQuery) -> Response:
    """Return the stored global model as DAVE-ML, with standard errors and check cases."""
    content = write_dave_ml(get_result(store, GLOBAL_MODEL, query))
    name = {"Content-Disposition": 'attachment; filename="flexsid-global-model.dml"'}
    return Response(content, media_type="application/xml", headers=name)


@router.post("/predictions", status_code=201)
def save_global_prediction(
    store: TheStore, query: TheGlobalModelQuery, body: SaveGlobalPredictionRequest
) -> DerivativePrediction:
    """Store the derivatives of a computed global model at one condition as a prediction.

    Runs take priors from it, and pre-flight simulations, designs and comparisons its values.
    """
    result = get_result(store, GLOBAL_MODEL, query)
    return store_global_prediction(store, result, body.source, body.condition)
