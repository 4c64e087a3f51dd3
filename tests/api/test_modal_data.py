"""Modal data over REST: import, modes over fuel, mode shapes, correlation, observability."""

from __future__ import annotations

import io
import re
from dataclasses import replace
from pathlib import Path
from typing import Any
from xml.etree import ElementTree
from zipfile import ZipFile

import numpy as np
import pytest
from fastapi.testclient import TestClient
from scipy.io import loadmat
from structural_files import make_structure, print_mass, print_shapes, write_deck

from flexsid.importers.formats.readers import read_file

SHARED = Path(__file__).parents[3] / "shared" / "data"
FEM = SHARED / "maewing1" / "fem"
needs_fem = pytest.mark.skipif(not FEM.exists(), reason="mAEWing1's FEM is not beside the project")

PLACES = ("0.,-4.", "0.,0.", "0.,4.", "1.,0.", "0.,-2.", "0.,2.")
DECK = "".join(f"GRID,{n},,{p},0.\n" for n, p in enumerate(PLACES, start=1)).encode()


def printout(frequencies: tuple[float, ...], shapes: list[list[float]]) -> bytes:
    """A printout with eigenvectors whose third components are given."""
    text = ""
    for mode, (hertz, shape) in enumerate(zip(frequencies, shapes, strict=True), start=1):
        text += f"1    JOB\n      EIGENVALUE =  {(2 * np.pi * hertz) ** 2:.6E}\n"
        text += f"          R E A L   E I G E N V E C T O R   N O .          {mode}\n\n"
        for node, z in enumerate(shape, start=1):
            text += f"  {node}  G  0.0  0.0  {z:.6E}  0.0  0.0  0.0\n"
    return text.encode()


BENDING = [1.0, -0.4, 1.0, -0.5, -0.1, -0.1]
ROLLING = [1.0, 0.0, -1.0, 0.0, -0.6, 0.6]


def upload(client: TestClient, *files: tuple[str, bytes]) -> str:
    response = client.post("/api/v1/uploads", files=[("files", file) for file in files])
    assert response.status_code == 201, response.text
    return response.json()["upload"]["id"]


@pytest.fixture
def table(client: TestClient) -> Any:
    """A small structure at three fuel fractions; its modes cross after the second."""
    files = [
        ("deck.bdf", DECK),
        ("empty.f06", printout((5.0, 7.0), [BENDING, ROLLING])),
        ("half.f06", printout((5.8, 6.4), [[-x for x in BENDING], ROLLING])),
        ("full.f06", printout((6.0, 6.6), [ROLLING, BENDING])),
    ]
    identity = upload(client, *files)
    found = client.get(f"/api/v1/uploads/{identity}/modal-data").json()
    assert [item["field"] for item in found["queries"]] == [
        "length_unit",
        "mass_unit",
        "generalized_mass",
    ]
    payload = {
        "aircraft_id": 1,
        "name": "wing",
        "length_unit": "ft",
        "mass_unit": "slug",
        "generalized_mass": "unit",
        "fuel": {"empty.f06": 0.0, "half.f06": 0.5, "full.f06": 1.0},
    }
    response = client.post(f"/api/v1/uploads/{identity}/modal-data", json=payload)
    assert response.status_code == 201, response.text
    return response.json()


def test_modal_data_are_stored_with_units_and_notes(client: TestClient, table: Any) -> None:
    assert table["fuel"] == [0.0, 0.5, 1.0]
    assert table["names"] == ["SW1B", "AW1B"]
    assert table["symmetric"] == [True, False]
    assert "in slug times ft squared" in " ".join(table["notes"])
    modes = client.get(f"/api/v1/modal-tables/{table['id']}/modes?fuel=0").json()["items"]
    assert modes[0]["mass_kg_m2"] == pytest.approx(14.5939029 * 0.3048**2)
    assert modes[0]["frequency_hz"] == pytest.approx(5.0, rel=1e-5)


