"""Equal concurrent GET requests share one response, never an outdated one."""

from __future__ import annotations

import asyncio
from collections.abc import Coroutine
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import pytest
from starlette.types import Message, Receive, Scope, Send

from flexsid.api.middleware.request_coalescing import RequestCoalescing


class Service:
    """Counts its requests; responds with a delay."""

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
    """Run in a separate thread: browser tests may have an event loop in this one."""
    with ThreadPoolExecutor(1) as thread:
        thread.submit(asyncio.run, scenario).result()


async def send_request(
    app: RequestCoalescing, path: str = "/list", query: bytes = b"", **scope: Any
) -> str:
    sent: list[Message] = []

    async def send(message: Message) -> None:
        sent.append(message)

    async def receive() -> Message:
        return {"type": "http.request", "body": b"", "more_body": False}

    asked = {"type": "http", "method": "GET", "path": path, "query_string": query, "headers": []}
    await app({**asked, **scope}, receive, send)
    assert [m["type"] for m in sent] == ["http.response.start", "http.response.body"]
    return str(sent[1]["body"].decode())


def test_fifty_equal_requests_are_processed_as_two() -> None:
    async def scenario() -> None:
        service = Service()
        app = RequestCoalescing(service)
        responses = await asyncio.gather(*(send_request(app) for _ in range(50)))
        # The first was being processed when the others arrived.
        assert responses == ["1"] + 49 * ["2"]
        assert await send_request(app) == "3"  # responses are not cached

    _run(scenario())


def test_request_after_change_is_not_outdated() -> None:
    async def scenario() -> None:
        service = Service()
        app = RequestCoalescing(service)
        service.pause.clear()
        first = asyncio.create_task(send_request(app))
        await asyncio.sleep(0.01)
        service.asked = 100  # a change, while the first response is being sent
        second = asyncio.create_task(send_request(app))
        await asyncio.sleep(0.01)
        service.pause.set()
        assert (await first, await second) == ("1", "101")

    _run(scenario())


def test_different_requests_are_processed_separately() -> None:
    async def scenario() -> None:
        service = Service()
        app = RequestCoalescing(service)
        ann, bob = ([(b"x-flexsid-analyst", name)] for name in (b"Ann", b"Bob"))
        responses = await asyncio.gather(
            send_request(app),
            send_request(app, query=b"limit=5"),
            send_request(app, path="/other"),
            send_request(app, headers=ann),
            send_request(app, headers=bob),
            send_request(app, method="POST"),
            send_request(app, method="POST"),
        )
        assert sorted(responses) == list("1234567")

    _run(scenario())


def test_streams_are_not_shared() -> None:
    async def scenario() -> None:
        service = Service(length=False)
        app = RequestCoalescing(service)
        service.pause.clear()
        streams = [asyncio.create_task(send_request(app)) for _ in range(3)]
        await asyncio.sleep(0.01)
        assert service.asked == 3
        service.pause.set()
        assert sorted(await asyncio.gather(*streams)) == ["1", "2", "3"]

    _run(scenario())


def test_error_is_not_shared() -> None:
    async def scenario() -> None:
        service = Service()
        app = RequestCoalescing(service)
        service.pause.clear()
        first = asyncio.create_task(send_request(app))
        await asyncio.sleep(0.01)
        service.fails = True
        second = asyncio.create_task(send_request(app))
        service.pause.set()
        assert await first == "1"
        with pytest.raises(ValueError, match="broken"):
            await second
        service.fails = False
        assert await send_request(app) == "3"

    _run(scenario())
