"""Figures of identified roots, flutter speeds and closed-loop stability."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query
from fastapi.responses import Response

from flexsid import figures
from flexsid.api.context import TheStore
from flexsid.api.export import Form, respond_with_figure
from flexsid.api.routes.figures.figure import Figure, Id
from flexsid.api.routes.flutter import TheFlutterQuery
from flexsid.records.flutter import Along
from flexsid.workflow.flutter import closed_loop, flutter_analysis

router = APIRouter()
TheAxis = Annotated[Along, Query(description="Variable over which the roots are tracked.")]


@router.get("/v-omega-zeta", response_model=Figure)
def draw_v_omega_zeta(
    store: TheStore, query: TheFlutterQuery, along: TheAxis = Along.AIRSPEED, form: Form = "json"
) -> Response:
    """Draw frequency and damping of the identified roots with ±2 standard errors."""
    return respond_with_figure(
        figures.v_omega_zeta(flutter_analysis.trace_flutter_roots(store, query, along)), form
    )


@router.get("/root-locus", response_model=Figure)
def draw_root_locus(
    store: TheStore, query: TheFlutterQuery, along: TheAxis = Along.AIRSPEED, form: Form = "json"
) -> Response:
    """Draw the identified roots in the s-plane."""
    return respond_with_figure(
        figures.root_locus(flutter_analysis.trace_flutter_roots(store, query, along)), form
    )


@router.get("/equivalent-modes", response_model=Figure)
def draw_equivalent_modes(store: TheStore, query: TheFlutterQuery, form: Form = "json") -> Response:
    """Draw equivalent frequency and damping of every run over dynamic pressure (Eq. 25)."""
    return respond_with_figure(
        figures.equivalent_modes(flutter_analysis.analyse_flutter(store, query)), form
    )


@router.get("/flutter-forecast", response_model=Figure)
def draw_flutter_forecast(store: TheStore, query: TheFlutterQuery, form: Form = "json") -> Response:
    """Draw the predicted flutter speed by run, and by classical flutter prediction methods."""
    return respond_with_figure(
        figures.flutter_forecast(flutter_analysis.analyse_flutter(store, query)), form
    )


@router.get("/flutter-map", response_model=Figure)
def draw_flutter_map(store: TheStore, query: TheFlutterQuery, form: Form = "json") -> Response:
    """Draw the flutter speed over fuel and altitude."""
    return respond_with_figure(
        figures.flutter_map(flutter_analysis.map_flutter_speed(store, query)), form
    )


@router.get("/closed-loop-margins", response_model=Figure)
def draw_closed_loop_margins(
    store: TheStore, query: TheFlutterQuery, controller_id: Id, form: Form = "json"
) -> Response:
    """Draw the stability margins of the loop of every surface over airspeed."""
    value = closed_loop.analyse_closed_loop(store, query, controller_id)
    return respond_with_figure(figures.closed_loop_margins(value), form)


@router.get("/closed-loop-roots", response_model=Figure)
def draw_closed_loop_roots(
    store: TheStore, query: TheFlutterQuery, controller_id: Id, form: Form = "json"
) -> Response:
    """Draw the roots with and without the controller."""
    value = closed_loop.analyse_closed_loop(store, query, controller_id)
    return respond_with_figure(figures.closed_loop_roots(value), form)