def test_modes_are_tracked_through_crossing(client: TestClient, table: Any) -> None:
    at_full = client.get(f"/api/v1/modal-tables/{table['id']}/modes?fuel=1").json()["items"]
    assert [(mode["name"], round(mode["frequency_hz"], 4)) for mode in at_full] == [
        ("AW1B", 6.0),
        ("SW1B", 6.6),
    ]
    response = client.get(f"/api/v1/modal-tables/{table['id']}/shape?number=1&fuel=0.8").json()
    assert response["name"] == "SW1B"
    moved = np.array(response["displacement_m"])[:, 2] / 0.3048
    assert moved == pytest.approx(
        BENDING, abs=1e-5
    )  # the sign of the shapes is consistent over fuel
    assert np.array(response["nodes_m"])[:3, 1] == pytest.approx([-1.2192, 0.0, 1.2192])
    assert response["sensors"][0]["sensor"]


def test_import_of_same_name_is_new_version(client: TestClient, table: Any) -> None:
    identity = upload(
        client, ("a.f06", printout((5.1, 7.2), [BENDING, ROLLING])), ("deck.bdf", DECK)
    )
    payload = {"aircraft_id": 1, "name": "wing", "length_unit": "ft", "generalized_mass": "unknown"}
    second = client.post(f"/api/v1/uploads/{identity}/modal-data", json=payload).json()
    assert (second["name"], second["version"]) == ("wing", table["version"] + 1)
    at = f"/api/v1/modal-tables/{table['id']}/correlation?other_id={second['id']}&fuel=0"
    pairs = client.get(at).json()["pairs"]
    assert [pair["mac"] for pair in pairs] == pytest.approx([1.0, 1.0])
    assert pairs[0]["frequency_change"] == pytest.approx(0.02, abs=1e-5)


def test_mode_name_is_corrected_with_reason(client: TestClient, table: Any) -> None:
    at = f"/api/v1/modal-tables/{table['id']}"
    payload = {"number": 2, "name": "AW1T", "symmetric": False, "reason": "it twists in the GVT"}
    headers = {"X-Flexsid-Analyst": "Ada"}
    response = client.post(f"{at}/corrections", json=payload, headers=headers)
    assert response.status_code == 201
    mode = client.get(f"{at}/modes?fuel=0").json()["items"][1]
    assert mode["name"] == "AW1T"
    assert mode["reason"] == "it twists in the GVT (corrected, by Ada)"
    assert client.get(at).json()["names"] == ["SW1B", "AW1T"]
    refused = client.post(f"{at}/corrections", json={**payload, "reason": " "})
    assert refused.json()["code"] == "invalid-request"


@pytest.mark.parametrize(
    ("files", "payload", "code"),
    [
        ((("a.f06", printout((5.0,), [BENDING])),), {}, "unit-needed"),
        ((("a.f06", printout((5.0,), [BENDING])),), {"length_unit": "m"}, "mass-needed"),
        (
            (("a.f06", printout((5.0,), [BENDING])),),
            {"length_unit": "m", "generalized_mass": "unknown"},
            "no-nodes",
        ),
        (
            (("a.f06", printout((5.0,), [[*BENDING, 1.0]])), ("deck.bdf", DECK)),
            {"length_unit": "m", "generalized_mass": "unknown"},
            "missing-node",
        ),
        (
            (("a.f06", printout((5.0,), [BENDING])), ("deck.bdf", DECK)),
            {"length_unit": "m", "generalized_mass": "unknown", "axes": "aft left up"},
            "bad-axes",
        ),
        ((("deck.bdf", DECK),), {"length_unit": "m"}, "no-shapes"),
    ],
)
def test_missing_information_is_reported(
    client: TestClient, files: Any, payload: dict[str, Any], code: str
) -> None:
    identity = upload(client, *files)
    before = client.get("/api/v1/modal-tables").json()["items"]
    response = client.post(
        f"/api/v1/uploads/{identity}/modal-data", json={"aircraft_id": 1, "name": "x", **payload}
    )
    assert 400 <= response.status_code < 500
    assert response.json()["code"] == code
    assert client.get("/api/v1/modal-tables").json()["items"] == before


def test_mode_shape_of_demonstration_aircraft(client: TestClient) -> None:
    shape = client.get("/api/v1/modal-tables/1/shape?number=9&fuel=0.3").json()
    assert shape["name"] == "SW1T"
    assert len(shape["nodes_m"]) == shape["n_nodes"] == 133
    assert len(shape["lines"]) > 133
    assert client.get("/api/v1/modal-tables/1/shape?number=5").status_code == 404
    assert client.get("/api/v1/modal-tables/2/shape?number=9").json()["code"] == "no-nodes"


