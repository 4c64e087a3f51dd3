"""Figures of structures: modes over fuel, MAC, model order, stabilisation."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query
from fastapi.responses import Response

from flexsid import figures
from flexsid.api.context import TheStore
from flexsid.api.export import Form, sent
from flexsid.api.routes.figures.answer import Figure, Id
from flexsid.api.routes.modal_tables import Fuel, TheOrderQuestion
from flexsid.api.routes.vibration_tests import TheModeSearch
from flexsid.api.wire import Reference, split_names
from flexsid.workflow.modal_data import ground_vibration_test
from flexsid.workflow.views import correlation, model_order
from flexsid.workflow.views.fuel import modes_against_fuel

router = APIRouter()


@router.get("/modes-against-fuel", response_model=Figure)
def draw_modes_against_fuel(store: TheStore, modal_table_id: Id, form: Form = "json") -> Response:
    """Draw frequency and damping of the modes of a table over fuel, crossings marked."""
    return sent(figures.modes_against_fuel(modes_against_fuel(store, modal_table_id)), form)


@router.get("/mac", response_model=Figure)
def draw_assurance(
    store: TheStore,
    modal_table_id: Id,
    fuel: Fuel = 0.5,
    other_id: Reference = None,
    other_fuel: Annotated[float | None, Query(ge=0.0, le=1.0)] = None,
    form: Form = "json",
) -> Response:
    """Draw the MAC of a table's modes with themselves, another fuel weight, or another table."""
    at_other = fuel if other_fuel is None else other_fuel
    value = correlation.assurance(store, modal_table_id, fuel, other_id, at_other)
    return sent(figures.assurance(value), form)


@router.get("/model-order", response_model=Figure)
def draw_model_order(
    store: TheStore,
    question: TheOrderQuestion,
    derivatives: Annotated[
        str, Query(description="Derivatives to draw, separated by commas.", max_length=2000)
    ] = "CZ_alpha,Cm_alpha,CZ_q,Cm_q",
    form: Form = "json",
) -> Response:
    """Draw derivatives against the number of modes kept, with the band of ±10 %."""
    value = model_order.model_order(store, question)
    return sent(figures.model_order(value, split_names(derivatives) or ()), form)


@router.get("/reduced-responses", response_model=Figure)
def draw_reduced_responses(
    store: TheStore,
    question: TheOrderQuestion,
    output: Annotated[str, Query(max_length=64)],
    surface: Annotated[str, Query(max_length=64)],
    counts: Annotated[str, Query(description="Modes kept, separated by commas.")] = "0,1,2,3,4",
    form: Form = "json",
) -> Response:
    """Draw one response of the full and the reduced models, and to sensors of a rigid body."""
    kept = tuple(int(n) for n in split_names(counts) or () if n.isascii() and n.isdigit())
    value = model_order.reduced_responses(store, question, output, surface, kept[:10])
    return sent(figures.reduced_responses(value), form)


@router.get("/stabilisation", response_model=Figure)
def draw_stabilisation(
    store: TheStore, responses_id: Id, search: TheModeSearch, form: Form = "json"
) -> Response:
    """Draw the poles of models of every order over the mean measured response."""
    value = ground_vibration_test.draw_stabilisation(store, responses_id, search)
    return sent(figures.stabilisation(value), form)
