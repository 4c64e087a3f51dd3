"""Figures of identified roots, of the margin to flutter, and of closed loops."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query
from fastapi.responses import Response

from flexsid import figures
from flexsid.api.context import TheStore
from flexsid.api.export import Form, sent
from flexsid.api.routes.figures.answer import Figure, Id
from flexsid.api.routes.flutter import TheQuestion
from flexsid.records.flutter import Along
from flexsid.workflow.flutter import closed_loop, flutter_analysis

router = APIRouter()
TheAxis = Annotated[Along, Query(description="What roots are followed along.")]


@router.get("/v-omega-zeta", response_model=Figure)
def draw_v_omega_zeta(
    store: TheStore, question: TheQuestion, along: TheAxis = Along.AIRSPEED, form: Form = "json"
) -> Response:
    """Draw frequency and damping of the identified roots with ±2 standard errors."""
    return sent(figures.v_omega_zeta(flutter_analysis.flutter_roots(store, question, along)), form)


@router.get("/root-locus", response_model=Figure)
def draw_root_locus(
    store: TheStore, question: TheQuestion, along: TheAxis = Along.AIRSPEED, form: Form = "json"
) -> Response:
    """Draw the identified roots in the s-plane."""
    return sent(figures.root_locus(flutter_analysis.flutter_roots(store, question, along)), form)


@router.get("/equivalent-modes", response_model=Figure)
def draw_equivalent_modes(store: TheStore, question: TheQuestion, form: Form = "json") -> Response:
    """Draw equivalent frequency and damping of every run over dynamic pressure (Eq. 25)."""
    return sent(figures.equivalent_modes(flutter_analysis.flutter(store, question)), form)


@router.get("/flutter-forecast", response_model=Figure)
def draw_flutter_forecast(store: TheStore, question: TheQuestion, form: Form = "json") -> Response:
    """Draw the flutter speed each run predicts, classical trackers beside it."""
    return sent(figures.flutter_forecast(flutter_analysis.flutter(store, question)), form)


@router.get("/flutter-map", response_model=Figure)
def draw_flutter_map(store: TheStore, question: TheQuestion, form: Form = "json") -> Response:
    """Draw the flutter speed over fuel and altitude."""
    return sent(figures.flutter_map(flutter_analysis.flutter_map(store, question)), form)


@router.get("/closed-loop-margins", response_model=Figure)
def draw_closed_loop_margins(
    store: TheStore, question: TheQuestion, controller_id: Id, form: Form = "json"
) -> Response:
    """Draw margins of every surface's loop over airspeed."""
    value = closed_loop.closed_loop(store, question, controller_id)
    return sent(figures.closed_loop_margins(value), form)


@router.get("/closed-loop-roots", response_model=Figure)
def draw_closed_loop_roots(
    store: TheStore, question: TheQuestion, controller_id: Id, form: Form = "json"
) -> Response:
    """Draw roots with and without a controller."""
    value = closed_loop.closed_loop(store, question, controller_id)
    return sent(figures.closed_loop_roots(value), form)
