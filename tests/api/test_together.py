"""Equal questions that wait at the same time are answered together, and never with old news."""

from __future__ import annotations

import asyncio
from collections.abc import Coroutine
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import pytest
from starlette.types import Message, Receive, Scope, Send

from flexsid.api.together import Together


class Service:
    """Counts up with every question; takes a moment to answer."""

    def __init__(self, *, length: bool = True) -> None:
        self.asked = 0
        self.length = length
        self.fails = False
        self.pause = asyncio.Event()
        self.pause.set()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        self.asked += 1
        body = str(self.asked).encode()
        if self.fails:
            raise ValueError("broken")
        headers = [(b"content-length", str(len(body)).encode())] if self.length else []
        await asyncio.sleep(0)
        await send({"type": "http.response.start", "status": 200, "headers": headers})
        await self.pause.wait()
        await send({"type": "http.response.body", "body": body})


def _run(scenario: Coroutine[Any, Any, None]) -> None:
    """Run in a thread of its own: a browser of other tests keeps a loop in this one."""
    with ThreadPoolExecutor(1) as thread:
        thread.submit(asyncio.run, scenario).result()


async def ask(app: Together, path: str = "/list", query: bytes = b"", **scope: Any) -> str:
    sent: list[Message] = []

    async def send(message: Message) -> None:
        sent.append(message)

    async def receive() -> Message:
        return {"type": "http.request", "body": b"", "more_body": False}

    asked = {"type": "http", "method": "GET", "path": path, "query_string": query, "headers": []}
    await app({**asked, **scope}, receive, send)
    assert [m["type"] for m in sent] == ["http.response.start", "http.response.body"]
    return str(sent[1]["body"].decode())


def test_fifty_pages_cost_what_two_do() -> None:
    async def scenario() -> None:
        service = Service()
        app = Together(service)
        answers = await asyncio.gather(*(ask(app) for _ in range(50)))
        # The first was already being answered when the others asked.
        assert answers == ["1"] + 49 * ["2"]
        assert await ask(app) == "3"  # nothing is kept for later

    _run(scenario())


def test_whoever_asks_after_a_change_sees_it() -> None:
    async def scenario() -> None:
        service = Service()
        app = Together(service)
        service.pause.clear()
        first = asyncio.create_task(ask(app))
        await asyncio.sleep(0.01)
        service.asked = 100  # a change, while the first answer is on its way
        second = asyncio.create_task(ask(app))
        await asyncio.sleep(0.01)
        service.pause.set()
        assert (await first, await second) == ("1", "101")

    _run(scenario())


def test_other_questions_are_answered_for_themselves() -> None:
    async def scenario() -> None:
        service = Service()
        app = Together(service)
        ann, bob = ([(b"x-flexsid-analyst", name)] for name in (b"Ann", b"Bob"))
        answers = await asyncio.gather(
            ask(app),
            ask(app, query=b"limit=5"),
            ask(app, path="/other"),
            ask(app, headers=ann),
            ask(app, headers=bob),
            ask(app, method="POST"),
            ask(app, method="POST"),
        )
        assert sorted(answers) == list("1234567")

    _run(scenario())


def test_a_stream_is_not_waited_for() -> None:
    async def scenario() -> None:
        service = Service(length=False)
        app = Together(service)
        service.pause.clear()
        streams = [asyncio.create_task(ask(app)) for _ in range(3)]
        await asyncio.sleep(0.01)
        assert service.asked == 3
        service.pause.set()
        assert sorted(await asyncio.gather(*streams)) == ["1", "2", "3"]

    _run(scenario())


def test_an_error_is_nobody_elses() -> None:
    async def scenario() -> None:
        service = Service()
        app = Together(service)
        service.pause.clear()
        first = asyncio.create_task(ask(app))
        await asyncio.sleep(0.01)
        service.fails = True
        second = asyncio.create_task(ask(app))
        service.pause.set()
        assert await first == "1"
        with pytest.raises(ValueError, match="broken"):
            await second
        service.fails = False
        assert await ask(app) == "3"

    _run(scenario())
