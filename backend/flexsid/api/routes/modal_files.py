"""Modal data and flutter summaries from uploaded files."""

from __future__ import annotations

from typing import Annotated, Literal

from fastapi import Depends

from flexsid.api.context import TheStore
from flexsid.api.models.requests import Id, Request, Title
from flexsid.api.parameters import query_as
from flexsid.api.router import make_router
from flexsid.api.serialization import Identity, JsonRoute, Reference, UploadId, drop_none
from flexsid.importers.modal_data import (
    MassOptions,
    ModalDataOptions,
    ModalFiles,
    extract_mass_table,
    extract_modal_data,
    inspect_modal_data,
)
from flexsid.records.aircraft import Aircraft
from flexsid.records.flutter_summary import FlutterSummary, SummaryRoots
from flexsid.records.modal_data import ModalTable
from flexsid.request_models import body_of
from flexsid.storage.paging import Page
from flexsid.workflow.aircraft.aircraft_definition import set_mass_table
from flexsid.workflow.flutter.flutter_summary import add_warning, save_flutter_summary
from flexsid.workflow.flutter.summary_roots import SummaryQuery, read_summary_roots
from flexsid.workflow.importing.uploads import open_upload
from flexsid.workflow.modal_data.modal_import import store_modal_data

router = make_router(tag="modal-data", route_class=JsonRoute)


@body_of(ModalDataOptions)
class ModalDataRequest(Request):
    """Units, axes and fuel fractions of uploaded modal data; see ``ModalDataOptions``."""

    aircraft_id: Id


@body_of(MassOptions)
class MassRequest(Request):
    """Units, axes and fuel fractions of mass properties of uploaded printouts (GPWG)."""

    aircraft_id: Id


class FlutterSummaryRequest(Request):
    """Name of a flutter summary, and unit of its velocities."""

    aircraft_id: Id
    name: Title
    speed_unit: Literal["m/s", "ft/s", "in/s", "kt", "km/h"]


@router.get("/uploads/{upload_id}/modal-data")
def inspect_modal_files(store: TheStore, upload_id: UploadId) -> ModalFiles:
    """Return the modes in the files of an upload, and the information missing for an import."""
    return inspect_modal_data(open_upload(store, upload_id))


@router.post("/uploads/{upload_id}/modal-data", status_code=201)
def import_modal_data(store: TheStore, upload_id: UploadId, body: ModalDataRequest) -> ModalTable:
    """Import the modes of uploaded files as a modal table, as a new version of its name."""
    aircraft = store.aircraft.get(body.aircraft_id)
    raw = extract_modal_data(open_upload(store, upload_id), body.make_record(ModalDataOptions))
    return store_modal_data(store, aircraft, raw)


@router.post("/uploads/{upload_id}/mass-properties")
def import_mass_properties(store: TheStore, upload_id: UploadId, body: MassRequest) -> Aircraft:
    """Set the mass properties of an aircraft at the fuel weights of uploaded printouts."""
    options = body.make_record(MassOptions)
    table = extract_mass_table(open_upload(store, upload_id), options)
    return set_mass_table(store, body.aircraft_id, table)


@router.post("/uploads/{upload_id}/flutter-summary", status_code=201)
def import_flutter_summary(
    store: TheStore, upload_id: UploadId, body: FlutterSummaryRequest
) -> FlutterSummary:
    """Import the flutter summary of an uploaded printout, with its flutter speeds."""
    aircraft = store.aircraft.get(body.aircraft_id)
    sources = open_upload(store, upload_id)
    return save_flutter_summary(store, aircraft, sources, body.name, body.speed_unit)


@router.get("/flutter-summaries")
def list_flutter_summaries(store: TheStore, aircraft_id: Reference = None) -> Page[FlutterSummary]:
    """List the flutter summaries of one aircraft, or of all."""
    found = [
        add_warning(summary)
        for summary in store.flutter_summaries.find(**drop_none(aircraft_id=aircraft_id))
    ]
    return Page(items=found)


@router.get("/flutter-summaries/{summary_id}")
def get_flutter_summary(store: TheStore, summary_id: Identity) -> FlutterSummary:
    """Return one flutter summary."""
    return add_warning(store.flutter_summaries.get(summary_id))


@router.get("/flutter-summaries/{summary_id}/roots")
def get_summary_roots(
    store: TheStore, query: Annotated[SummaryQuery, Depends(query_as(SummaryQuery, "summary_id"))]
) -> SummaryRoots:
    """Return the roots of one analysis, and where they become unstable at a damping g."""
    return read_summary_roots(store, query)
