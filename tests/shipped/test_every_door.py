"""The run of a maneuver that is proposed is the run that each door requests."""

from __future__ import annotations

import asyncio
import json
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pytest
from mcp import Client as AgentClient
from mcp.client.stdio import StdioServerParameters
from shipped import PROGRAM, Client, Server, ask_command, make_environment, run_command, serving
from waiting import wait_until

MANEUVER = 2
CLIENT = """
import sys
from flexsid.client import Workbench
print(Workbench(sys.argv[1]).submit(int(sys.argv[2]), "EE"))
"""


@pytest.fixture(scope="module")
def database(campaign: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    file = tmp_path_factory.mktemp("doors") / "flexsid.db"
    shutil.copy(campaign, file)
    return file


@pytest.fixture(scope="module")
def server(database: Path) -> Iterator[Server]:
    with serving(database.parent, f"sqlite:///{database}") as started:
        yield started


@pytest.fixture(scope="module")
def client(server: Server) -> Client:
    return server.connect()


@pytest.fixture(scope="module")
def proposal(client: Client) -> dict[str, Any]:
    """What the page proposes, and requests unchanged."""
    return client.get(f"maneuvers/{MANEUVER}/run-proposal")


@pytest.mark.parametrize("form", ["json", "csv", "nc"])
def test_samples_are_the_same_file_over_rest_and_on_the_command_line(
    client: Client, database: Path, tmp_path: Path, form: str
) -> None:
    file = tmp_path / f"samples.{form}"
    order = ("samples", str(MANEUVER), "--channels", "q,wf4s", "--output", str(file))
    ask_command(tmp_path, f"sqlite:///{database}", *order)
    sent = client.request(
        "get", f"maneuvers/{MANEUVER}/samples", params={"channels": "q,wf4s", "format": form}
    )
    assert (sent.status_code, sent.content) == (200, file.read_bytes())


def request_by_page(client: Client, proposal: dict[str, Any]) -> int:
    body = {
        "maneuver_id": MANEUVER,
        "method": "EE",
        "structure": proposal["structure"],
        "settings": proposal["settings"],
    }
    return client.send("post", "runs", body)["id"]


def request_by_rest(client: Client) -> int:
    return client.send("post", "runs", {"maneuver_id": MANEUVER, "method": "EE"})["id"]


def request_by_command(folder: Path, database: Path) -> int:
    arguments = ("run", "--maneuver", str(MANEUVER), "--method", "EE")
    return ask_command(folder, f"sqlite:///{database}", *arguments)["id"]


def request_by_client(server: Server, folder: Path) -> int:
    command = [sys.executable, "-c", CLIENT, server.url, str(MANEUVER)]
    environment = make_environment()
    done = subprocess.run(
        command, cwd=folder, env=environment, capture_output=True, text=True, check=True
    )
    return int(done.stdout)


def request_by_batch(client: Client) -> int:
    """Return how many runs of a batch of one are not new."""
    body = {"name": "doors", "maneuver_ids": [MANEUVER], "methods": ["EE"]}
    return client.send("post", "batches", body)["repeated"]


def request_by_template(client: Client, run_id: int) -> int:
    template = client.send("post", "run-templates", {"run_id": run_id, "name": "as proposed"})
    body = {"maneuver_id": MANEUVER, "method": "EE", "run_template_id": template["id"]}
    return client.send("post", "runs", body)["id"]


def request_by_agent(server: Server) -> int:
    parameters = StdioServerParameters(command=str(PROGRAM), args=["mcp", "--url", server.url])

    async def ask() -> int:
        async with AgentClient(parameters) as agent:
            body = {"maneuver_id": MANEUVER, "method": "EE"}
            called = await agent.call_tool("request_run", {"body": body})
            text = getattr(called.content[0], "text", "")
            return json.loads(text)["result"]["id"]

    # The thread of a browser test has a loop already.
    with ThreadPoolExecutor(1) as executor:
        return executor.submit(asyncio.run, ask()).result()


def test_page_rest_command_client_batch_template_and_agent_request_one_run(
    server: Server, client: Client, proposal: dict[str, Any], database: Path, tmp_path: Path
) -> None:
    first = request_by_page(client, proposal)
    found = {
        "rest": request_by_rest(client),
        "command": request_by_command(tmp_path, database),
        "client": request_by_client(server, tmp_path),
        "template": request_by_template(client, first),
        "agent": request_by_agent(server),
    }
    # A request that equals a run, in its settings, model and data, is that run.
    assert found == dict.fromkeys(found, first)
    assert request_by_batch(client) == 1
    run = client.get(f"runs/{first}")
    assert run["settings"] == proposal["settings"]
    assert run["structure"] == proposal["structure"]


EVERY_OPTION: dict[str, tuple[str | None, dict[str, Any]]] = {
    "--axis": ("longitudinal", {"structure": {"axis": "longitudinal"}}),
    "--modes": ("7,9", {"structure": {"modes": [7, 9]}}),
    "--inputs": ("bfs,wf1s,wf4s", {"structure": {"inputs": ["bfs", "wf1s", "wf4s"]}}),
    "--outputs": (
        "alpha,q,theta,az_ofr",
        {"structure": {"outputs": ["alpha", "q", "theta", "az_ofr"]}},
    ),
    "--free": ("CZ_alpha,Cm_alpha,Cm_q", {"structure": {"free": ["CZ_alpha", "Cm_alpha", "Cm_q"]}}),
    "--free-delays": (None, {"structure": {"free_delays": True}}),
    "--extra-parameters": ("scale_alpha", {"structure": {"extra_parameters": ["scale_alpha"]}}),
    "--band": ("0.6,8.0", {"settings": {"band_hz": [0.6, 8.0]}}),
    "--start": ("prediction", {"settings": {"start": "prediction"}}),
    "--max-iterations": ("2", {"settings": {"max_iterations": 2}}),
    "--noise": ("full", {"settings": {"noise": "full"}}),
    "--prior-spread": ("0.4", {"settings": {"prior_spread": 0.4}}),
    "--out-of-band-modes": ("omitted", {"settings": {"out_of_band_modes": "omitted"}}),
    "--additional-maneuvers": ("4", {"settings": {"additional_maneuver_ids": [4]}}),
}
"""Options of `flexsid run` with a value that is not the default, and the same over REST."""


def test_options_of_the_command_are_fields_of_the_interface(
    client: Client, database: Path, tmp_path: Path
) -> None:
    body: dict[str, Any] = {"maneuver_id": MANEUVER, "method": "OE"}
    order = ["run", "--maneuver", str(MANEUVER), "--method", "OE"]
    for option, (value, fields) in EVERY_OPTION.items():
        order += [option] if value is None else [option, value]
        for part, field in fields.items():
            body[part] = body.get(part, {}) | field
    first = client.send("post", "runs", body)["id"]
    assert ask_command(tmp_path, f"sqlite:///{database}", *order)["id"] == first
    run = client.get(f"runs/{first}")
    for part in ("structure", "settings"):
        assert {name: run[part][name] for name in body[part]} == body[part]
    described = run_command(tmp_path, f"sqlite:///{database}", "run", "--help").stdout
    known = set(re.findall(r"^ +(--[a-z-]+)", described, re.MULTILINE))
    of_the_command = {"--database", "--json", "--maneuver", "--method", "--wait"}
    named = {"--structure", "--template", "--start-run", "--aerodynamics"}  # need a record
    assert known == EVERY_OPTION.keys() | of_the_command | named


def test_a_search_proposes_what_the_run_of_the_record_supports(
    client: Client, proposal: dict[str, Any]
) -> None:
    body = {
        "maneuver_ids": [MANEUVER],
        "method": "EE",
        "structure": proposal["structure"],
        "settings": {"resamplings": 0},
    }
    search = client.send("post", "searches", body)
    ended = client.wait_for_end(f"searches/{search['id']}")
    assert ended["state"] == "succeeded", ended["error"]
    result = ended["result"]
    # Its model is that of the run, which its tests do not reject: the search proposes one.
    assert result["undecided"] == ""
    (proposed,) = (one for one in result["candidates"] if one["proposed"])
    assert proposed["adequacy"] == "consistent"
    number = result["candidates"].index(proposed)
    run = client.send("post", f"searches/{search['id']}/candidates/{number}/run")
    assert run["settings"] == proposal["settings"]
    # The run of the record holds no term that the search drops.
    record = client.send("post", "runs", {"maneuver_id": MANEUVER, "method": "EE"})
    found = client.wait_for_end(f"runs/{record['id']}")["parameters"]
    held = {row["name"] for row in found if abs(row["value"]) > 4.5 * row["std_error"]}
    assert len(held) > 35
    assert held <= set(proposed["structure"]["free"])
    # Nor differ the values at the end of its path from those of the run.
    values = {row["name"]: row for row in found}
    terms = [term for group in result["groups"] for term in group["terms"] if term["selected"]]
    for term in terms:
        of_run = values[term["name"]]
        assert abs(term["value"] - of_run["value"]) < 2.0 * of_run["std_error"], term["name"]


def test_a_live_test_point_queues_the_run_that_the_page_proposes_for_it(client: Client) -> None:
    first = client.send("post", "runs", {"maneuver_id": MANEUVER, "method": "EE"})
    assert client.wait_for_end(f"runs/{first['id']}")["state"] == "succeeded"
    receiver = {"name": "replay", "options": {"maneuver_id": MANEUVER, "speed": 1000.0}}
    body = {"run_id": first["id"], "title": "doors", "flight_id": 1, "receiver": receiver}
    stream = client.send("post", "live/streams", body)["id"]

    def find_point() -> Any:
        points = client.get(f"live/streams/{stream}")["test_points"]
        return points[0] if points else None

    point = wait_until(find_point, "the test point")
    assert point["run_id"] is not None, point["message"]
    run = client.get(f"runs/{point['run_id']}")
    proposed = client.get(f"maneuvers/{point['maneuver_id']}/run-proposal")
    assert run["settings"] == proposed["settings"]
    assert run["structure"] == proposed["structure"]
