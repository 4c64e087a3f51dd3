"""Ground vibration tests: measured responses, the modes in them, mass orthogonality."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, Literal

from fastapi import APIRouter, Depends, Query, status
from fastapi import Path as InPath
from pydantic import ConfigDict, Field

from flexsid.api.context import TheContext, TheStore
from flexsid.api.requests import Line, Title
from flexsid.api.wire import Identity, Json, Reference
from flexsid.importers.responses import ResponseAnswers, extract_responses
from flexsid.records.modal_table import MeasuredResponses, ModalTable
from flexsid.records.modal_views import FoundModes, Orthogonality
from flexsid.storage.repository import LARGEST_ID
from flexsid.text import LONGEST_FIELD
from flexsid.workflow.modal_data import ground_vibration_test

router = APIRouter(tags=["vibration-tests"])

_STRICT: Any = ConfigDict(extra="forbid")
_UploadId = Annotated[str, InPath(min_length=1, max_length=64, description="Id of the upload.")]
_Id = Annotated[int, Field(strict=True, ge=1, le=LARGEST_ID)]
_Metre = Annotated[float, Field(strict=True, ge=-1e6, le=1e6)]
_Fraction = Annotated[float, Field(strict=True, ge=0.0, le=1.0)]
_Hz = Annotated[float | None, Field(strict=True, gt=0.0, le=100_000.0)]
_Place = Annotated[int, Field(strict=True, ge=0, le=1000)]
_Order = Annotated[int, Field(strict=True, ge=4, le=80)]


@dataclass(frozen=True, slots=True, kw_only=True)
class ResponsesRequest:
    """What an analyst says of measured responses; see ``ResponseAnswers``."""

    aircraft_id: _Id
    name: Title
    response_unit: Literal["m/s2", "g", "in/s2", "ft/s2", "m/s", "in/s", "m", "mm", "in", "ft"]
    force_unit: Literal["N", "lbf"]
    fuel: _Fraction = 0.0
    length_unit: Literal["m", "mm", "in", "ft"] | None = None
    axes: Annotated[str, Field(max_length=60), Line] = "aft right up"
    origin: tuple[_Metre, _Metre, _Metre] = (0.0, 0.0, 0.0)

    __pydantic_config__ = _STRICT


@dataclass(frozen=True, slots=True, kw_only=True)
class FoundModesRequest:
    """Which modes found in responses are to be kept, and under which name."""

    name: Title
    low_hz: _Hz = None
    high_hz: _Hz = None
    order: _Order = 30
    keep: (
        Annotated[
            tuple[Annotated[int, Field(strict=True, ge=0, le=1000)], ...], Field(max_length=500)
        ]
        | None
    ) = None
    like_id: _Id | None = None

    __pydantic_config__ = _STRICT


@dataclass(frozen=True, slots=True, kw_only=True)
class OrthogonalityRequest:
    """Which field of the files is the mass matrix, and whose shapes are taken."""

    modal_table_id: _Id
    field: Annotated[str, Field(min_length=1, max_length=LONGEST_FIELD), Line]
    fuel: _Fraction = 0.5

    __pydantic_config__ = _STRICT


@dataclass(frozen=True, slots=True, kw_only=True)
class MeasuredResponsesList:
    """Sets of measured responses."""

    items: list[MeasuredResponses]
    next: str | None = None


def _mode_search(
    low_hz: Annotated[float | None, Query(gt=0.0, le=100_000.0)] = None,
    high_hz: Annotated[float | None, Query(gt=0.0, le=100_000.0)] = None,
    order: Annotated[int, Query(ge=4, le=80, description="Highest order of the models.")] = 30,
) -> ground_vibration_test.ModeSearch:
    return ground_vibration_test.ModeSearch(low_hz=low_hz, high_hz=high_hz, order=order)


TheModeSearch = Annotated[ground_vibration_test.ModeSearch, Depends(_mode_search)]


@router.post(
    "/uploads/{upload_id}/responses",
    response_model=MeasuredResponses,
    status_code=status.HTTP_201_CREATED,
)
def import_responses(context: TheContext, upload_id: _UploadId, wanted: ResponsesRequest) -> Json:
    """Keep the frequency responses of uploaded files."""
    aircraft = context.store.aircraft.get(wanted.aircraft_id)
    answers = ResponseAnswers(
        name=wanted.name,
        response_unit=wanted.response_unit,
        force_unit=wanted.force_unit,
        fuel=wanted.fuel,
        length_unit=wanted.length_unit,
        axes=wanted.axes,
        origin=wanted.origin,
    )
    raw = extract_responses(context.uploads.sources(upload_id), answers)
    kept = ground_vibration_test.keep_responses(context.store, aircraft, raw)
    return Json(kept, status.HTTP_201_CREATED)


@router.get("/measured-responses", response_model=MeasuredResponsesList)
def list_measured_responses(store: TheStore, aircraft_id: Reference = None) -> Json:
    """List the measured responses of an aircraft or of all."""
    chosen = {} if aircraft_id is None else {"aircraft_id": aircraft_id}
    return Json(MeasuredResponsesList(items=store.measured_responses.find(**chosen)))


@router.get("/measured-responses/{responses_id}", response_model=MeasuredResponses)
def get_measured_responses(store: TheStore, responses_id: Identity) -> Json:
    """Return one set of measured responses."""
    return Json(store.measured_responses.get(responses_id))


@router.get("/measured-responses/{responses_id}/modes", response_model=FoundModes)
def find_modes(store: TheStore, responses_id: Identity, search: TheModeSearch) -> Json:
    """Find the modes in measured responses that are stable over the orders of models."""
    return Json(ground_vibration_test.find_modes(store, responses_id, search))


@router.post(
    "/measured-responses/{responses_id}/modes",
    response_model=ModalTable,
    status_code=status.HTTP_201_CREATED,
)
def keep_found_modes(store: TheStore, responses_id: Identity, wanted: FoundModesRequest) -> Json:
    """Keep the modes found as a table of a GVT, named like those of another table."""
    search = ground_vibration_test.ModeSearch(
        low_hz=wanted.low_hz, high_hz=wanted.high_hz, order=wanted.order
    )
    table = ground_vibration_test.keep_found_modes(
        store, responses_id, search, wanted.name, wanted.keep, wanted.like_id
    )
    return Json(table, status.HTTP_201_CREATED)


@router.post("/uploads/{upload_id}/orthogonality", response_model=Orthogonality)
def check_orthogonality(
    context: TheContext, upload_id: _UploadId, wanted: OrthogonalityRequest
) -> Json:
    """Check the shapes of a table over a mass matrix in an uploaded file."""
    sources = context.uploads.sources(upload_id)
    told = ground_vibration_test.orthogonality(
        context.store, wanted.modal_table_id, wanted.fuel, sources, wanted.field
    )
    return Json(told)
