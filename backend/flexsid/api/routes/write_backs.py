"""Write-backs: the posterior of a run as new versions of modal table and prediction."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from flexsid.api.authorization import TheAnalyst
from flexsid.api.context import TheStore
from flexsid.api.models.requests import Id, Lines, Request
from flexsid.api.router import make_router
from flexsid.api.serialization import (
    Identity,
    JsonRoute,
    Reference,
    RequiredReference,
    drop_none,
)
from flexsid.records.write_back import WriteBack, WriteBackProposal
from flexsid.storage.lists.list_query import Items
from flexsid.text import LONGEST_NOTE
from flexsid.workflow.runs import write_backs

router = make_router("/write-backs", tag="modal-tables", route_class=JsonRoute)


class WriteBackRequest(Request):
    """The run whose posterior is written back, and the reason of the person who decides."""

    run_id: Id
    reason: Annotated[str, Field(min_length=1, max_length=LONGEST_NOTE), Lines]


@router.get("")
def list_write_backs(store: TheStore, aircraft_id: Reference = None) -> Items[WriteBack]:
    """List the write-backs, including undone ones, newest first."""
    return Items(items=store.write_backs.find(**drop_none(aircraft_id=aircraft_id))[::-1])


@router.get("/proposal")
def propose_write_back(store: TheStore, run_id: RequiredReference) -> WriteBackProposal:
    """Return what a write-back of a run would write: every parameter before and after."""
    return write_backs.propose_write_back(store, run_id)


@router.post("", status_code=201)
def add_write_back(store: TheStore, body: WriteBackRequest, analyst: TheAnalyst) -> WriteBack:
    """Write the posterior of a run back, as new versions of its modal table and prediction.

    The former versions stay. Runs of other maneuvers have the new versions by default, with the
    joint posterior as prior; those of the same maneuvers do not: their data would count twice.
    """
    return write_backs.write_back(store, body.run_id, body.reason, analyst)


@router.delete("/{write_back_id}")
def undo_write_back(store: TheStore, write_back_id: Identity, analyst: TheAnalyst) -> WriteBack:
    """Undo a write-back: the former versions are the default again. Nothing is deleted."""
    return write_backs.undo_write_back(store, write_back_id, analyst)
