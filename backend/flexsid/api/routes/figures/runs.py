"""Figures of one estimation run: its fit, what is left over, its poles."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query
from fastapi.responses import Response

from flexsid import figures
from flexsid.api.context import TheStore
from flexsid.api.export import Form, sent
from flexsid.api.routes.figures.answer import Figure, Id, Names
from flexsid.api.wire import split_ids, split_names
from flexsid.storage.repository import LARGEST_ID
from flexsid.workflow import views

router = APIRouter()
_Block = Annotated[str | None, Query(description="Block of lines; the run's first by default.")]


@router.get("/fit", response_model=Figure)
def draw_fit(
    store: TheStore, run_id: Id, output: Names = None, block: _Block = None, form: Form = "json"
) -> Response:
    """Draw fitted over measured lines."""
    return sent(figures.fit(views.fit(store, run_id, split_names(output) or (), block)), form)


@router.get("/residual", response_model=Figure)
def draw_residual(
    store: TheStore, run_id: Id, block: _Block = None, form: Form = "json"
) -> Response:
    """Draw what the model left over, per output and frequency."""
    return sent(figures.residual(views.residual(store, run_id, block)), form)


@router.get("/parameter-correlation", response_model=Figure)
def draw_parameter_correlation(store: TheStore, run_id: Id, form: Form = "json") -> Response:
    """Draw how the estimates depend on each other."""
    return sent(figures.parameter_correlation(views.parameter_correlation(store, run_id)), form)


@router.get("/poles", response_model=Figure)
def draw_poles(
    store: TheStore,
    run_id: Annotated[str, Query(description="Ids of runs, separated by commas.")],
    form: Form = "json",
) -> Response:
    """Draw the poles of identified models beside those of the first one's modes in vacuo."""
    return sent(figures.poles(views.poles(store, split_ids(run_id, "run_id"))), form)


@router.get("/iterations", response_model=Figure)
def draw_iterations(store: TheStore, run_id: Id, form: Form = "json") -> Response:
    """Draw how the cost fell."""
    return sent(figures.iterations(views.iterations(store, run_id)), form)


@router.get("/time-check", response_model=Figure)
def draw_time_check(
    store: TheStore,
    run_id: Id,
    outputs: Names = None,
    maneuver_id: Annotated[int | None, Query(ge=1, le=LARGEST_ID)] = None,
    points: Annotated[int, Query(ge=100, le=20_000)] = views.POINTS,
    form: Form = "json",
) -> Response:
    """Draw recorded outputs and what the identified model makes of the recorded inputs."""
    chosen = split_names(outputs) or ()
    return sent(
        figures.time_check(views.time_check(store, run_id, chosen, maneuver_id, points)), form
    )
