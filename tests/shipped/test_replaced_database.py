"""A database that is deleted or replaced beneath a server is noticed, and nothing acknowledged."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from shipped import Client, serving

MAPPING = {
    "text": """
flight = { number = 1 }
time = { rate = { value = 50, unit = "Hz" } }
[aircraft]
name = "X-1"
[[channels]]
column = "q"
name = "q"
unit = "deg/s"
role = "output"
"""
}


def check_refused(client: Client) -> None:
    """Reads, writes, health and readiness report that the file is another one."""
    for method, path, body in (
        ("get", "health", None),
        ("get", "health/ready", None),
        ("get", "maneuvers", None),
        ("post", "mappings", {"name": "lost", **MAPPING}),
    ):
        response = client.request(method, path, body)
        found = (response.status_code, response.json()["code"])
        assert found == (503, "database-replaced"), (path, response.text)


@pytest.mark.parametrize(
    "fault", ["deleted", "replaced", pytest.param("moved away and back", marks=pytest.mark.long)]
)
def test_a_server_notices_that_its_database_is_another_file(tmp_path: Path, fault: str) -> None:
    file, copy = tmp_path / "flexsid.db", tmp_path / "copy.db"
    with serving(tmp_path, f"sqlite:///{file}") as server:
        client = server.connect()
        client.send("post", "mappings", {"name": "stored", **MAPPING})
        if fault == "replaced":
            shutil.copy(file, copy)
            copy.replace(file)
        else:
            file.replace(copy)
        check_refused(client)
        if fault == "moved away and back":
            copy.replace(file)
            assert client.get("health")["status"] in ("ok", "degraded")
            names = [one["name"] for one in client.get("mappings")["items"]]
            assert names == ["stored"]
