"""Figures that compare derivatives of runs and predictions."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query
from fastapi.responses import Response

from flexsid import figures
from flexsid.api.context import TheStore
from flexsid.api.export import Form, respond_with_figure
from flexsid.api.routes.comparisons import TheTrend
from flexsid.api.routes.figures.figure import Figure, Ids
from flexsid.api.serialization import split_ids
from flexsid.workflow import views

router = APIRouter()


@router.get("/derivatives", response_model=Figure)
def draw_derivatives(
    store: TheStore,
    run_ids: Annotated[str, Query(description="Ids separated by commas.")],
    prediction_ids: Ids = None,
    coefficient: Annotated[str | None, Query(description="CZ, Cm, CQ7 ...")] = None,
    form: Form = "json",
) -> Response:
    """Draw derivatives by method and prediction with ±2 standard errors."""
    value = views.derivatives(
        store,
        split_ids(run_ids, "run_ids"),
        split_ids(prediction_ids, "prediction_ids"),
        coefficient,
    )
    return respond_with_figure(figures.derivatives(value), form)


@router.get("/forest", response_model=Figure)
def draw_forest(
    store: TheStore,
    run_ids: Annotated[str, Query(description="Ids separated by commas.")],
    name: Annotated[str, Query(max_length=64, description="Derivative, e.g. Cm_alpha.")],
    prediction_ids: Ids = None,
    form: Form = "json",
) -> Response:
    """Draw the estimates and predictions of one derivative, with their mean (forest plot)."""
    value = views.derivatives(
        store, split_ids(run_ids, "run_ids"), split_ids(prediction_ids, "prediction_ids")
    )
    return respond_with_figure(figures.forest(value, name), form)


@router.get("/trend", response_model=Figure)
def draw_trend(store: TheStore, derivative_trend: TheTrend, form: Form = "json") -> Response:
    """Draw one derivative over the flight conditions, with weighted fits."""
    return respond_with_figure(figures.trend(derivative_trend), form)
