"""Size limits of request bodies: 512 MB for uploads, 2 MB for all other requests."""

from __future__ import annotations

from starlette.datastructures import Headers
from starlette.exceptions import HTTPException
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from flexsid.api.errors import make_problem

LARGEST_BODY = 2 * 1024**2
LARGEST_UPLOAD = 512 * 1024**2
_UPLOADS = frozenset({"/api/v1/maneuvers", "/api/v1/uploads"})


class BodyLimit:
    """Refuses bodies whose announced or received size exceeds the limit of the route."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass the request on and count its body; respond with 413 above the limit."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        limit = LARGEST_UPLOAD if scope["path"] in _UPLOADS else LARGEST_BODY
        words = f"the body is larger than {limit // 1024**2} MB, the limit of this route"
        announced = Headers(scope=scope).get("content-length", "0")
        if not announced.isdigit() or int(announced[:20]) > limit:
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

        await self._app(scope, receive_counted, send)