@needs_fem
def test_maewing1_is_imported_with_flutter_summary(client: TestClient) -> None:
    names = ["sol103_maewing1_femv4p2p1.op2", "sol103_maewing1_femv4p2p1.f06"]
    identity = upload(client, *((name, (FEM / name).read_bytes()) for name in names))
    payload = {"aircraft_id": 1, "name": "FEM 4.2.1", "length_unit": "in", "mass_unit": "slinch"}
    table = client.post(f"/api/v1/uploads/{identity}/modal-data", json=payload).json()
    assert table["names"][:5] == ["SW1B", "AW1T", "SW1T", "AW1B", "SW2B"]
    assert any("agree with the largest displacements printed" in n for n in table["notes"])
    assert table["symmetric"][:5] == [True, False, True, False, True]
    antisymmetric = (
        f"/api/v1/modal-tables/{table['id']}/shape?number={table['numbers'][3]}&fuel=0.5"
    )
    shape = client.get(antisymmetric).json()
    assert shape["name"] == "AW1B"
    nodes, normal = np.array(shape["nodes_m"]), np.array(shape["displacement_m"])[:, 2]
    right, left = (nodes[:, 1] * side > 1.0 for side in (1.0, -1.0))  # outer half of each wing
    assert normal[right].mean() == pytest.approx(-normal[left].mean(), rel=0.02)
    name = "sol145_maewing1_femv5p2.f06"
    identity = upload(client, (name, (FEM / name).read_bytes()))
    at = f"/api/v1/uploads/{identity}/flutter-summary"
    summary = client.post(at, json={"aircraft_id": 1, "name": "SOL 145", "speed_unit": "kt"}).json()
    assert summary["points"][0]["airspeed_m_s"] == pytest.approx(32.33, abs=0.02)
    assert summary["points"][0]["omega_rad_s"] == pytest.approx(36.5, abs=0.3)


def test_number_of_modes_needed_at_condition(client: TestClient) -> None:
    condition = "aircraft_id=1&airspeed_m_s=39.8&fuel=0.5&altitude_m=1524"
    result = client.get(f"/api/v1/modal-tables/order?{condition}").json()
    assert result["needed"] in (2, 3, 4)
    assert len(result["steps"]) == 9
    assert result["steps"][-1]["bias"] == pytest.approx(0.0, abs=1e-9)
    assert "every derivative of the rigid body is within" in result["evidence"][0]
    assert "With one mode fewer" in result["evidence"][1]
    drawn = client.get(f"/api/v1/figures/model-order?{condition}&derivatives=Cm_alpha").json()
    assert [trace["name"] for trace in drawn["data"]] == ["residualised", "truncated"]
    band = drawn["layout"]["shapes"][0]
    assert band["y1"] / band["y0"] == pytest.approx(1.1 / 0.9)
    responses = client.get(
        f"/api/v1/figures/reduced-responses?{condition}&output=q&surface=bfs&counts=1,3"
    ).json()
    names = [trace["name"] for trace in responses["data"][::2]]
    assert names[0] == "all 8 modes"
    assert names[1:] == ["SP + SW1B", "SP + SW1B + SW1T + SFA", "rigid-body sensors (C_e = 0)"]


def test_observability_of_modes_by_sensor(client: TestClient) -> None:
    result = client.get("/api/v1/modal-tables/1/observability?fuel=0.5").json()
    assert result["names"][:4] == ["SW1B", "SW1T", "SFA", "SWL"]
    rows = {row["sensor"]: row["share"] for row in result["rows"]}
    # Outboard accelerometers respond to wing torsion, the one at the c.g. hardly.
    assert rows["az_oar"][1] > 4 * rows["az_egi"][1]
    assert all(error is not None and error >= 1.0 for error in result["std_error"])
    best = result["candidates"][0]
    assert best["gain"] == max(c["gain"] for c in result["candidates"])
    assert best["helps"] in result["names"]
    assert 0.0 < best["shrinks_to"] < 1.0


def test_figures_of_modes_over_fuel_and_mac(client: TestClient, table: Any) -> None:
    figure = client.get(f"/api/v1/figures/modes-against-fuel?modal_table_id={table['id']}").json()
    (crossing,) = [trace for trace in figure["data"] if trace["name"] == "crossing"]
    assert crossing["text"] == ["SW1B × AW1B"]
    assert 0.5 < crossing["x"][0] < 1.0
    mac = client.get("/api/v1/figures/mac?modal_table_id=1&fuel=0&other_fuel=1").json()
    assert mac["data"][0]["type"] == "heatmap"
    assert client.get("/api/v1/figures/mac?modal_table_id=2").json()["code"] == "no-shapes"


