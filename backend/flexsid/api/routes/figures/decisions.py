"""Frozen figures of decisions."""

from __future__ import annotations

from fastapi import APIRouter
from fastapi.responses import Response

from flexsid.api.context import TheStore
from flexsid.api.export import Form, respond_with_figure
from flexsid.api.routes.figures.figure import Figure, Id
from flexsid.workflow.review.audit import read_figure

router = APIRouter()


@router.get("/frozen", response_model=Figure)
def draw_frozen(store: TheStore, figure_id: Id, form: Form = "json") -> Response:
    """Draw a frozen figure in its stored state."""
    return respond_with_figure(read_figure(store, store.frozen_figures.get(figure_id)), form)
