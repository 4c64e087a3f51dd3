"""Figures of searches for a model structure."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query
from fastapi.responses import Response

from flexsid import figures
from flexsid.api.context import TheStore
from flexsid.api.export import Form, sent
from flexsid.api.routes.figures.answer import Figure, Id
from flexsid.workflow.structure_determination import searches

router = APIRouter()
_Group = Annotated[str | None, Query(description="Coefficient (EE) or method; the first.")]


@router.get("/search-path", response_model=Figure)
def draw_search_path(
    store: TheStore, search_id: Id, group: _Group = None, form: Form = "json"
) -> Response:
    """Draw the criteria after every step of a search for structure."""
    return sent(figures.search_path(searches.group_of(store, search_id, group)), form)


@router.get("/search-stability", response_model=Figure)
def draw_search_stability(
    store: TheStore, search_id: Id, group: _Group = None, form: Form = "json"
) -> Response:
    """Draw how often each term is chosen when the lines are drawn anew."""
    return sent(figures.search_stability(searches.group_of(store, search_id, group)), form)
