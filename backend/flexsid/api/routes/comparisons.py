"""Comparisons of derivatives between runs and predictions, and over flight conditions."""

from __future__ import annotations

from typing import Annotated

from fastapi import Query

from flexsid.api.context import TheStore
from flexsid.api.router import make_router
from flexsid.api.serialization import JsonRoute
from flexsid.figure_table import TrendParameters
from flexsid.records.comparison import Comparison, DerivativeTrend
from flexsid.text import split_ids
from flexsid.workflow.comparison.derivative_comparison import compare
from flexsid.workflow.comparison.trends import fit_derivative_trend

router = make_router("/comparisons", tag="comparisons", route_class=JsonRoute)

_Runs = Annotated[str, Query(description="Ids of runs, separated by commas.")]
_Predictions = Annotated[str | None, Query(description="Ids of predictions, separated by commas.")]


@router.get("")
def get_comparison(
    store: TheStore, run_ids: _Runs, prediction_ids: _Predictions = None
) -> Comparison:
    """Compare derivatives of runs and predictions, with the difference of every pair."""
    return compare(
        store, split_ids(run_ids, "run_ids"), split_ids(prediction_ids, "prediction_ids")
    )


@router.get("/trend")
def get_trend(store: TheStore, parameters: Annotated[TrendParameters, Query()]) -> DerivativeTrend:
    """Return one derivative over the flight conditions, with a weighted fit per method."""
    return fit_derivative_trend(store, **dict(parameters))
