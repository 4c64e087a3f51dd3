"""The command ``flexsid``, and a server that it has started.

Tests of this kind act as a user does, through the command and the port, and import nothing of
flexsid: a promise that holds only in the process of a test is found out. Starting the installed
program costs five seconds of computation for a server and two for a command, most of it for
loading libraries. So commands are forked from a process that has loaded them, except in tests of
what the start itself decides and in one test of each mode (``serving_installed``).
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import httpx2
from ports import find_free_port
from preloaded import ForkedCommand
from waiting import PATIENCE_S, wait_until

PROGRAM = _INSTALLED = Path(sys.executable).parent / "flexsid"
"""The program to start; tests replace it by that of another environment."""
API = "/api/v1"
PASSWORD = "correct horse battery"
_UNDER_WAY = ("queued", "running")


def make_environment(**variables: str) -> dict[str, str]:
    """Return the environment of this process without settings of flexsid and Python."""
    own = {k: v for k, v in os.environ.items() if not k.startswith(("FLEXSID_", "PYTHON"))}
    return {**own, **variables}


def run_command(
    folder: Path, database: str, *arguments: str, **variables: str
) -> subprocess.CompletedProcess[str]:
    """Run ``flexsid`` in a folder and return what it printed."""
    with tempfile.TemporaryDirectory() as printed:
        output, errors = Path(printed, "output"), Path(printed, "errors")
        process = _start([*arguments, "--database", database], folder, variables, output, errors)
        try:
            code = process.wait(PATIENCE_S)
            assert code is not None, f"flexsid {arguments[0]} does not end"
        finally:
            process.kill()
        return subprocess.CompletedProcess(
            arguments, code, *(file.read_text("utf-8") for file in (output, errors))
        )


def _start(
    arguments: list[str],
    folder: Path,
    variables: dict[str, str],
    output: Path,
    errors: Path,
    *,
    is_forked: bool = True,
) -> subprocess.Popen[bytes] | ForkedCommand:
    """Start ``flexsid``; what it prints is appended to two files, which may be the same."""
    environment = make_environment(**variables)
    if is_forked and PROGRAM == _INSTALLED:
        for file in (output, errors):
            file.touch()
        return ForkedCommand(arguments, folder, environment, output, errors)
    with output.open("ab") as out, errors.open("ab") as err:
        return subprocess.Popen(
            [PROGRAM, *arguments], cwd=folder, env=environment, stdout=out, stderr=err
        )


def ask_command(folder: Path, database: str, *arguments: str) -> Any:
    """Run ``flexsid`` with ``--json`` and return its result."""
    done = run_command(folder, database, *arguments, "--json")
    assert done.returncode == 0, done.stdout + done.stderr
    return json.loads(done.stdout)


@dataclass(frozen=True, slots=True)
class Server:
    """A server that runs, and the process that serves."""

    port: int
    process: subprocess.Popen[bytes] | ForkedCommand
    log: Path
    clients: list[httpx2.Client] = field(default_factory=list)

    @property
    def url(self) -> str:
        """Address of the server."""
        return f"http://127.0.0.1:{self.port}"

    def connect(self, **options: Any) -> Client:
        """Return a client without log-in; ``serving`` closes it."""
        opened = httpx2.Client(base_url=self.url, timeout=PATIENCE_S, trust_env=False, **options)
        self.clients.append(opened)
        return Client(opened)

    def log_in(self, name: str, password: str = PASSWORD) -> Client:
        """Return a client with the session of an account."""
        client = self.connect(headers={"Sec-Fetch-Site": "same-origin"})
        client.send("post", "session", {"name": name, "password": password})
        return client


@dataclass(frozen=True, slots=True)
class Client:
    """Requests of one user."""

    http: httpx2.Client

    def request(self, method: str, path: str, body: Any = None, **sent: Any) -> httpx2.Response:
        """Send a request, with a JSON body if there is one."""
        where = path if path.startswith("/") else f"{API}/{path}"
        if body is not None:
            sent["json"] = body
        return self.http.request(method.upper(), where, **sent)

    def send(self, method: str, path: str, body: Any = None, **sent: Any) -> Any:
        """Send a request that must succeed, and return its content."""
        response = self.request(method, path, body, **sent)
        assert response.is_success, f"{method} {path}: {response.status_code} {response.text}"
        return response.json() if response.content else None

    def get(self, path: str, **sent: Any) -> Any:
        """Return the content of an address."""
        return self.send("get", path, **sent)

    def upload(self, *files: Path) -> Any:
        """Upload files and return what the server found in them."""
        sent = [("files", (file.name, file.read_bytes())) for file in files]
        return self.send("post", "uploads", files=sent)

    def wait_for_end(self, path: str) -> Any:
        """Wait until a job or a run has ended; return its last state."""

        def check() -> Any:
            now = self.get(path)
            return None if now["state"] in _UNDER_WAY else now

        return wait_until(check, f"the end of {path}")


@contextmanager
def serving(
    folder: Path, database: str, *options: str, command: str = "serve", **variables: str
) -> Iterator[Server]:
    """Serve a database in a folder, until the block ends."""
    arguments = [command, "--database", database, *options]
    with _serving(folder, arguments, variables, is_forked=True) as server:
        yield server


@contextmanager
def serving_installed(folder: Path, database: str, **variables: str) -> Iterator[Server]:
    """The same by the installed program."""
    with _serving(folder, ["serve", "--database", database], variables, is_forked=False) as server:
        yield server


@contextmanager
def _serving(
    folder: Path, arguments: list[str], variables: dict[str, str], *, is_forked: bool
) -> Iterator[Server]:
    port, log = find_free_port(), folder / "server.log"
    variables = {"FLEXSID_PORT": str(port), **variables}
    process = _start(arguments, folder, variables, log, log, is_forked=is_forked)
    server = Server(port, process, log)
    try:
        probe = server.connect().http
        wait_until(lambda: _responds(probe, server), "the start of the server")
        yield server
    finally:
        for client in server.clients:
            client.close()
        process.terminate()
        process.wait(PATIENCE_S)


def invite(folder: Path, database: str, name: str, *roles: tuple[str, str]) -> str:
    """Add an account with roles in campaigns by the command, and return the code of its invitation.

    ``roles`` has pairs of role and campaign, the name of an aircraft or "all".
    """
    (role, campaign), *others = roles or [("", "")]
    named = [role, "--campaign", campaign] if role else []
    added = ask_command(folder, database, "users", "add", name, *named)
    for role, campaign in others:
        ask_command(folder, database, "users", "grant", name, role, "--campaign", campaign)
    return added["invitation"].partition("#")[2]


def set_password(server: Server, code: str) -> None:
    """Accept an invitation as its page does."""
    server.connect(headers={"Sec-Fetch-Site": "same-origin"}).send(
        "post", "invitations", {"code": code, "password": PASSWORD}
    )


def _responds(probe: httpx2.Client, server: Server) -> bool:
    assert server.process.poll() is None, server.log.read_text()
    try:
        return probe.get(f"{API}/health/live").is_success
    except httpx2.TransportError:
        return False
