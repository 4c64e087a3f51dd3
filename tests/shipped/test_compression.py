"""Responses are sent compressed to whoever accepts it, events at once to everybody."""

from __future__ import annotations

import gzip
import re
from collections.abc import Iterator
from pathlib import Path

import httpx2
import pytest
from shipped import API, Client, Server, serving

LEAST_BYTES = 1024
ACCEPTED = (
    ("br, gzip", "br"),
    ("gzip", "gzip"),
    ("br;q=0, gzip", "gzip"),
    ("identity", None),
    ("x-br", None),
)


def fetch(client: Client, path: str, accepted: str) -> tuple[httpx2.Response, bytes]:
    """Return a response, and its body as it was sent."""
    with client.http.stream("GET", path, headers={"Accept-Encoding": accepted}) as response:
        return response, b"".join(response.iter_raw())


@pytest.fixture
def server(flown_url: str, tmp_path: Path) -> Iterator[Server]:
    with serving(tmp_path, flown_url) as started:
        yield started


def test_every_asset_is_sent_as_compressed_as_is_accepted(server: Server) -> None:
    client = server.connect()
    page, _ = fetch(client, "/", "identity")
    assert page.status_code == 200
    text = client.http.get("/").text
    named = re.findall(r'"(/assets/[^"]+\.(?:js|css))"', text)
    assert len(named) >= 2
    for path in named:
        plain, content = fetch(client, path, "identity")
        assert len(content) == int(plain.headers["content-length"])
        for accepted, encoding in ACCEPTED:
            response, body = fetch(client, path, accepted)
            assert response.status_code == 200
            assert response.headers.get("content-encoding") == encoding, (path, accepted)
            assert response.headers["content-type"] == plain.headers["content-type"]
            assert "immutable" in response.headers["cache-control"]
            if encoding == "gzip":
                assert gzip.decompress(body) == content
            if encoding is not None:
                assert len(body) < max(len(content), 200)
                assert response.headers["vary"] == "Accept-Encoding"
    assert client.request("get", "/assets/missing.js").status_code == 404
    assert client.request("get", "/assets/..%2findex.html").status_code == 404


def test_every_response_above_1_kb_is_compressed(server: Server) -> None:
    client = server.connect()
    paths = client.get("openapi.json")["paths"]
    lists = [path for path, methods in paths.items() if "get" in methods and "{" not in path]
    large = []
    for path in ["/", "/runs/1", f"{API}/openapi.json", f"{API}/runs/1", *lists]:
        if path.endswith(("/events", "/openid", "/callback")):
            continue
        plain, content = fetch(client, path, "identity")
        assert "content-encoding" not in plain.headers
        if len(content) < LEAST_BYTES:
            continue
        response, body = fetch(client, path, "gzip, deflate, br")
        assert response.headers.get("content-encoding") == "gzip", path
        assert len(gzip.decompress(body)) >= LEAST_BYTES
        assert "Accept-Encoding" in response.headers["vary"]
        large.append(path)
    assert f"{API}/runs/1" in large
    assert len(large) > 5


def test_events_arrive_one_by_one_to_a_client_that_accepts_compression(server: Server) -> None:
    client = server.connect()
    headers = {"Accept-Encoding": "gzip, br"}
    with client.http.stream("GET", f"{API}/events?after=0", headers=headers) as response:
        assert "content-encoding" not in response.headers
        lines = response.iter_lines()
        assert any(line.startswith("event:") for line in lines)
        note = {"subject": "maneuver", "key": "1", "text": "noted"}
        server.connect().send("post", "notes", note, headers={"X-Flexsid-Analyst": "Ann"})
        assert any('"notes"' in line for line in lines)
