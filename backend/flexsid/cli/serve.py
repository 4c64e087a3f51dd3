"""Serve the workbench, and fill it with the demonstration campaign."""

from __future__ import annotations

import socket
import sys
from types import FrameType

import uvicorn
from fastapi import FastAPI

from flexsid.api.app import create_app
from flexsid.cli.opening import opened
from flexsid.cli.saying import say_next
from flexsid.demo import campaign
from flexsid.demo.aircraft import NAME as DEMO_AIRCRAFT
from flexsid.errors import FlexsidError
from flexsid.settings import Settings
from flexsid.storage.store import Store

_LOOPBACK = "127.0.0.1"  # there is no log-in, so nobody else is answered
_GRACE_S = 1


class _Server(uvicorn.Server):
    as_json = False

    def handle_exit(self, sig: int, frame: FrameType | None) -> None:
        # An open stream of events would keep the server from stopping.
        app = self.config.app
        if isinstance(app, FastAPI) and hasattr(app.state, "context"):
            app.state.context.live.stop()
        super().handle_exit(sig, frame)

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        await super().startup(sockets)
        if self.started:
            url = f"http://{_LOOPBACK}:{self.config.port}"
            words = f"flexsid serves on {url} (Ctrl-C stops it)"
            say_next(words, {"url": url}, as_json=self.as_json)


def serve(settings: Settings, *, as_json: bool = False) -> int:
    """Serve until told to stop."""
    with _listening(settings.port) as listening:
        app = create_app(settings, bring_along=bring_along)
        config = uvicorn.Config(
            app,
            host=_LOOPBACK,
            port=settings.port,
            log_level="warning",
            access_log=False,
            timeout_graceful_shutdown=_GRACE_S,
        )
        server = _Server(config)
        server.as_json = as_json
        server.run(sockets=[listening])
    return 0 if server.started else 1


def fill(settings: Settings, *, as_json: bool = False) -> None:
    """Fly what is missing of the demonstration campaign, with a progress bar."""
    with opened(settings) as store:
        campaign.fill(store, _show_progress)
        maneuvers = store.maneuver_page(limit=None).items
    if sys.stderr.isatty():
        print(file=sys.stderr)
    if as_json:
        say_next("", {"maneuvers": len(maneuvers)}, as_json=True)


def bring_along(store: Store, name: str) -> None:
    """Add the aircraft that comes with the workbench, if it is called so."""
    if name == DEMO_AIRCRAFT:
        campaign.add_aircraft(store)


def _listening(port: int) -> socket.socket:
    """Take the port first: a server that cannot serve should not start anything."""
    # Named as TCP, or asyncio would leave answers waiting for acknowledgements (40 ms each).
    listening = socket.socket(socket.AF_INET, socket.SOCK_STREAM, socket.IPPROTO_TCP)
    listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        listening.bind((_LOOPBACK, port))
    except OSError as error:
        listening.close()
        raise FlexsidError(
            f"port {port} cannot be had ({error.strerror}); choose another by FLEXSID_PORT",
            code="port-taken",
        ) from error
    return listening


def _show_progress(fraction: float, message: str) -> None:
    if sys.stderr.isatty():
        bar = "█" * round(30 * fraction)
        print(f"\r{bar:<30} {fraction:4.0%} {message:<50.50}", end="", file=sys.stderr, flush=True)
    else:
        print(f"{fraction:4.0%} {message}", file=sys.stderr, flush=True)
