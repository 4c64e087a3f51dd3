"""Jobs of all kinds: progress, log, cancellation, and the stream of their state changes."""

from __future__ import annotations

import time
from collections.abc import AsyncIterator, Iterator
from dataclasses import dataclass, field, replace
from typing import Annotated

import anyio.to_thread
import sqlalchemy as sa
from fastapi import Header, Query, Request, status
from fastapi.responses import StreamingResponse
from fastapi.sse import KEEPALIVE_COMMENT

from flexsid.api.authorization import identify, list_campaigns
from flexsid.api.context import TheContext, TheStore
from flexsid.api.live_events import JobUpdate, LiveEvents, write_event
from flexsid.api.models.responses import extend_record, response_of
from flexsid.api.router import make_router
from flexsid.api.routes.grey_box import refuse_code
from flexsid.api.serialization import After, Identity, Json, Limit, Reference
from flexsid.jobs.kinds import GREY_BOX, load_kinds
from flexsid.records.account import AccountRole
from flexsid.records.job import JobEvent
from flexsid.records.run import RunState
from flexsid.storage.access import Access, get_access, using_access
from flexsid.storage.jobs import job_list, job_log, leases, queue
from flexsid.storage.jobs.job_list import JobItem, Throughput
from flexsid.storage.lists.list_query import Items, Page
from flexsid.storage.store import Store
from flexsid.storage.tables import jobs
from flexsid.streams.live_streams import LiveStreams
from flexsid.text import split_ids

# --- Jobs of all kinds: progress, log and cancellation --------------------------------------------

jobs_router = make_router("/jobs", tag="jobs")


@dataclass(frozen=True, slots=True, kw_only=True)
class WorkerPool:
    """The dispatching server, its number of workers, and their jobs.

    ``without_workers_s`` is the time since the last worker was connected [s], ``valid_until`` the
    end of the certificate by which workers of a cluster are reached.
    """

    server: str
    location: str
    workers: int
    running: list[int]
    without_workers_s: float = 0.0
    valid_until: str | None = None


@response_of(Throughput)
class QueueStatus:
    """The queue: jobs by state, recently ended ones, and estimated time until it is empty.

    ``typical_s`` is the median computing time of recent jobs of each kind, that of the
    demonstration where none has ended. [s]
    """

    remaining_s: float | None
    worker_pool: WorkerPool | None


@jobs_router.get("", response_model=Page[JobItem])
def list_jobs(
    store: TheStore,
    state: RunState | None = None,
    kind: Annotated[str | None, Query(max_length=32, description="Kind of job.")] = None,
    batch_id: Reference = None,
    ids: Annotated[
        str | None,
        Query(
            max_length=20_000,
            pattern="^[0-9, ]*$",
            description="Ids of jobs, separated by commas.",
        ),
    ] = None,
    limit: Limit = 100,
    after: After = None,
) -> Json:
    """List jobs, newest first."""
    only = None if ids is None else split_ids(ids, "ids")
    return Json(
        job_list.read_page(
            store, state=state, kind=kind, batch_id=batch_id, ids=only, limit=limit, after=after
        )
    )


