"""Events: a stream of the state changes of runs."""

from __future__ import annotations

from collections.abc import AsyncIterable
from typing import Annotated

from fastapi import APIRouter, Header, Query
from fastapi.sse import EventSourceResponse, ServerSentEvent

from flexsid.api.context import TheContext
from flexsid.api.serialization import dump_json

router = APIRouter(prefix="/events", tags=["jobs"])

_Event = Annotated[int | None, Query(ge=0, le=2**63 - 1, description="Id of the last known event.")]


@router.get("", response_class=EventSourceResponse)
async def stream_events(
    context: TheContext,
    after: _Event = None,
    last_event_id: Annotated[str | None, Header()] = None,
) -> AsyncIterable[ServerSentEvent]:
    """Stream the state changes of runs, as server-sent events.

    `run` is an entry of the run log, with its id; `running` lists the running jobs; `missed` means
    that events were dropped: reload the lists. Browsers resume after a reconnection (header
    `Last-Event-ID`); other clients give the id of the last known event.
    """
    resumed = last_event_id is not None and last_event_id.isascii() and last_event_id.isdigit()
    known = int(last_event_id[:18]) if resumed and last_event_id else after
    async for update in context.live.listen(known):
        if update.missed:
            yield ServerSentEvent(event="missed", raw_data="{}")
        for event in update.events:
            yield ServerSentEvent(event="run", id=str(event.id), raw_data=dump_json(event).decode())
        if update.running is not None:
            yield ServerSentEvent(event="running", raw_data=dump_json(update.running).decode())
