"""Clients that send slowly, or nothing, stop nobody else; and they do not stay."""

from __future__ import annotations

import json
import socket
import sqlite3
from collections.abc import Iterator
from contextlib import ExitStack, closing, contextmanager
from pathlib import Path

import psycopg
import pytest
from shipped import Server, invite, serving, set_password
from waiting import PATIENCE_S, wait_until

NOTE = {"subject": "maneuver", "key": "1", "text": "noted"}
_JSON = ("application/json", '{"text": ')
_FORM = ("multipart/form-data; boundary=b", "--b\r\n")
HALF = (
    *(
        f"{method} /api/v1{path} HTTP/1.1\r\nHost: localhost\r\nContent-Type: {kind}\r\n"
        f"Content-Length: 1000\r\n\r\n{begin}"
        for method, path, (kind, begin) in (
            ("POST", "/notes", _JSON),
            ("POST", "/session", _JSON),
            ("PUT", "/aircraft/1", _JSON),
            ("DELETE", "/session", _JSON),
            ("POST", "/maneuvers", _FORM),
            ("POST", "/uploads", _FORM),
        )
    ),
    "GET /api/v1/runs HTTP/1.1\r\nHost: loc",
    "",
)


@contextmanager
def _sending(server: Server, *texts: str) -> Iterator[list[socket.socket]]:
    """Connections on which these texts were sent."""
    with ExitStack() as opened:
        connections = []
        for text in texts:
            one = socket.create_connection(("127.0.0.1", server.port), PATIENCE_S)
            connections.append(opened.enter_context(one))
            one.sendall(text.encode())
        yield connections


def test_half_sent_requests_stop_neither_writes_nor_log_ins(flown_url: str, tmp_path: Path) -> None:
    code = invite(tmp_path, flown_url, "Ann", ("analyst", "all"))
    with serving(tmp_path, flown_url, FLEXSID_MODE="team") as server:
        set_password(server, code)
        with _sending(server, *HALF * 3):
            # Each of them has arrived, as far as it was sent.
            assert server.connect().request("get", "session").status_code == 200
            client = server.log_in("Ann")
            assert client.request("post", "notes", NOTE).status_code == 201
            assert client.request("get", "notes?maneuver_id=1").status_code == 200


def test_requests_that_do_not_arrive_are_refused(flown_url: str, tmp_path: Path) -> None:
    with serving(tmp_path, flown_url) as server, _sending(server, *HALF) as connections:
        responses = [_read_to_end(one) for one in connections]
        for response in responses[:-1]:
            head, _, body = response.partition("\r\n\r\n")
            assert head.startswith("HTTP/1.1 408 Request Timeout\r\n"), response
            assert "connection: close" in head
            assert json.loads(body)["code"] == "request-timeout"
        assert responses[-1] == "", "nothing was begun"
        assert server.connect().request("get", "runs").status_code == 200


def test_headers_without_end_are_refused(flown_url: str, tmp_path: Path) -> None:
    with serving(tmp_path, flown_url) as server:
        for begin in (
            "GET /api/v1/runs HTTP/1.1\r\nHost: localhost\r\nX-Long: ",
            "GET /api/v1/runs?",
            # Of the parts of a body, and after it.
            "POST /api/v1/notes HTTP/1.1\r\nHost: localhost\r\n"
            "Transfer-Encoding: chunked\r\n\r\n1;x=",
            "POST /api/v1/notes HTTP/1.1\r\nHost: localhost\r\n"
            "Transfer-Encoding: chunked\r\n\r\n1\r\n{\r\n0\r\nX-Long: ",
        ):
            with (
                _sending(server, begin) as (one,),
                pytest.raises(OSError, match=r"reset|[Bb]roken"),
            ):
                _send_for_ever(one)


@pytest.mark.parametrize("backend", ["sqlite", pytest.param("postgresql", marks=pytest.mark.long)])
def test_a_server_that_cannot_write_is_not_ready(
    flown_url: str, backend: str, tmp_path: Path
) -> None:
    with serving(tmp_path, flown_url) as server:
        client = server.connect()

        def find_status() -> int:
            return client.request("get", "health/ready").status_code

        wait_until(lambda: find_status() == 204, "the start of the dispatcher")
        with _locked(flown_url):
            refused = client.request("get", "health/ready")
            assert (refused.status_code, refused.json()["code"]) == (503, "database-unavailable")
        wait_until(lambda: find_status() == 204, "the end of the other transaction")


@contextmanager
def _locked(url: str) -> Iterator[None]:
    """The lock of writers, held by another program."""
    if url.startswith("postgresql"):
        with closing(psycopg.connect(url)) as other:
            other.execute("LOCK TABLE leases IN EXCLUSIVE MODE")
            yield
    else:
        file = url.removeprefix("sqlite:///")
        with closing(sqlite3.connect(file, isolation_level=None)) as other:
            other.execute("BEGIN IMMEDIATE")
            yield


def _read_to_end(connection: socket.socket) -> str:
    parts = []
    while part := connection.recv(65536):
        parts.append(part)
    return b"".join(parts).decode()


def _send_for_ever(connection: socket.socket) -> None:
    while True:
        connection.sendall(b"x" * 65536)
