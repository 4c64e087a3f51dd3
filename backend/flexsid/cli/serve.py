"""Commands ``flexsid serve`` and ``flexsid demo``."""

from __future__ import annotations

import socket
import sys
from types import FrameType

import uvicorn
from fastapi import FastAPI

from flexsid.api.app import create_app
from flexsid.cli.database import open_store
from flexsid.cli.output import print_next_result
from flexsid.demo import campaign
from flexsid.demo.aircraft import NAME as DEMO_AIRCRAFT
from flexsid.errors import FlexsidError
from flexsid.jobs.interpreter import configure_interpreter
from flexsid.settings import Settings
from flexsid.storage.migrate import upgrade
from flexsid.storage.store import Store

_LOOPBACK = "127.0.0.1"  # without log-in, only the loopback address is served
_GRACE_S = 1


class _Server(uvicorn.Server):
    as_json = False

    def handle_exit(self, sig: int, frame: FrameType | None) -> None:
        # An open event stream would prevent the server from stopping.
        app = self.config.app
        if isinstance(app, FastAPI) and hasattr(app.state, "context"):
            app.state.context.live.stop()
        super().handle_exit(sig, frame)

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        await super().startup(sockets)
        configure_interpreter()
        if self.started:
            url = f"http://{_LOOPBACK}:{self.config.port}"
            text = f"flexsid serves on {url} (Ctrl-C stops it)"
            print_next_result(text, {"url": url}, as_json=self.as_json)


def serve(settings: Settings, *, as_json: bool = False) -> int:
    """Serve until stopped by a signal."""
    with _bind_port(settings.port) as port:
        upgrade(settings.database)  # refuses an invalid database before the server starts
        return _serve_on(port, settings, as_json)


def demo(settings: Settings, *, as_json: bool = False) -> int:
    """Simulate the missing maneuvers of the demonstration campaign, then serve."""
    with _bind_port(settings.port) as port:
        fill(settings, as_json=as_json)
        return _serve_on(port, settings, as_json)


def _serve_on(port: socket.socket, settings: Settings, as_json: bool) -> int:
    app = create_app(settings, add_builtin_aircraft=add_builtin_aircraft)
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
    """Simulate the missing maneuvers of the demonstration campaign, with a progress bar."""
    with open_store(settings, new=True) as store:
        campaign.add_campaign(store, _show_progress)
        maneuvers = store.maneuver_page(limit=None).items
    if sys.stderr.isatty():
        print(file=sys.stderr)
    if as_json:
        print_next_result("", {"maneuvers": len(maneuvers)}, as_json=True)


def add_builtin_aircraft(store: Store, name: str) -> None:
    """Add the built-in aircraft if ``name`` is its name."""
    if name == DEMO_AIRCRAFT:
        campaign.add_aircraft(store)


def _bind_port(port: int) -> socket.socket:
    """Bind the port before the database is filled, and return the listening socket."""
    # With the protocol given as TCP, asyncio sets TCP_NODELAY; otherwise responses wait 40 ms.
    listener = socket.socket(socket.AF_INET, socket.SOCK_STREAM, socket.IPPROTO_TCP)
    listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        listener.bind((_LOOPBACK, port))
        listener.listen()  # early connections wait instead of being refused
    except OSError as error:
        listener.close()
        raise FlexsidError(
            f"port {port} is not available ({error.strerror}); select another with "
            "FLEXSID_PORT, or make demo PORT=8010",
            code="port-taken",
        ) from error
    return listener


def _show_progress(fraction: float, message: str) -> None:
    if sys.stderr.isatty():
        bar = "█" * round(30 * fraction)
        print(f"\r{bar:<30} {fraction:4.0%} {message:<50.50}", end="", file=sys.stderr, flush=True)
    else:
        print(f"{fraction:4.0%} {message}", file=sys.stderr, flush=True)
