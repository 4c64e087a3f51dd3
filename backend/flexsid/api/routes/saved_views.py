"""Saved views: named filters of pages, shared by all users of the workbench."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query, Response, status

from flexsid.api.context import TheStore
from flexsid.api.requests import SavedViewRequest
from flexsid.api.responses import SavedViewList
from flexsid.api.serialization import Identity, Json
from flexsid.records.saved_view import SavedView

router = APIRouter(prefix="/saved-views", tags=["saved views"])


@router.get("", response_model=SavedViewList)
def list_saved_views(
    store: TheStore, page: Annotated[str | None, Query(max_length=64)] = None
) -> Json:
    """List saved views, of one page or of all."""
    found = store.saved_views.find() if page is None else store.saved_views.find(page=page)
    return Json(SavedViewList(items=sorted(found, key=lambda view: view.name.casefold())))


@router.post("", response_model=SavedView, status_code=status.HTTP_201_CREATED)
def add_saved_view(store: TheStore, body: SavedViewRequest) -> Json:
    """Store the filters of a page under a name; refused if the name is in use."""
    return Json(store.saved_views.add(body.to_record()), status.HTTP_201_CREATED)


@router.delete("/{view_id}", status_code=status.HTTP_204_NO_CONTENT)
def delete_saved_view(store: TheStore, view_id: Identity) -> Response:
    """Delete a saved view."""
    store.saved_views.delete(view_id)
    return Response(status_code=status.HTTP_204_NO_CONTENT)