@jobs_router.get("/status", response_model=QueueStatus)
def get_queue_status(store: TheStore) -> Json:
    """Return the state of the queue and its workers."""
    rate = job_list.count_throughput(store)
    usual = {name: kind.usual_s for name, kind in load_kinds().items() if kind.usual_s is not None}
    rate = replace(rate, typical_s=usual | rate.typical_s)
    pool = leases.status(store)
    return Json(
        extend_record(
            QueueStatus,
            rate,
            # A dispatcher of another version may report more.
            worker_pool=None
            if pool is None
            else WorkerPool(**{k: v for k, v in pool.items() if k in WorkerPool.__slots__}),
        )
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class JobKind:
    """A kind of job, its label, and the address of what its jobs work on or have as result.

    ``{field}`` in the address is a value of the request of a job, ``{result.field}`` of its
    result, ``{id}`` its id; ``:percent`` multiplies a fraction by 100, ``:not`` is the contrary.
    """

    name: str
    label: str
    page: str


@jobs_router.get("/kinds", response_model=Items[JobKind])
def list_job_kinds() -> Json:
    """List the kinds of jobs, with their labels and addresses."""
    kinds = load_kinds().values()
    return Json(
        Items(items=[JobKind(name=one.name, label=one.label, page=one.page) for one in kinds])
    )


@jobs_router.get("/{job_id}", response_model=JobItem)
def get_job(store: TheStore, job_id: Identity) -> Json:
    """Return the progress of a job."""
    return Json(job_list.get(store, job_id))


@jobs_router.get("/{job_id}/log", response_model=Items[JobEvent])
def get_job_log(store: TheStore, job_id: Identity) -> Json:
    """Return the log of a job."""
    job_list.get(store, job_id)
    return Json(Items(items=job_log.read_log(store, job_id)))


@jobs_router.post("/{job_id}/cancel", response_model=JobItem, status_code=status.HTTP_202_ACCEPTED)
def cancel_job(context: TheContext, job_id: Identity) -> Json:
    """Cancel a job that has not ended."""
    queue.request_cancel(context.store, job_id)
    context.dispatcher.wake()
    return Json(job_list.get(context.store, job_id), status.HTTP_202_ACCEPTED)


@jobs_router.post("/{job_id}/retry", response_model=JobItem, status_code=status.HTTP_202_ACCEPTED)
def retry_job(context: TheContext, job_id: Identity) -> Json:
    """Queue a failed or cancelled job again."""
    job = context.store.jobs.get(job_id)
    if job.kind == GREY_BOX.name and GREY_BOX.read_request(job).source:
        refuse_code(context)
    with context.store.transaction():  # as it was queued; it may start at once
        queue.request_retry(context.store, job_id)
        queued = job_list.get(context.store, job_id)
    context.dispatcher.wake()
    return Json(queued, status.HTTP_202_ACCEPTED)


# --- Events: a stream of the state changes of jobs, and of live identification --------------------

events_router = make_router("/events", tag="jobs")

_CHECKED_S = 1.0  # between two checks of the account of a reader of samples [s]
_UNBUFFERED = {"Cache-Control": "no-cache", "X-Accel-Buffering": "no"}  # by browsers, by nginx
_FIELDS = {"data": "string", "event": "string", "id": "string"}
_SCHEMA = {"type": "object", "properties": {one: {"type": sort} for one, sort in _FIELDS.items()}}


class _EventStream(StreamingResponse):
    """Server-sent events as they are written.

    Not those of the framework, which passes each event through two queues for each of a hundred
    pages: 120 ms for one update, in which no other request was served.
    """

    media_type = "text/event-stream"


_Event = Annotated[int | None, Query(ge=0, le=2**31 - 1, description="Id of the last known event.")]
_Channels = Annotated[str, Query(description="Channels of the stream, separated by commas.")]


@events_router.get(
    "",
    response_class=_EventStream,
    responses={200: {"content": {"text/event-stream": {"itemSchema": _SCHEMA}}}},
)
async def stream_events(
    request: Request,
    context: TheContext,
    after: _Event = None,
    last_event_id: Annotated[str | None, Header()] = None,
    stream_id: Reference = None,
    channels: _Channels = "",
) -> _EventStream:
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
    names = tuple(name.strip() for name in channels.split(",") if name.strip())
    reader = _StreamReader(context.streams, stream_id, names)
    texts = _write_updates(context.live, context.store, request, known, reader)
    return _EventStream(texts, headers=_UNBUFFERED)


async def _write_updates(
    live: LiveEvents, store: Store, request: Request, after: int | None, reader: _StreamReader
) -> AsyncIterator[bytes]:
    """Yield the text of each update, until the session ends or the server stops."""
    access, checked = get_access(), 0.0
    async for update in live.listen(after):
        # Not for an update of another campaign, which this reader does not see.
        silence = KEEPALIVE_COMMENT if update.is_empty else b""
        is_due = (
            update.events
            or update.running
            or update.changed
            or time.monotonic() - checked > _CHECKED_S
        )
        if access is not None and is_due:
            visible = await anyio.to_thread.run_sync(
                *(_select_visible, store, request, access, update), limiter=live.limiter
            )
            if visible is None:
                return
            update, access = visible
            checked = time.monotonic()
        samples = b"".join(text for one in update.streams for text in reader.read(one, access))
        if text := update.text + samples or silence:
            yield text


@dataclass(slots=True)
class _StreamReader:
    """What one reader has seen of the streams: number of states, end of the samples."""

    streams: LiveStreams
    stream_id: int | None
    names: tuple[str, ...]
    seen: dict[int, int] = field(default_factory=dict)
    newest_s: float | None = None

    def read(self, stream_id: int, access: Access | None) -> Iterator[bytes]:
        """Yield what is new of a stream, if its campaign may be read."""
        campaign = self.streams.find_campaign(stream_id)
        readable = None if access is None else access.readable
        if campaign is None or (readable is not None and campaign not in readable):
            return
        count = self.streams.count_states(stream_id)
        if self.seen.get(stream_id) != count:
            self.seen[stream_id] = count
            snapshot = self.streams.find_snapshot(stream_id)
            yield write_event("live", snapshot)
        newest_s = self.streams.find_newest_s(stream_id)
        if stream_id != self.stream_id or not self.names or newest_s is None:
            return
        if self.newest_s is not None and newest_s > self.newest_s:
            chart = self.streams.read_samples(stream_id, self.names, self.newest_s, 4000)
            yield write_event("samples", chart)
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
