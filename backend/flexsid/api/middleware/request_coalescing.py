"""Coalescing of equal concurrent GET requests.

When the state of a batch changes, every open page reloads its lists. One request is processed,
and all equal requests that arrived before its processing began share its response: fifty pages
cost as much as two, and no response is older than its request.
"""

from __future__ import annotations

import asyncio
from collections.abc import MutableMapping
from dataclasses import dataclass, field
from itertools import count
from typing import Any

from starlette.datastructures import Headers
from starlette.types import ASGIApp, Message, Receive, Scope, Send

_LARGEST = 4 * 1024**2  # larger responses, and those of unknown length, are not shared
_CLIENT_HEADERS = frozenset({b"connection", b"keep-alive", b"referer", b"user-agent"})

_RequestKey = tuple[str, bytes, frozenset[tuple[bytes, bytes]]]


@dataclass(slots=True)
class _Pending:
    """Equal requests: the number waiting, and the newest response with its start."""

    lock: asyncio.Lock = field(default_factory=asyncio.Lock)
    waiting: int = 0
    started: int = 0
    response: list[Message] | None = None


class RequestCoalescing:
    """Shares responses among equal waiting GET requests; equal includes the headers."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app
        self._pending: dict[_RequestKey, _Pending] = {}
        self._clock = count(1)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Process the request, or send the response of an equal one."""
        if scope["type"] != "http" or scope["method"] != "GET":
            await self._app(scope, receive, send)
            return
        headers = frozenset(pair for pair in scope["headers"] if pair[0] not in _CLIENT_HEADERS)
        key = (scope["path"], scope["query_string"], headers)
        arrived = next(self._clock)
        pending = self._pending.setdefault(key, _Pending())
        pending.waiting += 1
        try:
            response = await self._respond(pending, arrived, scope, receive, send)
        finally:
            pending.waiting -= 1
            if not pending.waiting:
                del self._pending[key]
        for message in response:
            await send(dict(message))

    async def _respond(
        self, pending: _Pending, arrived: int, scope: Scope, receive: Receive, send: Send
    ) -> list[Message]:
        """Return the response to send; empty if it has been sent already."""
        await pending.lock.acquire()
        relay = _Relay(send, pending.lock)
        try:
            if pending.response is None or pending.started < arrived:
                pending.started, pending.response = next(self._clock), None
                await self._app(scope, receive, relay)
                if not relay.passes:
                    pending.response = relay.messages
                return relay.messages
            return pending.response
        finally:
            if not relay.passes:
                pending.lock.release()


class _Relay:
    """Buffers a response, or sends it at once if it is long or of unknown length."""

    def __init__(self, send: Send, lock: asyncio.Lock) -> None:
        self.messages: list[Message] = []
        self.passes = False
        self._send = send
        self._lock = lock

    async def __call__(self, message: MutableMapping[str, Any]) -> None:
        if message["type"] == "http.response.start":
            length = Headers(raw=message["headers"]).get("content-length")
            if length is None or int(length) > _LARGEST:
                self.passes = True
                self._lock.release()  # other requests do not wait for a slow client
        if self.passes:
            await self._send(message)
        else:
            self.messages.append(message)
