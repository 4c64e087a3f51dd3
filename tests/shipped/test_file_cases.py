"""Files of producers and of faults, from an upload to what is read or refused."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from shipped import Client, serving

CASES = Path(__file__).parents[1] / "importers" / "cases"
AIRCRAFT = """
[aircraft]
name = "Cases"
surfaces = [{ name = "elevator" }]
sensors = [{ name = "q", kind = "gyro" }]
geometry.area = { value = 0.8, unit = "m2" }
geometry.chord = { value = 0.3, unit = "m" }
geometry.span = { value = 2.6, unit = "m" }
mass.fuel = [0]
mass.mass = { values = [10], unit = "kg" }
mass.pitch_inertia = { values = [1.2], unit = "kg*m2" }
mass.x_cg = { values = [0], unit = "m" }
"""
UNITS = {"length_unit": "m", "mass_unit": "kg"}


@pytest.fixture(scope="module")
def client(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Client]:
    folder = tmp_path_factory.mktemp("server")
    with serving(folder, f"sqlite:///{folder / 'flexsid.db'}") as server:
        connected = server.connect()
        connected.send("post", "aircraft", {"text": AIRCRAFT})
        yield connected


def import_modes(client: Client, *names: str) -> Any:
    """Import the modes of files; return the table, or the text of the refusal."""
    sent = [("files", (name, (CASES / name).read_bytes())) for name in names]
    response = client.request("post", "uploads", files=sent)
    if response.is_success:
        upload = response.json()["upload"]["id"]
        body = {"aircraft_id": 1, "name": names[0], "generalized_mass": "file", **UNITS}
        response = client.request("post", f"uploads/{upload}/modal-data", body)
    if response.is_success:
        return response.json()
    assert 400 <= response.status_code < 500, response.text
    return response.text


@pytest.mark.parametrize(
    ("names", "reason"),
    [
        (["universal-nan-55.unv"], "row 17: 'NaN' is not a number, node 1"),
        (["universal-stars-55.unv"], "is not a number, node 1"),
        (["universal-decimal-comma-55.unv"], "row 3: '0,00000E+00' is not a number"),
        (["universal-three-digit-exponent-mass-55.unv"], "'0.17977+309' is too large"),
        (["nastran-nan.f06", "nastran-two-grids.bdf"], "'NaN' is not a number"),
        (
            ["nastran-buckling-sol106.f06", "nastran-buckling-sol106.bdf"],
            "whose eigenvalues are load factors",
        ),
        (
            ["nastran-flutter-sol145.f06", "nastran-flutter-sol145.bdf"],
            "roots of a flutter analysis",
        ),
    ],
)
def test_what_is_no_mode_is_refused_with_the_reason(
    client: Client, names: list[str], reason: str
) -> None:
    assert reason in import_modes(client, *names)


@pytest.mark.parametrize(
    ("names", "hertz"),
    [
        (["universal-three-digit-exponent-55.unv"], [5.0]),
        (["universal-node-comments-55.unv"], [5.0]),
        (["nastran95-cyclic-frequency.f06", "wing-six-grids.bdf"], [3.5, 11.25]),
        (["msc-nastran-modes.h5"], [3.5, 11.25]),
        (["mystran-modes.f06", "nastran-two-grids.bdf"], [5.0, 9.0]),
    ],
)
def test_modes_are_read(client: Client, names: list[str], hertz: list[float]) -> None:
    upload = client.upload(*(CASES / name for name in names))["upload"]["id"]
    found = client.get(f"uploads/{upload}/modal-data")
    assert found["frequencies_hz"] == pytest.approx(hertz)
    assert len(import_modes(client, *names)["numbers"]) == len(hertz)


@pytest.mark.parametrize(
    ("model", "names", "symmetric"),
    [
        ("half-clamped", ["W1B", "W2B", "W1T"], [None, None, None]),
        ("half-symmetric", ["SW1B", "AW1B"], [True, False]),
        ("with-tail", ["SW1B", ""], [True, False]),
        ("one-sided-pair", ["W1B", "W2B"], [None, None]),
        (
            "suspended",
            ["R1", "R2", "R3", "SW1B", "SW2B", "AW1B"],
            [True, True, False, True, True, False],
        ),
    ],
)
def test_modes_are_named_by_supports_and_symmetry(
    client: Client, model: str, names: list[str], symmetric: list[bool | None]
) -> None:
    table = import_modes(client, f"wing-{model}.bdf", f"wing-{model}.f06")
    assert (table["names"], table["symmetric"]) == (names, symmetric)
    assert sum("symmetry unknown" in reason for reason in table["reasons"]) == symmetric.count(None)
    modes = client.get(f"modal-tables/{table['id']}/modes", params={"fuel": 0.0})["items"]
    assert [mode["symmetric"] for mode in modes] == symmetric


def test_the_force_unit_of_a_file_is_not_contradicted(client: Client) -> None:
    upload = client.upload(CASES / "universal-frf-per-lbf.unv")["upload"]["id"]
    body = {"aircraft_id": 1, "name": "x", "response_unit": "m/s2", "force_unit": "N"}
    refused = client.request("post", f"uploads/{upload}/responses", body)
    assert refused.status_code == 422
    assert "its forces in lbf, N was given" in refused.text
