"""Cross-orthogonality over mass matrices of files: DMIG, ``.op4``, Guyan, test-analysis models."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from beam_model import make_beam, write_matrix_entries, write_results
from fastapi.testclient import TestClient
from waiting import ended

from flexsid.importers.nastran.op4 import write_op4

BEAM = make_beam()
MEASURED = np.arange(0, 13, 2)  # nodes
MEASURED_DOFS = np.flatnonzero(
    np.isin(BEAM.dofs[:, 0], BEAM.structure.ids[MEASURED]) & (BEAM.dofs[:, 1] == 3)
)
PUNCH = (
    write_matrix_entries("MAAX", BEAM.mass, BEAM.dofs)
    + write_matrix_entries("KAAX", BEAM.stiffness, BEAM.dofs, large=False)
).encode()


def upload(client: TestClient, *files: tuple[str, bytes]) -> str:
    response = client.post("/api/v1/uploads", files=[("files", file) for file in files])
    assert response.status_code == 201, response.text
    return response.json()["upload"]["id"]


def request(client: TestClient, at: str, body: dict[str, Any]) -> dict[str, Any]:
    """Request an orthogonality, and return its job after its end."""
    response = client.post(at, json=body)
    assert response.status_code == 202, response.text
    return ended(client, response.headers["location"])


def compute(client: TestClient, at: str, body: dict[str, Any]) -> dict[str, Any]:
    job = request(client, at, body)
    assert job["state"] == "succeeded", job["error"]
    return client.get(f"/api/v1/orthogonality/{job['id']}").json()


def fail(client: TestClient, at: str, body: dict[str, Any]) -> dict[str, Any]:
    """Return the error of a job that fails, and has no result."""
    job = request(client, at, body)
    assert client.get(f"/api/v1/orthogonality/{job['id']}").status_code == 404
    return job["error"]


def store(client: TestClient, structure: Any, name: str, kind: str) -> int:
    deck, printout = write_results(structure)
    identity = upload(client, ("deck.bdf", deck), ("modes.f06", printout))
    options = {"length_unit": "m", "mass_unit": "kg", "generalized_mass": "unit"}
    body = {"aircraft_id": 1, "name": name, "kind": kind, **options}
    response = client.post(f"/api/v1/uploads/{identity}/modal-data", json=body)
    assert response.status_code == 201, response.text
    return response.json()["id"]


@pytest.fixture
def sources(client: TestClient) -> dict[str, int]:
    """The beam, and a test of its vertical motion at every second node, numbered differently."""
    test = replace(
        BEAM.structure,
        ids=np.arange(1, MEASURED.size + 1),
        xyz=BEAM.structure.xyz[MEASURED],
        shape=3.0 * BEAM.structure.shape[:, MEASURED] * [0, 0, 1, 0, 0, 0],
    )
    return {
        "modal_table_id": store(client, BEAM.structure, "beam", "FEM"),
        "other_id": store(client, test, "beam test", "GVT"),
    }


def test_mass_reduced_by_guyan_makes_test_modes_orthogonal(
    client: TestClient, sources: dict[str, int]
) -> None:
    at = f"/api/v1/uploads/{upload(client, ('matrices.pch', PUNCH))}/orthogonality"
    inspected = client.get(at.replace("orthogonality", "modal-data")).json()
    assert "matrix MAAX, 26 x 26 at 13 nodes" in inspected["files"][0]["holds"]
    model = {"modal_table_id": sources["modal_table_id"], "mass": "MAAX", "fuel": 0.0}
    assert fail(client, at, model)["code"] == "unit-needed"
    whole = compute(client, at, model | {"length_unit": "m"})
    assert whole["worst"] < 2e-5
    assert whole["n_dofs"] == 26
    body = model | sources | {"length_unit": "m"}
    refused = fail(client, at, body)
    assert refused["code"] == "not-reduced"
    assert "give the stiffness matrix" in refused["message"]
    found = compute(client, at, body | {"stiffness": "KAAX"})
    assert found["n_dofs"] == 7
    assert "26 degrees of freedom is reduced to 7 by static condensation" in found["notes"][-1]
    left = np.setdiff1d(np.arange(26), MEASURED_DOFS)
    K, M = BEAM.stiffness, BEAM.mass
    transform = np.zeros((26, 7))
    transform[MEASURED_DOFS] = np.eye(7)
    transform[left] = -np.linalg.solve(K[np.ix_(left, left)], K[np.ix_(left, MEASURED_DOFS)])
    shapes = BEAM.structure.shape[:, MEASURED, 2]
    product = shapes @ transform.T @ M @ transform @ shapes.T
    size = np.sqrt(np.diag(product))
    assert found["values"] == pytest.approx(product / np.outer(size, size), abs=1e-5)
    assert found["least_pair"] > 0.999


def test_mass_of_a_test_analysis_model_in_inches(
    client: TestClient, sources: dict[str, int]
) -> None:
    """Text and binary ``.op4`` with a list of degrees of freedom; rotations in any unit."""
    inch = 0.0254
    scale = np.where(BEAM.dofs[:, 1] > 3, 1.0 / inch, 1.0)  # slinch and slinch inch
    mass = BEAM.mass * np.outer(scale, scale) / 175.0
    listed = "node,component\n" + "".join(f"{node},{part}\n" for node, part in BEAM.dofs.tolist())
    for binary in (False, True):
        content = write_op4({"MTAM": mass}, binary=binary)
        at = upload(client, ("m.op4", content), ("dofs.csv", listed.encode()))
        body = {"modal_table_id": sources["modal_table_id"], "mass": "MTAM", "length_unit": "in"}
        found = compute(client, f"/api/v1/uploads/{at}/orthogonality", body)
        assert found["worst"] < 2e-5
    at = upload(client, ("m.op4", write_op4({"MTAM": mass})))
    refused = fail(client, f"/api/v1/uploads/{at}/orthogonality", body)
    assert "39 or 78 rows and columns are expected" in refused["message"]


def test_displacement_systems_of_a_deck_apply_to_its_matrices(
    client: TestClient, sources: dict[str, int]
) -> None:
    """Every node has displacements in a system whose x is up and whose y is the span."""
    deck = "CORD2R,7,,0.,0.,0.,-1.,0.,0.\n,0.,0.,1.\n" + "".join(
        f"GRID,{node},,{x},{y},{z},7\n"
        for node, (x, y, z) in zip(
            BEAM.structure.ids.tolist(), BEAM.structure.xyz.tolist(), strict=True
        )
    )
    dofs = BEAM.dofs.copy()
    up = dofs[:, 1] == 3
    dofs[up, 1] = 1  # up
    dofs[~up, 1] = 6  # about -x of the basic system
    sign = np.where(up, 1.0, -1.0)
    entries = write_matrix_entries("MAAX", BEAM.mass * np.outer(sign, sign), dofs)
    at = upload(client, ("wing.bdf", (deck + entries).encode()))
    body = {"modal_table_id": sources["modal_table_id"], "mass": "MAAX", "length_unit": "m"}
    found = compute(client, f"/api/v1/uploads/{at}/orthogonality", body)
    assert found["worst"] < 2e-5
    assert not any("basic axes" in note for note in found["notes"])


@pytest.mark.parametrize(
    ("content", "body", "reason"),
    [
        (PUNCH, {"mass": "MGG"}, "no file has a matrix 'MGG'; expected one of MAAX, KAAX"),
        (
            PUNCH.replace(b"MAAX           0       6", b"MAAX           0       1"),
            {"mass": "MAAX"},
            "matrix MAAX is not symmetric",
        ),
        (
            write_matrix_entries("MAAX", BEAM.mass, BEAM.dofs + np.array([900, 0])).encode(),
            {"mass": "MAAX"},
            "no degree of freedom at which beam has a shape",
        ),
        (
            write_matrix_entries("MAAX", -BEAM.mass, BEAM.dofs).encode(),
            {"mass": "MAAX"},
            "must be positive definite",
        ),
    ],
)
def test_unusable_matrices_are_refused(
    client: TestClient, sources: dict[str, int], content: bytes, body: dict[str, str], reason: str
) -> None:
    at = f"/api/v1/uploads/{upload(client, ('matrices.pch', content))}/orthogonality"
    model = {"modal_table_id": sources["modal_table_id"], "length_unit": "m"}
    assert reason in fail(client, at, model | body)["message"]


def test_equal_requests_have_one_result_that_outlives_the_files(
    client: TestClient, sources: dict[str, int]
) -> None:
    identity = upload(client, ("matrices.pch", PUNCH))
    at = f"/api/v1/uploads/{identity}/orthogonality"
    body = {"modal_table_id": sources["modal_table_id"], "mass": "MAAX", "length_unit": "m"}
    refused = client.post(at, json=body | {"axes": "up up up"})
    assert refused.status_code == 422
    assert "not a right-handed system" in refused.json()["detail"]
    assert client.post(at, json=body | {"other_id": 999}).status_code == 404
    job = request(client, at, body)
    assert client.post(at, json=body).json()["id"] == job["id"]
    assert client.delete(f"/api/v1/uploads/{identity}").status_code < 300
    assert client.get(f"/api/v1/orthogonality/{job['id']}").json()["worst"] < 2e-5
    assert client.post(at, json=body).status_code == 404
