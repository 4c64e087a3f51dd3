"""Notes on maneuvers, runs, modes and derivatives, and saved views."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

from fastapi import Query, Response

from flexsid.api.authorization import NamedAnalyst, TheAnalyst, choose_author
from flexsid.api.context import TheStore
from flexsid.api.models.decisions import NoteEditRequest, NoteRequest
from flexsid.api.models.requests import SavedViewRequest
from flexsid.api.router import make_router
from flexsid.api.serialization import Identity, Json, JsonRoute, Reference, drop_none
from flexsid.errors import BadInput
from flexsid.records.note import Note, SavedView
from flexsid.storage.lists.list_query import Items
from flexsid.workflow.review import notes as workflow

# --- Notes on maneuvers, runs, modes and derivatives ----------------------------------------------

notes_router = make_router("/notes", tag="notes", route_class=JsonRoute)


@notes_router.get("")
def list_notes(
    store: TheStore,
    aircraft_id: Reference = None,
    maneuver_id: Reference = None,
    run_id: Reference = None,
) -> Items[Note]:
    """List notes of a campaign, a maneuver or a run (its maneuver, modes, derivatives included)."""
    if [aircraft_id, maneuver_id, run_id].count(None) < 2:
        raise BadInput("give one of aircraft_id, maneuver_id and run_id, not several")
    found = workflow.list_notes(
        store, aircraft_id=aircraft_id, maneuver_id=maneuver_id, run_id=run_id
    )
    return Items(items=found)


@notes_router.post("", response_model=Note, status_code=201)
def add_note(store: TheStore, body: NoteRequest, analyst: NamedAnalyst) -> Json:
    """Add a note in Markdown."""
    stored = workflow.add_note(
        store, body.subject, body.key, body.text, analyst, aircraft_id=body.aircraft_id
    )
    return Json(stored, 201, {"Location": f"/api/v1/notes/{stored.id}"})


@notes_router.get("/{note_id}")
def get_note(store: TheStore, note_id: Identity) -> Note:
    """Return a note with all its revisions, also if it is deleted."""
    return workflow.get_note(store, note_id)


@notes_router.put("/{note_id}")
def edit_note(
    store: TheStore, note_id: Identity, body: NoteEditRequest, analyst: NamedAnalyst
) -> Note:
    """Store a new revision of a note of one's own; earlier ones remain."""
    return workflow.edit_note(store, note_id, body.revision, body.text, analyst)


@notes_router.delete("/{note_id}", status_code=204)
def delete_note(
    store: TheStore,
    note_id: Identity,
    analyst: NamedAnalyst,
    revision: Annotated[int, Query(ge=1, le=2**31 - 1, description="Revision that was read.")],
) -> Response:
    """Mark a note of one's own as deleted; its revisions remain readable."""
    workflow.delete_note(store, note_id, revision, analyst)
    return Response(status_code=204)


# --- Saved views: named filters of pages, shared by all users of the workbench --------------------

saved_views_router = make_router("/saved-views", tag="saved views", route_class=JsonRoute)


@saved_views_router.get("")
def list_saved_views(
    store: TheStore, page: Annotated[str | None, Query(max_length=64)] = None
) -> Items[SavedView]:
    """List saved views, of one page or of all."""
    found = store.saved_views.find(**drop_none(page=page))
    return Items(items=sorted(found, key=lambda view: view.name.casefold()))


@saved_views_router.post("", status_code=201)
def add_saved_view(store: TheStore, body: SavedViewRequest, analyst: TheAnalyst) -> SavedView:
    """Store the filters of a page under a name; refused if the name is in use."""
    view = body.make_record(SavedView)
    author = choose_author(view.author, analyst)
    return store.saved_views.add(replace(view, author=author))


@saved_views_router.delete("/{view_id}", status_code=204)
def delete_saved_view(store: TheStore, view_id: Identity) -> None:
    """Delete a saved view."""
    store.saved_views.delete(view_id)
