"""GET requests from the application to its own routes."""

from __future__ import annotations

from starlette.requests import Request
from starlette.types import Message


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
        "headers": [(b"host", request.headers.get("host", "").encode())],
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

    await request.app(scope, receive, send)
    return status, b"".join(parts)
