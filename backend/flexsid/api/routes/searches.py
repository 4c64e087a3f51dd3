"""Searches for model structure: ask for one, follow it, open what it found as runs."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime
from typing import Annotated, Any, Literal

from fastapi import APIRouter, Path, status
from pydantic import ConfigDict, Field

from flexsid.api.analyst import TheAnalyst
from flexsid.api.context import TheContext, TheStore
from flexsid.api.requests import Id
from flexsid.api.run_answers import Run, run_answer
from flexsid.api.run_requests import Frequency, StructureRequest
from flexsid.api.wire import Identity, Json, Reference
from flexsid.records.run import Method, RunState
from flexsid.records.search import (
    Algorithm,
    SearchSettings,
    SearchStart,
    StructureSearch,
)
from flexsid.workflow.structure_determination import searches

router = APIRouter(prefix="/searches", tags=["searches"])

_STRICT: Any = ConfigDict(extra="forbid")
Threshold = Annotated[float, Field(strict=True, gt=0.0, le=1e6, allow_inf_nan=False)]
Place = Annotated[int, Path(ge=0, le=10_000, description="Place among the candidates, from 0.")]


@dataclass(frozen=True, slots=True, kw_only=True)
class SearchSettingsRequest:
    """What a term must show, and how that is tried; see ``SearchSettings``."""

    algorithm: Algorithm = Algorithm.STEPWISE
    begin: SearchStart = SearchStart.ALL
    f_in: Threshold = 20.0
    f_out: Threshold = 20.0
    pse_noise: Threshold = 25.0
    draws: Annotated[int, Field(strict=True, ge=0, le=500)] = 30
    validate_on: Annotated[tuple[Id, ...], Field(max_length=100)] = ()
    band_hz: tuple[Frequency, Frequency] | None = None
    max_iterations: Annotated[int, Field(strict=True, ge=1, le=1000)] = 100
    noise: Literal["diagonal", "full"] = "diagonal"

    __pydantic_config__ = _STRICT

    def record(self) -> SearchSettings:
        """Return what is kept."""
        return SearchSettings(
            algorithm=self.algorithm,
            begin=self.begin,
            f_in=self.f_in,
            f_out=self.f_out,
            pse_noise=self.pse_noise,
            draws=self.draws,
            validate_on=self.validate_on,
            band_hz=self.band_hz,
            max_iterations=self.max_iterations,
            noise=self.noise,
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class SearchRequest:
    """Maneuvers to search over, and a structure whose free derivatives are the candidates."""

    maneuver_ids: Annotated[tuple[Id, ...], Field(min_length=1, max_length=200)]
    method: Method
    structure: StructureRequest
    settings: SearchSettingsRequest = SearchSettingsRequest()
    modal_table_id: Id | None = None
    damping_table_id: Id | None = None
    prediction_id: Id | None = None

    __pydantic_config__ = _STRICT


@dataclass(frozen=True, slots=True, kw_only=True)
class SearchItem:
    """One line of the list: a search without what it found."""

    id: int
    aircraft_id: int
    maneuver_ids: tuple[int, ...]
    method: Method
    modes: tuple[int, ...]
    state: RunState
    sentence: str | None
    author: str
    created_at: datetime | None


@dataclass(frozen=True, slots=True, kw_only=True)
class SearchList:
    """Searches, newest first."""

    items: list[SearchItem]


@router.post("", response_model=StructureSearch, status_code=status.HTTP_202_ACCEPTED)
def request_search(context: TheContext, wanted: SearchRequest, analyst: TheAnalyst) -> Json:
    """Queue a search for the terms of a model; follow it at the answer's ``Location``."""
    store = context.store
    first = store.maneuvers.get(wanted.maneuver_ids[0])
    kept = searches.add_search(
        store,
        StructureSearch(
            aircraft_id=first.aircraft_id,
            maneuver_ids=wanted.maneuver_ids,
            method=wanted.method,
            structure=wanted.structure.record(),
            settings=wanted.settings.record(),
            modal_table_id=wanted.modal_table_id,
            damping_table_id=wanted.damping_table_id,
            prediction_id=wanted.prediction_id,
            author=analyst,
        ),
    )
    context.searches.begin(kept)
    location = {"Location": f"/api/v1/searches/{kept.id}"}
    return Json(kept, status.HTTP_202_ACCEPTED, location)


@router.get("", response_model=SearchList)
def list_searches(store: TheStore, aircraft_id: Reference = None) -> Json:
    """List searches, newest first."""
    chosen = {} if aircraft_id is None else {"aircraft_id": aircraft_id}
    found = store.searches.find(**chosen)
    return Json(SearchList(items=[_line(one) for one in reversed(found)]))


@router.get("/{search_id}", response_model=StructureSearch)
def get_search(store: TheStore, search_id: Identity) -> Json:
    """Return one search: how far it is, or all that it found."""
    return Json(store.searches.get(search_id))


@router.post("/{search_id}/cancel", response_model=StructureSearch)
def cancel_search(store: TheStore, search_id: Identity) -> Json:
    """Stop a search that has not ended."""
    return Json(searches.cancel_search(store, search_id))


@router.post("/{search_id}/candidates/{place}/run", response_model=Run)
def open_candidate(
    context: TheContext, search_id: Identity, place: Place, analyst: TheAnalyst
) -> Json:
    """Open a candidate as a run; it is queued when first opened, and the same ever after."""
    run = searches.open_as_run(context.store, search_id, place, analyst)
    context.dispatcher.wake()
    return Json(run_answer(context.store, run), headers={"Location": f"/api/v1/runs/{run.id}"})


def _line(found: StructureSearch) -> SearchItem:
    assert found.id is not None
    return SearchItem(
        id=found.id,
        aircraft_id=found.aircraft_id,
        maneuver_ids=found.maneuver_ids,
        method=found.method,
        modes=found.structure.modes,
        state=found.state,
        sentence=None if found.result is None else found.result.sentence,
        author=found.author,
        created_at=found.created_at,
    )