@pytest.mark.parametrize("form", ["uff", "csv"])
def test_exported_modes_are_imported_unchanged(client: TestClient, table: Any, form: str) -> None:
    written = client.get(f"/api/v1/modal-tables/{table['id']}/file?form={form}&fuel=0.5")
    assert f".{form}" in written.headers["content-disposition"]
    identity = upload(client, (f"back.{form}", written.content))
    found = client.get(f"/api/v1/uploads/{identity}/modal-data").json()
    assert found["queries"] == []  # the file contains units and masses
    again = client.post(
        f"/api/v1/uploads/{identity}/modal-data", json={"aircraft_id": 1, "name": "back"}
    ).json()
    for what in ("modes?fuel=0.5", "shape?number=1&fuel=0.5", "shape?number=2&fuel=0.5"):
        first = client.get(f"/api/v1/modal-tables/{table['id']}/{what}").json()
        second = client.get(f"/api/v1/modal-tables/{again['id']}/{what}").json()
        if "items" in first:
            for mode, back in zip(first["items"], second["items"], strict=True):
                assert back["frequency_hz"] == pytest.approx(mode["frequency_hz"], rel=1e-15)
                assert back["mass_kg_m2"] == pytest.approx(mode["mass_kg_m2"], rel=1e-15)
        else:
            assert second["displacement_m"] == first["displacement_m"]
            assert second["nodes_m"] == first["nodes_m"]


TRAVELLING = np.array(
    [
        [[0, 0.2j, 1.0], [0, 0, -0.4j], [0, 0.1, 1.0], [0.3, 0, -0.5], [0, 0, 0.2j], [0, 0, 0.1]],
        [[0, 0, 1.0], [0, 0, 0], [0, 0, -1.0], [0, 0, 0], [0, 0, -0.6], [0, 0, 0.6 + 0.1j]],
    ]
)
"""Shapes of two complex modes at the nodes of ``DECK``, in any phase."""


def write_complex_modes() -> bytes:
    """A table in CSV whose shapes are turned by 40 degrees from their principal direction."""
    names = ("phi_{}_m", "phi_{}_quadrature_m")
    head = ",".join(name.format(axis) for name in names for axis in "xyz")
    rows = [f"mode,frequency_hz,damping,node,x_m,y_m,z_m,{head}"]
    turned = TRAVELLING * np.exp(0.7j)
    for mode, hertz in enumerate((5.0, 7.0)):
        for node, place in enumerate(PLACES):
            values = [*turned[mode, node].real, *turned[mode, node].imag]
            shape = ",".join(repr(float(one)) for one in values)
            rows.append(f"{mode + 1},{hertz},.02,{node + 1},{place},0,{shape}")
    return ("\n".join(rows) + "\n").encode()


def read_complex_shape(client: TestClient, table_id: int, number: int) -> np.ndarray:
    """Motion at all nodes as it is drawn: Re(shape e^(i omega t)) a quarter of a period later."""
    found = client.get(f"/api/v1/modal-tables/{table_id}/shape?number={number}").json()
    return np.array(found["displacement_m"]) + 1j * np.array(found["quadrature_m"])


