"""Modal data and flutter summaries from uploaded files."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Annotated, Any, Literal

from fastapi import APIRouter, status
from fastapi import Path as InPath
from pydantic import ConfigDict, Field, StrictBool

from flexsid.api.context import TheContext, TheStore
from flexsid.api.requests import Line, Title
from flexsid.api.responses import FlutterSummaryList
from flexsid.api.serialization import Identity, Json, Reference
from flexsid.importers.modal_data import (
    ModalDataOptions,
    ModalFiles,
    extract_modal_data,
    inspect_modal_data,
)
from flexsid.records.modal_table import FlutterSummary, ModalKind, ModalTable
from flexsid.storage.repository import LARGEST_ID
from flexsid.workflow.flutter.flutter_summary import add_warning, save_flutter_summary
from flexsid.workflow.modal_data.modal_import import store_modal_data

router = APIRouter(tags=["modal-data"])

_STRICT: Any = ConfigDict(extra="forbid")
_UploadId = Annotated[str, InPath(min_length=1, max_length=64, description="Id of the upload.")]
_AircraftId = Annotated[int, Field(strict=True, ge=1, le=LARGEST_ID)]
_Fraction = Annotated[float, Field(strict=True, ge=0.0, le=1.0)]
_Node = Annotated[int, Field(strict=True, ge=0, le=LARGEST_ID)]
_Metre = Annotated[float, Field(strict=True, ge=-1e6, le=1e6)]


@dataclass(frozen=True, slots=True, kw_only=True)
class ModalDataRequest:
    """Units, axes and fuel fractions of uploaded modal data; see ``ModalDataOptions``."""

    aircraft_id: _AircraftId
    name: Title
    kind: ModalKind = ModalKind.FEM
    length_unit: Literal["m", "mm", "in", "ft"] | None = None
    mass_unit: Literal["kg", "t", "lb", "slug", "slinch"] | None = None
    generalized_mass: Literal["file", "unit", "unknown"] | None = None
    axes: Annotated[str, Field(max_length=60), Line] = "aft right up"
    origin: tuple[_Metre, _Metre, _Metre] = (0.0, 0.0, 0.0)
    fuel: Annotated[dict[Title, _Fraction], Field(max_length=200)] = field(default_factory=dict)
    rigid_modes: StrictBool = False
    points: Annotated[dict[Title, _Node], Field(max_length=1000)] = field(default_factory=dict)

    __pydantic_config__ = _STRICT

    def to_options(self) -> ModalDataOptions:
        """Return the settings of the import."""
        return ModalDataOptions(
            name=self.name,
            kind=self.kind,
            length_unit=self.length_unit,
            mass_unit=self.mass_unit,
            generalized_mass=self.generalized_mass,
            axes=self.axes,
            origin=self.origin,
            fuel=self.fuel,
            rigid_modes=self.rigid_modes,
            points=self.points,
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class FlutterSummaryRequest:
    """Name of a flutter summary, and unit of its velocities."""

    aircraft_id: _AircraftId
    name: Title
    speed_unit: Literal["m/s", "ft/s", "in/s", "kt", "km/h"]

    __pydantic_config__ = _STRICT


@router.get("/uploads/{upload_id}/structure", response_model=ModalFiles)
def inspect_modal_files(context: TheContext, upload_id: _UploadId) -> Json:
    """Return the modes in the files of an upload, and the information missing for an import."""
    return Json(inspect_modal_data(context.uploads.sources(upload_id)))


@router.post(
    "/uploads/{upload_id}/structure",
    response_model=ModalTable,
    status_code=status.HTTP_201_CREATED,
)
def import_modal_data(context: TheContext, upload_id: _UploadId, body: ModalDataRequest) -> Json:
    """Import the modes of uploaded files as a modal table, as a new version of its name."""
    aircraft = context.store.aircraft.get(body.aircraft_id)
    raw = extract_modal_data(context.uploads.sources(upload_id), body.to_options())
    return Json(store_modal_data(context.store, aircraft, raw), status.HTTP_201_CREATED)


@router.post(
    "/uploads/{upload_id}/flutter-summary",
    response_model=FlutterSummary,
    status_code=status.HTTP_201_CREATED,
)
def import_flutter_summary(
    context: TheContext, upload_id: _UploadId, body: FlutterSummaryRequest
) -> Json:
    """Import the flutter summary of an uploaded printout, with its flutter speeds."""
    aircraft = context.store.aircraft.get(body.aircraft_id)
    sources = context.uploads.sources(upload_id)
    stored = save_flutter_summary(context.store, aircraft, sources, body.name, body.speed_unit)
    return Json(stored, status.HTTP_201_CREATED)


@router.get("/flutter-summaries", response_model=FlutterSummaryList)
def list_flutter_summaries(store: TheStore, aircraft_id: Reference = None) -> Json:
    """List the flutter summaries of one aircraft, or of all."""
    filters = {} if aircraft_id is None else {"aircraft_id": aircraft_id}
    found = [add_warning(summary) for summary in store.flutter_summaries.find(**filters)]
    return Json(FlutterSummaryList(items=found))


@router.get("/flutter-summaries/{summary_id}", response_model=FlutterSummary)
def get_flutter_summary(store: TheStore, summary_id: Identity) -> Json:
    """Return one flutter summary."""
    return Json(add_warning(store.flutter_summaries.get(summary_id)))
