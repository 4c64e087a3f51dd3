"""A doublet whose harmonics nobody knows, from its files to estimates by every entry point."""

from __future__ import annotations

import re
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
from shipped import Client, ask_command, make_environment, run_command, serving
from waiting import wait_until

DURATION_S = 7.5
FINEST_RAD = np.deg2rad(0.01)
RIGID = {"modes": []}
CHANGE = r"would be (-?[\d.]+) instead of (-?[\d.]+)"
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
    steady = doublet.client.wait_for_end(f"runs/{doublet.request(maneuver_id=1)['id']}")
    runs = (("falls", run), ("steady", steady))
    share = {name: compute_condition_share(one) for name, one in runs}
    # An airspeed known to 40 / sqrt(12) = 11.5 % is a dynamic pressure known to 23 %.
    assert 0.18 < share["falls"] < 0.28, share
    assert share["steady"] < 0.05, share


def compute_condition_share(run: dict[str, Any]) -> float:
    found = {one["name"]: one for one in run["parameters"]}["Cm_elevator"]
    assert found["std_error"] >= found["condition_std"]
    return found["condition_std"] / abs(found["value"])


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


def make_late_surface() -> dict[str, np.ndarray]:
    columns = simulate_doublet()
    columns["elevator"] = np.interp(columns["t"] + 0.03, columns["t"], columns["elevator"])
    return columns


def repeat(samples: np.ndarray, times: int) -> np.ndarray:
    return samples[np.arange(samples.size) // times * times]


def make_repeated_surface() -> dict[str, np.ndarray]:
    columns = simulate_doublet()
    columns["elevator"] = repeat(columns["elevator"], 3)
    return columns


def make_surface_in_steps(rate_hz: int = 20) -> dict[str, np.ndarray]:
    def deflect(time: np.ndarray) -> np.ndarray:
        return repeat(make_pulses(time, (0.6, 1), (0.6, -1)), 1000 // rate_hz)

    return simulate(7.5, deflect)


def make_reversed_gyro() -> dict[str, np.ndarray]:
    columns = simulate_doublet()
    return columns | {"q": -columns["q"]}


@pytest.mark.parametrize(
    ("make", "channel", "begin", "option"),
    [
        (make_late_surface, "elevator", "elevator acts ", {"kind": "delay"}),
        (
            *(make_repeated_surface, "elevator", "elevator is held at 33.3 Hz: the recorder"),
            {"kind": "interpolation", "between_samples": "smooth"},
        ),
        pytest.param(
            *(make_surface_in_steps, "elevator", "elevator is held at 20 Hz: the surface"),
            {"kind": "interpolation", "between_samples": "held"},
            marks=pytest.mark.long,
        ),
        pytest.param(
            *(make_reversed_gyro, "q", "The sign of q is reversed"),
            {"kind": "calibration", "scale": -1.0},
            marks=pytest.mark.long,
        ),
    ],
)
def test_the_cause_of_a_rejection_is_named_and_its_correction_settles_it(
    doublet: Doublet,
    tmp_path: Path,
    make: Callable[[], dict[str, np.ndarray]],
    channel: str,
    begin: str,
    option: dict[str, Any],
) -> None:
    number = doublet.add(tmp_path, make())

    def estimate(method: str) -> dict[str, Any]:
        requested = doublet.request(maneuver_id=number, method=method)
        return doublet.client.wait_for_end(f"runs/{requested['id']}")

    for run in (estimate("EE"), estimate("OE")):
        adequacy = run["adequacy"]
        assert adequacy["state"] == "suspect"
        assert adequacy["reason"].startswith(begin), adequacy["reason"]
        changes = [re.search(CHANGE, one["meaning"]) for one in adequacy["tests"]]
        assert [one[0] for one in changes if one and one[1] == one[2]] == []
    correction = adequacy["causes"][0]["finding"]["correction"]
    assert correction["channel"] == channel
    assert {name: correction[name] for name in option} == option
    if option["kind"] == "delay":
        assert correction["delay_s"] == pytest.approx(-0.03, abs=5e-4)
    if option["kind"] == "delay":
        doublet.client.send("post", f"runs/{run['id']}/corrections", None)
    else:
        took = run_command(doublet.folder, doublet.database, "correct", str(run["id"]))
        assert f"run {run['id']}: maneuver {number}, {channel}: " in took.stdout, took.stderr
    (step,) = doublet.client.get(f"maneuvers/{number}/conditioning")["items"]
    assert step["correction"] == correction | {"is_shared": True}
    corrected = estimate("OE")
    doublet.client.send("delete", f"maneuvers/{number}/conditioning/{step['id']}")
    assert corrected["adequacy"]["causes"] == [], corrected["adequacy"]["reason"]
    values = {one["name"]: one for one in corrected["parameters"]}
    for one in run["parameters"]:
        name, true = one["name"], DERIVATIVES[one["name"]]
        assert abs(values[name]["value"] - true) < 4 * values[name]["std_error"], name
        if one["std_error"] is None:
            assert one["no_error"] in ("moved by the cause", "not converged")
        else:  # what the correction moves by more than its error has none before
            assert abs(one["value"] - values[name]["value"]) < 1.01 * one["std_error"], name


def test_a_mapping_states_what_is_between_the_samples(doublet: Doublet, tmp_path: Path) -> None:
    record, mapping = write_record(tmp_path, make_surface_in_steps(25))
    text, column = mapping.read_text(), 'column = "elevator"\n'
    mapping.write_text(text.replace(column, f'{column}between_samples = "stairs"\n'))
    arguments = ("import", str(record), "--mapping", str(mapping))
    refused = run_command(doublet.folder, doublet.database, *arguments)
    assert refused.returncode == 2
    assert "between_samples' must be 'held', 'linear' or 'smooth'" in refused.stderr
    mapping.write_text(text.replace(column, f'{column}between_samples = "held"\n'))
    number = doublet.ask(*arguments)["maneuver"]
    channels = doublet.client.get(f"maneuvers/{number}")["channels"]
    said = {one["name"]: one["between_samples"] for one in channels}
    assert said == dict.fromkeys(said) | {"elevator": "held"}
    run = doublet.client.wait_for_end(f"runs/{doublet.request(maneuver_id=number)['id']}")
    assert run["adequacy"]["causes"] == []
    found = {one["name"]: one for one in run["parameters"]}
    for name, true in DERIVATIVES.items():
        assert abs(found[name]["value"] - true) < 4 * found[name]["std_error"], name


def test_a_reversed_surface_is_implausible(doublet: Doublet, tmp_path: Path) -> None:
    columns = simulate_doublet()
    columns["elevator"] = -columns["elevator"]
    number = doublet.add(tmp_path, columns)
    run = doublet.client.wait_for_end(f"runs/{doublet.request(maneuver_id=number)['id']}")
    warned = [one for one in run["fit"]["warnings"] if "Check the sign of its channel" in one]
    assert len(warned) == 1
    assert warned[0].startswith("CZ_elevator and Cm_elevator are positive")
