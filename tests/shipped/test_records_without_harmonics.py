"""A doublet whose harmonics nobody knows, from its files to estimates by every entry point."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rigid_record import (
    DERIVATIVES,
    SHORT_PERIOD_HZ,
    make_pulses,
    simulate,
    simulate_doublet,
    write_record,
)
from shipped import Client, ask_command, make_environment, serving
from waiting import wait_until

DURATION_S = 7.5
FINEST_RAD = np.deg2rad(0.01)
RIGID = {"modes": []}
CLIENT = """
import sys
from flexsid.client import Workbench
print(Workbench(sys.argv[1]).submit(1, "OE", modes=[]))
"""


def make_coarse_step() -> dict[str, np.ndarray]:
    """The elevator is held for seconds, and recorded in steps of 0.01 deg."""
    columns = simulate(DURATION_S, lambda time: make_pulses(time, (3.6, 1)))
    columns["elevator"] = FINEST_RAD * np.rint(columns["elevator"] / FINEST_RAD)
    return columns


@dataclass(frozen=True, slots=True)
class Doublet:
    """A server with the maneuver 1, and the folder and database of its commands."""

    url: str
    client: Client
    folder: Path
    database: str

    def add(self, folder: Path, columns: dict[str, np.ndarray]) -> int:
        """Import another record of the aircraft and return the id of its maneuver."""
        record, mapping = write_record(folder, columns)
        return self.ask("import", str(record), "--mapping", str(mapping))["maneuver"]

    def ask(self, *arguments: str) -> Any:
        return ask_command(self.folder, self.database, *arguments)

    def request(self, **changes: Any) -> dict[str, Any]:
        body = {"maneuver_id": 1, "method": "OE", "structure": RIGID, **changes}
        return self.client.send("post", "runs", body)


@pytest.fixture(scope="module")
def doublet(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Doublet]:
    folder = tmp_path_factory.mktemp("doublet")
    database = f"sqlite:///{folder / 'flexsid.db'}"
    record, mapping = write_record(folder, simulate_doublet())
    ask_command(folder, database, "import", str(record), "--mapping", str(mapping))
    with serving(folder, database) as server:
        yield Doublet(server.url, server.connect(), folder, database)


@pytest.mark.parametrize("method", ["OE", "EE"])
def test_a_run_without_a_band_contains_the_short_period(doublet: Doublet, method: str) -> None:
    requested = doublet.request(method=method)
    low, high = requested["settings"]["band_hz"]
    assert low == pytest.approx(1 / DURATION_S)
    assert low < SHORT_PERIOD_HZ < high
    run = doublet.client.wait_for_end(f"runs/{requested['id']}")
    assert run["state"] == "succeeded", run["error"]
    found = {one["name"]: one for one in run["parameters"]}
    for name, true in DERIVATIVES.items():
        error, std = found[name]["value"] - true, found[name]["std_error"]
        assert abs(error) < 4 * std, name
        assert std < 0.05 * abs(true), name


def test_a_step_that_is_held_to_the_end_gives_right_values(
    doublet: Doublet, tmp_path: Path
) -> None:
    number = doublet.add(tmp_path, simulate(4.0, lambda time: make_pulses(time, (9.0, 1))))
    requested = [doublet.request(maneuver_id=number, method=method) for method in ("OE", "EE")]
    for one in requested:
        run = doublet.client.wait_for_end(f"runs/{one['id']}")
        assert run["state"] == "succeeded", run["error"]
        assert run["adequacy"]["state"] == "consistent", run["adequacy"]["reason"]
        found = {one["name"]: one for one in run["parameters"]}
        for name, true in DERIVATIVES.items():
            error, std = found[name]["value"] - true, found[name]["std_error"]
            assert abs(error) < 3 * std, (run["method"], name)
            assert std < 0.25 * abs(true), (run["method"], name)


def run_by_request(doublet: Doublet) -> Any:
    return doublet.request()


def run_without_structure(doublet: Doublet) -> Any:
    return doublet.request(structure=None)


def run_of_template(doublet: Doublet) -> Any:
    known = doublet.client.get("run-templates")["items"]
    if not known:
        body = {"run_id": doublet.request()["id"], "name": "standard"}
        known = [doublet.client.send("post", "run-templates", body)]
    return doublet.request(run_template_id=known[0]["id"])


def run_of_batch(doublet: Doublet) -> Any:
    body: dict[str, Any] = {
        "name": "all",
        "maneuver_ids": [1],
        "methods": ["OE"],
        "structures": [{"structure": RIGID}],
    }
    run = doublet.request()
    assert doublet.client.send("post", "batches", body)["repeated"] == 1
    return run


def run_of_command(doublet: Doublet) -> Any:
    return doublet.ask("run", "--maneuver", "1", "--method", "OE", "--modes", "")


def run_of_command_by_proposal(doublet: Doublet) -> Any:
    return doublet.ask("run", "--maneuver", "1", "--method", "OE")


def run_of_client(doublet: Doublet) -> Any:
    program = [sys.executable, "-c", CLIENT, doublet.url]
    done = subprocess.run(
        program, env=make_environment(), capture_output=True, text=True, check=True
    )
    return doublet.client.get(f"runs/{int(done.stdout)}")


def search_of_request(doublet: Doublet) -> Any:
    body = {"maneuver_ids": [1], "method": "OE", "structure": RIGID}
    return doublet.client.send("post", "searches", body)


def search_of_command(doublet: Doublet) -> Any:
    return doublet.ask("search", "1", "--method", "EE", "--modes", "")


@pytest.mark.parametrize(
    "entry",
    [
        *(run_by_request, run_without_structure, run_of_template, run_of_batch, run_of_command),
        *(run_of_command_by_proposal, run_of_client, search_of_request, search_of_command),
    ],
)
def test_every_entry_point_has_the_proposed_band(
    doublet: Doublet, entry: Callable[[Doublet], Any]
) -> None:
    proposed = doublet.client.get("maneuvers/1/run-proposal")["settings"]
    settings = entry(doublet)["settings"]
    assert settings["band_hz"] == proposed["band_hz"]
    if entry.__name__.startswith("run"):
        assert settings == proposed


def assess(client: Client, number: int) -> dict[str, Any]:
    client.send("post", "quality/assess", {"maneuver_ids": [number]})
    address = f"maneuvers/{number}/quality"
    return wait_until(lambda: client.get(address)["quality"], "the assessment")


def test_an_airspeed_that_falls_is_named_by_quality_and_run(
    doublet: Doublet, tmp_path: Path
) -> None:
    columns = simulate_doublet()
    columns["airspeed"] = np.linspace(72.0, 48.0, columns["t"].size)
    number = doublet.add(tmp_path, columns)
    quality = assess(doublet.client, number)
    assert "Airspeed drifted by 40" in quality["summary"]
    run = doublet.client.wait_for_end(f"runs/{doublet.request(maneuver_id=number)['id']}")
    said = [text for text in run["fit"]["warnings"] if "the airspeed falls by 24.0 m/s" in text]
    assert len(said) == 1
    assert "one airspeed, of 60.0 m/s" in said[0]


def test_a_held_surface_is_sound(doublet: Doublet, tmp_path: Path) -> None:
    for number in (1, doublet.add(tmp_path, make_coarse_step())):
        quality = assess(doublet.client, number)
        found = {one["name"]: one for one in quality["report"]["channels"]}["elevator"]
        assert (found["saturated"], found["stretches"]) == (0.0, []), number
        assert quality["verdict"] != "bad", quality["summary"]


def test_a_clipped_and_a_frozen_sensor_are_not(doublet: Doublet, tmp_path: Path) -> None:
    columns = simulate_doublet()
    columns["q"] = np.clip(columns["q"], -0.05, 0.05)
    columns["alpha"][200:240] = columns["alpha"][200]
    quality = assess(doublet.client, doublet.add(tmp_path, columns))
    warnings = [one for one in quality["report"]["warnings"] if one["channel"] is not None]
    about = {(one["about"], one["channel"]) for one in warnings}
    assert about == {("saturation", "q"), ("dropouts", "alpha")}, warnings
