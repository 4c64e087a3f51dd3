"""Figures of excitation designs."""

from __future__ import annotations

from fastapi import APIRouter
from fastapi.responses import Response

from flexsid import figures
from flexsid.api.context import TheStore
from flexsid.api.export import Form, respond_with_figure
from flexsid.api.routes.designs import Level
from flexsid.api.routes.figures.figure import Figure, Id
from flexsid.workflow.excitation import excitation_designs
from flexsid.workflow.excitation.predicted_accuracy import predict_response

router = APIRouter()


@router.get("/design-history", response_model=Figure)
def draw_design_history(
    store: TheStore, design_id: Id, level: Level = 0, form: Form = "json"
) -> Response:
    """Draw one period of an excitation design."""
    value = excitation_designs.sample_design(store.designs.get(design_id), level)
    return respond_with_figure(figures.design_history(value), form)


@router.get("/design-spectrum", response_model=Figure)
def draw_design_spectrum(
    store: TheStore, design_id: Id, level: Level = 0, form: Form = "json"
) -> Response:
    """Draw the amplitudes of the harmonics of an excitation design, by input."""
    value = excitation_designs.sample_design(store.designs.get(design_id), level)
    return respond_with_figure(figures.design_spectrum(value), form)


@router.get("/design-worth", response_model=Figure)
def draw_design_information(
    store: TheStore, design_id: Id, run_id: Id, level: Level = 0, form: Form = "json"
) -> Response:
    """Draw the information of each harmonic of a design on the parameters of a run."""
    design = store.designs.get(design_id)
    return respond_with_figure(
        figures.design_worth(predict_response(store, design, run_id, level)), form
    )


@router.get("/design-signal", response_model=Figure)
def draw_design_signal(
    store: TheStore, design_id: Id, run_id: Id, level: Level = 0, form: Form = "json"
) -> Response:
    """Draw the expected signal-to-noise ratio by output and harmonic of a design."""
    design = store.designs.get(design_id)
    return respond_with_figure(
        figures.design_signal(predict_response(store, design, run_id, level)), form
    )
