"""Saved views: named filters of pages, shared by all users of the workbench."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

from fastapi import Query

from flexsid.api.analyst import TheAnalyst, choose_author
from flexsid.api.context import TheStore
from flexsid.api.models.requests import SavedViewRequest
from flexsid.api.router import make_router
from flexsid.api.serialization import Identity, JsonRoute, drop_none
from flexsid.records.saved_view import SavedView
from flexsid.storage.paging import Items

router = make_router("/saved-views", tag="saved views", route_class=JsonRoute)


@router.get("")
def list_saved_views(
    store: TheStore, page: Annotated[str | None, Query(max_length=64)] = None
) -> Items[SavedView]:
    """List saved views, of one page or of all."""
    found = store.saved_views.find(**drop_none(page=page))
    return Items(items=sorted(found, key=lambda view: view.name.casefold()))


@router.post("", status_code=201)
def add_saved_view(store: TheStore, body: SavedViewRequest, analyst: TheAnalyst) -> SavedView:
    """Store the filters of a page under a name; refused if the name is in use."""
    view = body.make_record(SavedView)
    author = choose_author(view.author, analyst)
    return store.saved_views.add(replace(view, author=author))


@router.delete("/{view_id}", status_code=204)
def delete_saved_view(store: TheStore, view_id: Identity) -> None:
    """Delete a saved view."""
    store.saved_views.delete(view_id)
