"""A week of a team through the port, and what each kind of account may do on the way.

Five people import, estimate, search, design, fly, review, report, back up, restore and upgrade.
Afterwards every route of the description is asked by each kind of account.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, contextmanager
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from rigid_record import make_pulses, simulate, simulate_doublet, write_record
from shipped import (
    Client,
    Server,
    ask_command,
    invite,
    serving_installed,
    set_password,
)
from tests.shipped.test_team import DESIGN, NAMED, RANKS, SECRET, STRUCTURE, set_schema
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
SKIPPED = ("/api/v1/events", "/api/v1/session")
"""An endless response, log-in and log-out."""

Connect = Callable[[str], Client]


@pytest.mark.parametrize(
    ("mode", "backend", "n_servers"),
    [
        ("team", "sqlite", 1),
        *(
            pytest.param(mode, backend, n_servers, marks=pytest.mark.long)
            for mode in ("team", "organisation")
            for backend in ("sqlite", "postgresql")
            for n_servers in (1, 2)
            if (mode, backend, n_servers) != ("team", "sqlite", 1)
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
    with ThreadPoolExecutor(3) as commands:
        codes = list(commands.map(lambda one: invite(tmp_path, database, *one), ROLES.items()))
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
    # Now another of the servers dispatches.
    with at_work(tmp_path, database, mode, n_servers, reverse=True) as (_, connect):
        assert connect("Eve").get(f"decisions/{decision}")["state"] == "approved"
        again = connect("Cid").send("post", "runs", {"maneuver_id": 1, "method": "EE"})
        assert connect("Eve").wait_for_end(f"runs/{again['id']}")["state"] == "succeeded"


@contextmanager
def at_work(
    folder: Path, database: str, mode: str, n_servers: int, *, reverse: bool = False
) -> Iterator[tuple[list[Server], Connect]]:
    """Start servers with a disk each, and connect people to one after the other.

    The first one dispatches, or the last one if they start in ``reverse``.
    """
    variables = {"FLEXSID_MODE": mode}
    if mode == "organisation":
        variables |= {"FLEXSID_PROXIES": "127.0.0.1", "FLEXSID_PROXY_SECRET": SECRET}
    with ExitStack() as stack:
        servers: list[Server] = []
        for k in reversed(range(n_servers)) if reverse else range(n_servers):
            own = folder / f"server-{k}"
            own.mkdir(exist_ok=True)
            start = serving_installed(own, database, TMPDIR=str(own), **variables)
            servers.append(stack.enter_context(start))
            if n_servers > 1:
                wait_until(partial(is_ready, servers[-1]), "a server that dispatches")
        servers.sort(key=lambda server: server.log)
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


def is_ready(server: Server) -> bool:
    return server.connect().request("get", "health/ready").status_code == 204


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
    """Compare the responses of all routes, to all kinds of account, with the table of permissions.

    Without ``every`` those that read only, to accounts that may do no more.
    """
    nobody = server.connect(headers={"Sec-Fetch-Site": "same-origin"})
    ann = connect("Ann")
    operations = list(list_operations(ann))
    assert len(operations) > 300
    for name in (None, "Otto", "Eve", *(("Cid", "Ben", "Ann") if every else ())):
        client = nobody if name is None else connect(name)
        for method, address, needed, parameters in operations:
            if address.startswith(SKIPPED) or (method != "get" and not every):
                continue
            # Uploads belong to an account, and have no number.
            of_record = any(one["schema"].get("type") == "integer" for one in parameters)
            may = is_allowed(name, needed, of_record=of_record)
            # What would be changed does not exist.
            number = "999999" if may and method != "get" else "1"
            path = fill(address, parameters, number)
            response = client.request(method, path, headers=NAMED if name == "Ann" else {})
            what = f"{name}, {method} {path}: {response.status_code} {response.text[:300]}"
            assert response.status_code < 500, what
            if may:
                assert response.status_code not in (401, 403), what
            else:
                assert response.status_code in ((401,) if name is None else (403, 404)), what


def is_allowed(name: str | None, needed: str, *, of_record: bool) -> bool:
    """Return whether the table allows a route; records are of a campaign that is not Otto's."""
    if needed == "public" or (needed == "account" and name is not None):
        return True
    if name is None or (name == "Otto" and of_record):
        return False
    return RANKS.index(ROLES[name][0]) >= RANKS.index(needed)


def list_operations(client: Client) -> Iterator[tuple[str, str, str, list[dict[str, Any]]]]:
    """List method, address, permission and parameters of each route."""
    described = client.get("openapi.json")["paths"]
    for address, methods in described.items():
        for method, operation in methods.items():
            parameters = [one for one in operation.get("parameters", ()) if one["in"] == "path"]
            yield method, address, operation["x-permission"], parameters


def fill(path: str, parameters: list[dict[str, Any]], number: str) -> str:
    """Return an address with values of its parameters."""
    for parameter in parameters:
        schema = parameter["schema"]
        value = number if schema.get("type") == "integer" else str(schema.get("enum", ["x"])[0])
        path = path.replace(f"{{{parameter['name']}}}", value)
    return path
