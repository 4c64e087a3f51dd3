"""Ground vibration test of FLEX-28 over REST: responses, modal identification, correlation."""

from __future__ import annotations

import io
from typing import Any

import numpy as np
import pytest
from fastapi.testclient import TestClient
from waiting import ended

from flexsid.demo.flex28 import load_nodes, load_truth

NUMBERS = (7, 8, 9, 10, 11, 12, 13)
NODES = tuple(range(1, 134, 3))
SHAKER = (61, 127)  # nodes; both pushed in z
RNG = np.random.default_rng(2)


def function(node: int, shaker: int, hertz: np.ndarray, values: np.ndarray) -> str:
    """A data set 58: acceleration in z at a node per force in z at a shaker."""
    rows = "".join(
        "".join(f"{part:20.12E}" for part in (value.real, value.imag)) + "\n" for value in values
    )
    return (
        "    -1\n    58\n"
        + "NONE\n" * 5
        + f"    4         0    0         0       NONE{node:10d}   3       NONE{shaker:10d}   3\n"
        + f"         6{hertz.size:10d}         1{hertz[0]:13.5E}{hertz[1] - hertz[0]:13.5E}"
        + f"{0.0:13.5E}\n"
        + "        18    0    0    0            Frequency                  Hz\n"
        + "        12    0    0    0         Acceleration                m/s2\n"
        + "        13    0    0    0                Force                   N\n"
        + "         0    0    0    0                 NONE                NONE\n"
        + rows
        + "    -1\n"
    )


@pytest.fixture(scope="module")
def recorded() -> bytes:
    """Responses at empty fuel with one percent of noise, and the geometry."""
    modes = load_truth().modes.at(0.0).select(NUMBERS)
    places, shapes = load_nodes()
    at = [load_truth().modes.numbers.index(number) for number in NUMBERS]
    # z of the structural axes is positive up, opposite to body axes.
    phi = -shapes[0, at][:, :, 2].astype(float)
    hertz = np.arange(2.0, 18.0, 0.04)
    s = 2j * np.pi * hertz[:, None]
    gain = s**2 / (modes.mass * (s**2 + 2 * modes.zeta * modes.omega * s + modes.omega**2))
    text = ["    -1\n  2411\n"]
    for node in NODES:
        x, y, z = places[node - 1]
        text.append(f"{node:10d}{0:10d}{0:10d}{11:10d}\n{x:25.16E}{y:25.16E}{z:25.16E}\n")
    text.append("    -1\n")
    for shaker in SHAKER:
        for node in NODES:
            values = (gain * phi[:, node - 1] * phi[:, shaker - 1]).sum(axis=1)
            noise = RNG.normal(size=values.shape) + 1j * RNG.normal(size=values.shape)
            values = values + 0.007 * np.sqrt(np.mean(np.abs(values) ** 2)) * noise
            text.append(function(node, shaker, hertz, values))
    return "".join(text).encode()


@pytest.fixture
def responses(client: TestClient, recorded: bytes) -> Any:
    response = client.post("/api/v1/uploads", files=[("files", ("gvt.uff", recorded))])
    assert response.status_code == 201, response.text
    identity = response.json()["upload"]["id"]
    payload = {
        "aircraft_id": 1,
        "name": "GVT, empty",
        "response_unit": "m/s2",
        "force_unit": "N",
        "length_unit": "m",
    }
    response = client.post(f"/api/v1/uploads/{identity}/responses", json=payload)
    assert response.status_code == 201, response.text
    return response.json()


def identify(client: TestClient, responses: Any, search: str) -> Any:
    """Request the modes of a band, wait for the job, and return them."""
    at = f"/api/v1/measured-responses/{responses['id']}/modes"
    job = client.post(f"{at}/results?{search}")
    assert ended(client, job.headers["location"])["state"] == "succeeded"
    return client.get(f"{at}?{search}").json()


