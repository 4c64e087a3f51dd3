"""Comparisons: derivatives of runs and predictions side by side, and over conditions."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Depends, Query

from flexsid.api.context import TheStore
from flexsid.api.wire import Json, split_ids
from flexsid.records.comparison import Against, Comparison, DerivativeTrend
from flexsid.workflow.comparison.derivative_comparison import compare
from flexsid.workflow.comparison.trends import trend

router = APIRouter(prefix="/comparisons", tags=["comparisons"])

_Runs = Annotated[str, Query(description="Ids of runs, separated by commas.")]
_Predictions = Annotated[str | None, Query(description="Ids of predictions, separated by commas.")]


@router.get("", response_model=Comparison)
def get_comparison(store: TheStore, run_ids: _Runs, prediction_ids: _Predictions = None) -> Json:
    """Compare derivatives of runs and predictions, pair by pair too, and what differs in them."""
    return Json(
        compare(store, split_ids(run_ids, "run_ids"), split_ids(prediction_ids, "prediction_ids"))
    )


def read_trend(
    store: TheStore,
    run_ids: _Runs,
    name: Annotated[str, Query(max_length=64, description="Derivative, e.g. Cm_alpha.")],
    against: Against = Against.DYNAMIC_PRESSURE,
    prediction_ids: _Predictions = None,
    degree: Annotated[int, Query(ge=0, le=3, description="Of the weighted polynomial.")] = 1,
) -> DerivativeTrend:
    """Read a trend, for its numbers and for its figure."""
    return trend(
        store,
        split_ids(run_ids, "run_ids"),
        name,
        against,
        split_ids(prediction_ids, "prediction_ids"),
        degree,
    )


TheTrend = Annotated[DerivativeTrend, Depends(read_trend)]


@router.get("/trend", response_model=DerivativeTrend)
def get_trend(asked: TheTrend) -> Json:
    """Lay one derivative out over the conditions that were flown, with a fit per method."""
    return Json(asked)
