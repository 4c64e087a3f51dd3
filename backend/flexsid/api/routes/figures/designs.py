"""Figures of designed excitations."""

from __future__ import annotations

from fastapi import APIRouter
from fastapi.responses import Response

from flexsid import figures
from flexsid.api.context import TheStore
from flexsid.api.export import Form, sent
from flexsid.api.routes.designs import Level
from flexsid.api.routes.figures.answer import Figure, Id
from flexsid.workflow.excitation import excitation_designs
from flexsid.workflow.excitation.predicted_accuracy import expected_response

router = APIRouter()


@router.get("/design-history", response_model=Figure)
def draw_design_history(
    store: TheStore, design_id: Id, level: Level = 0, form: Form = "json"
) -> Response:
    """Draw one period of a designed excitation."""
    value = excitation_designs.designed(store.designs.get(design_id), level)
    return sent(figures.design_history(value), form)


@router.get("/design-spectrum", response_model=Figure)
def draw_design_spectrum(
    store: TheStore, design_id: Id, level: Level = 0, form: Form = "json"
) -> Response:
    """Draw the lines of a designed excitation by the input that owns them."""
    value = excitation_designs.designed(store.designs.get(design_id), level)
    return sent(figures.design_spectrum(value), form)


@router.get("/design-worth", response_model=Figure)
def draw_design_worth(
    store: TheStore, design_id: Id, run_id: Id, level: Level = 0, form: Form = "json"
) -> Response:
    """Draw what each line of a design is worth for the parameters of a run."""
    design = store.designs.get(design_id)
    return sent(figures.design_worth(expected_response(store, design, run_id, level)), form)


@router.get("/design-signal", response_model=Figure)
def draw_design_signal(
    store: TheStore, design_id: Id, run_id: Id, level: Level = 0, form: Form = "json"
) -> Response:
    """Draw each output's expected signal over noise at each line of a design."""
    design = store.designs.get(design_id)
    return sent(figures.design_signal(expected_response(store, design, run_id, level)), form)