def test_modes_are_identified_stored_and_correlated(client: TestClient, responses: Any) -> None:
    assert responses["quantity"] == "acceleration"
    assert responses["references"] == ["61+z", "127+z"]
    at = f"/api/v1/measured-responses/{responses['id']}/modes"
    found = identify(client, responses, "low_hz=2&high_hz=17&order=24")
    truth = load_truth().modes.at(0.0).select(NUMBERS[:6])
    hertz = [mode["frequency_hz"] for mode in found["items"]]
    assert hertz == pytest.approx(truth.omega / (2.0 * np.pi), rel=2e-3)
    assert [mode["damping"] for mode in found["items"]] == pytest.approx(truth.zeta, rel=0.06)
    assert found["scaled"]
    assert found["fit_error"] < 0.03
    payload = {"name": "GVT found", "low_hz": 2, "high_hz": 17, "order": 24, "template_id": 1}
    table = client.post(at, json=payload).json()
    assert table["kind"] == "GVT"
    assert table["numbers"] == list(NUMBERS[:6])
    stored = client.get(f"/api/v1/modal-tables/{table['id']}/modes?fuel=0").json()["items"]
    assert [mode["collinearity"] for mode in stored] == [
        pytest.approx(mode["collinearity"]) for mode in found["items"]
    ]
    shape = client.get(f"/api/v1/modal-tables/{table['id']}/shape?number={NUMBERS[0]}").json()
    assert 0.0 < np.abs(shape["quadrature_m"]).max() < 0.1 * shape["largest_m"]
    assert table["names"] == ["SW1B", "AW1B", "SW1T", "AW1T", "SFA", "SWL"]
    assert table["reasons"][0].startswith("matched to SW1B of FEM, MAC ")
    result = client.get(
        f"/api/v1/modal-tables/1/correlation?other_id={table['id']}&fuel=0&other_fuel=0"
    ).json()
    pairs = {pair["name"]: pair for pair in result["pairs"]}
    assert all(pairs[name]["mac"] > 0.98 for name in ("SW1B", "SW1T", "SWL"))
    assert min(point["comac"] for point in result["points"]) > 0.9
    assert all(pair["mac"] >= 0.1 for pair in result["pairs"])
    assert "modes have no counterpart" in " ".join(result["notes"])
    payload = {"name": "FEM updated", "test_ids": [table["id"]]}
    response = client.post("/api/v1/modal-tables/1/updates", json=payload)
    assert response.status_code == 201, response.text
    updated = response.json()
    assert updated["kind"] == "FEM"
    assert any(note.startswith("SW1B: frequency x ") for note in updated["notes"])
    refused = client.post("/api/v1/modal-tables/1/updates", json={"name": "none"}).json()
    assert refused["code"] == "nothing-to-update"

    drawn = client.get(
        f"/api/v1/figures/stabilisation?responses_id={responses['id']}&low_hz=2&high_hz=17&order=24"
    ).json()
    assert [trace["name"] for trace in drawn["data"]] == [
        *("measured", "fitted", "mode indicator", "mode indicator 2"),
        *("new pole", "stable frequency", "stable"),
    ]
    assert len(drawn["layout"]["shapes"]) == 6


def test_modes_are_identified_only_on_request(client: TestClient, responses: Any) -> None:
    at = f"/api/v1/measured-responses/{responses['id']}/modes"
    assert client.get(at).json()["code"] == "not-computed"
    assert client.post(at, json={"name": "GVT found"}).json()["code"] == "not-computed"
    refused = client.post(f"{at}/results?low_hz=100&high_hz=110").json()
    assert refused["code"] == "too-few-frequencies"


def test_mode_shapes_are_mass_orthogonal(client: TestClient) -> None:
    """Uses a mass matrix for which the modes of FLEX-28 are orthogonal."""
    shapes = load_nodes()[1][8, :, :, :3].astype(float) * np.array([-1.0, 1.0, -1.0])
    flat = shapes.reshape(25, -1).T
    inverse = np.linalg.pinv(flat)
    mass = 1.3558 * inverse.T @ inverse
    file = io.BytesIO()
    np.savez(file, mass=mass, small=np.eye(5))
    files = [("files", ("mass.npz", file.getvalue()))]
    identity = client.post("/api/v1/uploads", files=files).json()["upload"]["id"]
    at = f"/api/v1/uploads/{identity}/orthogonality"
    response = client.post(at, json={"modal_table_id": 1, "mass": "mass", "fuel": 0.5})
    job = ended(client, response.headers["location"])
    assert client.get(f"/api/v1/orthogonality/{job['id']}").json()["worst"] < 1e-4
    response = client.post(at, json={"modal_table_id": 1, "mass": "small"})
    refused = ended(client, response.headers["location"])
    assert "399 or 798 rows and columns are expected" in refused["error"]["message"]


