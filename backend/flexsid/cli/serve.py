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
from flexsid.jobs.prompt import be_prompt
from flexsid.settings import Settings
from flexsid.storage.migrate import upgrade
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
        be_prompt()
        if self.started:
            url = f"http://{_LOOPBACK}:{self.config.port}"
            words = f"flexsid serves on {url} (Ctrl-C stops it)"
            say_next(words, {"url": url}, as_json=self.as_json)


def serve(settings: Settings, *, as_json: bool = False) -> int:
    """Serve until told to stop."""
    with _taken(settings.port) as port:
        upgrade(settings.database)  # what is no database is said so, before the server starts
        return _serve_on(port, settings, as_json)


def demo(settings: Settings, *, as_json: bool = False) -> int:
    """Fly what is missing of the demonstration campaign, then serve."""
    with _taken(settings.port) as port:
        fill(settings, as_json=as_json)
        return _serve_on(port, settings, as_json)


def _serve_on(port: socket.socket, settings: Settings, as_json: bool) -> int:
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
    server.run(sockets=[port])
    return 0 if server.started else 1


def fill(settings: Settings, *, as_json: bool = False) -> None:
    """Fly what is missing of the demonstration campaign, with a progress bar."""
    with opened(settings, new=True) as store:
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


def _taken(port: int) -> socket.socket:
    """Take the port first: what cannot be served should not be started, nor flown."""
    # Named as TCP, or asyncio would leave answers waiting for acknowledgements (40 ms each).
    taken = socket.socket(socket.AF_INET, socket.SOCK_STREAM, socket.IPPROTO_TCP)
    taken.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        taken.bind((_LOOPBACK, port))
        taken.listen()  # who comes early waits instead of being refused
    except OSError as error:
        taken.close()
        raise FlexsidError(
            f"port {port} cannot be had ({error.strerror}); choose another by "
            "FLEXSID_PORT, or make demo PORT=8010",
            code="port-taken",
        ) from error
    return taken


def _show_progress(fraction: float, message: str) -> None:
    if sys.stderr.isatty():
        bar = "█" * round(30 * fraction)
        print(f"\r{bar:<30} {fraction:4.0%} {message:<50.50}", end="", file=sys.stderr, flush=True)
    else:
        print(f"{fraction:4.0%} {message}", file=sys.stderr, flush=True)
