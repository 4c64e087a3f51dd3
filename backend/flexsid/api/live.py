"""Live: what happens to runs, told to every page that listens, as it happens.

The database is read once for all listeners. What is told has the id of its line
in the log of runs, so that a page that lost its connection goes on where it was.
"""

from __future__ import annotations

import asyncio
import logging
from collections.abc import AsyncIterator
from dataclasses import dataclass

from anyio import to_thread

from flexsid.errors import FlexsidError
from flexsid.records.batch import RunEvent
from flexsid.storage import job_list, run_log
from flexsid.storage.job_list import Job
from flexsid.storage.store import Store

_log = logging.getLogger(__name__)

_LOOK_S = 1.0  # other servers write into the log too
_MOST = 1000  # a page that missed more than this reads its lists again


@dataclass(frozen=True, slots=True)
class Happened:
    """Lines of the log that are new, and the jobs that run, where they have moved."""

    events: list[RunEvent]
    running: list[Job] | None
    missed: bool = False


class Live:
    """Reads the log and hands it on; lives in the event loop of the server."""

    def __init__(self, store: Store) -> None:
        self._store = store
        self._listeners: set[asyncio.Queue[Happened | None]] = set()
        self._rung = asyncio.Event()
        self._loop = asyncio.get_running_loop()
        self._stopped = False
        self._task = asyncio.create_task(self._run())

    def ring(self) -> None:
        """Look at the log now; may be called from any thread."""
        if not self._stopped:
            self._loop.call_soon_threadsafe(self._rung.set)

    def stop(self) -> None:
        """End all streams, so that the server can stop; may be called from any thread."""
        if not self._stopped:
            self._stopped = True
            self._loop.call_soon_threadsafe(self._end)

    async def listen(self, after: int | None) -> AsyncIterator[Happened]:
        """Yield what happened after an event, then what happens, until the server stops.

        Parameters
        ----------
        after
            Id of the last event that is known; None: only what is new.
        """
        heard: asyncio.Queue[Happened | None] = asyncio.Queue()
        self._listeners.add(heard)
        self._rung.set()
        try:
            last = after
            if after is not None:
                known = await to_thread.run_sync(run_log.since, self._store, after, _MOST)
                last = known[-1].id if known else after
                yield Happened(known, None, missed=len(known) == _MOST)
            while not self._stopped:
                said = await heard.get()
                if said is None:
                    return
                events = [event for event in said.events if last is None or event.id > last]
                if events or said.running is not None:
                    yield Happened(events, said.running)
        finally:
            self._listeners.discard(heard)

    async def _run(self) -> None:
        last: int | None = None
        before: list[Job] = []
        while not self._stopped:
            self._rung.clear()
            if self._listeners:
                try:
                    events, running = await to_thread.run_sync(self._read, last)
                except FlexsidError as error:
                    _log.warning("live news wait: %s", error.message)
                else:
                    last = events[-1].id if events else last
                    if last is None:
                        last = await to_thread.run_sync(run_log.newest, self._store)
                    moved = running if running != before else None
                    before = running
                    for heard in self._listeners:
                        heard.put_nowait(Happened(events, moved))
            else:
                last = None
            try:
                await asyncio.wait_for(self._rung.wait(), _LOOK_S)
            except TimeoutError:
                continue

    def _read(self, last: int | None) -> tuple[list[RunEvent], list[Job]]:
        events = [] if last is None else run_log.since(self._store, last, _MOST)
        return events, job_list.under_way(self._store)

    def _end(self) -> None:
        self._task.cancel()
        for heard in self._listeners:
            heard.put_nowait(None)
