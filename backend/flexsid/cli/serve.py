"""Commands ``flexsid serve`` and ``flexsid demo``, and the certificate of a Dask cluster."""

from __future__ import annotations

import argparse
import logging
import socket
import sys
from contextlib import closing
from datetime import UTC, datetime
from importlib.util import find_spec
from pathlib import Path
from types import FrameType

import uvicorn
from fastapi import FastAPI

from flexsid.api.app import create_app
from flexsid.api.middleware.limits import ClientConnection, allow_connections
from flexsid.api.middleware.request_log import JsonFormatter
from flexsid.cli.administration import open_store
from flexsid.cli.output import print_next_result, print_written_file, show_progress
from flexsid.demo import campaign
from flexsid.demo.campaign_process import CampaignProcess, add_demonstration, find_record
from flexsid.demo.flex28 import NAME, UNSTEADY_NAME
from flexsid.errors import BadInput, FlexsidError
from flexsid.importers.formats.readers import load_formats
from flexsid.jobs.cluster import write_cluster_certificate
from flexsid.jobs.fork_server import start_fork_server
from flexsid.jobs.health import PartHealth
from flexsid.jobs.messages import configure_interpreter, loading
from flexsid.jobs.notifier import read_channels
from flexsid.reports import read_template
from flexsid.settings import Mode, Settings
from flexsid.storage.migrate import upgrade
from flexsid.storage.store import Store
from flexsid.streams.receivers import load_receivers
from flexsid.sysid.model.sensor_models import load_sensor_models
from flexsid.workflow.fits.computation import load_estimators
from flexsid.workflow.review.condition_sheet import load_simulated

# --- Commands ``flexsid serve`` and ``flexsid demo`` ----------------------------------------------

_GRACE_S = 1
_IDLE_S = 75  # longer than clients with a pool of connections leave them idle


class _Server(uvicorn.Server):
    as_json = False
    campaign_process: CampaignProcess | None = None
    url = ""

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
            text = f"flexsid serves on {self.url} (Ctrl-C stops it)"
            print_next_result(text, {"url": self.url}, as_json=self.as_json)
            if self.campaign_process is not None:
                self.campaign_process.start()


def serve(settings: Settings, arguments: argparse.Namespace) -> int:
    """Serve until stopped by a signal."""
    _load_extensions()
    _check_files(settings)
    start_fork_server()
    with _bind_port(settings.address, settings.port) as port:
        upgrade(settings.database)  # refuses an invalid database before the server starts
        return _serve_on(port, settings, arguments.json)


def demo(settings: Settings, arguments: argparse.Namespace) -> int:
    """Serve while the missing maneuvers of the demonstration campaign are simulated."""
    if arguments.no_serve:
        _fill(settings, arguments.json, unsteady=arguments.unsteady)
        return 0
    _load_extensions()
    _check_files(settings)
    start_fork_server()
    campaign_process = CampaignProcess(
        settings.database, _report_progress, unsteady=arguments.unsteady
    )
    with _bind_port(settings.address, settings.port) as port:
        upgrade(settings.database)
        try:
            return _serve_on(port, settings, arguments.json, campaign_process)
        finally:
            campaign_process.stop()


def _load_extensions() -> None:
    """Load what installed packages add, to refuse one that fails before the server starts."""
    load_sensor_models()
    load_formats()
    load_receivers()
    load_estimators()
    load_simulated()


def _check_files(settings: Settings) -> None:
    """Refuse files that would fail the first report or message."""
    if settings.report_template is not None:
        read_template(settings.report_template)
    if settings.notifications is not None:
        read_channels(settings.notifications)


def _serve_on(
    port: socket.socket,
    settings: Settings,
    as_json: bool,
    campaign_process: CampaignProcess | None = None,
) -> int:
    if settings.openid is not None and find_spec("authlib") is None:
        raise BadInput(
            "log-in at an OpenID provider needs the extra `oidc`: pip install 'flexsid[oidc]'"
        )
    if settings.mode is not Mode.PERSONAL:
        for handler in logging.getLogger().handlers:
            handler.setFormatter(JsonFormatter())

    def check_campaign() -> PartHealth | None:
        return None if campaign_process is None else campaign_process.check_health()

    def find_start() -> str | None:
        with closing(Store.open(settings.database)) as store:
            record = find_record(store)
        return None if record is None else f"/conditions/{record.id}"

    with loading():
        app = create_app(
            settings,
            add_builtin_aircraft=add_builtin_aircraft,
            check_additional_part=check_campaign,
            find_start=None if campaign_process is None else find_start,
        )
    config = uvicorn.Config(
        app,
        host=settings.address,
        port=settings.port,
        http=ClientConnection,
        ws="none",
        limit_concurrency=allow_connections(),
        log_level="warning",
        access_log=False,
        timeout_graceful_shutdown=_GRACE_S,
        timeout_keep_alive=_IDLE_S,
        proxy_headers=False,  # the application reads those of listed proxies
    )
    server = _Server(config)
    server.as_json = as_json
    server.campaign_process = campaign_process
    server.url = settings.public_url
    server.run(sockets=[port])
    return 0 if server.started else 1


def _fill(settings: Settings, as_json: bool, *, unsteady: bool) -> None:
    with open_store(settings, new=True) as store:
        add_demonstration(store, _report_progress, unsteady=unsteady)
        maneuvers = store.maneuver_page(limit=None).items
    if sys.stderr.isatty():
        print(file=sys.stderr)
    if as_json:
        print_next_result("", {"maneuvers": len(maneuvers)}, as_json=True)


def add_builtin_aircraft(store: Store, name: str) -> None:
    """Add a built-in aircraft if ``name`` is its name."""
    if name in (NAME, UNSTEADY_NAME):
        campaign.add_aircraft(store, unsteady=name == UNSTEADY_NAME)


def _bind_port(address: str, port: int) -> socket.socket:
    """Bind the port before the database is filled, and return the listening socket."""
    # With the protocol given as TCP, asyncio sets TCP_NODELAY; otherwise responses wait 40 ms.
    family = socket.AF_INET6 if ":" in address else socket.AF_INET
    listener = socket.socket(family, socket.SOCK_STREAM, socket.IPPROTO_TCP)
    listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        listener.bind((address, port))
        listener.listen()  # early connections wait instead of being refused
    except OSError as error:
        listener.close()
        raise FlexsidError(
            f"port {port} is not available ({error.strerror}); select another with "
            "FLEXSID_PORT, or make demo PORT=8010",
            code="port-taken",
        ) from error
    return listener


def _report_progress(fraction: float, message: str) -> None:
    if sys.stderr.isatty():
        show_progress(f"{'█' * round(30 * fraction):<30} {fraction:4.0%} {message:<50.50}")
    else:
        print(f"{fraction:4.0%} {message}", file=sys.stderr, flush=True)


# --- Certificate of a Dask cluster: ``flexsid cluster-certificate`` -------------------------------


def write_certificate(settings: Settings, arguments: argparse.Namespace) -> int:
    """Write the configuration of a Dask cluster with a new key and certificate."""
    end = write_cluster_certificate(Path(arguments.file), datetime.now(UTC))
    text = f"wrote {arguments.file}, valid until {end:%Y-%m-%d}; name it by DASK_CONFIG"
    result = {"file": arguments.file, "valid_until": end.isoformat()}
    print_written_file(text, result, as_json=arguments.json)
    return 0
