"""Events: a stream of the state changes of jobs."""

from __future__ import annotations

from collections.abc import AsyncIterable
from dataclasses import replace
from typing import Annotated

import anyio.to_thread
import sqlalchemy as sa
from fastapi import APIRouter, Header, Query, Request
from fastapi.sse import EventSourceResponse, ServerSentEvent

from flexsid.api.authorization import identify, list_campaigns
from flexsid.api.context import TheContext
from flexsid.api.live_events import JobUpdate
from flexsid.api.serialization import dump_json
from flexsid.records.account import Role
from flexsid.storage.access import Access, get_access, using_access
from flexsid.storage.store import Store
from flexsid.storage.tables import jobs

router = APIRouter(prefix="/events", tags=["jobs"])

_Event = Annotated[int | None, Query(ge=0, le=2**31 - 1, description="Id of the last known event.")]


@router.get("", response_class=EventSourceResponse)
async def stream_events(
    request: Request,
    context: TheContext,
    after: _Event = None,
    last_event_id: Annotated[str | None, Header()] = None,
) -> AsyncIterable[ServerSentEvent]:
    """Stream the state changes of jobs, as server-sent events.

    `job` is an entry of the log, with its id; `running` lists the running jobs; `missed` means
    that events were dropped: reload the lists. Browsers resume after a reconnection (header
    `Last-Event-ID`); other clients give the id of the last known event.
    """
    resumed = last_event_id is not None and last_event_id.isascii() and last_event_id.isdigit()
    known = int(last_event_id[:18]) if resumed and last_event_id else after
    access = get_access()
    async for update in context.live.listen(known):
        if access is not None:
            visible = await anyio.to_thread.run_sync(
                _select_visible, context.store, request, access, update
            )
            if visible is None:
                return  # the session has ended
            update = visible
        if update.missed:
            yield ServerSentEvent(event="missed", raw_data="{}")
        for event in update.events:
            yield ServerSentEvent(event="job", id=str(event.id), raw_data=dump_json(event).decode())
        if update.running is not None:
            yield ServerSentEvent(event="running", raw_data=dump_json(update.running).decode())


def _select_visible(
    store: Store, request: Request, access: Access, update: JobUpdate
) -> JobUpdate | None:
    """Return the part of an update in the present campaigns of the account; None if logged out."""
    with using_access(None):
        identity = identify(store, request.app.state.settings, request)
    if identity is None:
        return None
    present = replace(access, readable=list_campaigns(identity.roles, Role.VIEWER))
    named = {event.job_id for event in update.events} | {job.id for job in update.running or ()}
    with using_access(present), store.database.reading() as connection:
        visible = set(connection.scalars(sa.select(jobs.c.id).where(jobs.c.id.in_(named))))
    running = update.running
    return JobUpdate(
        [event for event in update.events if event.job_id in visible],
        None if running is None else [job for job in running if job.id in visible],
        update.missed,
    )
