"""A member of each role does through the port what the table of permissions allows, no more.

The server is started as the documentation states, in both modes with accounts, on both databases,
on a new database and again on one of an earlier schema, which it migrates.
"""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import httpx2
import pytest
from rigid_record import simulate_doublet, write_record
from shipped import (
    Client,
    Server,
    ask_command,
    invite,
    make_environment,
    run_command,
    serving_installed,
    set_password,
)

SECRET = "0123456789abcdef" * 4
RANKS = ("viewer", "analyst", "reviewer", "admin")
STRUCTURE = {"modes": []}
DESIGN = {
    "duration_s": 24.0,
    "rate_hz": 50.0,
    "fta": 500,
    "first_harmonic": 6,
    "peaks": [0.01, 0.02, 0.03],
    "effort": "quick",
}
RULES = {"quorum": 1, "own_allowed": True, "reason": "small team"}
# A member of one campaign need not name it; an administrator of all does.
NAMED = {"X-Flexsid-Campaign": "1"}
HEADERS: dict[str, tuple[dict[str, str], ...]] = {"analyst": ({}, NAMED), "site": (NAMED,)}

# The least role, and a request whose records are all of the first campaign, or of none.
REQUESTS: tuple[tuple[str, str, str, Any], ...] = (
    ("viewer", "get", "maneuvers/1", None),
    ("viewer", "get", "runs", None),
    ("viewer", "get", "designs", None),
    ("viewer", "get", "maneuvers/1/run-proposal", None),
    ("analyst", "post", "runs", {"maneuver_id": 1, "method": "OE", "settings": {}}),
    ("analyst", "post", "batches", {"maneuver_ids": [1], "methods": ["EE"], "name": "b"}),
    (
        "analyst",
        "post",
        "searches",
        {"maneuver_ids": [1], "method": "EE", "structure": STRUCTURE},
    ),
    ("analyst", "post", "designs", DESIGN),
    ("analyst", "post", "quality/assess", {"maneuver_ids": [1]}),
    ("analyst", "post", "saved-views", {"page": "runs", "search": "?aircraft=1"}),
    (
        "analyst",
        "post",
        "model-structures",
        {"aircraft_id": 1, "structure": STRUCTURE},
    ),
    ("analyst", "post", "frozen-figures", {"kind": "time-history", "query": "maneuver_id=1"}),
    ("admin", "put", "review-rules/1", RULES),
)


@contextmanager
def in_team_mode(folder: Path, database: str) -> Iterator[tuple[Server, Callable[[str], Client]]]:
    with serving_installed(folder, database, FLEXSID_MODE="team") as server:
        yield server, server.log_in


@contextmanager
def in_organisation_mode(
    folder: Path, database: str
) -> Iterator[tuple[Server, Callable[[str], Client]]]:
    variables = {"FLEXSID_PROXIES": "127.0.0.1", "FLEXSID_PROXY_SECRET": SECRET}
    with serving_installed(folder, database, FLEXSID_MODE="organisation", **variables) as server:

        def connect(name: str) -> Client:
            named = {"X-Forwarded-User": name, "X-Flexsid-Proxy-Secret": SECRET}
            return server.connect(headers={"Sec-Fetch-Site": "same-origin", **named})

        yield server, connect


@pytest.mark.parametrize(
    ("start", "database_kind"),
    [
        (in_team_mode, "sqlite"),
        pytest.param(in_organisation_mode, "postgresql", marks=pytest.mark.long),
        pytest.param(in_team_mode, "postgresql", marks=pytest.mark.long),
        pytest.param(in_organisation_mode, "sqlite", marks=pytest.mark.long),
    ],
)
def test_each_role_does_what_it_may(
    start: Any, database_kind: str, tmp_path: Path, request: pytest.FixtureRequest
) -> None:
    database = f"sqlite:///{tmp_path / 'team.db'}"
    if database_kind == "postgresql":
        cluster = request.getfixturevalue("postgresql")
        database = cluster.url(cluster.copy("template1"))
    ask_command(tmp_path, database, "migrate")
    for aircraft in ("Falke", "Habicht"):
        (tmp_path / aircraft).mkdir()
        files = write_record(tmp_path / aircraft, simulate_doublet(), aircraft)
        ask_command(tmp_path, database, "import", str(files[0]), "--mapping", str(files[1]))
    members = {role.title(): role for role in RANKS}
    codes = [invite(tmp_path, database, name, (role, "Falke")) for name, role in members.items()]
    codes += [invite(tmp_path, database, "Otto", ("analyst", "Habicht"))]
    codes += [invite(tmp_path, database, "Site", ("admin", "all"))]
    with start(tmp_path, database) as (server, connect):
        if start is in_team_mode:
            for code in codes:
                set_password(server, code)
        check_roles(server, connect, "first")
    set_schema(database, "0045")  # the next server migrates it
    with start(tmp_path, database) as (server, connect):
        check_roles(server, connect, "second")
    # The way back to the earlier schema, which no command goes, leaves seals of the later one.
    found = json.loads(run_command(tmp_path, database, "check", "--json").stdout)["warnings"]
    assert "without-campaign" not in {one["code"] for one in found}


def set_schema(database: str, revision: str) -> None:
    """Let a database be of an earlier schema."""
    subprocess.run(
        [sys.executable, "-m", "alembic", "downgrade", revision],
        cwd=Path(__file__).parents[2],
        env=make_environment(FLEXSID_DATABASE=database),
        check=True,
    )


def check_roles(server: Server, connect: Callable[[str], Client], round_name: str) -> None:
    clients = {name: connect(name.title()) for name in (*RANKS, "otto", "site")}
    nobody = server.connect(headers={"Sec-Fetch-Site": "same-origin"})
    for least, method, path, body in REQUESTS:
        assert nobody.request(method, path, body).status_code == 401, path
        for name, client in clients.items():
            for header in HEADERS.get(name, ({},)):
                named = name_record(client, path, body, f"{round_name} {name} {len(header)}")
                response = client.request(method, path, named, headers=header)
                check_response(name, least, path, response)
    viewer = clients["viewer"]
    for path in ("designs", "saved-views?page=runs", "model-structures"):
        found = [one for one in viewer.get(path)["items"] if round_name in one["name"]]
        assert len(found) == 5, f"{path}: a member sees what the others stored"
    kinds = {job["kind"] for job in viewer.get("jobs?limit=200")["items"]}
    assert {"estimation", "structure-search", "quality-assessment"} <= kinds


def name_record(client: Client, path: str, body: Any, name: str) -> Any:
    """Return the body with a name of its own, and the newest version of what it changes."""
    if body is None:
        return None
    if path in ("batches", "designs", "saved-views", "model-structures"):
        return body | {"name": name}
    if path == "frozen-figures":
        return body | {"title": name}
    if path.startswith("review-rules"):
        return body | {"version": read_version(client, path)}
    return body


def read_version(client: Client, path: str) -> int:
    response = client.request("get", path)
    return response.json()["current"]["version"] if response.is_success else 0


def check_response(name: str, least: str, path: str, response: httpx2.Response) -> None:
    what = f"{name}, {path}: {response.status_code} {response.text[:300]}"
    if name == "otto":  # lists and designs of his own campaign
        is_of_own = path in ("runs", "designs") or path.startswith("saved-views")
        assert response.status_code in ((200, 201, 202, 404) if is_of_own else (403, 404)), what
    elif name == "site" or RANKS.index(name) >= RANKS.index(least):
        assert response.is_success, what
    else:
        assert response.status_code == 403, what
