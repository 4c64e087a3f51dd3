"""Limit of concurrent requests that write, so that reading does not wait for writers.

A writer may wait half a minute for the write lock of the database, which another program holds.
Readers need no lock, but a thread of the same pool. Who logs in does not wait for other writers.
"""

from __future__ import annotations

from contextlib import AsyncExitStack

import anyio
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from flexsid.api.middleware.body_limit import READING, is_upload

THREADS = 5
"""Threads of requests. The database driver and numpy hold the interpreter lock; more threads only
wait for each other (forty threads on one list of a thousand rows blocked each other)."""

_LOGINS = 1
_WRITERS = THREADS - _LOGINS - 1
_LOGIN = "/api/v1/session"


class WriteLimit:
    """Middleware that leaves one thread to requests that read, and one to those that log in.

    A place is taken when a request has arrived, and left when its response begins: clients that
    send or read slowly take none.
    """

    def __init__(self, app: ASGIApp) -> None:
        self._app = app
        self._writers = anyio.Semaphore(_WRITERS)
        self._logins = anyio.Semaphore(_LOGINS)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on a request, after others that write if there are too many."""
        if scope["type"] != "http" or scope["method"] in READING:
            await self._app(scope, receive, send)
            return
        is_login = scope["method"] == "POST" and scope["path"] == _LOGIN
        places = self._logins if is_login else self._writers
        async with AsyncExitStack() as place:

            async def receive_and_take() -> Message:
                message = await receive()
                if message["type"] == "http.request" and not message.get("more_body", False):
                    await place.enter_async_context(places)
                return message

            async def leave_and_send(message: Message) -> None:
                await place.aclose()
                await send(message)

            if is_upload(scope):
                await self._app(scope, receive_and_take, leave_and_send)
            else:
                await place.enter_async_context(places)
                await self._app(scope, receive, leave_and_send)
