"""Together: who asks the same at the same time is answered together.

When a batch moves on, every open page reads its lists again. One question is
answered, and the others that were asked before that answer was begun take it over:
fifty pages cost what two do, and none sees anything older than its question.
"""

from __future__ import annotations

import asyncio
from collections.abc import MutableMapping
from dataclasses import dataclass, field
from itertools import count
from typing import Any

from starlette.datastructures import Headers
from starlette.types import ASGIApp, Message, Receive, Scope, Send

_LARGEST = 4 * 1024**2  # an answer that is larger, or has no length yet, is sent as it comes
_OF_THE_CALLER = frozenset({b"connection", b"keep-alive", b"referer", b"user-agent"})

_Question = tuple[str, bytes, frozenset[tuple[bytes, bytes]]]


@dataclass(slots=True)
class _Asked:
    """A question, how many wait for its answer, and the newest answer."""

    turn: asyncio.Lock = field(default_factory=asyncio.Lock)
    waiting: int = 0
    begun: int = 0
    answer: list[Message] | None = None


class Together:
    """Shares answers among equal GET requests that wait; headers count as the question does."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app
        self._asked: dict[_Question, _Asked] = {}
        self._clock = count(1)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer, or hand on the answer of another."""
        if scope["type"] != "http" or scope["method"] != "GET":
            await self._app(scope, receive, send)
            return
        headers = frozenset(pair for pair in scope["headers"] if pair[0] not in _OF_THE_CALLER)
        question = (scope["path"], scope["query_string"], headers)
        arrived = next(self._clock)
        asked = self._asked.setdefault(question, _Asked())
        asked.waiting += 1
        try:
            answer = await self._answer(asked, arrived, scope, receive, send)
        finally:
            asked.waiting -= 1
            if not asked.waiting:
                del self._asked[question]
        for message in answer:
            await send(dict(message))

    async def _answer(
        self, asked: _Asked, arrived: int, scope: Scope, receive: Receive, send: Send
    ) -> list[Message]:
        """The answer to send; nothing where it has been sent."""
        await asked.turn.acquire()
        relay = _Relay(send, asked.turn)
        try:
            if asked.answer is None or asked.begun < arrived:
                asked.begun, asked.answer = next(self._clock), None
                await self._app(scope, receive, relay)
                if not relay.passes:
                    asked.answer = relay.kept
                return relay.kept
            return asked.answer
        finally:
            if not relay.passes:
                asked.turn.release()


class _Relay:
    """Keeps an answer back, or lets it pass as soon as it is seen to be long."""

    def __init__(self, send: Send, turn: asyncio.Lock) -> None:
        self.kept: list[Message] = []
        self.passes = False
        self._send = send
        self._turn = turn

    async def __call__(self, message: MutableMapping[str, Any]) -> None:
        if message["type"] == "http.response.start":
            length = Headers(raw=message["headers"]).get("content-length")
            if length is None or int(length) > _LARGEST:
                self.passes = True
                self._turn.release()  # nobody is to wait for a slow reader
        if self.passes:
            await self._send(message)
        else:
            self.kept.append(message)
