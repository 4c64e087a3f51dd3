"""Figures of modal data: modes over fuel, MAC, model order, stabilisation diagram."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query
from fastapi.responses import Response

from flexsid import figures
from flexsid.api.context import TheStore
from flexsid.api.export import Form, respond_with_figure
from flexsid.api.routes.figures.figure import Figure, Id
from flexsid.api.routes.modal_tables import Fuel, TheOrderQuery
from flexsid.api.routes.vibration_tests import TheModeSearch
from flexsid.api.serialization import Reference, split_names
from flexsid.workflow.modal_data import ground_vibration_test
from flexsid.workflow.views import correlation, model_order
from flexsid.workflow.views.fuel import trace_modes

router = APIRouter()


@router.get("/modes-against-fuel", response_model=Figure)
def draw_modes_against_fuel(store: TheStore, modal_table_id: Id, form: Form = "json") -> Response:
    """Draw frequency and damping of the modes of a table over fuel, with crossings."""
    return respond_with_figure(figures.modes_against_fuel(trace_modes(store, modal_table_id)), form)


@router.get("/mac", response_model=Figure)
def draw_mac(
    store: TheStore,
    modal_table_id: Id,
    fuel: Fuel = 0.5,
    other_id: Reference = None,
    other_fuel: Annotated[float | None, Query(ge=0.0, le=1.0)] = None,
    form: Form = "json",
) -> Response:
    """Draw the MAC of the modes of a table with itself, another fuel fraction or another table."""
    at_other = fuel if other_fuel is None else other_fuel
    value = correlation.compute_assurance(store, modal_table_id, fuel, other_id, at_other)
    return respond_with_figure(figures.assurance(value), form)


@router.get("/model-order", response_model=Figure)
def draw_model_order(
    store: TheStore,
    query: TheOrderQuery,
    derivatives: Annotated[
        str, Query(description="Derivatives to draw, separated by commas.", max_length=2000)
    ] = "CZ_alpha,Cm_alpha,CZ_q,Cm_q",
    form: Form = "json",
) -> Response:
    """Draw derivatives over the number of retained modes, with a band of ±10 %."""
    value = model_order.study_model_order(store, query)
    return respond_with_figure(figures.model_order(value, split_names(derivatives) or ()), form)


@router.get("/reduced-responses", response_model=Figure)
def draw_reduced_responses(
    store: TheStore,
    query: TheOrderQuery,
    output: Annotated[str, Query(max_length=64)],
    surface: Annotated[str, Query(max_length=64)],
    counts: Annotated[
        str, Query(description="Numbers of retained modes, separated by commas.")
    ] = "0,1,2,3,4",
    form: Form = "json",
) -> Response:
    """Draw one frequency response of full and reduced models, and with rigid-body sensors."""
    n_modes = tuple(int(n) for n in split_names(counts) or () if n.isascii() and n.isdigit())
    value = model_order.compute_reduced_responses(store, query, output, surface, n_modes[:10])
    return respond_with_figure(figures.reduced_responses(value), form)


@router.get("/stabilisation", response_model=Figure)
def draw_stabilisation(
    store: TheStore, responses_id: Id, search: TheModeSearch, form: Form = "json"
) -> Response:
    """Draw the stabilisation diagram: poles by model order, and the mean measured response."""
    value = ground_vibration_test.compute_stabilisation_diagram(store, responses_id, search)
    return respond_with_figure(figures.stabilisation(value), form)
