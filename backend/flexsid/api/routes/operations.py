"""Operation of a server: health, the audit log, and backups."""

from __future__ import annotations

from fastapi import Response, status
from fastapi.responses import FileResponse

import flexsid
from flexsid.api.authorization import TheAnalyst
from flexsid.api.context import Context, TheContext, TheStore
from flexsid.api.models.responses import Health
from flexsid.api.responses import submit_job
from flexsid.api.router import make_router
from flexsid.api.serialization import After, Identity, Json, JsonRoute, Limit
from flexsid.errors import UnknownRecord
from flexsid.jobs.health import NotReady, PartHealth, PartState, check_readers
from flexsid.jobs.kinds import BACKUP
from flexsid.records.account import AuditEvent
from flexsid.records.run import RunState
from flexsid.storage import changes
from flexsid.storage.jobs.job_list import JobItem
from flexsid.storage.lists.list_query import Page
from flexsid.workflow.maintenance.database import BackupRequest, find_backup, refuse_backup
from flexsid.workflow.review.decision_review import find_clock_error

# --- Health of server, database, dispatcher and workers -------------------------------------------

_LONGEST_WRITE_S = 2.0  # of another transaction; a probe must not occupy a thread for longer

health_router = make_router(tag="health", route_class=JsonRoute)


@health_router.get("/health/live", status_code=204)
async def check_liveness() -> Response:
    """Return 204 while the server responds; otherwise it should be restarted."""
    return Response(status_code=204)


@health_router.get("/health/ready", status_code=204)
def check_readiness(context: TheContext) -> None:
    """Return 204 if requests can be processed: the database can be written, jobs are dispatched.

    Otherwise 503 with the reason: requests should be sent to another server.
    """
    context.store.database.check_writing(_LONGEST_WRITE_S)
    for part in context.queue_health.check():
        if part.state is not PartState.OK:
            raise NotReady(f"{part.name}: {part.text}")


@health_router.get("/health")
def get_health(context: TheContext) -> Health:
    """Return the state of server, database, dispatcher and workers.

    The status is `degraded` (200) if runs cannot be processed or the clock is wrong: a restart of
    the server would not help. If the database does not respond, the status code is 503.
    """
    parts = check_parts(context)
    degraded = any(part.state is PartState.DEGRADED for part in parts)
    return Health(
        status=PartState.DEGRADED if degraded else PartState.OK,
        version=flexsid.__version__,
        database=context.store.database.url.get_backend_name(),
        migration=context.migration,
        parts=parts,
    )


def check_parts(context: Context) -> tuple[PartHealth, ...]:
    """Return the state of all parts, also of those that only some servers have."""
    database = context.store.database
    with database.reading() as connection:
        connection.exec_driver_sql("SELECT 1")
    losses = database.find_losses()
    clock_error = find_clock_error(context.store)
    others = (
        context.queue_health.check_certificate(),
        context.queue_health.check_notifications(),
        context.login_addresses.check(),
        context.check_additional_part(),
    )
    return (
        PartHealth(
            name="database",
            state=PartState.DEGRADED if losses else PartState.OK,
            text=f"{' '.join(losses)} Run `flexsid check`."
            if losses
            else f"{database.url.get_backend_name()} responds.",
        ),
        *context.queue_health.check(),
        PartHealth(
            name="clock",
            state=PartState.OK if clock_error is None else PartState.DEGRADED,
            text="Not behind the last stored event."
            if clock_error is None
            else f"{clock_error[:1].upper()}{clock_error[1:]}.",
        ),
        check_readers(context.is_shared),
        *(part for part in others if part is not None),
    )


# --- The audit log: who changed what, when and from where -----------------------------------------

audit_log_router = make_router("/audit-events", tag="session", route_class=JsonRoute)


@audit_log_router.get("", response_model=Page[AuditEvent])
def list_audit_events(store: TheStore, limit: Limit = 100, after: After = None) -> Json:
    """List the changes by accounts in the campaigns of which one is an administrator.

    `sealed` is the event as JSON, and `hash` its SHA-256; it includes the hash of the event before.
    """
    return Json(changes.read_page(store, limit=limit, after=after))


# --- Backups of the database, made by jobs --------------------------------------------------------

backups_router = make_router("/backups", tag="jobs")
_SQLITE = "application/vnd.sqlite3"
_FILE = {"schema": {"type": "string", "format": "binary"}}


@backups_router.post("", response_model=JobItem, status_code=status.HTTP_202_ACCEPTED)
def request_backup(context: TheContext, analyst: TheAnalyst) -> Json:
    """Back the database up into a new file beside it; its copy is checked."""
    refuse_backup(context.store)
    return submit_job(context, BACKUP, BackupRequest(), analyst, "Database")


@backups_router.get(
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
