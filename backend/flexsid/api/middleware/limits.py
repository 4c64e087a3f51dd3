"""Limits of requests: size of bodies and headers, time to arrive, and concurrent writes.

Only uploads are passed on before they have arrived, to be written into files. Other bodies are
received here, where they take no thread and no place of ``api/middleware/limits.py``.

Otherwise a connection that only waits would remain for ever, with what it has sent.

A writer may wait half a minute for the write lock of the database, which another program holds.
Readers need no lock, but a thread of the same pool. Who logs in does not wait for other writers.
"""

from __future__ import annotations

import asyncio
from contextlib import AsyncExitStack
from http import HTTPStatus
from typing import Any

import anyio
from starlette.datastructures import Headers
from starlette.exceptions import HTTPException
from starlette.types import ASGIApp, Message, Receive, Scope, Send
from uvicorn.protocols.http.httptools_impl import HttpToolsProtocol

from flexsid.api.errors import make_problem
from flexsid.api.middleware.request_log import LARGEST_HEADERS, refuse_headers

# --- Size limits of request bodies: 512 MB for uploads, 2 MB for all other requests ---------------

LARGEST_BODY = 2 * 1024**2
LARGEST_UPLOAD = 512 * 1024**2
READING = ("GET", "HEAD", "OPTIONS")
"""Methods of requests that change nothing."""

_UPLOADS = frozenset({"/api/v1/maneuvers", "/api/v1/uploads"})


def is_upload(scope: Scope) -> bool:
    """Return whether the body of a request may be large; its route reads it to the end."""
    return scope["method"] == "POST" and scope["path"] in _UPLOADS


