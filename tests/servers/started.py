"""Servers and commands as users start them, in processes of their own."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import urllib.error
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ports import find_free_port
from waiting import PATIENCE_S

FLEXSID = str(Path(sys.executable).parent / "flexsid")


@dataclass(frozen=True, slots=True)
class Response:
    """What a server responded."""

    status: int
    body: Any
    cookie: str


@dataclass(frozen=True, slots=True)
class Server:
    """A server on a port of this computer."""

    port: int

    def request(
        self, method: str, path: str, body: Any = None, headers: dict[str, str] | None = None
    ) -> Response:
        """Send a request of JSON, and return the response, also of a refusal."""
        sent = urllib.request.Request(
            f"http://127.0.0.1:{self.port}/api/v1{path}",
            None if body is None else json.dumps(body).encode(),
            {
                "Content-Type": "application/json",
                "Sec-Fetch-Site": "same-origin",
                **(headers or {}),
            },
            method=method,
        )
        try:
            with urllib.request.urlopen(sent, timeout=PATIENCE_S) as received:
                return _read(received)
        except urllib.error.HTTPError as refused:
            with refused:
                return _read(refused)


def _read(received: Any) -> Response:
    text = received.read()
    cookie = received.headers.get("Set-Cookie", "").partition(";")[0]
    return Response(received.status, json.loads(text) if text else None, cookie)


def run_command(url: str, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Run the command on a database until it ends."""
    return subprocess.run(
        [FLEXSID, *arguments],
        env={**os.environ, "FLEXSID_DATABASE": url},
        capture_output=True,
        text=True,
        timeout=PATIENCE_S,
        check=False,
    )


@contextmanager
def start_server(url: str, **variables: str) -> Iterator[Server]:
    """Run ``flexsid serve`` on a database, with further variables of the environment."""
    port = find_free_port()
    environment = {**os.environ, **variables, "FLEXSID_DATABASE": url, "FLEXSID_PORT": str(port)}
    process = subprocess.Popen(
        [FLEXSID, "serve"], env=environment, stdout=subprocess.PIPE, text=True
    )
    assert process.stdout is not None
    try:
        assert f":{port}" in process.stdout.readline(), "the server has not started"
        yield Server(port)
        assert process.poll() is None, "the server ended by itself"
    finally:
        process.terminate()
        process.wait(PATIENCE_S)
        process.stdout.close()
