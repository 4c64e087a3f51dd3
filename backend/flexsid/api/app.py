"""The FastAPI application: database, dispatcher, routes, page and scheduled backups."""

from __future__ import annotations

import asyncio
import logging
import mimetypes
import os
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from datetime import UTC, datetime, timedelta
from pathlib import Path

import anyio.to_thread
from fastapi import APIRouter, FastAPI, Response
from fastapi.middleware.gzip import GZipMiddleware
from fastapi.responses import FileResponse, HTMLResponse, RedirectResponse
from fastapi.staticfiles import StaticFiles
from starlette.datastructures import Headers
from starlette.types import Scope

import flexsid
from flexsid.api.authorization import LoginAddresses
from flexsid.api.context import Context
from flexsid.api.description import add_docs, add_examples
from flexsid.api.errors import add_error_handlers
from flexsid.api.live_events import LiveEvents
from flexsid.api.middleware.limits import THREADS, BodyLimit, WriteLimit
from flexsid.api.middleware.request_coalescing import RequestCoalescing
from flexsid.api.middleware.request_log import RequestLog, RequestMetrics, add_metrics
from flexsid.api.middleware.security import SecurityMiddleware
from flexsid.api.middleware.tables import TableFiles
from flexsid.api.parameters import DESCRIPTION
from flexsid.api.router import PREFIX, make_operation_id
from flexsid.api.routes import (
    aircraft,
    analyses,
    decisions,
    designs,
    figures,
    flutter,
    global_models,
    grey_box,
    jobs,
    live,
    maneuvers,
    modal_tables,
    model_structures,
    notes,
    operations,
    quality,
    reports,
    runs,
    session,
    uploads,
    validation,
    vibration_tests,
    write_backs,
)
from flexsid.jobs.dispatcher_process import DispatcherProcess, DispatcherSettings
from flexsid.jobs.health import PartHealth, QueueHealth
from flexsid.jobs.kind import submit
from flexsid.jobs.kinds import BACKUP, load_kinds
from flexsid.reports import read_template
from flexsid.settings import Mode, Settings
from flexsid.storage.access import GIGABYTE, Quotas
from flexsid.storage.copies.backup import find_file
from flexsid.storage.jobs import leases
from flexsid.storage.migrate import upgrade
from flexsid.storage.store import Store
from flexsid.streams.live_streams import LiveStreams
from flexsid.workflow.importing.flight_import import AddBuiltinAircraft
from flexsid.workflow.maintenance.database import BackupRequest, is_backup_due
from flexsid.workflow.review.decision_review import find_clock_error

# --- The built frontend, if the installation contains it ------------------------------------------

FRONTEND = Path(flexsid.__file__).parent / "frontend_dist"
_ENCODINGS = {"br": ".br", "gzip": ".gz"}
"""Suffix of the files that the build has compressed, by encoding, the smallest first."""

_NOT_BUILT = """<!doctype html>
<html lang="en"><meta charset="utf-8"><title>flexsid</title>
<h1>The frontend of flexsid has not been built</h1>
<p>The server is running (<a href="/api/v1/health">health</a>, <a href="/api/docs">API</a>), but
the frontend is missing from this installation. In a source checkout <code>make demo</code>
builds it.</p></html>
"""


FindStart = Callable[[], str | None]
"""Returns the address on which the page opens in place of the start page; None for that."""


def add_page(app: FastAPI, folder: Path = FRONTEND, find_start: FindStart | None = None) -> None:
    """Serve the built frontend at ``/`` and at the addresses of its views."""
    if (folder / "index.html").is_file():
        if find_start is not None:
            _add_start(app, folder, find_start)
        app.mount("/assets", _Assets(directory=folder / "assets"))
        app.frontend("/", directory=folder, fallback="index.html")
        return

    @app.get("/", include_in_schema=False)
    async def show_missing_frontend() -> HTMLResponse:
        return HTMLResponse(_NOT_BUILT)


