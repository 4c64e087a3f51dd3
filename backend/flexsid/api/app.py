"""The FastAPI application: database, dispatcher, routes and frontend."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager

import anyio.to_thread
from fastapi import FastAPI
from fastapi.middleware.gzip import GZipMiddleware

import flexsid
from flexsid.api.context import Context
from flexsid.api.errors import add_error_handlers
from flexsid.api.live_events import LiveEvents
from flexsid.api.login_addresses import LoginAddresses
from flexsid.api.metrics import add_metrics
from flexsid.api.middleware.body_limit import BodyLimit
from flexsid.api.middleware.request_coalescing import RequestCoalescing
from flexsid.api.middleware.request_log import RequestLog, RequestMetrics
from flexsid.api.middleware.security import SecurityMiddleware
from flexsid.api.middleware.write_limit import THREADS, WriteLimit
from flexsid.api.openapi.description import add_examples
from flexsid.api.openapi.docs import add_docs
from flexsid.api.page import FindStart, add_page
from flexsid.api.parameters import DESCRIPTION
from flexsid.api.router import make_operation_id
from flexsid.api.routes import (
    aircraft,
    audit_log,
    backups,
    batches,
    closed_loop,
    comparisons,
    compatibility,
    conditioning,
    conditions,
    controllers,
    decisions,
    design_predictions,
    designs,
    events,
    figures,
    flights,
    flutter,
    global_models,
    ground_tests,
    health,
    jobs,
    live,
    maneuvers,
    mappings,
    modal_files,
    modal_tables,
    model_structures,
    nomenclature,
    notes,
    predictions,
    quality,
    reports,
    review,
    run_templates,
    runs,
    saved_views,
    searches,
    session,
    transfer_functions,
    uploads,
    validation,
    vibration_tests,
)
from flexsid.api.scheduled_backups import schedule_backups
from flexsid.jobs.dispatcher_process import DispatcherProcess, DispatcherSettings
from flexsid.jobs.health import PartHealth, QueueHealth
from flexsid.jobs.kinds import load_kinds
from flexsid.reports import read_template
from flexsid.settings import Mode, Settings
from flexsid.storage.backup import find_file
from flexsid.storage.migrate import upgrade
from flexsid.storage.quotas import GIGABYTE, Quotas
from flexsid.storage.store import Store
from flexsid.streams.live_streams import LiveStreams
from flexsid.workflow.importing.flight_import import AddBuiltinAircraft
from flexsid.workflow.maintenance.database_backup import BackupRequest
from flexsid.workflow.review.decision_review import find_clock_error

_log = logging.getLogger(__name__)

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
        live = LiveEvents(store, lambda: health.check_parts(app.state.context))
        duty = DispatcherSettings(
            *(settings.database, load_kinds, settings.dask, settings.workers),
            url=settings.public_url,
        )
        dispatcher = DispatcherProcess(duty, on_change=live.notify)
        dispatcher.start()
        streams = LiveStreams(
            *(store, live.publish_stream, dispatcher.wake),
            *(settings.receiver_credentials, settings.brokers),
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
        openapi_url="/api/v1/openapi.json",
        docs_url=None,
        redoc_url=None,
        generate_unique_id_function=make_operation_id,
    )
    app.state.settings = settings
    for module in (
        health,
        session,
        audit_log,
        aircraft,
        flights,
        ground_tests,
        maneuvers,
        compatibility,
        conditioning,
        quality,
        mappings,
        uploads,
        modal_tables,
        modal_files,
        vibration_tests,
        predictions,
        model_structures,
        decisions,
        review,
        runs,
        saved_views,
        notes,
        run_templates,
        searches,
        jobs,
        events,
        backups,
        batches,
        comparisons,
        conditions,
        reports,
        designs,
        design_predictions,
        controllers,
        flutter,
        closed_loop,
        global_models,
        transfer_functions,
        validation,
        live,
        figures,
        nomenclature,
    ):
        # Not included, which builds every route, and the schemas of its fields, a second time.
        app.router.routes.extend(module.router.routes)
    add_examples(app)
    metrics = RequestMetrics()
    add_metrics(app, metrics)
    add_docs(app)
    add_page(app, find_start=find_start)
    add_error_handlers(app)
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
