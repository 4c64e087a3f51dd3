"""Requests that write wait for each other; those that read or log in do not wait for them."""

from __future__ import annotations

import asyncio
from collections.abc import Coroutine
from concurrent.futures import ThreadPoolExecutor
from typing import Any

from starlette.types import Receive, Scope, Send

from flexsid.api.middleware.limits import WriteLimit


class Service:
    """An application whose requests respond, and end, when the test sets an event."""

    def __init__(self) -> None:
        self.begun: list[str] = []
        self.responds = asyncio.Event()
        self.ends = asyncio.Event()

    async def __call__(self, scope: Scope, _receive: Receive, send: Send) -> None:
        self.begun.append(scope["path"])
        await self.responds.wait()
        await send({"type": "http.response.start", "status": 200, "headers": []})
        await self.ends.wait()


async def _send(app: WriteLimit, method: str, path: str) -> None:
    async def nothing(*_: Any) -> Any:
        return None

    scope = {"type": "http", "method": method, "path": path}
    await app(scope, nothing, nothing)


def _run(scenario: Coroutine[Any, Any, None]) -> None:
    # That of a browser test has a loop already.
    with ThreadPoolExecutor(1) as executor:
        executor.submit(asyncio.run, scenario).result()


async def _pass_time() -> None:
    for _ in range(20):
        await asyncio.sleep(0)


def test_reading_and_log_in_do_not_wait_for_writers() -> None:
    async def scenario() -> None:
        service = Service()
        app = WriteLimit(service)
        sent = [asyncio.create_task(_send(app, "POST", "/api/v1/notes")) for _ in range(5)]
        await _pass_time()
        assert service.begun == ["/api/v1/notes"] * 3
        sent.append(asyncio.create_task(_send(app, "POST", "/api/v1/session")))
        sent.append(asyncio.create_task(_send(app, "GET", "/api/v1/runs")))
        await _pass_time()
        assert set(service.begun[3:]) == {"/api/v1/session", "/api/v1/runs"}
        # Clients that have not received their responses stop nobody.
        service.responds.set()
        await _pass_time()
        assert service.begun[5:] == ["/api/v1/notes"] * 2
        service.ends.set()
        await asyncio.gather(*sent)

    _run(scenario())
