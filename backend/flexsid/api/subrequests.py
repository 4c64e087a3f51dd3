"""GET requests from the application to its own routes."""

from __future__ import annotations

from starlette.requests import Request
from starlette.types import Message

from flexsid.storage.access import get_access, using_access

_IDENTITY = (b"host", b"cookie", b"authorization", b"x-forwarded-user", b"x-flexsid-proxy-secret")


async def get_internally(request: Request, path: str, query: str) -> tuple[int, bytes]:
    """Return status and body of ``GET path?query``, called with the host of a request."""
    copied = ("asgi", "http_version", "scheme", "server", "client", "state")
    scope = {
        **{key: request.scope[key] for key in copied if key in request.scope},
        "type": "http",
        "method": "GET",
        "path": path,
        "raw_path": path.encode(),
        "root_path": "",
        "query_string": query.encode(),
        # The same account asks.
        "headers": [pair for pair in request.scope["headers"] if pair[0] in _IDENTITY],
    }
    status, parts = 500, list[bytes]()

    async def receive() -> Message:
        return {"type": "http.request", "body": b"", "more_body": False}

    async def send(message: Message) -> None:
        nonlocal status
        if message["type"] == "http.response.start":
            status = message["status"]
        elif message["type"] == "http.response.body":
            parts.append(message.get("body", b""))

    with using_access(get_access()):  # the other route sets that of its own permission
        await request.app(scope, receive, send)
    return status, b"".join(parts)
