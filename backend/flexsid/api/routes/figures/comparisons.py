"""Figures that hold derivatives of runs and predictions beside each other."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query
from fastapi.responses import Response

from flexsid import figures
from flexsid.api.context import TheStore
from flexsid.api.export import Form, sent
from flexsid.api.routes.comparisons import TheTrend
from flexsid.api.routes.figures.answer import Figure, Ids
from flexsid.api.wire import split_ids
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
    return sent(figures.derivatives(value), form)


@router.get("/forest", response_model=Figure)
def draw_forest(
    store: TheStore,
    run_ids: Annotated[str, Query(description="Ids separated by commas.")],
    name: Annotated[str, Query(max_length=64, description="Derivative, e.g. Cm_alpha.")],
    prediction_ids: Ids = None,
    form: Form = "json",
) -> Response:
    """Draw what each run and prediction says about one derivative, over their mean."""
    value = views.derivatives(
        store, split_ids(run_ids, "run_ids"), split_ids(prediction_ids, "prediction_ids")
    )
    return sent(figures.forest(value, name), form)


@router.get("/trend", response_model=Figure)
def draw_trend(store: TheStore, asked: TheTrend, form: Form = "json") -> Response:
    """Draw one derivative over the conditions that were flown, with weighted fits."""
    return sent(figures.trend(asked), form)
