"""Live events of jobs, streams and what a team changes, for all connected pages.

The database is read once for all listeners. Every event has the id of its entry in the log
of jobs, so that a page can resume after a lost connection.
"""

from __future__ import annotations

import asyncio
import logging
import time
from collections.abc import AsyncIterator, Callable
from dataclasses import dataclass, replace
from functools import cached_property

from anyio import CapacityLimiter, to_thread
from fastapi.sse import format_sse_event

from flexsid.api.serialization import dump_json
from flexsid.errors import FlexsidError
from flexsid.records.job import JobEvent
from flexsid.storage.changes import Totals, find_changed, read_totals
from flexsid.storage.jobs import job_list, job_log
from flexsid.storage.jobs.job_list import JobItem
from flexsid.storage.store import Store

_log = logging.getLogger(__name__)

_POLL_S = 1.0  # other servers write into the log too
_GATHERED_S = 0.05  # from a change to reading: the end of a job and the start of the next one are
# one update of a hundred pages, not three
_MAX_EVENTS = 1000  # a page that missed more events reloads its lists
_HEALTH: frozenset[tuple[str, None]] = frozenset({("health", None)})
_STREAMS_S = 0.1  # between two events of streams: samples are sent ten times per second
_SILENT_S = 15.0  # proxies close a connection on which nothing is sent for a minute


@dataclass(frozen=True)
class JobUpdate:
    """New entries of the log, the running jobs if they have changed, and what else has changed.

    ``changed`` has sorts of records with their campaign; without one for all readers.
    Without slots, so that its text is written once for all readers.
    """

    events: list[JobEvent]
    running: list[JobItem] | None
    missed: bool = False
    streams: frozenset[int] = frozenset()
    changed: frozenset[tuple[str, int | None]] = frozenset()

    @property
    def is_empty(self) -> bool:
        """Whether nothing has changed."""
        return self == _NOTHING

    @cached_property
    def text(self) -> bytes:
        """All that every reader of it is sent, as server-sent events."""
        parts = [write_event("missed", {})] if self.missed else []
        parts += [write_event("job", event, event.id) for event in self.events]
        if self.running is not None:
            parts.append(write_event("running", self.running))
        if self.changed:
            records = {"records": sorted({name for name, _ in self.changed})}
            parts.append(write_event("changed", records))
        return b"".join(parts)

    def extend(self, later: JobUpdate) -> JobUpdate:
        """Return this update and a later one as one."""
        return JobUpdate(
            [*self.events, *later.events],
            self.running if later.running is None else later.running,
            self.missed or later.missed,
            self.streams | later.streams,
            self.changed | later.changed,
        )


_NOTHING = JobUpdate([], None)


def write_event(name: str, content: object, number: int | None = None) -> bytes:
    """Write a server-sent event; one with a number can be resumed after."""
    known = None if number is None else str(number)
    return format_sse_event(data_str=dump_json(content).decode(), event=name, id=known)


@dataclass(frozen=True, slots=True)
class _LastRead:
    """What was read last; without a database nothing is known."""

    running: list[JobItem]
    totals: Totals
    health: object