class BodyLimit:
    """Refuses bodies whose announced or received size exceeds the limit of the route."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass the request on with its body; respond with 413 above the limit."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        limit = LARGEST_UPLOAD if is_upload(scope) else LARGEST_BODY
        words = f"the body is larger than {limit // 1024**2} MB, the limit of this route"
        announced = Headers(scope=scope).get("content-length", "0")
        if not (announced.isascii() and announced.isdigit()) or int(announced[:20]) > limit:
            await make_problem(413, "too-large", words)(scope, receive, send)
            return
        received = 0

        async def receive_counted() -> Message:
            nonlocal received
            message = await receive()
            received += len(message.get("body", b""))
            if received > limit:
                raise HTTPException(413, words)
            return message

        if is_upload(scope) or scope["method"] in READING:
            await self._app(scope, receive_counted, send)
            return
        try:
            body = await _receive_body(receive_counted)
        except HTTPException:
            await make_problem(413, "too-large", words)(scope, receive, send)
            return
        if body is not None:
            await self._app(scope, _repeat(body, receive), send)


async def _receive_body(receive: Receive) -> bytes | None:
    """Return the whole body; None if the client has closed the connection before its end."""
    body = bytearray()
    while True:
        message = await receive()
        if message["type"] != "http.request":
            return None
        body += message.get("body", b"")
        if not message.get("more_body", False):
            return bytes(body)


def _repeat(body: bytes, receive: Receive) -> Receive:
    waiting: list[Message] = [{"type": "http.request", "body": body, "more_body": False}]

    async def receive_again() -> Message:
        return waiting.pop() if waiting else await receive()

    return receive_again


# --- Connections of clients: requests must arrive in time, and with headers of limited size -------

# Those of Apache (mod_reqtimeout): a request must begin and have its headers, and a body must
# begin, within this time; a body may take longer by the time that its bytes need at this rate.
HEADERS_S = 20.0
BODY_S = 20.0
LEAST_BYTES_PER_S = 500.0

MOST_CONNECTIONS = 4096
_OTHER_FILES = 256
"""Open files of the server besides those of connections: database, pipes, uploads."""


class ClientConnection(HttpToolsProtocol):
    """A connection that is closed when the headers or the body of a request do not arrive."""

    def __init__(self, *args: Any, **options: Any) -> None:
        super().__init__(*args, **options)
        self._most_connections = self.limit_concurrency
        self.limit_concurrency = None  # pyrefly: ignore[bad-override-mutable-attribute]
        self._timer: asyncio.TimerHandle | None = None
        self._has_begun = False  # the first request
        self._has_headers = False  # the request that arrives
        self._since_s = 0.0
        self._n_received = 0  # bytes of its body
        self._n_unused = 0  # bytes since its begin, the end of its headers, or the last of its body

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """Wait for a request, unless there are too many connections."""
        super().connection_made(transport)
        if self._most_connections is not None and len(self.connections) > self._most_connections:
            self._refuse(503, "too-many-connections", "the server has too many connections")
        else:
            self._begin_waiting()

    def connection_lost(self, exc: Exception | None) -> None:
        """End waiting."""
        self._end_waiting()
        super().connection_lost(exc)

    def data_received(self, data: bytes) -> None:
        """Read a part of a request; what is no part of a body is limited."""
        self._has_begun = True
        if self._timer is None:
            self._begin_waiting()
        self._n_unused += len(data)
        super().data_received(data)
        if self._n_unused > LARGEST_HEADERS and not self.transport.is_closing():
            self._refuse(431, "headers-too-large", refuse_headers(self._n_unused))

    def on_message_begin(self) -> None:
        """Wait for headers."""
        super().on_message_begin()
        self._begin_waiting()

    def on_headers_complete(self) -> None:
        """Wait for a body."""
        super().on_headers_complete()
        self._begin_waiting(has_headers=True)

    def on_body(self, body: bytes) -> None:
        """Wait for the rest of the body."""
        super().on_body(body)
        self._n_received += len(body)
        self._n_unused = 0

    def on_message_complete(self) -> None:
        """End waiting: the server responds, or its own limit of idle connections holds."""
        super().on_message_complete()
        self._end_waiting()

    def _begin_waiting(self, *, has_headers: bool = False) -> None:
        self._end_waiting()
        self._has_headers = has_headers
        self._since_s = self.loop.time()
        self._timer = self.loop.call_later(BODY_S if has_headers else HEADERS_S, self._check)

    def _end_waiting(self) -> None:
        self._n_received = self._n_unused = 0
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None

    def _check(self) -> None:
        if self.transport.is_closing():
            return
        if self.flow.read_paused:  # the server does not read at present
            self._begin_waiting(has_headers=self._has_headers)
            return
        allowed_s = BODY_S + self._n_received / LEAST_BYTES_PER_S
        ends_s = self._since_s + (allowed_s if self._has_headers else HEADERS_S)
        if self.loop.time() < ends_s:
            self._timer = self.loop.call_at(ends_s, self._check)
            return
        if not self._has_begun:  # opened by a browser beforehand
            self.transport.close()
            return
        what = "body" if self._has_headers else "headers"
        self._refuse(408, "request-timeout", f"the {what} of the request did not arrive in time")

    def _refuse(self, status: int, code: str, detail: str) -> None:
        """Respond to what is no whole request, unless a response has begun, and close."""
        self._end_waiting()
        is_responding = self.cycle is not None and not self.cycle.response_complete
        if not is_responding or (self._has_headers and not self.cycle.response_started):
            response = make_problem(status, code, detail)
            response.headers["connection"] = "close"
            lines = [f"HTTP/1.1 {status} {HTTPStatus(status).phrase}".encode()]
            lines += [b"%s: %s" % pair for pair in response.raw_headers]
            self.transport.write(b"\r\n".join([*lines, b"", bytes(response.body)]))
        self.transport.close()


def allow_connections() -> int:
    """Return the largest number of connections, for which files are allowed to be open."""
    try:
        import resource
    except ImportError:  # on Windows, which has no such limit
        return MOST_CONNECTIONS
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    needed = MOST_CONNECTIONS + _OTHER_FILES
    if soft != resource.RLIM_INFINITY and soft < needed:
        soft = needed if hard == resource.RLIM_INFINITY else min(needed, hard)
        resource.setrlimit(resource.RLIMIT_NOFILE, (soft, hard))
        return max(soft - _OTHER_FILES, soft // 2)
    return MOST_CONNECTIONS


# --- Limit of concurrent requests that write, so that reading does not wait for writers -----------

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