def test_complex_modes_are_drawn_and_exported_with_their_phases(client: TestClient) -> None:
    body = {"aircraft_id": 1, "kind": "GVT", "generalized_mass": "unknown"}
    identity = upload(client, ("gvt.csv", write_complex_modes()))
    at = f"/api/v1/uploads/{identity}/modal-data"
    response = client.post(at, json=body | {"name": "complex"})
    assert response.status_code == 201, response.text
    table = response.json()["id"]
    modes = client.get(f"/api/v1/modal-tables/{table}/modes").json()["items"]
    squares = np.abs(np.sum(TRAVELLING**2, axis=(1, 2))) / np.sum(abs(TRAVELLING) ** 2, axis=(1, 2))
    assert [mode["collinearity"] for mode in modes] == pytest.approx(squares**2)
    for number in (1, 2):
        drawn = read_complex_shape(client, table, number)
        truth = TRAVELLING[number - 1]
        phase = np.vdot(truth, drawn) / np.vdot(truth, truth)
        assert abs(phase) == pytest.approx(1.0)
        assert drawn == pytest.approx(phase * truth, abs=1e-6)
        # In phase with the largest motion.
        assert np.linalg.norm(np.real(drawn)) >= np.linalg.norm(np.real(truth))
    for form in ("uff", "uff-single", "csv"):
        written = client.get(f"/api/v1/modal-tables/{table}/file?form={form}").content
        identity = upload(client, (f"back.{form.partition('-')[0]}", written))
        again = client.post(
            f"/api/v1/uploads/{identity}/modal-data", json=body | {"name": form}
        ).json()
        back = client.get(f"/api/v1/modal-tables/{again['id']}/modes").json()["items"]
        for name in ("frequency_hz", "damping", "collinearity"):
            assert [one[name] for one in back] == pytest.approx(
                [one[name] for one in modes], rel=1e-4 if "single" in form else 1e-9
            )
        for number in (1, 2):
            known = read_complex_shape(client, table, number)
            assert read_complex_shape(client, again["id"], number) == pytest.approx(known, abs=2e-5)
    file: Any = io.BytesIO(client.get(f"/api/v1/modal-tables/{table}/file?form=mat").content)
    found = loadmat(file)
    assert (found["shapes"] + 1j * found["quadrature"])[0, :, :3] == pytest.approx(
        read_complex_shape(client, table, 1), abs=1e-6
    )
    picture = client.get(f"/api/v1/modal-tables/{table}/picture?number=1&moving=true").text
    moving = re.findall(r'values="([^"]+)"', picture)[0].split(";")
    assert moving[0] == moving[-1] != moving[12]  # a quarter of a period from rest, not at rest


def test_exported_modes_are_read_by_others(client: TestClient, table: Any, tmp_path: Path) -> None:
    """Single precision for readers that do not know double; MATLAB, matrices."""
    at = f"/api/v1/modal-tables/{table['id']}"
    single = client.get(f"{at}/file?form=uff-single&fuel=0.5")
    identity = upload(client, ("single.uff", single.content))
    again = client.post(
        f"/api/v1/uploads/{identity}/modal-data", json={"aircraft_id": 1, "name": "single"}
    ).json()
    first = client.get(f"{at}/shape?number=1&fuel=0.5").json()
    second = client.get(f"/api/v1/modal-tables/{again['id']}/shape?number=1&fuel=0.5").json()
    largest = first["largest_m"]
    np.testing.assert_allclose(
        second["displacement_m"], first["displacement_m"], atol=1e-5 * largest
    )
    assert b"         2         6\n" in single.content  # real, single precision
    file: Any = io.BytesIO(client.get(f"{at}/file?form=mat&fuel=0.5").content)
    found = loadmat(file)
    assert found["shapes"].shape == (found["numbers"].size, found["nodes"].shape[0], 6)
    hertz = [mode["frequency_hz"] for mode in client.get(f"{at}/modes?fuel=0.5").json()["items"]]
    assert found["frequency_hz"].ravel() == pytest.approx(hertz)
    moved = np.array(first["displacement_m"])
    for form in ("op4", "op4-binary"):
        content = client.get(f"{at}/file?form={form}&fuel=0.5").content
        (tmp_path / "modes.op4").write_bytes(content)
        terms = {one.path: one.samples for one in read_file(tmp_path / "modes.op4", "modes.op4")}
        shapes = np.zeros(terms["matrix/PHIG/size"])
        shapes[terms["matrix/PHIG/row"], terms["matrix/PHIG/column"]] = terms["matrix/PHIG/value"]
        assert shapes[:, 0].reshape(-1, 6)[:, :3] == pytest.approx(moved, abs=1e-6 * largest)


def test_all_fuel_weights_are_one_archive(client: TestClient, table: Any) -> None:
    at = f"/api/v1/modal-tables/{table['id']}"
    with ZipFile(io.BytesIO(client.get(f"{at}/archive?form=op4-binary").content)) as archive:
        names = [f"modes-{table['id']}-fuel-{fuel}.op4" for fuel in ("0", "0.5", "1")]
        assert archive.namelist() == names
        alone = client.get(f"{at}/file?form=op4-binary&fuel=1").content
        assert archive.read(names[2]) == alone
    assert client.get("/api/v1/modal-tables/2/archive").json()["code"] == "no-nodes"


