"""Figures of model structure determination."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query
from fastapi.responses import Response

from flexsid import figures
from flexsid.api.context import TheStore
from flexsid.api.export import Form, respond_with_figure
from flexsid.api.routes.figures.figure import Figure, Id
from flexsid.workflow.structure_determination import searches

router = APIRouter()
_Group = Annotated[
    str | None, Query(description="Coefficient (EE) or method; by default the first.")
]


@router.get("/search-path", response_model=Figure)
def draw_search_path(
    store: TheStore, search_id: Id, group: _Group = None, form: Form = "json"
) -> Response:
    """Draw the criteria after every step of a search."""
    return respond_with_figure(
        figures.search_path(searches.get_group(store, search_id, group)), form
    )


@router.get("/search-stability", response_model=Figure)
def draw_search_stability(
    store: TheStore, search_id: Id, group: _Group = None, form: Form = "json"
) -> Response:
    """Draw the frequency of selection of each term in bootstrap samples."""
    return respond_with_figure(
        figures.search_stability(searches.get_group(store, search_id, group)), form
    )