def _add_start(app: FastAPI, folder: Path, find_start: FindStart) -> None:
    """Open the page on another view than the start page; links within the page are as before."""

    @app.get("/", include_in_schema=False)
    def open_page() -> Response:
        start = find_start()
        if start is None:
            return FileResponse(folder / "index.html")
        return RedirectResponse(start, 307, {"Cache-Control": "no-store"})


class _Assets(StaticFiles):
    """Files of the build, each as compressed as the browser accepts."""

    def file_response(
        self,
        full_path: str | os.PathLike[str],
        stat_result: os.stat_result,
        scope: Scope,
        status_code: int = 200,
    ) -> Response:
        accepted = read_encodings(Headers(scope=scope).get("accept-encoding", ""))
        for encoding, suffix in _ENCODINGS.items():
            compressed = f"{os.fspath(full_path)}{suffix}"
            if encoding in accepted and os.path.isfile(compressed):
                media_type = mimetypes.guess_type(full_path)[0]
                headers = {"Content-Encoding": encoding, "Vary": "Accept-Encoding"}
                return FileResponse(compressed, media_type=media_type, headers=headers)
        return super().file_response(full_path, stat_result, scope, status_code)


def read_encodings(header: str) -> set[str]:
    """Return the encodings that a header ``Accept-Encoding`` accepts by name."""
    accepted = set[str]()
    for part in header.lower().split(","):
        name, _, weight = part.partition(";")
        if weight.replace(" ", "") not in ("q=0", "q=0.0", "q=0.00", "q=0.000"):
            accepted.add(name.strip())
    return accepted


# --- Backups at intervals, queued by the server ---------------------------------------------------

_log = logging.getLogger(__name__)
_CHECK_S = 60.0


async def schedule_backups(context: Context, hours: int, request: BackupRequest) -> None:
    """Queue a backup whenever the last one is older than an interval, until cancelled."""
    while True:
        try:
            if await anyio.to_thread.run_sync(request_due_backup, context.store, hours, request):
                context.dispatcher.wake()
        except Exception:  # such as a locked database; without this no backup would follow
            _log.exception("no backup was requested; trying again")
        await asyncio.sleep(_CHECK_S)


def request_due_backup(store: Store, hours: int, request: BackupRequest) -> bool:
    """Queue a backup if one is due; return whether it is.

    Raises
    ------
    BadInput
        If the database is not SQLite.
    """
    if not is_backup_due(store, timedelta(hours=hours), datetime.now(UTC)):
        return False
    submit(store, BACKUP, request, title="Database, scheduled")
    return True


# --- The FastAPI application: database, dispatcher, routes and frontend ---------------------------

_OPENAPI = f"{PREFIX}/openapi.json"
_LEAST_COMPRESSED = 1024  # [bytes]
_LEVEL = 4  # of zlib: JSON is 7 % larger than by level 6, in two thirds of the time


