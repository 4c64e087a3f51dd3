"""Saved views: addresses under names, shared by everybody who uses the workbench."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query, Response, status

from flexsid.api.answers import SavedViewList
from flexsid.api.context import TheStore
from flexsid.api.requests import SavedViewRequest
from flexsid.api.wire import Identity, Json
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
def add_saved_view(store: TheStore, wanted: SavedViewRequest) -> Json:
    """Keep what a page shows under a name; one of the same name is not replaced."""
    return Json(store.saved_views.add(wanted.record()), status.HTTP_201_CREATED)


@router.delete("/{view_id}", status_code=status.HTTP_204_NO_CONTENT)
def delete_saved_view(store: TheStore, view_id: Identity) -> Response:
    """Forget a saved view."""
    store.saved_views.delete(view_id)
    return Response(status_code=status.HTTP_204_NO_CONTENT)