def test_responses_are_estimated_from_time_data(client: TestClient) -> None:
    """Two forces; noise of a quarter of the variance of each response."""
    rng = np.random.default_rng(3)
    gain = np.array([[2.0, -1.0], [0.5, 3.0]])
    forces = rng.normal(size=(4000, 2))
    responses = forces @ gain.T
    responses += 0.5 * responses.std(axis=0) * rng.normal(size=responses.shape)
    head = "time [s],force 61+z [N],force 127+z [N],61+z [m/s2],64+z [m/s2]"
    table = np.column_stack([np.arange(4000) / 100.0, forces, responses])
    rows = "\n".join(",".join(f"{x:.9g}" for x in row) for row in table)
    files = [("files", ("run.csv", f"{head}\n{rows}\n".encode()))]
    identity = client.post("/api/v1/uploads", files=files).json()["upload"]["id"]
    held = client.get(f"/api/v1/uploads/{identity}/modal-data").json()
    assert held["files"][0]["has_records"]
    payload = {"aircraft_id": 1, "name": "GVT, random"}
    at = f"/api/v1/uploads/{identity}"
    assert client.post(f"{at}/responses", json=payload).json()["code"] == "time-data"
    payload |= {"averages": 40, "estimator": "H1", "overlap": 0.5, "window": "hann"}
    response = client.post(f"{at}/response-estimates", json=payload)
    assert response.status_code == 202, response.text
    job = ended(client, response.headers["location"])
    assert job["state"] == "succeeded"
    number = job["result"]["responses_id"]
    stored = client.get(f"/api/v1/measured-responses/{number}").json()
    assert stored["averaging"]["averages"] == 40
    assert stored["averaging"]["n_independent"] == pytest.approx(38.0, abs=0.2)
    query = "response_dof=64%2Bz&reference_dof=127%2Bz"
    found = client.get(f"/api/v1/measured-responses/{number}/function?{query}").json()
    assert np.mean(found["real"]) == pytest.approx(3.0, abs=0.1)
    assert np.mean(found["multiple_coherence"]) == pytest.approx(0.8, abs=0.02)
    error = np.hypot(np.array(found["real"]) - 3.0, found["imaginary"])
    assert np.mean(error**2) == pytest.approx(np.mean(np.square(found["std"])), rel=0.25)
    drawn = client.get(f"/api/v1/figures/measured-response?responses_id={number}&{query}").json()
    assert [trace["name"] for trace in drawn["data"]] == [
        *("measured", "standard deviation", "phase", "multiple coherence", "ordinary coherence")
    ]
    refused = client.get(
        f"/api/v1/measured-responses/{number}/function?response_dof=9%2Bz&reference_dof=61%2Bz"
    ).json()
    assert refused["code"] == "unknown-point"
    payload["estimator"] = "H2"
    failed = client.post(f"{at}/response-estimates", json=payload)
    assert ended(client, failed.headers["location"])["error"]["code"] == "several-forces"


def test_poles_are_selected_by_hand(client: TestClient, responses: Any) -> None:
    """Only the modes of the selected poles are fitted and stored, with their provenance."""
    band = "low_hz=2&high_hz=17&order=24"
    automatic = identify(client, responses, band)
    assert not automatic["selected"]
    modes = [automatic["items"][k]["frequency_hz"] for k in (0, 2, 4)]
    picked = [
        next(
            pole["number"]
            for pole in reversed(automatic["poles"])
            if abs(pole["frequency_hz"] / hertz - 1.0) < 0.005
        )
        for hertz in modes
    ]
    listed = ",".join(map(str, picked))
    found = identify(client, responses, f"{band}&poles={listed}")
    assert [one["number"] for one in found["selected"]] == picked
    assert [mode["frequency_hz"] for mode in found["items"]] == pytest.approx(modes, rel=5e-3)
    at = f"/api/v1/measured-responses/{responses['id']}/modes"
    payload = {"name": "by hand", "low_hz": 2, "high_hz": 17, "order": 24, "poles": picked}
    table = client.post(at, json=payload).json()
    assert len(table["numbers"]) == 3
    assert any("selected by hand in the stabilisation diagram" in note for note in table["notes"])
    drawn = client.get(
        f"/api/v1/figures/stabilisation?responses_id={responses['id']}&{band}&poles={listed}"
    ).json()
    assert drawn["data"][-1]["name"] == "selected by hand"
    job = client.post(f"{at}/results?{band}&poles=99999")
    assert ended(client, job.headers["location"])["error"]["code"] == "unknown-pole"
