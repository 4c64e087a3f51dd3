"""Comparisons of derivatives between runs and predictions, and over flight conditions."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Depends, Query

from flexsid.api.context import TheStore
from flexsid.api.serialization import Json, split_ids
from flexsid.records.comparison import Against, Comparison, DerivativeTrend
from flexsid.workflow.comparison.derivative_comparison import compare
from flexsid.workflow.comparison.trends import fit_derivative_trend

router = APIRouter(prefix="/comparisons", tags=["comparisons"])

_Runs = Annotated[str, Query(description="Ids of runs, separated by commas.")]
_Predictions = Annotated[str | None, Query(description="Ids of predictions, separated by commas.")]


@router.get("", response_model=Comparison)
def get_comparison(store: TheStore, run_ids: _Runs, prediction_ids: _Predictions = None) -> Json:
    """Compare derivatives of runs and predictions, with the difference of every pair."""
    return Json(
        compare(store, split_ids(run_ids, "run_ids"), split_ids(prediction_ids, "prediction_ids"))
    )


def read_trend(
    store: TheStore,
    run_ids: _Runs,
    name: Annotated[str, Query(max_length=64, description="Derivative, e.g. Cm_alpha.")],
    against: Against = Against.DYNAMIC_PRESSURE,
    prediction_ids: _Predictions = None,
    degree: Annotated[int, Query(ge=0, le=3, description="Degree of the weighted polynomial.")] = 1,
) -> DerivativeTrend:
    """Return the trend of one derivative, for its data and its figure."""
    return fit_derivative_trend(
        store,
        split_ids(run_ids, "run_ids"),
        name,
        against,
        split_ids(prediction_ids, "prediction_ids"),
        degree,
    )


TheTrend = Annotated[DerivativeTrend, Depends(read_trend)]


@router.get("/trend", response_model=DerivativeTrend)
def get_trend(derivative_trend: TheTrend) -> Json:
    """Return one derivative over the flight conditions, with a weighted fit per method."""
    return Json(derivative_trend)
