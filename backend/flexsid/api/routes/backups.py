"""Backups of the database, made by jobs."""

from __future__ import annotations

from fastapi import status
from fastapi.responses import FileResponse

from flexsid.api.analyst import TheAnalyst
from flexsid.api.context import TheContext, TheStore
from flexsid.api.router import make_router
from flexsid.api.serialization import Identity, Json
from flexsid.api.submission import submit_job
from flexsid.errors import UnknownRecord
from flexsid.jobs.kinds import BACKUP
from flexsid.records.run import RunState
from flexsid.storage.job_list import JobItem
from flexsid.workflow.maintenance.database_backup import BackupRequest, find_backup, refuse_backup

router = make_router("/backups", tag="jobs")
_SQLITE = "application/vnd.sqlite3"
_FILE = {"schema": {"type": "string", "format": "binary"}}


@router.post("", response_model=JobItem, status_code=status.HTTP_202_ACCEPTED)
def request_backup(context: TheContext, analyst: TheAnalyst) -> Json:
    """Back the database up into a new file beside it; its copy is checked."""
    refuse_backup(context.store)
    return submit_job(context, BACKUP, BackupRequest(), analyst, "Database")


@router.get(
    "/{job_id}", response_class=FileResponse, responses={200: {"content": {_SQLITE: _FILE}}}
)
def get_backup(store: TheStore, job_id: Identity) -> FileResponse:
    """Return the backup that a job has made."""
    refuse_backup(store)
    job = store.jobs.get(job_id)
    if job.kind != BACKUP.name or job.state is not RunState.SUCCEEDED:
        raise UnknownRecord(f"job {job_id} has made no backup")
    file = find_backup(store, BACKUP.read_result(job))
    return FileResponse(file, media_type=_SQLITE, filename=f"flexsid-{file.name}")
