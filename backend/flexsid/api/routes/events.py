"""Events: a stream of what happens to runs."""

from __future__ import annotations

from collections.abc import AsyncIterable
from typing import Annotated

from fastapi import APIRouter, Header, Query
from fastapi.sse import EventSourceResponse, ServerSentEvent

from flexsid.api.context import TheContext
from flexsid.api.wire import dump

router = APIRouter(prefix="/events", tags=["jobs"])

_Event = Annotated[int | None, Query(ge=0, le=2**63 - 1, description="Last event known.")]


@router.get("", response_class=EventSourceResponse)
async def stream_events(
    context: TheContext,
    after: _Event = None,
    last_event_id: Annotated[str | None, Header()] = None,
) -> AsyncIterable[ServerSentEvent]:
    """Stream what happens to runs, as server-sent events.

    `run` is a line of a log, with its id; `running` lists the jobs under way; `missed`
    says that more happened meanwhile than is told: read the lists again. A browser that
    connects again goes on by itself; others give the id of the last event they know.
    """
    resumed = last_event_id is not None and last_event_id.isascii() and last_event_id.isdigit()
    known = int(last_event_id[:18]) if resumed and last_event_id else after
    async for happened in context.live.listen(known):
        if happened.missed:
            yield ServerSentEvent(event="missed", raw_data="{}")
        for event in happened.events:
            yield ServerSentEvent(event="run", id=str(event.id), raw_data=dump(event).decode())
        if happened.running is not None:
            yield ServerSentEvent(event="running", raw_data=dump(happened.running).decode())
