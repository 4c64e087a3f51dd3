"""A server in the process of the test, on a database with one flown maneuver."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any
from urllib.parse import quote

import pytest
from fastapi import FastAPI
from fastapi.testclient import TestClient
from preloaded import use_preloaded
from tests.api.conformity import check_against
from tests.api.team import Act

from flexsid.api.app import create_app
from flexsid.jobs import dispatcher_process
from flexsid.settings import Settings

Serve = Callable[[str], AbstractContextManager[TestClient]]


@pytest.fixture(scope="session")
def app() -> Iterator[FastAPI]:
    """Return the application, created once: this takes longer than most tests.

    The dispatcher is started by the first request, for the same reason.
    """
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(dispatcher_process, "_SETTLE_S", 10.0)
        yield create_app(Settings())


@pytest.fixture
def serve(app: FastAPI, monkeypatch: pytest.MonkeyPatch) -> Serve:
    """Return a function that starts a server on a database, as a context manager."""
    use_preloaded(monkeypatch)

    def start(url: str) -> TestClient:
        app.state.settings = Settings(database=url)
        client = TestClient(
            app,
            base_url="http://127.0.0.1:8000",
            raise_server_exceptions=False,
            client=("192.0.2.7", 50_000),
        )
        client.event_hooks = {"response": [check_against(app)]}
        return client

    return start


@pytest.fixture
def client(serve: Serve, flown_url: str) -> Iterator[TestClient]:
    """Return a client of a server with the flown maneuver 1 and the succeeded EE run 1."""
    with serve(flown_url) as started:
        yield started


@pytest.fixture
def empty(serve: Serve, database_url: str) -> Iterator[TestClient]:
    with serve(database_url) as started:
        yield started


@pytest.fixture
def upload_files(tmp_path: Path) -> list[tuple[str, tuple[str, bytes]]]:
    """Return a small recording and its mapping."""
    rows = ["t_s,bf,q", *(f"{k / 50:.2f},{k % 3},{-k % 5}" for k in range(20))]
    mapping = """
        [aircraft]
        name = "FLEX-28"
        [flight]
        number = 7
        [maneuver]
        label = "multisine"
        [maneuver.condition]
        airspeed = { value = 20.0, unit = "m/s" }
        density = { value = 1.2, unit = "kg/m3" }
        fuel_fraction = { value = 0.5 }
        [time]
        column = "t_s"
        [[channels]]
        column = "bf"
        name = "bfs"
        unit = "deg"
        role = "input"
        [[channels]]
        column = "q"
        unit = "deg/s"
        role = "output"
        """
    return [
        ("files", ("../../m.csv", "\n".join(rows).encode())),
        ("mapping", ("m.toml", mapping.encode())),
    ]


@pytest.fixture
def act(client: TestClient) -> Act:
    """Send a request under a name: ``act("Ann", "post", "decisions", {...})``."""

    def do(name: str, method: str, path: str, body: Any = None) -> Any:
        headers = {"X-Flexsid-Analyst": quote(name)}
        return client.request(method, f"/api/v1/{path}", json=body, headers=headers)

    return do
