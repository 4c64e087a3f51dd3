"""A server that listens, with one maneuver that was flown and run 1, EE, that succeeded."""

from __future__ import annotations

import shutil
import socket
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
import uvicorn

from flexsid.api.app import create_app
from flexsid.client import Workbench
from flexsid.settings import Settings


@pytest.fixture(scope="session")
def live_url(flown_file: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """Address of a server of this process."""
    file = tmp_path_factory.mktemp("live") / "flown.db"
    shutil.copy(flown_file, file)
    listening = socket.create_server(("127.0.0.1", 0))
    port = listening.getsockname()[1]
    app = create_app(Settings(database=f"sqlite:///{file}"))
    server = uvicorn.Server(uvicorn.Config(app, log_level="warning", access_log=False))
    thread = threading.Thread(target=server.run, kwargs={"sockets": [listening]})
    thread.start()
    while not server.started:
        assert thread.is_alive()
        time.sleep(0.01)
    yield f"http://127.0.0.1:{port}"
    server.should_exit = True
    thread.join()
    listening.close()


@pytest.fixture
def workbench(live_url: str) -> Workbench:
    return Workbench(live_url)
