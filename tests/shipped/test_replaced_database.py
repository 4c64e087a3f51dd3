"""A database that is deleted or replaced is noticed: beneath a server nothing is acknowledged."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from shipped import Client, ask_command, run_command, serving

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


@pytest.mark.long
@pytest.mark.parametrize("fault", ["deleted", "replaced", "moved away and back"])
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


def test_a_deleted_file_and_a_deleted_log_are_noticed(tmp_path: Path) -> None:
    file, left = tmp_path / "flexsid.db", tmp_path / "left"
    left.mkdir()
    with serving(tmp_path, f"sqlite:///{file}") as server:
        server.connect().send("post", "mappings", {"name": "stored", **MAPPING})
        # What is left beside each other if all processes are killed and the log is deleted.
        for one in (file, file.with_name("flexsid.db-mark")):
            shutil.copy(one, left)
        file.unlink()
        check_refused(server.connect())
    database = f"sqlite:///{left / 'flexsid.db'}"
    with serving(left, database) as server:
        health = server.connect().get("health")
        (part,) = (one for one in health["parts"] if one["name"] == "database")
        assert (health["status"], part["state"]) == ("degraded", "degraded")
        assert "not in the database" in part["text"]
    checked = run_command(left, database, "check")
    assert checked.returncode == 1
    assert "acknowledged transactions are not in the database" in checked.stdout
    assert ask_command(left, database, "check", "--accept-losses")["sound"]
