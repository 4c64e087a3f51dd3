"""Notes on maneuvers, runs, modes and derivatives."""

from __future__ import annotations

from typing import Annotated

from fastapi import Query, Response

from flexsid.api.analyst import NamedAnalyst
from flexsid.api.context import TheStore
from flexsid.api.models.decision_requests import NoteEditRequest, NoteRequest
from flexsid.api.router import make_router
from flexsid.api.serialization import Identity, Json, JsonRoute, Reference
from flexsid.errors import BadInput
from flexsid.records.note import Note
from flexsid.storage.paging import Items
from flexsid.workflow.review import notes as workflow

router = make_router("/notes", tag="notes", route_class=JsonRoute)


@router.get("")
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


@router.post("", response_model=Note, status_code=201)
def add_note(store: TheStore, body: NoteRequest, analyst: NamedAnalyst) -> Json:
    """Add a note in Markdown."""
    stored = workflow.add_note(
        store, body.subject, body.key, body.text, analyst, aircraft_id=body.aircraft_id
    )
    return Json(stored, 201, {"Location": f"/api/v1/notes/{stored.id}"})


@router.get("/{note_id}")
def get_note(store: TheStore, note_id: Identity) -> Note:
    """Return a note with all its revisions, also if it is deleted."""
    return workflow.get_note(store, note_id)


@router.put("/{note_id}")
def edit_note(
    store: TheStore, note_id: Identity, body: NoteEditRequest, analyst: NamedAnalyst
) -> Note:
    """Store a new revision of a note of one's own; earlier ones remain."""
    return workflow.edit_note(store, note_id, body.revision, body.text, analyst)


@router.delete("/{note_id}", status_code=204)
def delete_note(
    store: TheStore,
    note_id: Identity,
    analyst: NamedAnalyst,
    revision: Annotated[int, Query(ge=1, le=2**31 - 1, description="Revision that was read.")],
) -> Response:
    """Mark a note of one's own as deleted; its revisions remain readable."""
    workflow.delete_note(store, note_id, revision, analyst)
    return Response(status_code=204)
