"""Modes come from the outputs of an imported record, without a modal table."""

from __future__ import annotations

import re
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from shipped import Client, ask_command, make_environment, run_command, serving

RATE, DURATION = 16.0, 150.0
FREQUENCY, DAMPING, TONE = 3.0, 0.02, 4.7
PLACES = {"tip": 1.0, "middle": 0.5, "root": -0.2}
BAND = "low_hz=2&high_hz=6"
CLIENT = """
import sys
from flexsid.client import Workbench
found = Workbench(sys.argv[1]).identify_output_only(1, low_hz=2.0, high_hz=6.0)
print(found["modes"][0]["frequency_hz"])
"""


@dataclass(frozen=True, slots=True)
class Flown:
    """A server with one record in turbulence."""

    url: str
    client: Client
    folder: Path
    database: str


def write_turbulence(folder: Path) -> tuple[Path, Path]:
    """Write accelerations of one mode in white noise, with a tone, and their mapping."""
    rng = np.random.default_rng(7)
    n = int(RATE * DURATION)
    omega = 2.0 * np.pi * FREQUENCY
    step = np.exp(omega * (-DAMPING + 1j * np.sqrt(1.0 - DAMPING**2)) / RATE)
    state = np.zeros(n + 500, dtype=complex)
    for k in range(1, n + 500):
        state[k] = step * state[k - 1] + rng.normal()
    modal = np.real(state[500:]) / np.std(np.real(state))
    time = np.arange(n) / RATE
    hum = 0.3 * np.sin(2.0 * np.pi * TONE * time)
    elevator = 1e-2 * rng.normal(size=n)
    motions = (size * modal + hum + 0.05 * rng.normal(size=n) for size in PLACES.values())
    columns = [time, elevator, *motions]
    record, mapping = folder / "turbulence.csv", folder / "mapping.toml"
    header = ",".join(("t", "elevator", *PLACES))
    np.savetxt(record, np.stack(columns, axis=1), "%.9g", ",", header=header, comments="")
    sensors = ", ".join(
        f'{{ name = "{name}", kind = "accelerometer", axis = "z", '
        f'location = {{ values = [0, {k}, 0], unit = "m" }} }}'
        for k, name in enumerate(PLACES)
    )
    quantities = {"elevator": ("rad", "input"), **dict.fromkeys(PLACES, ("m/s2", "output"))}
    channels = "".join(
        f'[[channels]]\ncolumn = "{name}"\nname = "{name}"\nunit = "{unit}"\nrole = "{role}"\n'
        for name, (unit, role) in quantities.items()
    )
    mapping.write_text(
        f"""flight = {{ number = 1 }}
time = {{ column = "t" }}
[maneuver]
label = "turbulence"
axis = "longitudinal"
condition.airspeed = {{ value = 30, unit = "m/s" }}
condition.density = {{ value = 1.2, unit = "kg/m3" }}
condition.fuel_fraction = {{ value = 0, unit = "%" }}
[aircraft]
name = "Wing in turbulence"
surfaces = [{{ name = "elevator" }}]
sensors = [{sensors}]
geometry.area = {{ value = 1, unit = "m2" }}
geometry.chord = {{ value = 0.3, unit = "m" }}
geometry.span = {{ value = 3, unit = "m" }}
mass.fuel = [0]
mass.mass = {{ values = [10], unit = "kg" }}
mass.pitch_inertia = {{ values = [1], unit = "kg*m2" }}
mass.x_cg = {{ values = [0], unit = "m" }}
{channels}"""
    )
    return record, mapping


@pytest.fixture(scope="module")
def flown(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Flown]:
    folder = tmp_path_factory.mktemp("output-only")
    database = f"sqlite:///{folder / 'flexsid.db'}"
    record, mapping = write_turbulence(folder)
    with serving(folder, database) as server:
        client = server.connect()
        upload = client.upload(record)["upload"]["id"]
        job = client.send("post", f"uploads/{upload}/import", {"mapping": mapping.read_text()})
        assert client.wait_for_end(f"jobs/{job['id']}")["result"]["maneuver_id"] == 1
        yield Flown(server.url, client, folder, database)


def identify(flown: Flown) -> dict[str, Any]:
    query = f"maneuver_id=1&{BAND}"
    job = flown.client.send("post", f"output-only-modes/results?{query}")
    if job["state"] != "succeeded":
        assert flown.client.wait_for_end(f"jobs/{job['id']}")["state"] == "succeeded"
    return flown.client.get(f"output-only-modes?{query}")


def test_every_entry_point_has_the_mode_with_its_errors(flown: Flown) -> None:
    found = identify(flown)
    (mode,) = found["modes"]
    assert abs(mode["frequency_hz"] - FREQUENCY) < 4.0 * mode["frequency_std_hz"] < 0.1
    assert abs(mode["damping"] - DAMPING) < 4.0 * mode["damping_std"] < DAMPING * 2.0
    assert mode["shape_real"] == pytest.approx([1.0, 0.5, -0.2], abs=0.05)
    assert mode["name"] == ""
    assert found["tones_hz"] == pytest.approx([TONE], abs=0.01)

    figure = flown.client.get(f"figures/output-only-modes?maneuver_id=1&{BAND}")
    assert [one["name"] for one in figure["data"]] == ["measured", "fitted", "modes, ±2σ"]
    command = "output-only", "--maneuver", "1", "--band", "2,6"
    printed = run_command(flown.folder, flown.database, *command)
    assert printed.returncode == 0, printed.stderr
    (tone,) = re.findall(r"^  tones \[Hz\] +([\d.]+)$", printed.stdout, re.MULTILINE)
    assert float(tone) == pytest.approx(TONE, abs=0.01)
    asked = ask_command(flown.folder, flown.database, *command)
    assert asked["modes"][0]["frequency_hz"] == mode["frequency_hz"]
    client = subprocess.run(
        [sys.executable, "-c", CLIENT, flown.url],
        env=make_environment(),
        capture_output=True,
        text=True,
        check=True,
    )
    assert float(client.stdout) == mode["frequency_hz"]


@pytest.mark.parametrize(
    ("query", "status", "code"),
    [
        ("maneuver_id=1&low_hz=6&high_hz=2", 422, "bad-band"),
        ("maneuver_id=1&outputs=none", 422, "unknown-channel"),
        ("maneuver_id=99", 404, "unknown-record"),
        ("", 422, "invalid-request"),
    ],
)
def test_requests_that_cannot_be_computed_are_refused(
    flown: Flown, query: str, status: int, code: str
) -> None:
    refused = flown.client.request("post", f"output-only-modes/results?{query}")
    assert (refused.status_code, refused.json()["code"]) == (status, code)
