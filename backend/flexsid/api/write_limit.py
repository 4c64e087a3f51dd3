"""Limit of concurrent requests that write, so that reading does not wait for writers.

A writer may wait half a minute for the write lock of the database, which another program holds.
Readers need no lock, but a thread of the same pool.
"""

from __future__ import annotations

import anyio
from starlette.types import ASGIApp, Receive, Scope, Send

THREADS = 4
"""Threads of requests. The database driver and numpy hold the interpreter lock; more threads only
wait for each other (forty threads on one list of a thousand rows blocked each other)."""

_WRITERS = THREADS - 1
_READING = ("GET", "HEAD", "OPTIONS")


class WriteLimit:
    """Middleware that leaves one thread to requests that read."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app
        self._writers = anyio.Semaphore(_WRITERS)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on a request, after others that write if there are too many."""
        if scope["type"] != "http" or scope["method"] in _READING:
            await self._app(scope, receive, send)
            return
        async with self._writers:
            await self._app(scope, receive, send)
