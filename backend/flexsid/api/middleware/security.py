"""Security middleware: host check, cross-site request check and security headers.

Pages of other sites in the same browser must neither read nor change data: the host check
prevents DNS rebinding, the origin check prevents cross-site request forgery. With accounts the
server has the host of its address too, and a change by the cookie of a session must state its
origin, as all browsers do.
"""

from __future__ import annotations

from urllib.parse import urlsplit

from starlette.datastructures import Headers, MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from flexsid.api.errors import make_problem
from flexsid.settings import Mode, Settings

LOOPBACK_HOSTS = frozenset({"localhost", "127.0.0.1", "[::1]"})
_SAFE_METHODS = frozenset({"GET", "HEAD", "OPTIONS"})
_HEADERS = {
    "Content-Security-Policy": "default-src 'self'; script-src 'self';"
    " style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; connect-src 'self';"
    " object-src 'none'; base-uri 'none'; form-action 'self'; frame-ancestors 'none'",
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "same-origin",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
}

_HSTS = "max-age=31536000"


class SecurityMiddleware:
    """Refuses foreign hosts and cross-site changes; adds the security headers."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass the request on, or respond with 403."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return

        settings: Settings = scope["app"].state.settings

        async def send_with_headers(message: Message) -> None:
            if message["type"] == "http.response.start":
                headers = MutableHeaders(scope=message)
                for name, value in _HEADERS.items():
                    headers.setdefault(name, value)
                if settings.is_secure:
                    headers.setdefault("Strict-Transport-Security", _HSTS)
                headers.setdefault(
                    "Cache-Control", _select_caching(scope["path"], message["status"])
                )
            await send(message)

        refusal = _check_request(scope["method"], Headers(scope=scope), settings)
        if refusal is None:
            await self._app(scope, receive, send_with_headers)
        else:
            code, detail = refusal
            await make_problem(403, code, detail)(scope, receive, send_with_headers)


def _check_request(method: str, headers: Headers, settings: Settings) -> tuple[str, str] | None:
    host = headers.get("host", "")
    own = None if settings.url is None else urlsplit(settings.url).netloc
    if _strip_port(host) not in LOOPBACK_HOSTS and host.lower() != own:
        return "foreign-host", f"host {host!r} is not served; use localhost or 127.0.0.1"
    if method in _SAFE_METHODS:
        return None
    site = headers.get("sec-fetch-site")
    if site is not None:
        allowed = site in ("same-origin", "none")
    else:
        # Not a current browser: scripts and the command line send no origin.
        origin = headers.get("origin")
        allowed = (
            urlsplit(origin).netloc == host
            if origin is not None
            else not _is_session(headers, settings)
        )
    return None if allowed else ("cross-site", "requests of another site must not change data")


def _is_session(headers: Headers, settings: Settings) -> bool:
    return settings.mode is not Mode.PERSONAL and "authorization" not in headers


def _strip_port(host: str) -> str:
    name, colon, port = host.rpartition(":")
    return name.lower() if colon and port.isdigit() else host.lower()


def _select_caching(path: str, status: int) -> str:
    if path.startswith("/assets/") and status == 200:
        return "public, max-age=31536000, immutable"  # file names contain a hash of the content
    return "no-cache"