class LiveEvents:
    """Reads what changes and distributes it; runs in the event loop of the server.

    Parameters
    ----------
    store
        Store of the records.
    check_health
        Returns the health of the parts of the workbench; pages read it when it differs.
    """

    def __init__(self, store: Store, check_health: Callable[[], object] = lambda: None) -> None:
        # A thousand pages that look up what they may show would occupy all threads of requests.
        self.limiter = CapacityLimiter(1)
        self._store = store
        self._check_health = check_health
        self._listeners: set[asyncio.Queue[JobUpdate | None]] = set()
        self._notified = asyncio.Event()
        self._loop = asyncio.get_running_loop()
        self._stopped = False
        self._streams: set[int] = set()
        self._task = asyncio.create_task(self._run())

    def notify(self) -> None:
        """Read the log now; may be called from any thread."""
        if not self._stopped:
            self._loop.call_soon_threadsafe(self._notified.set)

    def publish_stream(self, stream_id: int) -> None:
        """Report soon that a stream has new samples or a new state; from any thread."""
        if not self._stopped and self._listeners:
            self._loop.call_soon_threadsafe(self._add_stream, stream_id)

    def stop(self) -> None:
        """End all streams before the server stops; may be called from any thread."""
        if not self._stopped:
            self._stopped = True
            self._loop.call_soon_threadsafe(self._end)

    async def listen(self, after: int | None) -> AsyncIterator[JobUpdate]:
        """Yield the events after a known one, then all new ones, until the server stops.

        After a while without any an empty update is yielded, for which something is to be sent.

        Parameters
        ----------
        after
            Id of the last known event; None for new events only.
        """
        updates: asyncio.Queue[JobUpdate | None] = asyncio.Queue()
        self._listeners.add(updates)
        self._notified.set()
        try:
            last, sent = after, time.monotonic()
            if after is not None and not self._stopped:
                # From its first update on, this listener receives every later event.
                first = await updates.get()
                if first is None:
                    return
                known = await to_thread.run_sync(
                    job_log.read_since, self._store, after, _MAX_EVENTS, limiter=self.limiter
                )
                last = known[-1].id if known else after
                missed = len(known) == _MAX_EVENTS
                yield replace(first, events=known, missed=missed)
            while not self._stopped:
                update = await updates.get()
                while update is not None and not updates.empty():  # it came during the last one
                    later = updates.get_nowait()
                    update = None if later is None else update.extend(later)
                if update is None:
                    return
                events = [event for event in update.events if last is None or event.id > last]
                if len(events) < len(update.events):
                    update = replace(update, events=events)
                if not update.is_empty or time.monotonic() - sent > _SILENT_S:
                    sent = time.monotonic()
                    yield update
        finally:
            self._listeners.discard(updates)

    async def _run(self) -> None:
        last: int | None = None
        before: _LastRead | None = None
        while not self._stopped:
            self._notified.clear()
            if self._listeners:
                try:
                    last, update, before = await to_thread.run_sync(self._read, last, before)
                except FlexsidError as error:
                    _log.warning("live events are delayed: %s", error.message)
                    update = replace(_NOTHING, changed=_HEALTH if before else frozenset())
                    before = None
                for updates in self._listeners:
                    updates.put_nowait(update)
            else:
                last = before = None
            try:
                await asyncio.wait_for(self._notified.wait(), _POLL_S)
                await asyncio.sleep(_GATHERED_S)
            except TimeoutError:
                continue

    def _read(self, last: int | None, before: _LastRead | None) -> tuple[int, JobUpdate, _LastRead]:
        store = self._store
        events = [] if last is None else job_log.read_since(store, last, _MAX_EVENTS)
        if last is None:
            last = job_log.find_newest(store)
        state = _LastRead(job_list.list_running(store), read_totals(store), self._check_health())
        if before is None:
            update = JobUpdate(events, state.running, changed=_HEALTH)
        else:
            running = state.running if state.running != before.running else None
            changed = find_changed(before.totals, state.totals)
            if state.health != before.health:
                changed |= _HEALTH
            update = JobUpdate(events, running, changed=changed)
        return events[-1].id if events else last, update, state

    def _add_stream(self, stream_id: int) -> None:
        if not self._streams:
            self._loop.call_later(_STREAMS_S, self._send_streams)
        self._streams.add(stream_id)

    def _send_streams(self) -> None:
        update = replace(_NOTHING, streams=frozenset(self._streams))
        self._streams.clear()
        for updates in self._listeners:
            # A slow page reads the newest samples with what it waits for.
            if updates.empty():
                updates.put_nowait(update)

    def _end(self) -> None:
        self._task.cancel()
        for updates in self._listeners:
            updates.put_nowait(None)
