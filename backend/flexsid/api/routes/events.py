"""Events: a stream of the state changes of jobs, and of live identification."""

from __future__ import annotations

import time
from collections.abc import AsyncIterable, Iterator
from dataclasses import dataclass, field, replace
from typing import Annotated

import anyio.to_thread
import sqlalchemy as sa
from fastapi import Header, Query, Request
from fastapi.sse import EventSourceResponse, ServerSentEvent

from flexsid.api.authorization import identify, list_campaigns
from flexsid.api.context import TheContext
from flexsid.api.live_events import JobUpdate
from flexsid.api.router import make_router
from flexsid.api.serialization import Reference, dump_json
from flexsid.records.account import AccountRole
from flexsid.storage.access import Access, get_access, using_access
from flexsid.storage.store import Store
from flexsid.storage.tables import jobs
from flexsid.streams.live_streams import LiveStreams

router = make_router("/events", tag="jobs")

_CHECKED_S = 1.0  # between two checks of the account of a reader of samples [s]

_Event = Annotated[int | None, Query(ge=0, le=2**31 - 1, description="Id of the last known event.")]
_Channels = Annotated[str, Query(description="Channels of the stream, separated by commas.")]


@router.get("", response_class=EventSourceResponse)
async def stream_events(
    request: Request,
    context: TheContext,
    after: _Event = None,
    last_event_id: Annotated[str | None, Header()] = None,
    stream_id: Reference = None,
    channels: _Channels = "",
) -> AsyncIterable[ServerSentEvent]:
    """Stream the state changes of jobs and of live identification, as server-sent events.

    `job` is an entry of the log, with its id; `running` lists the running jobs; `missed` means
    that events were dropped: reload the lists. `changed` names sorts of records that have changed
    (`decisions`, `model_structures`, `notes`, `review_rules`, `live_streams`) or `health`: read
    them again. Browsers resume after a reconnection (header `Last-Event-ID`); other clients give
    the id of the last known event.

    `live` is the present state of a stream of samples (`LiveSnapshot`), sent when it changes.
    With `stream_id`, `samples` are new columns of its strip chart (`StripChart`), one for each
    frame, at most ten times per second.
    """
    resumed = last_event_id is not None and last_event_id.isascii() and last_event_id.isdigit()
    known = int(last_event_id[:18]) if resumed and last_event_id else after
    access, checked = get_access(), 0.0
    names = tuple(name.strip() for name in channels.split(",") if name.strip())
    reader = _StreamReader(context.streams, stream_id, names)
    async for update in context.live.listen(known):
        is_due = (
            update.events
            or update.running
            or update.changed
            or time.monotonic() - checked > _CHECKED_S
        )
        if access is not None and is_due:
            visible = await anyio.to_thread.run_sync(
                _select_visible, context.store, request, access, update
            )
            if visible is None:
                return  # the session has ended
            update, access = visible
            checked = time.monotonic()
        if update.missed:
            yield ServerSentEvent(event="missed", raw_data="{}")
        for event in update.events:
            yield ServerSentEvent(event="job", id=str(event.id), raw_data=dump_json(event).decode())
        if update.running is not None:
            yield ServerSentEvent(event="running", raw_data=dump_json(update.running).decode())
        if update.changed:
            records = {"records": sorted({name for name, _ in update.changed})}
            yield ServerSentEvent(event="changed", raw_data=dump_json(records).decode())
        for stream in update.streams:
            for event in reader.read(stream, access):
                yield event


@dataclass(slots=True)
class _StreamReader:
    """What one reader has seen of the streams: number of states, end of the samples."""

    streams: LiveStreams
    stream_id: int | None
    names: tuple[str, ...]
    seen: dict[int, int] = field(default_factory=dict)
    newest_s: float | None = None

    def read(self, stream_id: int, access: Access | None) -> Iterator[ServerSentEvent]:
        """Yield what is new of a stream, if its campaign may be read."""
        campaign = self.streams.find_campaign(stream_id)
        readable = None if access is None else access.readable
        if campaign is None or (readable is not None and campaign not in readable):
            return
        count = self.streams.count_states(stream_id)
        if self.seen.get(stream_id) != count:
            self.seen[stream_id] = count
            snapshot = self.streams.find_snapshot(stream_id)
            yield ServerSentEvent(event="live", raw_data=dump_json(snapshot).decode())
        newest_s = self.streams.find_newest_s(stream_id)
        if stream_id != self.stream_id or not self.names or newest_s is None:
            return
        if self.newest_s is not None and newest_s > self.newest_s:
            chart = self.streams.read_samples(stream_id, self.names, self.newest_s, 4000)
            yield ServerSentEvent(event="samples", raw_data=dump_json(chart).decode())
        self.newest_s = newest_s


def _select_visible(
    store: Store, request: Request, access: Access, update: JobUpdate
) -> tuple[JobUpdate, Access] | None:
    """Return the part of an update in the present campaigns of the account; None if logged out."""
    with using_access(None):
        identity = identify(store, request.app.state.settings, request)
    if identity is None:
        return None
    present = replace(access, readable=list_campaigns(identity.roles, AccountRole.VIEWER))
    named = {event.job_id for event in update.events} | {job.id for job in update.running or ()}
    visible: set[int] = set()
    if named:
        with using_access(present), store.database.reading() as connection:
            visible = set(connection.scalars(sa.select(jobs.c.id).where(jobs.c.id.in_(named))))
    running = update.running
    part = JobUpdate(
        [event for event in update.events if event.job_id in visible],
        None if running is None else [job for job in running if job.id in visible],
        update.missed,
        update.streams,
        frozenset(
            (name, campaign)
            for name, campaign in update.changed
            if campaign is None or present.readable is None or campaign in present.readable
        ),
    )
    return part, present
