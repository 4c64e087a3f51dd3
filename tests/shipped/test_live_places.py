"""Live streams connect to listed brokers only, and leave places to other campaigns."""

from __future__ import annotations

import json
import socket
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import httpx2
import pytest
from shipped import Client, invite, run_command, serving, set_password


@contextmanager
def listening() -> Iterator[socket.socket]:
    """A port that only the server reaches, and that must see no connection."""
    with socket.create_server(("127.0.0.1", 0)) as port:
        port.settimeout(0.0)
        yield port


def start(client: Client, name: str, **options: Any) -> httpx2.Response:
    receiver = {"name": name, "options": options}
    body = {"run_id": 1, "title": "stream", "receiver": receiver}
    return client.request("post", "live/streams", body)


@pytest.mark.parametrize(
    ("name", "place"), [("nats", "subject"), pytest.param("mqtt", "topic", marks=pytest.mark.long)]
)
def test_streams_connect_to_listed_brokers_only(
    flown_url: str, tmp_path: Path, name: str, place: str
) -> None:
    code = invite(tmp_path, flown_url, "Ann", ("analyst", "all"))
    with listening() as inner, listening() as listed, listening() as known:
        inner_url, listed_url, known_url = (
            f"{name}://127.0.0.1:{one.getsockname()[1]}" for one in (inner, listed, known)
        )
        credentials = tmp_path / "credentials.toml"
        content = {"server": known_url, "user": "flexsid", "password": "p"}
        lines = [f"{key} = {json.dumps(value)}" for key, value in content.items()]
        credentials.write_text("\n".join(["[range]", *lines]))
        variables = {"FLEXSID_BROKERS": listed_url, "FLEXSID_CREDENTIALS": str(credentials)}
        with serving(tmp_path, flown_url, FLEXSID_MODE="team", **variables) as server:
            set_password(server, code)
            ann = server.log_in("Ann")
            for address in (inner_url, f"{name}://169.254.169.254:80", known_url):
                refused = start(ann, name, server=address, **{place: "samples"})
                assert refused.status_code == 422, refused.text
                assert refused.json()["code"] == "bad-receiver-option"
                assert "FLEXSID_BROKERS" in refused.json()["detail"]
            with pytest.raises(BlockingIOError):
                inner.accept()
            for options in ({"server": listed_url}, {"server": known_url, "credentials": "range"}):
                started = start(ann, name, **options, **{place: "samples"})
                assert started.status_code == 201, started.text
                ann.send("post", f"live/streams/{started.json()['id']}/stop")


def test_without_accounts_any_broker_is_allowed(flown_url: str, tmp_path: Path) -> None:
    with serving(tmp_path, flown_url) as server:
        started = start(server.connect(), "nats", server="nats://127.0.0.1:9", subject="samples")
        assert started.status_code == 201, started.text


@pytest.mark.parametrize(
    "broker", ["broker", "nats://", "nats://broker:99999", "nats://a:secret@b"]
)
def test_brokers_that_are_no_addresses_are_refused(tmp_path: Path, broker: str) -> None:
    database = f"sqlite:///{tmp_path / 'new.db'}"
    done = run_command(tmp_path, database, "serve", FLEXSID_BROKERS=broker)
    assert done.returncode == 2
    assert "FLEXSID_BROKERS" in done.stderr
    assert "secret" not in done.stderr
