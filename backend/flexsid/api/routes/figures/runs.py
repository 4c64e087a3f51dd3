"""Figures of estimation runs: fit, residuals, poles, iterations."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query
from fastapi.responses import Response

from flexsid import figures
from flexsid.api.context import TheStore
from flexsid.api.export import Form, respond_with_figure
from flexsid.api.routes.figures.figure import Figure, Id, Names
from flexsid.api.serialization import split_ids, split_names
from flexsid.storage.repository import LARGEST_ID
from flexsid.workflow import views

router = APIRouter()
_Block = Annotated[
    str | None, Query(description="Set of data points; by default the first of the run.")
]


@router.get("/fit", response_model=Figure)
def draw_fit(
    store: TheStore, run_id: Id, output: Names = None, block: _Block = None, form: Form = "json"
) -> Response:
    """Draw the fitted model and the measured data points."""
    return respond_with_figure(
        figures.fit(views.fit(store, run_id, split_names(output) or (), block)), form
    )


@router.get("/residual", response_model=Figure)
def draw_residual(
    store: TheStore, run_id: Id, block: _Block = None, form: Form = "json"
) -> Response:
    """Draw the residuals by output and frequency."""
    return respond_with_figure(figures.residual(views.residual(store, run_id, block)), form)


@router.get("/parameter-correlation", response_model=Figure)
def draw_parameter_correlation(store: TheStore, run_id: Id, form: Form = "json") -> Response:
    """Draw the correlation matrix of the estimates."""
    return respond_with_figure(
        figures.parameter_correlation(views.parameter_correlation(store, run_id)), form
    )


@router.get("/poles", response_model=Figure)
def draw_poles(
    store: TheStore,
    run_id: Annotated[str, Query(description="Ids of runs, separated by commas.")],
    form: Form = "json",
) -> Response:
    """Draw the poles of identified models, and the in-vacuo modes of the first."""
    return respond_with_figure(figures.poles(views.poles(store, split_ids(run_id, "run_id"))), form)


@router.get("/iterations", response_model=Figure)
def draw_iterations(store: TheStore, run_id: Id, form: Form = "json") -> Response:
    """Draw the cost over the iterations."""
    return respond_with_figure(figures.iterations(views.iterations(store, run_id)), form)


@router.get("/time-check", response_model=Figure)
def draw_time_check(
    store: TheStore,
    run_id: Id,
    outputs: Names = None,
    maneuver_id: Annotated[int | None, Query(ge=1, le=LARGEST_ID)] = None,
    points: Annotated[int, Query(ge=100, le=20_000)] = views.POINTS,
    form: Form = "json",
) -> Response:
    """Draw recorded outputs and the response of the identified model to the recorded inputs."""
    selected = split_names(outputs) or ()
    return respond_with_figure(
        figures.time_check(views.time_check(store, run_id, selected, maneuver_id, points)), form
    )
