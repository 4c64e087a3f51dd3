"""Connections of clients: requests must arrive in time, and with headers of limited size.

Otherwise a connection that only waits would remain for ever, with what it has sent.
"""

from __future__ import annotations

import asyncio
from http import HTTPStatus
from typing import Any

from uvicorn.protocols.http.httptools_impl import HttpToolsProtocol

from flexsid.api.errors import make_problem
from flexsid.api.middleware.request_log import LARGEST_HEADERS, refuse_headers

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
        self._most_connections, self.limit_concurrency = self.limit_concurrency, None
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
