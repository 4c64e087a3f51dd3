"""How much a request may send: uploads much, everything else little."""

from __future__ import annotations

from starlette.datastructures import Headers
from starlette.exceptions import HTTPException
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from flexsid.api.errors import problem

LARGEST_BODY = 2 * 1024**2
LARGEST_UPLOAD = 512 * 1024**2
_UPLOADS = frozenset({"/api/v1/maneuvers", "/api/v1/uploads"})


class BodyLimit:
    """Refuses bodies that are announced too large, and stops those that turn out to be."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass a request on with its body counted, or answer with 413."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        limit = LARGEST_UPLOAD if scope["path"] in _UPLOADS else LARGEST_BODY
        words = f"the body is larger than the {limit // 1024**2} MB that may be sent here"
        announced = Headers(scope=scope).get("content-length", "0")
        if not announced.isdigit() or int(announced[:20]) > limit:
            await problem(413, "too-large", words)(scope, receive, send)
            return
        received = 0

        async def receive_counted() -> Message:
            nonlocal received
            message = await receive()
            received += len(message.get("body", b""))
            if received > limit:
                raise HTTPException(413, words)
            return message

        await self._app(scope, receive_counted, send)
