"""Comparison of runs and predictions, sheets of flight conditions, validation of models."""

from __future__ import annotations

from typing import Annotated

from fastapi import Query

from flexsid.api.context import TheStore
from flexsid.api.responses import add_analysis
from flexsid.api.router import make_router
from flexsid.api.serialization import Identity, JsonRoute, Reference
from flexsid.figure_table import TrendParameters
from flexsid.jobs.kinds import (
    AERODYNAMICS,
    CROSS_PREDICTION,
    CROSS_VALIDATION,
    POSTERIOR,
    read_condition_sheet,
)
from flexsid.records.condition_sheet import ConditionItem, ConditionSheet
from flexsid.records.validation import (
    Comparison,
    DerivativeTrend,
)
from flexsid.storage.lists.list_query import Items
from flexsid.text import split_ids
from flexsid.workflow.comparison.derivative_comparison import compare
from flexsid.workflow.comparison.trends import fit_derivative_trend
from flexsid.workflow.review import condition_sheet

# --- Comparisons of derivatives between runs and predictions, and over flight conditions ----------

comparisons_router = make_router("/comparisons", tag="comparisons", route_class=JsonRoute)

_Runs = Annotated[str, Query(description="Ids of runs, separated by commas.")]
_Predictions = Annotated[str | None, Query(description="Ids of predictions, separated by commas.")]


@comparisons_router.get("")
def get_comparison(
    store: TheStore, run_ids: _Runs, prediction_ids: _Predictions = None
) -> Comparison:
    """Compare derivatives of runs and predictions, with the difference of every pair."""
    return compare(
        store, split_ids(run_ids, "run_ids"), split_ids(prediction_ids, "prediction_ids")
    )


@comparisons_router.get("/trend")
def get_trend(store: TheStore, parameters: Annotated[TrendParameters, Query()]) -> DerivativeTrend:
    """Return one derivative over the flight conditions, with a weighted fit per method."""
    return fit_derivative_trend(store, **dict(parameters))


# --- Flight conditions, and the sheet of evidence of each -----------------------------------------

conditions_router = make_router("/conditions", tag="conditions", route_class=JsonRoute)


@conditions_router.get("")
def list_conditions(store: TheStore, aircraft_id: Reference = None) -> Items[ConditionItem]:
    """List flight conditions: maneuvers of one aircraft and axis at one airspeed and fuel."""
    return Items(items=condition_sheet.list_conditions(store, aircraft_id))


@conditions_router.get("/{condition_id}/sheet")
def get_condition_sheet(
    store: TheStore,
    condition_id: Identity,
    truth: Annotated[bool, Query(description="With the truth of a simulated aircraft.")] = False,
) -> ConditionSheet:
    """Return the evidence for the model of a condition, from stored results.

    The id of any maneuver of a condition names it; nothing is computed but comparisons.
    """
    return read_condition_sheet(store, condition_id, truth)


# --- Validation of identified models: cross-prediction of maneuvers, and cross-validation of runs

validation_router = make_router(tag="validation")


for _analysis in (CROSS_PREDICTION, CROSS_VALIDATION, AERODYNAMICS, POSTERIOR):
    add_analysis(validation_router, _analysis)
