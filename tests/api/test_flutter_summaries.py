"""Flutter summaries over REST: separate analyses, and all instabilities reported."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fastapi.testclient import TestClient

SHARED = Path(__file__).parents[3] / "shared" / "data"
SPEEDS = (20.0, 30.0, 40.0, 50.0)


def page(
    point: int,
    speed: Any,
    damping: Any,
    hertz: Any,
    *,
    subcase: int = 1,
    mach: float = 0.0,
    density: Any = 1.0,
    method: str = "PK",
    symmetry: str = "ASYMMETRIC",
    configuration: str = "AEROSG2D",
    growth: Any = None,
) -> str:
    """One page of a flutter summary; densities by row make it one of matched points."""
    matched = method == "PKNL"
    head = f"METHOD = {method}"
    if not matched:
        head = f"MACH NUMBER = {mach:7.4f}     DENSITY RATIO = {density:11.4E}     " + head
    text = f"1    TITLE                          PAGE\n\n0{'':100}SUBCASE {subcase}\n"
    text += f"0{'':50}FLUTTER  SUMMARY\n      CONFIGURATION = {configuration}     "
    text += f"XY-SYMMETRY = ASYMMETRIC     XZ-SYMMETRY = {symmetry}\n"
    text += f"       POINT = {point:4d}     {head}\n\n\n"
    text += "    KFREQ          1./KFREQ  " + ("   DENSITY     MACH NO.  " if matched else "")
    text += "    VELOCITY       DAMPING     FREQUENCY      COMPLEX   EIGENVALUE\n"
    rows = np.broadcast_arrays(speed, damping, hertz, density)
    for row, (v, g, f, rho) in enumerate(zip(*rows, strict=True)):
        omega = 2.0 * np.pi * f
        real = 0.5 * g * omega if growth is None else np.broadcast_to(growth, rows[0].shape)[row]
        between = f"{rho:13.5E}{mach:13.5E}" if matched else ""
        text += f"   {0.1:.4f}  {10.0:13.5E}{between}{v:13.5E}{g:13.5E}{f:13.5E}"
        text += f"{real:13.5E}{omega:13.5E}\n"
    return text


def import_summary(client: TestClient, *texts: str) -> Any:
    files = [("files", (f"f{n}.f06", text.encode())) for n, text in enumerate(texts)]
    identity = client.post("/api/v1/uploads", files=files).json()["upload"]["id"]
    payload = {"aircraft_id": 1, "name": "SOL 145", "speed_unit": "m/s"}
    response = client.post(f"/api/v1/uploads/{identity}/flutter-summary", json=payload)
    assert response.status_code == 201, response.text
    stored = response.json()
    assert client.get(f"/api/v1/flutter-summaries/{stored['id']}").json() == stored
    return stored


RISING = [-0.02, -0.01, 0.01, 0.02]
RISING_DENSITY = [0.1, 0.2, 0.3, 0.4]


def test_subcases_mach_numbers_and_densities_are_separate(client: TestClient) -> None:
    text = page(1, SPEEDS, RISING, 5.0)
    text += page(1, SPEEDS, [-0.03, -0.02, -0.01, 0.01], 5.0, mach=0.3)
    text += page(1, SPEEDS, [-0.03, -0.02, -0.02, 0.02], 5.0, mach=0.3, density=0.5)
    text += page(1, SPEEDS, [-0.04, 0.01, 0.01, 0.01], 5.0, subcase=2, symmetry="SYMMETRIC")
    points = import_summary(client, text)["points"]
    assert [point["airspeed_m_s"] for point in points] == pytest.approx([28.0, 35.0, 45.0, 45.0])
    assert [point["analysis"] for point in points] == [
        "subcase 2, XZ symmetric, Mach 0, density ratio 1, PK",
        "subcase 1, Mach 0, density ratio 1, PK",
        "subcase 1, Mach 0.3, density ratio 1, PK",
        "subcase 1, Mach 0.3, density ratio 0.5, PK",
    ]
    assert points[3]["density_ratio"] == 0.5


def test_analyses_are_listed_in_printed_order(client: TestClient) -> None:
    text = page(1, SPEEDS, RISING, 5.0, configuration="TIPTANKS", method="KE")
    text += page(1, SPEEDS, RISING, 5.0, subcase=2, mach=0.5, method="PKNL", density=RISING_DENSITY)
    text += page(1, SPEEDS, RISING, 5.0)
    text += page(2, SPEEDS, RISING, 7.0) + page(1, SPEEDS, RISING, 5.0)  # the same heading again
    analyses = import_summary(client, text)["analyses"]
    assert [one["title"] for one in analyses] == [
        "subcase 1, TIPTANKS, Mach 0, density ratio 1, KE",
        "subcase 2, Mach 0.5, density ratio 0.1 to 0.4, PKNL",
        "subcase 1, Mach 0, density ratio 1, PK",
        "subcase 1, Mach 0, density ratio 1, PK (2)",
    ]
    assert analyses[1]["density_ratio"] == [0.1, 0.4]
    assert [one["method"] for one in analyses] == ["KE", "PKNL", "PK", "PK"]


def test_roots_have_mode_names_and_instabilities_at_a_damping(client: TestClient) -> None:
    """A root is named by the frequency at the begin of its sweep; divergence has no damping g."""
    modes = client.get("/api/v1/modal-tables/1/modes?fuel=0").json()["items"]
    first = next(mode for mode in modes if mode["symmetric"])
    other = next(mode for mode in modes if not mode["symmetric"])
    text = page(1, SPEEDS, RISING, 1.02 * first["frequency_hz"], symmetry="SYMMETRIC")
    text += page(2, SPEEDS, -0.1, other["frequency_hz"], symmetry="SYMMETRIC")
    growth = [-4.0, -2.0, 2.0, 6.0]
    text += page(3, SPEEDS, [-0.2, -0.1, 0.1, 0.3], 0.0, growth=growth, symmetry="SYMMETRIC")
    stored = import_summary(client, text)
    roots = f"/api/v1/flutter-summaries/{stored['id']}/roots?modal_table_id=1&fuel=0"
    named = client.get(roots).json()
    assert [(one["number"], one["name"]) for one in named["roots"]] == [
        (1, first["name"]),
        (2, ""),
        (3, ""),
    ]
    assert named["roots"][0]["damping_g"] == RISING
    assert named["points"] == stored["points"]
    at = {p["root"]: p["airspeed_m_s"] for p in client.get(f"{roots}&g=0.015").json()["points"]}
    assert at == pytest.approx({1: 45.0, 3: 35.0})
    figure = f"/api/v1/figures/flutter-summary?summary_id={stored['id']}&g=0.015&modal_table_id=1"
    drawn = client.get(f"{figure}&fuel=0").json()
    assert f"1 {first['name']}" in [trace["name"] for trace in drawn["data"]]
    assert [note["text"] for note in drawn["layout"]["annotations"]] == ["flutter", "divergence"]
    refused = client.get(f"{roots}&analysis=1")
    assert (refused.status_code, refused.json()["code"]) == (422, "unknown-analysis")


def test_prediction_beside_is_that_at_the_density_and_airspeeds_of_the_analysis(
    client: TestClient,
) -> None:
    """The page requests what the figure reads."""
    stored = import_summary(client, page(1, SPEEDS, RISING, 5.0, density=0.8))
    roots = client.get(f"/api/v1/flutter-summaries/{stored['id']}/roots").json()
    assert roots["compared"] == pytest.approx(
        {"density_kg_m3": 0.98, "from_m_s": 20.0, "to_m_s": 50.0}
    )
    figure = f"/api/v1/figures/flutter-summary?summary_id={stored['id']}&prediction_id=1"
    assert client.get(figure).json()["code"] == "not-computed"
    request = {"prediction_id": 1, "fuel": 0.5, **roots["compared"]}
    begun = client.post("/api/v1/flutter/predicted/results", params=request)
    job = begun.json()["id"]
    assert client.get(figure).json().get("job_id", job) == job  # computed already, or not yet
    client.post(f"/api/v1/jobs/{job}/cancel")
    matched = page(1, SPEEDS, -0.1, 5.0, density=RISING_DENSITY, method="PKNL")
    stored = import_summary(client, matched)
    assert client.get(f"/api/v1/flutter-summaries/{stored['id']}/roots").json()["compared"] is None
    figure = f"/api/v1/figures/flutter-summary?summary_id={stored['id']}&prediction_id=1"
    assert client.get(figure).json()["code"] == "no-density"


def test_root_on_several_pages_and_repeated_analysis(client: TestClient) -> None:
    first = page(1, SPEEDS[:2], RISING[:2], 5.0) + page(1, SPEEDS[2:], RISING[2:], 5.0)
    again = page(1, SPEEDS, [-0.02, -0.02, -0.02, 0.02], 5.0)  # another deck, the same heading
    for text in (first + page(2, SPEEDS, -0.1, 9.0) + again, first + again):
        points = import_summary(client, text)["points"]
        assert [point["airspeed_m_s"] for point in points] == pytest.approx([35.0, 45.0])


def test_all_files_of_an_upload_are_read(client: TestClient) -> None:
    stored = import_summary(
        client,
        page(1, SPEEDS, RISING, 5.0, symmetry="SYMMETRIC"),
        page(1, SPEEDS, [-0.01, 0.01, 0.02, 0.03], 7.0, symmetry="ANTISYMMETRIC"),
    )
    assert [point["airspeed_m_s"] for point in stored["points"]] == pytest.approx([25.0, 35.0])
    assert stored["points"][0]["analysis"].startswith("f1.f06, subcase 1, XZ antisymmetric")
    assert stored["origin"] == "f0.f06, f1.f06"


def test_neutral_roots_have_no_flutter_speed_and_are_noted(client: TestClient) -> None:
    text = page(1, SPEEDS, [-1e-7, 2e-7, -3e-8, 1e-7], 6.0)  # an undamped in-vacuo mode
    text += page(2, SPEEDS, [-0.5, 0.4, -0.3, 0.6], 0.01, growth=1e-5)  # a rigid body's
    text += page(3, SPEEDS, [-0.02, -5e-5, 5e-5, 0.02], 5.0)
    stored = import_summary(client, text)
    assert [(point["root"], point["kind"]) for point in stored["points"]] == [(3, "flutter")]
    assert stored["points"][0]["airspeed_m_s"] == pytest.approx(35.0)
    assert any("roots 1, 2 stay neutral or slow" in note for note in stored["notes"])


def test_divergence_and_never_stable_roots_are_reported(client: TestClient) -> None:
    text = page(1, SPEEDS, [-0.2, -0.1, 0.1, 0.3], 0.0, growth=[-4.0, -2.0, 2.0, 6.0])
    text += page(2, SPEEDS, 0.03, 4.0)
    text += page(3, SPEEDS, 0.001, 0.0, growth=0.05)
    stored = import_summary(client, text)
    divergence, always = stored["points"]
    assert (divergence["kind"], divergence["is_bound"]) == ("divergence", False)
    assert divergence["airspeed_m_s"] == pytest.approx(35.0)
    assert divergence["omega_rad_s"] == 0.0
    assert (always["root"], always["kind"], always["is_bound"]) == (2, "flutter", True)
    assert always["airspeed_m_s"] == 20.0
    assert any("root 3 grows slowly, doubling in 13.9 s" in note for note in stored["notes"])


def test_matched_points_are_processed_in_their_order(client: TestClient) -> None:
    """Airspeed falls and rises while the density increases; damping crosses zero once."""
    speed = [150.0, 148.0, 147.0, 149.0, 152.0]
    damping = [-0.03, -0.02, -0.01, 0.01, 0.03]
    density = [0.1, 0.2, 0.3, 0.4, 0.5]
    for step in (1, -1):  # from either end
        text = page(1, speed[::step], damping[::step], 5.0, density=density[::step], method="PKNL")
        (point,) = import_summary(client, text)["points"]
        assert point["airspeed_m_s"] == pytest.approx(148.0)
        assert point["density_ratio"] == pytest.approx(0.35)
        assert not point["is_bound"]


def test_possible_root_exchanges_and_methods_without_roots_are_noted(
    client: TestClient,
) -> None:
    stored = import_summary(client, page(1, SPEEDS, RISING, [5.0, 5.0, 9.0, 9.0]))
    assert len(stored["points"]) == 1
    assert any("changes from 5 to 9 Hz between 30 and 40 m/s" in note for note in stored["notes"])
    stored = import_summary(client, page(1, SPEEDS, RISING, 5.0, method="K"))
    assert stored["points"] == []
    assert any("method K does not follow its roots" in note for note in stored["notes"])
    stored = import_summary(client, page(1, SPEEDS[::-1], RISING[::-1], 5.0, method="KE"))
    assert [point["airspeed_m_s"] for point in stored["points"]] == pytest.approx([35.0])


def test_row_with_overflowing_number_is_read(client: TestClient) -> None:
    text = page(1, SPEEDS, RISING, 5.0).replace("   0.1000  ", "   ******  ")
    assert len(import_summary(client, text)["points"]) == 1
    broken = page(1, SPEEDS, RISING, 5.0).replace(" 1.00000E-02", " **********")
    response = client.post("/api/v1/uploads", files=[("files", ("f.f06", broken.encode()))])
    assert "damping or frequency is not a number" in response.text


@pytest.mark.parametrize(
    ("file", "unit", "expected"),
    [
        (
            "maewing1/fem/sol145_maewing1_femv5p2.f06",
            "kt",
            [(7, 62.84, 36.68), (8, 66.67, 56.45)],  # symmetric and antisymmetric
        ),
        ("nastran/0012_flutter.f06", "m/s", [(2, 149.29, 39.09)]),
    ],
)
def test_published_samples_have_hand_computed_speeds(
    client: TestClient, file: str, unit: str, expected: Any
) -> None:
    if not (SHARED / file).exists():
        pytest.skip("the Nastran samples are not beside the project")
    files = [("files", ("flutter.f06", (SHARED / file).read_bytes()))]
    identity = client.post("/api/v1/uploads", files=files).json()["upload"]["id"]
    payload = {"aircraft_id": 1, "name": "SOL 145", "speed_unit": unit}
    stored = client.post(f"/api/v1/uploads/{identity}/flutter-summary", json=payload).json()
    factor = {"kt": 1852.0 / 3600.0, "m/s": 1.0}[unit]
    found = [(p["root"], p["airspeed_m_s"] / factor, p["omega_rad_s"]) for p in stored["points"]]
    assert [root for root, *_ in found] == [root for root, *_ in expected]
    for (_, *numbers), (_, *hand) in zip(found, expected, strict=True):
        assert numbers == pytest.approx(hand, abs=0.006)
