"""create_app: from settings to the whole service."""

from __future__ import annotations

import getpass
import logging
import tempfile
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path

import anyio.to_thread
from fastapi import APIRouter, Depends, FastAPI
from fastapi.routing import APIRoute

import flexsid
from flexsid.api.body_limit import BodyLimit
from flexsid.api.context import Context
from flexsid.api.description import describe
from flexsid.api.docs import add_docs
from flexsid.api.errors import Problem, add_error_handlers
from flexsid.api.guards import Guards
from flexsid.api.live import Live
from flexsid.api.page import add_page
from flexsid.api.parameters import DESCRIBED, only_known
from flexsid.api.routes import (
    aircraft,
    batches,
    closed_loop,
    comparisons,
    conditioning,
    controllers,
    decisions,
    designs,
    events,
    figures,
    flights,
    flutter,
    ground_tests,
    health,
    jobs,
    maneuvers,
    mappings,
    modal_tables,
    model_structures,
    nomenclature,
    predictions,
    quality,
    reports,
    review,
    runs,
    saved_views,
    structure_files,
    uploads,
    vibration_tests,
)
from flexsid.api.routes import searches as search_routes
from flexsid.api.routes import tasks as task_routes
from flexsid.api.together import Together
from flexsid.jobs.apart import DispatcherApart, Duty
from flexsid.jobs.health import QueueHealth
from flexsid.jobs.searches import Searches
from flexsid.jobs.steps import estimation_steps
from flexsid.reports import read_template
from flexsid.settings import Settings
from flexsid.storage.database import parse_url, sqlite_file
from flexsid.storage.migrate import upgrade
from flexsid.storage.store import Store
from flexsid.workflow.background_tasks import Tasks
from flexsid.workflow.importing.flight_import import BringAlong
from flexsid.workflow.importing.uploads import Uploads
from flexsid.workflow.quality.campaign_quality import Assessments
from flexsid.workflow.review.clock import find_clock_error

_log = logging.getLogger(__name__)

# The database and numpy hold the interpreter anyway; many threads only make them
# wait for each other (forty on one list of a thousand rows came to a standstill).
_THREADS = 4


def create_app(
    settings: Settings,
    *,
    bring_along: BringAlong | None = None,
) -> FastAPI:
    """Make the service: database brought up to date, dispatcher, routes and page.

    Parameters
    ----------
    settings
        Which database; read when the service starts, from ``app.state.settings``.
    bring_along
        Adds an aircraft that comes with the software when an upload needs it.
    """

    @asynccontextmanager
    async def lifespan(app: FastAPI) -> AsyncIterator[None]:
        anyio.to_thread.current_default_thread_limiter().total_tokens = _THREADS
        settings: Settings = app.state.settings
        # A template that is none should stop the server, not the first report.
        own = settings.report_template
        template = None if own is None else read_template(own)
        migration = upgrade(settings.database)
        store = Store.open(settings.database)
        late = find_clock_error(store)
        if late is not None:
            _log.warning(late)
        live = Live(store)
        duty = Duty(settings.database, estimation_steps, settings.dask, settings.workers)
        dispatcher = DispatcherApart(duty, on_change=live.ring)
        dispatcher.start()
        received = Uploads(store, _upload_folder(settings.database), bring_along)
        received.start()
        assessments = Assessments(store, settings.database)
        tasks = Tasks()
        searches = Searches(store)
        searches.start()
        app.state.context = Context(
            store=store,
            dispatcher=dispatcher,
            migration=migration,
            bring_along=bring_along,
            uploads=received,
            assessments=assessments,
            report_template=template,
            tasks=tasks,
            searches=searches,
            live=live,
            queue_health=QueueHealth(store),
        )
        try:
            yield
        finally:
            live.stop()
            assessments.stop()
            received.stop()
            tasks.stop()
            searches.stop()
            dispatcher.stop()
            store.close()

    app = FastAPI(
        title="flexsid",
        summary="A workbench to identify flexible aircraft from flight test",
        description=DESCRIBED,
        version=flexsid.__version__,
        lifespan=lifespan,
        openapi_url="/api/v1/openapi.json",
        docs_url=None,
        redoc_url=None,
        generate_unique_id_function=_operation_id,
    )
    app.state.settings = settings
    api = APIRouter(
        prefix="/api/v1",
        responses={"4XX": {"model": Problem}},
        dependencies=[Depends(only_known)],
    )
    for module in (
        health,
        aircraft,
        flights,
        ground_tests,
        maneuvers,
        conditioning,
        quality,
        mappings,
        uploads,
        modal_tables,
        structure_files,
        vibration_tests,
        predictions,
        model_structures,
        decisions,
        review,
        runs,
        saved_views,
        search_routes,
        jobs,
        events,
        batches,
        comparisons,
        reports,
        designs,
        controllers,
        flutter,
        closed_loop,
        task_routes,
        figures,
        nomenclature,
    ):
        api.include_router(module.router)
    app.include_router(api)
    describe(app)
    add_docs(app)
    add_page(app)
    add_error_handlers(app)
    app.add_middleware(BodyLimit)
    app.add_middleware(Together)
    app.add_middleware(Guards)  # the one added last comes first
    return app


def _upload_folder(database: str) -> Path:
    """Beside a database that is a file, for what is uploaded may be as large."""
    file = sqlite_file(parse_url(database))
    if file is None:
        return Path(tempfile.gettempdir()) / f"flexsid-uploads-{getpass.getuser()}"
    return file.with_name(f"{file.name}-uploads")


def _operation_id(route: APIRoute) -> str:
    return route.name
