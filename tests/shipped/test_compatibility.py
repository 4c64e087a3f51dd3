"""Sensors are compared by kinematics, and a fault corrected, without a modal table."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
from kinematic_flight import PlantedFault, record_flight, write_flight
from shipped import Client, ask_command, make_environment, run_command, serving

LATE = PlantedFault("alpha", delay_s=0.022)
CLIENT = """
import sys
from flexsid.client import Workbench
print(Workbench(sys.argv[1]).check_compatibility([1])["sentence"])
"""


@dataclass(frozen=True, slots=True)
class Flown:
    """A server, and two maneuvers of one aircraft with a late vane; a third is sound."""

    url: str
    client: Client
    folder: Path
    database: str

    def compare(self, *maneuvers: int) -> dict[str, Any]:
        ids = f"maneuver_ids={','.join(map(str, maneuvers))}"
        job = self.client.send("post", f"compatibility/results?{ids}")
        if job["state"] != "succeeded":
            assert self.client.wait_for_end(f"jobs/{job['id']}")["state"] == "succeeded"
        return self.client.get(f"compatibility?{ids}")

    def list_steps(self, maneuver: int) -> list[dict[str, Any]]:
        return [
            step
            for step in self.client.get(f"maneuvers/{maneuver}/conditioning")["items"]
            if step["undone_at"] is None
        ]

    def add(self, seed: int, fault: PlantedFault, aircraft: str) -> int:
        columns = record_flight(seed, "longitudinal", fault)
        folder = self.folder / f"{aircraft}-{seed}"
        record, mapping = write_flight(folder, columns, "longitudinal", aircraft)
        upload = self.client.upload(record)["upload"]["id"]
        body = {"mapping": mapping.read_text()}
        job = self.client.send("post", f"uploads/{upload}/import", body)
        return self.client.wait_for_end(f"jobs/{job['id']}")["result"]["maneuver_id"]


@pytest.fixture(scope="module")
def flown(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Flown]:
    folder = tmp_path_factory.mktemp("compatibility")
    database = f"sqlite:///{folder / 'flexsid.db'}"
    with serving(folder, database) as server:
        flown = Flown(server.url, server.connect(), folder, database)
        planted = ((1, LATE, "late"), (2, LATE, "late"), (3, PlantedFault(), "sound"))
        assert [flown.add(*one) for one in planted] == [1, 2, 3]
        yield flown


def test_a_late_vane_is_named_with_its_delay(flown: Flown) -> None:
    found = flown.compare(1, 2)
    assert found["state"] == "faulty"
    (fault,) = found["faults"]
    finding = fault["finding"]
    assert (finding["kind"], finding["channel"]) == ("delay", "alpha")
    assert abs(finding["value"] - 0.022) < 2.5 * finding["std"] < 0.005
    assert finding["sentence"].endswith("ms late.")
    assert finding["correction"]["delay_s"] == finding["value"]
    assert {one["name"] for one in found["sensors"]} == {"alpha", "q", "theta", "az"}


def test_sound_sensors_are_compatible(flown: Flown) -> None:
    found = flown.compare(3)
    assert found["state"] == "compatible"
    assert found["sentence"] == "4 sensors agree on one motion over 1 maneuver."


def test_the_command_and_the_client_name_the_same(flown: Flown) -> None:
    sentence = flown.compare(1)["sentence"]
    printed = run_command(flown.folder, flown.database, "compatibility", "--maneuver", "1")
    assert printed.returncode == 0, printed.stderr
    assert sentence in printed.stdout
    asked = subprocess.run(
        [sys.executable, "-c", CLIENT, flown.url],
        env=make_environment(),
        capture_output=True,
        text=True,
        check=True,
    )
    assert asked.stdout.strip() == sentence


@pytest.mark.parametrize(
    ("ids", "status", "code"),
    [
        ("maneuver_ids=1,3", 422, "wrong-aircraft"),
        ("maneuver_ids=99", 404, "unknown-record"),
        ("", 422, "invalid-request"),
    ],
)
def test_maneuvers_that_cannot_be_compared_are_refused(
    flown: Flown, ids: str, status: int, code: str
) -> None:
    refused = flown.client.request("post", f"compatibility/results?{ids}")
    assert (refused.status_code, refused.json()["code"]) == (status, code)


def test_a_shared_correction_holds_for_every_maneuver_until_it_is_undone(flown: Flown) -> None:
    correction = flown.compare(1, 2)["faults"][0]["finding"]["correction"]
    body = {"items": [{**correction, "is_shared": True}]}
    flown.client.send("post", "maneuvers/1/conditioning", body)
    assert [len(flown.list_steps(number)) for number in (1, 2, 3)] == [1, 1, 0]
    assert flown.compare(1, 2)["state"] == "compatible"

    later = flown.add(4, LATE, "late")
    (step,) = flown.list_steps(later)
    assert step["correction"]["delay_s"] == pytest.approx(correction["delay_s"])
    assert flown.compare(later)["state"] == "compatible"

    flown.client.send("delete", f"maneuvers/{later}/conditioning/{step['id']}")
    assert [len(flown.list_steps(number)) for number in (1, 2, later)] == [0, 0, 0]
    assert flown.compare(1, 2)["state"] == "faulty"


def test_the_command_corrects_what_it_finds(flown: Flown) -> None:
    reversed_gyro = flown.add(5, PlantedFault("q", scale=-1.0), "reversed")
    found = ask_command(
        *(flown.folder, flown.database, "compatibility"),
        *("--maneuver", str(reversed_gyro), "--correct"),
    )
    assert found["faults"][0]["finding"]["kind"] == "sign"
    (step,) = flown.list_steps(reversed_gyro)
    assert step["correction"]["scale"] == -1.0
    assert step["correction"]["is_shared"]
    assert flown.compare(reversed_gyro)["state"] == "compatible"
