"""A week of a team through the port, and what each kind of account may do on the way.

Five people import, estimate, search, design, fly, review, report, back up, restore and upgrade.
Afterwards every route of the description is asked by each kind of account.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

import pytest
from rigid_record import make_pulses, simulate, simulate_doublet, write_record
from shipped import (
    Client,
    Server,
    ask_command,
    invite,
    serving,
    set_password,
)
from tests.shipped.test_team import DESIGN, NAMED, SECRET, STRUCTURE, set_schema
from waiting import wait_until

ROLES = {
    "Ann": ("admin", "all"),
    "Ben": ("reviewer", "Rigid"),
    "Cid": ("analyst", "Rigid"),
    "Dora": ("reviewer", "Rigid"),
    "Eve": ("viewer", "Rigid"),
    "Otto": ("analyst", "Other"),
}
COMMAND = '[[channels]]\ncolumn = "elevator_command"\nunit = "rad"\nrole = "command"\n'
PREFIX = "/api/v1"
OPEN = ("/health/", "/nomenclature/axes", "/invitations")
"""Addresses that respond without an account, beside those of the session."""

CHANGES = ("put", "delete")

Connect = Callable[[str], Client]


@pytest.mark.parametrize(
    ("mode", "backend", "n_servers"),
    [
        ("team", "sqlite", 1),
        *(
            pytest.param(mode, backend, n_servers, marks=pytest.mark.long)
            for mode in ("team", "organisation")
            for backend, n_servers in (("sqlite", 1), ("postgresql", 1), ("postgresql", 2))
            if (mode, backend) != ("team", "sqlite")
        ),
    ],
)
def test_a_week_of_five_people(
    mode: str, backend: str, n_servers: int, tmp_path: Path, request: pytest.FixtureRequest
) -> None:
    database = f"sqlite:///{tmp_path / 'team.db'}"
    if backend == "postgresql":
        cluster = request.getfixturevalue("postgresql")
        database = cluster.url(cluster.copy("template1"))
    ask_command(tmp_path, database, "migrate")
    for aircraft in ("Rigid", "Other"):
        (tmp_path / aircraft).mkdir()
        files = write_record(tmp_path / aircraft, simulate_doublet(), aircraft)
        ask_command(tmp_path, database, "import", str(files[0]), "--mapping", str(files[1]))
    codes = [invite(tmp_path, database, name, role) for name, role in ROLES.items()]
    backup = tmp_path / "backup.db"
    with at_work(tmp_path, database, mode, n_servers) as (servers, connect):
        if mode == "team":
            for code in codes:
                set_password(servers[0], code)
        run = estimate(connect("Cid"), connect("Eve"), tmp_path)
        fly(connect("Cid"), run)
        decision = review(connect, run)
        for path in (f"reports/run/{run}", "reports/campaign?aircraft_id=1"):
            assert "Rigid" in connect("Eve").request("get", path).text
        ask_command(tmp_path, database, "backup", str(backup))
        later = note(connect("Cid"), "after the backup")
        check_routes(
            servers[-1], connect, every=request.node.get_closest_marker("long") is not None
        )
        ask_command(tmp_path, database, "restore", str(backup))
        assert note(connect("Cid"), "after the restore") > later
        texts = [one["text"] for one in connect("Eve").get("notes")["items"]]
        assert texts == ["after the restore"]
        assert ask_command(tmp_path, database, "check")["sound"]
    set_schema(database, "0045")
    with at_work(tmp_path, database, mode, n_servers) as (_, connect):
        assert connect("Eve").get(f"decisions/{decision}")["state"] == "approved"
        again = connect("Cid").send("post", "runs", {"maneuver_id": 1, "method": "EE"})
        assert connect("Eve").wait_for_end(f"runs/{again['id']}")["state"] == "succeeded"


@contextmanager
def at_work(
    folder: Path, database: str, mode: str, n_servers: int
) -> Iterator[tuple[list[Server], Connect]]:
    """Start servers with a disk each, and connect people to one after the other."""
    variables = {"FLEXSID_MODE": mode}
    if mode == "organisation":
        variables |= {"FLEXSID_PROXIES": "127.0.0.1", "FLEXSID_PROXY_SECRET": SECRET}
    with ExitStack() as stack:
        servers = []
        for k in range(n_servers):
            own = folder / f"server-{k}"
            own.mkdir(exist_ok=True)
            start = serving(own, database, TMPDIR=str(own), **variables)
            servers.append(stack.enter_context(start))
        clients: dict[str, Client] = {}

        def connect(name: str) -> Client:
            server = servers[len(clients) % n_servers]
            if name not in clients and mode == "team":
                clients[name] = server.log_in(name)
            elif name not in clients:
                named = {"X-Forwarded-User": name, "X-Flexsid-Proxy-Secret": SECRET}
                headers = {"Sec-Fetch-Site": "same-origin", **named}
                clients[name] = server.connect(headers=headers)
            return clients[name]

        yield servers, connect


def estimate(cid: Client, eve: Client, folder: Path) -> int:
    """Import a record, and request what is computed from it; return the run."""
    columns = simulate(9.0, lambda time: make_pulses(time, (0.9, 1), (0.9, -1)), seed=2)
    columns["elevator_command"] = columns["elevator"]
    record, mapping = write_record(folder, columns)
    mapping.write_text(mapping.read_text() + COMMAND)
    upload = cid.upload(record)["upload"]["id"]
    assert eve.request("get", f"uploads/{upload}").status_code == 403
    body = {"mapping": mapping.read_text(), "confirmed": True}
    job = cid.send("post", f"uploads/{upload}/import", body)
    ended = cid.wait_for_end(f"jobs/{job['id']}")
    assert ended["state"] == "succeeded", ended["error"]
    maneuver = max(one["id"] for one in eve.get("maneuvers")["items"])
    request = {"maneuver_id": maneuver, "method": "OE", "settings": {}}
    run = cid.send("post", "runs", request)["id"]
    batch = {"maneuver_ids": [1, maneuver], "methods": ["EE"], "name": "week"}
    cid.send("post", "batches", batch)
    search = {"maneuver_ids": [maneuver], "method": "EE", "structure": STRUCTURE}
    cid.send("post", "searches", search)
    cid.send("post", "designs", {**DESIGN, "name": "week"})
    cid.send("post", "quality/assess", {"maneuver_ids": [maneuver]})

    def is_idle() -> bool:
        jobs = eve.get("jobs?limit=200")["items"]
        return all(one["state"] not in ("queued", "running") for one in jobs)

    wait_until(is_idle, "the end of all jobs")
    failed = [one for one in eve.get("jobs?limit=200")["items"] if one["state"] != "succeeded"]
    assert failed == []
    return run


def fly(cid: Client, run: int) -> None:
    """Replay the maneuver of a run as a stream."""
    maneuver = cid.get(f"runs/{run}")["maneuver_id"]
    receiver = {"name": "replay", "options": {"maneuver_id": maneuver, "speed": 20.0}}
    body = {"run_id": run, "title": "week", "receiver": receiver}
    stream = cid.send("post", "live/streams", body)["id"]

    def has_ended() -> bool:
        return cid.get(f"live/streams/{stream}")["stream"]["status"] == "stopped"

    wait_until(has_ended, "the end of the stream")


def review(connect: Connect, run: int) -> int:
    """Propose a model structure, and decide on it by the votes of two reviewers."""
    rules = {"quorum": 2, "own_allowed": False, "reason": "agreed", "version": 0}
    connect("Ann").send("put", "review-rules/1", rules)
    cid = connect("Cid")
    structure = cid.send(
        "post", "model-structures", {"aircraft_id": 1, "structure": STRUCTURE, "name": "SP"}
    )
    proposal = {
        "title": "short period",
        "structure": {"id": structure["id"], "version": 1},
        "reasoning": "no modes in the band",
        "run_ids": [run],
    }
    decision = cid.send("post", "decisions", proposal)
    vote = {
        "revision": decision["revision"],
        "vote": "approve",
        "text": "agreed",
        "despite": "known",
    }
    path = f"decisions/{decision['id']}/votes"
    for name, status in (("Cid", 403), ("Eve", 403), ("Otto", 404), ("Ben", 201), ("Dora", 201)):
        assert connect(name).request("post", path, vote).status_code == status, name
    assert connect("Eve").get(f"decisions/{decision['id']}")["state"] == "approved"
    return decision["id"]


def note(client: Client, text: str) -> int:
    return client.send("post", "notes", {"subject": "maneuver", "key": "1", "text": text})["id"]


def check_routes(server: Server, connect: Connect, *, every: bool) -> None:
    """Ask the routes of the description; those that read only, unless ``every`` one."""
    nobody = server.connect(headers={"Sec-Fetch-Site": "same-origin"})
    ann = connect("Ann")
    people = [(None, nobody), *((name, connect(name)) for name in ("Otto", "Eve", "Cid", "Ben"))]
    operations = list(list_operations(ann))
    assert len(operations) > 300
    for name, client in [*people, ("Ann", ann)]:
        for method, address, path in operations:
            if method != "get" and (not every or name in ("Ann", "Ben", "Cid")):
                continue
            if address.startswith(("/events", "/session")):
                continue  # an endless response; log-in and log-out
            response = client.request(method, path, headers=NAMED if name == "Ann" else {})
            what = f"{name}, {method} {address}: {response.status_code} {response.text[:300]}"
            assert response.status_code < 500, what
            if name is None:
                assert response.status_code == 401 or address.startswith(OPEN), what
            elif "{" in address and (name == "Otto" or (name == "Eve" and method in CHANGES)):
                assert not response.is_success, what


def list_operations(client: Client) -> Iterator[tuple[str, str, str]]:
    """List method and address of each route, and an address with values of its parameters."""
    described = client.get("openapi.json")["paths"]
    for address, methods in described.items():
        for method, operation in methods.items():
            path = address
            for parameter in operation.get("parameters", ()):
                if parameter["in"] == "path":
                    value = choose_value(parameter["schema"])
                    path = path.replace(f"{{{parameter['name']}}}", value)
            yield method, address.removeprefix(PREFIX), path


def choose_value(schema: dict[str, Any]) -> str:
    if schema.get("type") == "integer":
        return "1"
    return str(schema["enum"][0]) if "enum" in schema else "x"
