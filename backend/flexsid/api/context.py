"""What a route is handed: the store, and who carries out runs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from fastapi import Depends, Request

from flexsid.api.live import Live
from flexsid.jobs.apart import DispatcherApart
from flexsid.jobs.health import QueueHealth
from flexsid.jobs.searches import Searches
from flexsid.storage.store import Store
from flexsid.workflow.background_tasks import Tasks
from flexsid.workflow.importing.flight_import import BringAlong
from flexsid.workflow.importing.uploads import Uploads
from flexsid.workflow.quality.campaign_quality import Assessments


@dataclass(frozen=True, slots=True, kw_only=True)
class Context:
    """What lives as long as the server."""

    store: Store
    dispatcher: DispatcherApart
    migration: str
    bring_along: BringAlong | None
    uploads: Uploads
    assessments: Assessments
    report_template: str | None
    tasks: Tasks
    searches: Searches
    live: Live
    queue_health: QueueHealth


# Asynchronous, so that no thread is spent on handing over a reference.
async def _context(request: Request) -> Context:
    return request.app.state.context


async def _store(request: Request) -> Store:
    return request.app.state.context.store


TheContext = Annotated[Context, Depends(_context)]
TheStore = Annotated[Store, Depends(_store)]