def create_app(
    settings: Settings,
    *,
    add_builtin_aircraft: AddBuiltinAircraft | None = None,
    check_additional_part: Callable[[], PartHealth | None] = lambda: None,
    find_start: FindStart | None = None,
) -> FastAPI:
    """Make the application: migrated database, dispatcher, routes and frontend.

    Parameters
    ----------
    settings
        Database and workers; read when the service starts, from ``app.state.settings``.
    add_builtin_aircraft
        Adds an aircraft that comes with the software when an upload needs it.
    check_additional_part
        Returns the health of a part that only this server has, or None.
    find_start
        Returns the address on which the page opens, or None for the start page.
    """

    @asynccontextmanager
    async def lifespan(app: FastAPI) -> AsyncIterator[None]:
        anyio.to_thread.current_default_thread_limiter().total_tokens = THREADS
        settings: Settings = app.state.settings
        # An invalid template stops the server, not the first report.
        template_path = settings.report_template
        template = None if template_path is None else read_template(template_path)
        if settings.backup_hours is not None:
            find_file(settings.database)  # only databases of SQLite are copied
        migration = upgrade(settings.database)
        store = Store.open(
            *(settings.database, settings.site_key, _read_quotas(settings)), settings.recordings
        )
        clock_error = find_clock_error(store)
        if clock_error is not None:
            _log.warning(clock_error)
        leases.announce(store, settings.public_url)
        live = LiveEvents(store, lambda: operations.check_parts(app.state.context))
        duty = DispatcherSettings(
            *(settings.database, load_kinds, settings.dask, settings.workers),
            url=settings.public_url,
            notifications=settings.notifications,
        )
        dispatcher = DispatcherProcess(duty, on_change=live.notify)
        dispatcher.start()
        streams = LiveStreams(
            *(store, live.publish_stream, dispatcher.wake),
            *(settings.credentials, settings.brokers),
        )
        streams.resume()
        app.state.context = Context(
            store=store,
            dispatcher=dispatcher,
            migration=migration,
            add_builtin_aircraft=add_builtin_aircraft,
            report_template=template,
            live=live,
            streams=streams,
            queue_health=QueueHealth(store, lambda: dispatcher.is_starting),
            login_addresses=LoginAddresses(),
            check_additional_part=check_additional_part,
            is_shared=settings.mode is not Mode.PERSONAL,
        )
        scheduled = None
        if settings.backup_hours is not None:
            request = BackupRequest(
                retained=settings.backups_retained, incremental=settings.backups_incremental
            )
            scheduled = asyncio.create_task(
                schedule_backups(app.state.context, settings.backup_hours, request)
            )
        try:
            yield
        finally:
            if scheduled is not None:
                scheduled.cancel()
            live.stop()
            streams.close()
            dispatcher.stop()
            store.close()

    app = FastAPI(
        title="flexsid",
        summary="A workbench to identify flexible aircraft from flight test",
        description=DESCRIPTION,
        version=flexsid.__version__,
        lifespan=lifespan,
        openapi_url=_OPENAPI,
        docs_url=None,
        redoc_url=None,
        generate_unique_id_function=make_operation_id,
    )
    app.state.settings = settings
    for module in (
        operations,
        session,
        aircraft,
        maneuvers,
        vibration_tests,
        grey_box,
        quality,
        uploads,
        modal_tables,
        write_backs,
        model_structures,
        decisions,
        runs,
        notes,
        jobs,
        validation,
        analyses,
        reports,
        designs,
        flutter,
        global_models,
        live,
        figures,
    ):
        # Not included, which builds every route, and the schemas of its fields, a second time.
        for router in vars(module).values():
            if isinstance(router, APIRouter):
                app.router.routes.extend(router.routes)
    add_examples(app)
    metrics = RequestMetrics()
    add_metrics(app, metrics)
    add_docs(app)
    add_page(app, find_start=find_start)
    add_error_handlers(app)
    app.add_middleware(TableFiles, prefix=f"{PREFIX}/", own=(_OPENAPI, f"{PREFIX}/figures/"))
    app.add_middleware(WriteLimit)
    app.add_middleware(BodyLimit)
    # Streams of events are excluded; equal requests share what is compressed once.
    app.add_middleware(GZipMiddleware, minimum_size=_LEAST_COMPRESSED, compresslevel=_LEVEL)
    app.add_middleware(RequestCoalescing)
    app.add_middleware(SecurityMiddleware)
    app.add_middleware(RequestLog, metrics=metrics)  # the last one added runs first
    return app


def _read_quotas(settings: Settings) -> Quotas:
    most = settings.campaign_gigabytes
    return Quotas(
        unfinished_jobs=settings.analyst_jobs,
        recorded_bytes=None if most is None else most * GIGABYTE,
        expansion=settings.expansion,
        account_upload_bytes=int(settings.account_upload_gigabytes * GIGABYTE),
        upload_bytes=int(settings.upload_gigabytes * GIGABYTE),
    )
