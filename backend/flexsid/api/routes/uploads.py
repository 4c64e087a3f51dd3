"""Uploads: files are read, described by a mapping, previewed and imported."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Annotated

from fastapi import APIRouter, File, Response, UploadFile, status

from flexsid.api.context import TheContext
from flexsid.api.requests import PreviewRequest, UploadMappingRequest
from flexsid.api.responses import UploadDetail
from flexsid.api.routes.figures import Figure
from flexsid.api.serialization import Json, UploadId
from flexsid.api.uploads import save_files
from flexsid.figures.time_history import draw_time_history
from flexsid.storage.paging import Items
from flexsid.workflow.importing import preview
from flexsid.workflow.importing.uploads import UploadProgress
from flexsid.workflow.views.maneuver import POINTS

router = APIRouter(prefix="/uploads", tags=["uploads"])


@router.get("", response_model=Items[UploadProgress])
def list_imports(context: TheContext) -> Json:
    """List the uploads that are being imported or queued."""
    return Json(Items(items=context.uploads.list_active()))


@router.post("", response_model=UploadDetail, status_code=status.HTTP_201_CREATED)
def upload_files(
    context: TheContext,
    files: Annotated[list[UploadFile], File(description="Recorder files of one flight.")],
) -> Json:
    """Read files and propose a mapping; nothing is stored in the database."""
    with TemporaryDirectory(prefix="flexsid-") as folder:
        paths, names = save_files(Path(folder), files)
        upload = context.uploads.read(paths, names)
    location = {"Location": f"/api/v1/uploads/{upload.id}"}
    return Json(_describe_upload(context, upload), status.HTTP_201_CREATED, location)


@router.get("/{upload_id}", response_model=UploadDetail)
def get_upload(context: TheContext, upload_id: UploadId) -> Json:
    """Return the contents of the files of an upload, and the proposed mapping."""
    return Json(_describe_upload(context, context.uploads.get(upload_id)))


@router.get("/{upload_id}/state", response_model=UploadProgress)
def get_upload_state(context: TheContext, upload_id: UploadId) -> Json:
    """Return the progress of an import."""
    return Json(context.uploads.get(upload_id))


@router.post("/{upload_id}/check", response_model=preview.Checked)
def check_upload(context: TheContext, upload_id: UploadId, body: UploadMappingRequest) -> Json:
    """Check a mapping against the files; nothing is stored."""
    return Json(
        preview.check_mapping(context.store, context.uploads.sources(upload_id), body.mapping)
    )


@router.post("/{upload_id}/preview", response_model=Figure)
def preview_upload(context: TheContext, upload_id: UploadId, body: PreviewRequest) -> Json:
    """Draw channels as read by a mapping."""
    sources = context.uploads.sources(upload_id)
    value = preview.preview_channels(sources, body.mapping, body.channels, POINTS)
    return Json(draw_time_history(value))


@router.post(
    "/{upload_id}/import", response_model=UploadProgress, status_code=status.HTTP_202_ACCEPTED
)
def import_upload(context: TheContext, upload_id: UploadId, body: UploadMappingRequest) -> Json:
    """Start importing the files with a mapping, completely or not at all."""
    progress = context.uploads.import_later(
        upload_id, body.mapping, body.aircraft_id, confirmed=body.confirmed
    )
    return Json(progress, status.HTTP_202_ACCEPTED)


@router.delete("/{upload_id}", status_code=status.HTTP_204_NO_CONTENT)
def delete_upload(context: TheContext, upload_id: UploadId) -> Response:
    """Cancel an import, or delete the files; imported data remain."""
    context.uploads.delete(upload_id)
    return Response(status_code=status.HTTP_204_NO_CONTENT)


def _describe_upload(context: TheContext, upload: UploadProgress) -> UploadDetail:
    sources = context.uploads.sources(upload.id)
    return UploadDetail(
        upload=upload,
        files=preview.describe_files(sources),
        fields=preview.describe_fields(sources),
        proposal=preview.propose_mapping(context.store, sources),
    )
