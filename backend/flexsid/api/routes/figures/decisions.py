"""Figures as they were decided upon."""

from __future__ import annotations

from fastapi import APIRouter
from fastapi.responses import Response

from flexsid.api.context import TheStore
from flexsid.api.export import Form, sent
from flexsid.api.routes.figures.answer import Figure, Id
from flexsid.workflow.review.audit import figure_spec

router = APIRouter()


@router.get("/frozen", response_model=Figure)
def draw_frozen(store: TheStore, figure_id: Id, form: Form = "json") -> Response:
    """Draw a figure as it was when it was frozen for a decision."""
    return sent(figure_spec(store, store.frozen_figures.get(figure_id)), form)
