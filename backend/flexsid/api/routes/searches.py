"""Model structure determination: searches, their progress, and candidates as runs."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime
from typing import Annotated

from fastapi import Path, status
from pydantic import Field

from flexsid.api.analyst import TheAnalyst
from flexsid.api.context import TheContext, TheStore
from flexsid.api.models.requests import Id, Request
from flexsid.api.models.run_requests import StructureRequest
from flexsid.api.models.run_responses import Run, build_run_response
from flexsid.api.router import make_router
from flexsid.api.serialization import Identity, Json, Reference, drop_none
from flexsid.records.run import Method, RunState
from flexsid.records.search import (
    SearchSettings,
    StructureSearch,
)
from flexsid.request_models import body_of
from flexsid.storage import queue
from flexsid.storage.paging import Items
from flexsid.workflow.structure_determination import searches

router = make_router("/searches", tag="searches")

Threshold = Annotated[float, Field(strict=True, gt=0.0, le=1e6, allow_inf_nan=False)]
Index = Annotated[int, Path(ge=0, le=10_000, description="Index of the candidate, from 0.")]


@body_of(SearchSettings)
class SearchSettingsRequest(Request):
    """Criteria and algorithm of the search; see ``SearchSettings``."""


class SearchRequest(Request):
    """Maneuvers of a search, and a structure whose free derivatives are the candidate terms."""

    maneuver_ids: Annotated[tuple[Id, ...], Field(min_length=1, max_length=200)]
    method: Method
    structure: StructureRequest
    settings: SearchSettingsRequest = SearchSettingsRequest()
    modal_table_id: Id | None = None
    damping_table_id: Id | None = None
    prediction_id: Id | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class SearchItem:
    """A search without its result."""

    id: int
    aircraft_id: int
    maneuver_ids: tuple[int, ...]
    method: Method
    modes: tuple[int, ...]
    state: RunState
    sentence: str | None
    author: str
    created_at: datetime | None


@router.post("", response_model=StructureSearch, status_code=status.HTTP_202_ACCEPTED)
def request_search(context: TheContext, body: SearchRequest, analyst: TheAnalyst) -> Json:
    """Queue a model structure determination; ``Location`` is the address of the search."""
    store = context.store
    first = store.maneuvers.get(body.maneuver_ids[0])
    stored = searches.add_search(
        store,
        body.make_record(
            StructureSearch,
            aircraft_id=first.aircraft_id,
            structure=body.structure.to_record(),
            settings=body.settings.make_record(SearchSettings),
            author=analyst,
        ),
    )
    context.dispatcher.wake()
    location = {"Location": f"/api/v1/searches/{stored.id}"}
    return Json(stored, status.HTTP_202_ACCEPTED, location)


@router.get("", response_model=Items[SearchItem])
def list_searches(store: TheStore, aircraft_id: Reference = None) -> Json:
    """List searches, newest first."""
    found = store.searches.find(**drop_none(aircraft_id=aircraft_id))
    return Json(Items(items=[_make_item(one) for one in reversed(found)]))


@router.get("/{search_id}", response_model=StructureSearch)
def get_search(store: TheStore, search_id: Identity) -> Json:
    """Return one search with its progress or result."""
    return Json(store.searches.get(search_id))


@router.post("/{search_id}/cancel", response_model=StructureSearch)
def cancel_search(context: TheContext, search_id: Identity) -> Json:
    """Cancel a search that has not ended."""
    found = context.store.searches.get(search_id)
    if found.job_id is not None:
        queue.request_cancel(context.store, found.job_id)
        context.dispatcher.wake()
    return Json(context.store.searches.get(search_id))


@router.post("/{search_id}/candidates/{index}/run", response_model=Run)
def create_candidate_run(
    context: TheContext, search_id: Identity, index: Index, analyst: TheAnalyst
) -> Json:
    """Return the run of a candidate; it is queued by the first request."""
    run = searches.create_candidate_run(context.store, search_id, index, analyst)
    context.dispatcher.wake()
    return Json(
        build_run_response(context.store, run), headers={"Location": f"/api/v1/runs/{run.id}"}
    )


def _make_item(search: StructureSearch) -> SearchItem:
    assert search.id is not None
    return SearchItem(
        id=search.id,
        aircraft_id=search.aircraft_id,
        maneuver_ids=search.maneuver_ids,
        method=search.method,
        modes=search.structure.modes,
        state=search.state,
        sentence=None if search.result is None else search.result.sentence,
        author=search.author,
        created_at=search.created_at,
    )