@pytest.mark.parametrize("moving", [False, True])
def test_a_shape_is_a_picture(client: TestClient, table: Any, moving: bool) -> None:
    """Of the two mode shapes of the deck: as many lines as the page shows, all inside."""
    at = f"/api/v1/modal-tables/{table['id']}"
    n_lines = len(client.get(f"{at}/shape?number=1").json()["lines"])
    drawn = client.get(f"{at}/picture?number=1&moving={moving}")
    root = ElementTree.fromstring(drawn.text)
    paths = root.findall("{*}path")
    assert [path.get("d", "").count("M") for path in paths] == [n_lines, n_lines]
    assert (root.find(".//{*}animate") is not None) == moving
    numbers = np.array(re.findall(r"[ML]([-\d.]+) ([-\d.]+)", paths[1].get("d", "")), dtype=float)
    assert ((numbers >= 0) & (numbers <= [960, 560])).all()


def test_selected_analysis_and_elements_are_stored(client: TestClient) -> None:
    clamped, free = make_structure(1), make_structure(2)
    free = replace(free, ids=clamped.ids)
    a, b, c = clamped.ids[:3].tolist()
    deck = f"CTRIA3,1,1,{a},{b},{c}\n" + write_deck(clamped)
    printed = print_shapes(clamped, "CLAMPED     SUBCASE 1")
    printed += print_shapes(free, "FREE     SUBCASE 2")
    identity = upload(client, ("wing.bdf", deck.encode()), ("wing.f06", printed.encode()))
    found = client.get(f"/api/v1/uploads/{identity}/modal-data").json()
    labels = [one["label"] for file in found["files"] for one in file["analyses"]]
    assert labels == ["subcase 1: CLAMPED", "subcase 2: FREE"]
    payload: dict[str, Any] = {"aircraft_id": 1, "name": "x", "length_unit": "m"}
    payload["generalized_mass"] = "unknown"
    payload["analyses"] = {"wing.f06": "subcase 3"}
    at = f"/api/v1/uploads/{identity}/modal-data"
    assert client.post(at, json=payload).json()["code"] == "unknown-analysis"
    payload["analyses"] = {"wing.f06": "subcase 2: FREE"}
    stored = client.post(at, json=payload).json()
    shape = client.get(f"/api/v1/modal-tables/{stored['id']}/shape?number=1").json()
    assert shape["frequency_hz"] == pytest.approx(free.omega[0] / 2.0 / np.pi, rel=1e-5)
    assert shape["lines"] == [[0, 1], [0, 2], [1, 2]]


def test_mass_properties_of_a_printout_are_those_of_the_aircraft(client: TestClient) -> None:
    files = [
        (f"{name}.f06", print_mass(mass, (2.0, 0.0, 0.1), np.diag([80.0, 60.0, 130.0])).encode())
        for name, mass in (("empty", 150.0), ("full", 200.0))
    ]
    identity = upload(client, *files)
    found = client.get(f"/api/v1/uploads/{identity}/modal-data").json()["files"]
    assert [file["mass"] for file in found] == [150.0, 200.0]
    at = f"/api/v1/uploads/{identity}/mass-properties"
    payload: dict[str, Any] = {"aircraft_id": 1, "length_unit": "m", "mass_unit": "kg"}
    assert client.post(at, json=payload).json()["code"] == "two-results"
    payload["fuel"] = {"full.f06": 1.0}
    before = client.get("/api/v1/aircraft/1").json()["mass"]
    mass = client.post(at, json=payload).json()["mass"]
    assert mass["fuel"] == before["fuel"]
    assert (mass["mass_kg"][0], mass["mass_kg"][-1]) == (150.0, 200.0)
    assert mass["mass_kg"][1:-1] == before["mass_kg"][1:-1], "other fuel weights are retained"
    assert mass["pitch_inertia_kg_m2"][-1] == pytest.approx(60.0, rel=1e-4)
    assert client.get("/api/v1/aircraft/1").json()["mass"] == mass
    other = upload(client, ("deck.bdf", DECK))
    refused = client.post(f"/api/v1/uploads/{other}/mass-properties", json=payload)
    assert refused.json()["code"] == "no-mass-properties"
