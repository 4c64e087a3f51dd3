"""Model structures shared by runs, and the searches that determine them."""

from __future__ import annotations

import re
from dataclasses import dataclass
from datetime import datetime
from typing import Annotated

from fastapi import Header, Path, status
from pydantic import Field

from flexsid.api.authorization import TheAnalyst
from flexsid.api.context import TheContext, TheStore
from flexsid.api.errors import Problem
from flexsid.api.models.requests import Id, Request
from flexsid.api.models.responses import StaleStructure
from flexsid.api.models.runs import (
    ModelStructureRequest,
    Run,
    StructureEditRequest,
    StructureRequest,
    build_run_response,
)
from flexsid.api.router import make_router
from flexsid.api.serialization import Identity, Json, JsonRoute, Reference, drop_none
from flexsid.errors import BadInput
from flexsid.records.decision import ModelStructure, StructureVersion
from flexsid.records.run import Method, RunState
from flexsid.records.search import SearchSettings, StructureSearch
from flexsid.request_models import body_of
from flexsid.storage.jobs import queue
from flexsid.storage.lists.list_query import Items, Page
from flexsid.workflow.model_structures import model_structures
from flexsid.workflow.structure_determination import searches

# --- Model structures shared by runs; each edit is a new version ----------------------------------

model_structures_router = make_router(
    "/model-structures", tag="model-structures", route_class=JsonRoute
)

Version = Annotated[int, Path(ge=1, le=2**31 - 1, description="Version of the record.")]
IfMatch = Annotated[str | None, Header(description='Version that was edited, e.g. `"3"`.')]


@model_structures_router.get("")
def list_model_structures(store: TheStore, aircraft_id: Reference = None) -> Page[ModelStructure]:
    """List the newest versions of the model structures of one aircraft, or of all."""
    return Page(items=store.model_structures.find(**drop_none(aircraft_id=aircraft_id)))


@model_structures_router.get("/{structure_id}", response_model=ModelStructure)
def get_model_structure(store: TheStore, structure_id: Identity) -> Json:
    """Return the newest version of one model structure; its number is the ``ETag``."""
    return _respond_with_etag(store.model_structures.get(structure_id))


@model_structures_router.get("/{structure_id}/versions")
def list_structure_versions(store: TheStore, structure_id: Identity) -> Items[StructureVersion]:
    """List every version of one model structure, oldest first."""
    store.model_structures.get(structure_id)
    found = store.structure_versions.find(structure_id=structure_id)
    return Items(items=found)


@model_structures_router.get("/{structure_id}/versions/{version}")
def get_structure_version(
    store: TheStore, structure_id: Identity, version: Version
) -> StructureVersion:
    """Return one version of one model structure."""
    return model_structures.get_version(store, structure_id, version)


@model_structures_router.post("", response_model=ModelStructure, status_code=201)
def add_model_structure(store: TheStore, body: ModelStructureRequest, analyst: TheAnalyst) -> Json:
    """Store a model structure under a name."""
    structure = body.structure.to_record()
    record = body.make_record(ModelStructure, structure=structure, author=analyst)
    return _respond_with_etag(model_structures.add_structure(store, record), 201)


@model_structures_router.put(
    "/{structure_id}",
    response_model=ModelStructure,
    responses={409: {"model": StaleStructure | Problem}},
)
def edit_model_structure(
    store: TheStore,
    structure_id: Identity,
    body: StructureEditRequest,
    analyst: TheAnalyst,
    if_match: IfMatch = None,
) -> Json:
    """Store a new version; refused (409, with both versions) if the edited one is outdated."""
    edited = model_structures.edit_structure(
        store,
        structure_id,
        read_edited_version(body.version, if_match),
        name=body.name,
        structure=body.structure.to_record(),
        note=body.note,
        author=analyst,
    )
    return _respond_with_etag(edited)


def read_edited_version(in_body: int | None, if_match: str | None) -> int:
    """Return the edited version, from the body or the header ``If-Match``.

    Raises
    ------
    BadInput
        If neither is given, or both are given and differ.
    """
    found = None
    if if_match is not None:
        match = re.fullmatch(r'(?:W/)?"?([0-9]{1,9})"?', if_match.strip())
        if match is None:
            raise BadInput(
                f'If-Match is {if_match!r}; expected the version that was edited, e.g. "3"',
                code="bad-version",
            )
        found = int(match[1])
    versions = {version for version in (in_body, found) if version is not None}
    if len(versions) != 1:
        raise BadInput(
            "the edited version is missing or ambiguous; give it as version or as If-Match",
            code="bad-version",
        )
    return versions.pop()


def _respond_with_etag(record: ModelStructure, code: int = 200) -> Json:
    headers = {"ETag": f'"{record.version}"'}
    if code == 201:
        headers["Location"] = f"/api/v1/model-structures/{record.id}"
    return Json(record, code, headers)


# --- Model structure determination: searches, their progress, and candidates as runs --------------

searches_router = make_router("/searches", tag="searches")

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


@searches_router.post("", response_model=StructureSearch, status_code=status.HTTP_202_ACCEPTED)
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


@searches_router.get("", response_model=Items[SearchItem])
def list_searches(store: TheStore, aircraft_id: Reference = None) -> Json:
    """List searches, newest first."""
    found = store.searches.find(**drop_none(aircraft_id=aircraft_id))
    return Json(Items(items=[_make_item(one) for one in reversed(found)]))


@searches_router.get("/{search_id}", response_model=StructureSearch)
def get_search(store: TheStore, search_id: Identity) -> Json:
    """Return one search with its progress or result."""
    return Json(store.searches.get(search_id))


@searches_router.post("/{search_id}/cancel", response_model=StructureSearch)
def cancel_search(context: TheContext, search_id: Identity) -> Json:
    """Cancel a search that has not ended."""
    found = context.store.searches.get(search_id)
    if found.job_id is not None:
        queue.request_cancel(context.store, found.job_id)
        context.dispatcher.wake()
    return Json(context.store.searches.get(search_id))


@searches_router.post("/{search_id}/candidates/{index}/run", response_model=Run)
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
