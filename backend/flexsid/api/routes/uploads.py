"""Uploads: files are read, described by a mapping, previewed and imported; stored mappings."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Annotated

from fastapi import File, Query, Response, UploadFile, status

from flexsid.api.authorization import TheAnalyst
from flexsid.api.context import TheContext, TheStore, save_files
from flexsid.api.models.requests import (
    DraftRequest,
    MappingRequest,
    PreviewRequest,
    UploadMappingRequest,
)
from flexsid.api.models.responses import UploadDetail
from flexsid.api.responses import KnownJob, submit_job
from flexsid.api.router import make_router
from flexsid.api.routes.figures import Figure
from flexsid.api.serialization import Identity, Json, JsonRoute, UploadId
from flexsid.figures.time_histories import draw_time_history
from flexsid.importers.mapping import parse_mapping
from flexsid.jobs.kinds import IMPORT
from flexsid.records.maneuver import StoredMapping
from flexsid.storage.access import storing_in_campaign
from flexsid.storage.jobs import job_list
from flexsid.storage.jobs.job_list import JobItem
from flexsid.storage.lists.list_query import Items
from flexsid.storage.store import Store
from flexsid.text import join_names
from flexsid.workflow.importing import preview, uploads
from flexsid.workflow.views.maneuver import POINTS

# --- Uploads: files are read, described by a mapping, previewed and imported ----------------------

uploads_router = make_router("/uploads", tag="uploads")


@uploads_router.post("", response_model=UploadDetail, status_code=status.HTTP_201_CREATED)
def upload_files(
    store: TheStore,
    files: Annotated[list[UploadFile], File(description="Recorder files of one flight.")],
) -> Json:
    """Read files and propose a mapping; nothing is stored in the database."""
    with TemporaryDirectory(prefix="flexsid-") as folder:
        paths, names = save_files(Path(folder), files)
        upload = uploads.add_upload(store, paths, names)
    location = {"Location": f"/api/v1/uploads/{upload.id}"}
    return Json(_describe_upload(store, upload.id), status.HTTP_201_CREATED, location)


@uploads_router.get("", response_model=Items[uploads.UploadItem])
def list_uploads(store: TheStore) -> Json:
    """List the own uploads that are not imported, most recently edited first."""
    return Json(Items(items=uploads.list_uploads(store)))


@uploads_router.get("/{upload_id}", response_model=UploadDetail)
def get_upload(
    store: TheStore,
    upload_id: UploadId,
    aircraft: Annotated[
        str | None, Query(description="Stored aircraft to propose the mapping for.", max_length=200)
    ] = None,
) -> Json:
    """Return the contents of the files of an upload, and the proposed mapping."""
    return Json(_describe_upload(store, upload_id, aircraft))


@uploads_router.put("/{upload_id}/draft", status_code=status.HTTP_204_NO_CONTENT)
def save_upload_draft(store: TheStore, upload_id: UploadId, body: DraftRequest) -> Response:
    """Store the mapping of an upload while it is edited; it need not be valid."""
    uploads.write_draft(store, upload_id, body.mapping)
    return Response(status_code=status.HTTP_204_NO_CONTENT)


@uploads_router.post("/{upload_id}/check", response_model=preview.Checked)
def check_upload(store: TheStore, upload_id: UploadId, body: UploadMappingRequest) -> Json:
    """Check a mapping against the files; nothing is stored."""
    sources = uploads.open_upload(store, upload_id)
    request = body.make_record(uploads.ImportRequest, upload_id=upload_id)
    return Json(preview.check_mapping(store, sources, request.mapping))


@uploads_router.post("/{upload_id}/preview", response_model=Figure)
def preview_upload(store: TheStore, upload_id: UploadId, body: PreviewRequest) -> Json:
    """Draw channels as read by a mapping."""
    sources = uploads.open_upload(store, upload_id)
    value = preview.preview_channels(sources, body.mapping, body.channels, POINTS)
    return Json(draw_time_history(value))


@uploads_router.post(
    "/{upload_id}/import", response_model=JobItem, status_code=status.HTTP_202_ACCEPTED
)
def import_upload(
    context: TheContext, upload_id: UploadId, body: UploadMappingRequest, analyst: TheAnalyst
) -> Json:
    """Queue the import of the files with a mapping, completely or not at all."""
    request = body.make_record(uploads.ImportRequest, upload_id=upload_id)
    campaign = uploads.check_import(context.store, request, context.add_builtin_aircraft)
    files = [file.name for file in uploads.open_upload(context.store, upload_id).items]
    with storing_in_campaign(campaign):
        return submit_job(context, IMPORT, request, analyst, join_names(files))


@uploads_router.get("/{upload_id}/import", response_model=KnownJob)
def get_import_job(store: TheStore, upload_id: UploadId) -> Json:
    """Return the newest job that imports an upload; null without one."""
    uploads.find_folder(store, upload_id)
    return Json(KnownJob(job_list.find_newest(store, IMPORT.name, upload_id=upload_id)))


@uploads_router.delete("/{upload_id}", status_code=status.HTTP_204_NO_CONTENT)
def delete_upload(store: TheStore, upload_id: UploadId) -> Response:
    """Delete the files; imported data remain."""
    uploads.delete_upload(store, upload_id)
    return Response(status_code=status.HTTP_204_NO_CONTENT)


def _describe_upload(store: Store, upload_id: str, aircraft: str | None = None) -> UploadDetail:
    sources = uploads.open_upload(store, upload_id)
    return UploadDetail(
        upload=uploads.Upload(id=upload_id),
        files=preview.describe_files(sources),
        fields=preview.describe_fields(sources),
        proposal=preview.propose_mapping(store, sources, aircraft),
        draft=uploads.read_draft(store, upload_id),
    )


# --- Stored mappings, for further files of the same recorder --------------------------------------

mappings_router = make_router("/mappings", tag="mappings", route_class=JsonRoute)


@mappings_router.get("")
def list_mappings(store: TheStore) -> Items[StoredMapping]:
    """List stored mappings."""
    return Items(items=store.mappings.find())


@mappings_router.get("/{mapping_id}")
def get_mapping(store: TheStore, mapping_id: Identity) -> StoredMapping:
    """Return one mapping."""
    return store.mappings.get(mapping_id)


@mappings_router.post("", response_model=StoredMapping, status_code=201)
def add_mapping(store: TheStore, body: MappingRequest) -> Json:
    """Store a mapping under a name; a mapping of the same name is replaced."""
    mapping = body.make_record(StoredMapping)
    parse_mapping(mapping.text)
    with store.transaction():
        for same in store.mappings.find(name=mapping.name):
            assert same.id is not None
            store.mappings.delete(same.id)
        stored = store.mappings.add(mapping)
    return Json(stored, 201, {"Location": f"/api/v1/mappings/{stored.id}"})


@mappings_router.delete("/{mapping_id}", status_code=204)
def delete_mapping(store: TheStore, mapping_id: Identity) -> None:
    """Delete a mapping; data imported with it are unchanged."""
    store.mappings.delete(mapping_id)
