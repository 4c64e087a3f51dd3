"""Size limits of request bodies: 512 MB for uploads, 2 MB for all other requests.

Only uploads are passed on before they have arrived, to be written into files. Other bodies are
received here, where they take no thread and no place of ``api/middleware/write_limit.py``.
"""

from __future__ import annotations

from starlette.datastructures import Headers
from starlette.exceptions import HTTPException
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from flexsid.api.errors import make_problem

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
