"""Structures out of uploaded files: what they hold, what is asked, and what is kept."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Annotated, Any, Literal

from fastapi import APIRouter, status
from fastapi import Path as InPath
from pydantic import ConfigDict, Field, StrictBool

from flexsid.api.answers import FlutterSummaryList
from flexsid.api.context import TheContext, TheStore
from flexsid.api.requests import Line, Title
from flexsid.api.wire import Identity, Json, Reference
from flexsid.importers.modal_data import (
    ModalFiles,
    StructureAnswers,
    extract_structure,
    look_at_structure,
)
from flexsid.records.modal_table import FlutterSummary, ModalKind, ModalTable
from flexsid.storage.repository import LARGEST_ID
from flexsid.workflow.flutter.flutter_summary import keep_flutter_summary, with_warning
from flexsid.workflow.modal_data.modal_import import keep_structure

router = APIRouter(tags=["structures"])

_STRICT: Any = ConfigDict(extra="forbid")
_UploadId = Annotated[str, InPath(min_length=1, max_length=64, description="Id of the upload.")]
_AircraftId = Annotated[int, Field(strict=True, ge=1, le=LARGEST_ID)]
_Fraction = Annotated[float, Field(strict=True, ge=0.0, le=1.0)]
_Node = Annotated[int, Field(strict=True, ge=0, le=LARGEST_ID)]
_Metre = Annotated[float, Field(strict=True, ge=-1e6, le=1e6)]


@dataclass(frozen=True, slots=True, kw_only=True)
class StructureFilesRequest:
    """What an analyst says of uploaded files; see ``StructureAnswers``."""

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

    def answers(self) -> StructureAnswers:
        """Return the answers alone."""
        return StructureAnswers(
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
    """What a flutter summary is called and in which unit its velocities are."""

    aircraft_id: _AircraftId
    name: Title
    speed_unit: Literal["m/s", "ft/s", "in/s", "kt", "km/h"]

    __pydantic_config__ = _STRICT


@router.get("/uploads/{upload_id}/structure", response_model=ModalFiles)
def look_at_upload(context: TheContext, upload_id: _UploadId) -> Json:
    """Say what modes the files of an upload hold, and what they leave open."""
    return Json(look_at_structure(context.uploads.sources(upload_id)))


@router.post(
    "/uploads/{upload_id}/structure",
    response_model=ModalTable,
    status_code=status.HTTP_201_CREATED,
)
def import_structure(
    context: TheContext, upload_id: _UploadId, wanted: StructureFilesRequest
) -> Json:
    """Keep the modes of uploaded files as a modal table, a version beside others of its name."""
    aircraft = context.store.aircraft.get(wanted.aircraft_id)
    raw = extract_structure(context.uploads.sources(upload_id), wanted.answers())
    return Json(keep_structure(context.store, aircraft, raw), status.HTTP_201_CREATED)


@router.post(
    "/uploads/{upload_id}/flutter-summary",
    response_model=FlutterSummary,
    status_code=status.HTTP_201_CREATED,
)
def import_flutter_summary(
    context: TheContext, upload_id: _UploadId, wanted: FlutterSummaryRequest
) -> Json:
    """Keep the flutter summary of an uploaded printout, with the speeds found from it."""
    aircraft = context.store.aircraft.get(wanted.aircraft_id)
    sources = context.uploads.sources(upload_id)
    kept = keep_flutter_summary(context.store, aircraft, sources, wanted.name, wanted.speed_unit)
    return Json(kept, status.HTTP_201_CREATED)


@router.get("/flutter-summaries", response_model=FlutterSummaryList)
def list_flutter_summaries(store: TheStore, aircraft_id: Reference = None) -> Json:
    """List the flutter summaries of an aircraft or of all."""
    chosen = {} if aircraft_id is None else {"aircraft_id": aircraft_id}
    found = [with_warning(summary) for summary in store.flutter_summaries.find(**chosen)]
    return Json(FlutterSummaryList(items=found))


@router.get("/flutter-summaries/{summary_id}", response_model=FlutterSummary)
def get_flutter_summary(store: TheStore, summary_id: Identity) -> Json:
    """Return one flutter summary."""
    return Json(with_warning(store.flutter_summaries.get(summary_id)))
