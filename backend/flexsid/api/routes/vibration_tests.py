"""Ground vibration tests: measured frequency responses, modal identification, orthogonality."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, Literal

from fastapi import APIRouter, Depends, Query, status
from fastapi import Path as InPath
from pydantic import ConfigDict, Field

from flexsid.api.context import TheContext, TheStore
from flexsid.api.requests import Line, Title
from flexsid.api.serialization import Identity, Json, Reference
from flexsid.importers.responses import ResponseOptions, extract_responses
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
    """Units, axes and fuel fraction of measured frequency responses; see ``ResponseOptions``."""

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
class IdentifiedModesRequest:
    """Identified modes to store, and the name of their modal table."""

    name: Title
    low_hz: _Hz = None
    high_hz: _Hz = None
    order: _Order = 30
    selected: (
        Annotated[
            tuple[Annotated[int, Field(strict=True, ge=0, le=1000)], ...], Field(max_length=500)
        ]
        | None
    ) = None
    template_id: _Id | None = None

    __pydantic_config__ = _STRICT


@dataclass(frozen=True, slots=True, kw_only=True)
class OrthogonalityRequest:
    """Field of the mass matrix in the files, and modal table of the shapes."""

    modal_table_id: _Id
    field: Annotated[str, Field(min_length=1, max_length=LONGEST_FIELD), Line]
    fuel: _Fraction = 0.5

    __pydantic_config__ = _STRICT


@dataclass(frozen=True, slots=True, kw_only=True)
class MeasuredResponsesList:
    """Sets of measured frequency responses."""

    items: list[MeasuredResponses]
    next: str | None = None


def _read_mode_search(
    low_hz: Annotated[float | None, Query(gt=0.0, le=100_000.0)] = None,
    high_hz: Annotated[float | None, Query(gt=0.0, le=100_000.0)] = None,
    order: Annotated[int, Query(ge=4, le=80, description="Highest model order.")] = 30,
) -> ground_vibration_test.ModeSearch:
    return ground_vibration_test.ModeSearch(low_hz=low_hz, high_hz=high_hz, order=order)


TheModeSearch = Annotated[ground_vibration_test.ModeSearch, Depends(_read_mode_search)]


@router.post(
    "/uploads/{upload_id}/responses",
    response_model=MeasuredResponses,
    status_code=status.HTTP_201_CREATED,
)
def import_responses(context: TheContext, upload_id: _UploadId, body: ResponsesRequest) -> Json:
    """Import the frequency responses of uploaded files."""
    aircraft = context.store.aircraft.get(body.aircraft_id)
    settings = ResponseOptions(
        name=body.name,
        response_unit=body.response_unit,
        force_unit=body.force_unit,
        fuel=body.fuel,
        length_unit=body.length_unit,
        axes=body.axes,
        origin=body.origin,
    )
    raw = extract_responses(context.uploads.sources(upload_id), settings)
    stored = ground_vibration_test.store_responses(context.store, aircraft, raw)
    return Json(stored, status.HTTP_201_CREATED)


@router.get("/measured-responses", response_model=MeasuredResponsesList)
def list_measured_responses(store: TheStore, aircraft_id: Reference = None) -> Json:
    """List the measured frequency responses of one aircraft, or of all."""
    filters = {} if aircraft_id is None else {"aircraft_id": aircraft_id}
    return Json(MeasuredResponsesList(items=store.measured_responses.find(**filters)))


@router.get("/measured-responses/{responses_id}", response_model=MeasuredResponses)
def get_measured_responses(store: TheStore, responses_id: Identity) -> Json:
    """Return one set of measured frequency responses."""
    return Json(store.measured_responses.get(responses_id))


@router.get("/measured-responses/{responses_id}/modes", response_model=FoundModes)
def identify_modes(store: TheStore, responses_id: Identity, search: TheModeSearch) -> Json:
    """Identify modes from measured frequency responses; stable over the model order."""
    return Json(ground_vibration_test.find_modes(store, responses_id, search))


@router.post(
    "/measured-responses/{responses_id}/modes",
    response_model=ModalTable,
    status_code=status.HTTP_201_CREATED,
)
def save_identified_modes(
    store: TheStore, responses_id: Identity, body: IdentifiedModesRequest
) -> Json:
    """Store identified modes as a GVT modal table, with the mode names of another table (MAC)."""
    search = ground_vibration_test.ModeSearch(
        low_hz=body.low_hz, high_hz=body.high_hz, order=body.order
    )
    table = ground_vibration_test.store_found_modes(
        store, responses_id, search, body.name, body.selected, body.template_id
    )
    return Json(table, status.HTTP_201_CREATED)


@router.post("/uploads/{upload_id}/orthogonality", response_model=Orthogonality)
def check_orthogonality(
    context: TheContext, upload_id: _UploadId, body: OrthogonalityRequest
) -> Json:
    """Check the orthogonality of mode shapes with a mass matrix of an uploaded file."""
    sources = context.uploads.sources(upload_id)
    orthogonality = ground_vibration_test.compute_orthogonality(
        context.store, body.modal_table_id, body.fuel, sources, body.field
    )
    return Json(orthogonality)
