"""Excitation designs over REST: creation, checks, export and predicted accuracy."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from fastapi.testclient import TestClient
from waiting import ended

from flexsid.errors import BadInput
from flexsid.sysid.excitation.designer import DesignSpecification, InputSpecification
from flexsid.workflow.excitation import excitation_designs
from flexsid.workflow.excitation.excitation_designs import check_evaluation

URL = "/api/v1/designs"
FTA_503: dict[str, Any] = {
    "name": "mini GVT",
    "fta": 503,
    "duration_s": 24.0,
    "rate_hz": 100.0,
    "first_harmonic": 6,
    "peaks": [0.01, 0.02, 0.04],
    "effort": "quick",
}


def test_catalogue_is_table_1(empty: TestClient):
    rows = empty.get(f"{URL}/catalogue").json()["items"]
    assert len(rows) == 24
    assert sum(len(row["inputs"]) for row in rows) == 177
    assert rows[8]["number"] == 524
    assert rows[8]["inputs"][-1] == "throttle"


def test_design_is_created_checked_and_exported(empty: TestClient):
    made = empty.post(URL, json=FTA_503)
    assert made.status_code == 201, made.text
    where = made.headers["location"]
    assert empty.get(where).json() == made.json()
    assert [one["id"] for one in empty.get(URL).json()["items"]] == [made.json()["id"]]
    assert max(made.json()["peak_factors"].values()) < 1.2

    slow = empty.get(f"{where}/checks?natural_frequency=60&rate=0.1&level=2").json()
    assert slow["correlation"] < 1e-12
    assert not any(row["within_limits"] for row in slow["inputs"])

    rows = empty.get(f"{where}/export?form=csv&level=1").text.splitlines()
    assert rows[0].startswith("# column 2: bfs [rad], CRC-32")
    rows = [row for row in rows if not row.startswith("#")]
    assert rows[0] == "t_s,bfs,wf3s,wf1s,wf4s,wf2s"
    samples = np.array([row.split(",") for row in rows[1:]], dtype=float)
    assert samples.shape == (2400, 6)
    assert np.abs(samples[:, 1]).max() == pytest.approx(0.02, rel=0.01)
    number = made.json()["id"]
    for kind, unit in (("design-history", "[deg]"), ("design-spectrum", "[deg]")):
        figure = empty.get(f"/api/v1/figures/{kind}?design_id={number}&level=2").json()
        assert len(figure["data"]) == 5
        assert unit in figure["layout"]["yaxis"]["title"]["text"]
    for form in ("mat", "h", "json"):
        assert empty.get(f"{where}/export?form={form}").status_code == 200
    card = empty.get(f"/api/v1/reports/run-card/{number}?level=2")
    checksum = empty.get(f"{where}/export?form=json&level=2").json()["self_test"]["crc32"]["bfs"]
    assert f"{checksum:08x}" in card.text
    assert "run-card-1-high.html" in card.headers["content-disposition"]
    assert empty.delete(where).status_code == 204
    assert empty.get(where).status_code == 404


def test_throttles_have_a_unit_and_a_limit_of_their_own(empty: TestClient):
    row = FTA_503 | {"fta": 518, "duration_s": 96.0, "throttle_peak": 0.1}
    made = empty.post(URL, json=row)
    assert made.status_code == 201, made.text
    where = made.headers["location"]
    limits = "natural_frequency=60&position=0.01"
    checks = {
        one["name"]: one for one in empty.get(f"{where}/checks?level=1&{limits}").json()["inputs"]
    }
    throttle, flap = checks["throttle"], checks["bfs"]
    assert (throttle["unit"], flap["unit"]) == ("1", "rad")
    assert throttle["command_peak"] == pytest.approx(0.1, rel=1e-3)
    assert throttle["deflection_peak"] == pytest.approx(0.1, rel=1e-3)
    assert throttle["within_limits"]
    assert not flap["within_limits"]
    number = where.rsplit("/", 1)[1]
    figure = empty.get(f"/api/v1/figures/design-history?design_id={number}").json()
    titles = [axis["title"]["text"] for name, axis in figure["layout"].items() if "yaxis" in name]
    assert sum(text.endswith("[%]") for text in titles) == 1
    for changes, code in (
        ({"throttle_peak": 0.6}, "amplitude-too-large"),  # 120 % at the high amplitude
        ({"fta": None, "inputs": [{"name": "u", "harmonics": [6]}]}, "bad-input"),
    ):
        refused = empty.post(URL, json=row | changes)
        assert refused.status_code == 422, refused.text
        assert refused.json()["code"] == code


@pytest.mark.parametrize(
    ("changes", "code", "words"),
    [
        ({"fta": 504}, "unknown-flight-test-aid", "504"),
        ({"rate_hz": 10.0}, "above-nyquist", "Nyquist frequency 5 Hz"),
        ({"duration_s": 24.003}, "period-not-whole", "24 s"),
        ({"fta": None}, "bad-input", "either"),
        (
            {"fta": None, "inputs": [{"name": "bfs", "harmonics": []}]},
            "input-without-harmonics",
            "bfs",
        ),
    ],
)
def test_infeasible_design_is_refused(
    empty: TestClient, changes: dict[str, Any], code: str, words: str
):
    response = empty.post(URL, json=FTA_503 | changes)
    assert response.status_code == 422, response.text
    assert response.json()["code"] == code
    assert words in response.json()["detail"]


@pytest.mark.parametrize(
    ("changes", "code", "words"),
    [
        ({"duration_s": 99_000.0}, "too-many-samples", "shorter period"),
        ({"count": 500}, "too-many-harmonics", "fewer harmonics"),
        ({"high_hz": 60.0}, "above-nyquist", "Nyquist frequency 50 Hz"),
    ],
)
def test_too_large_design_is_refused_before_computation(
    empty: TestClient, changes: dict[str, Any], code: str, words: str
):
    """Forty bands in a long record, each field within its limits."""
    band = {"low_hz": 0.05, "high_hz": 40.0, "count": 50} | changes
    period = band.pop("duration_s", 200.0)
    bands = [{"name": f"u{index}", **band} for index in range(40)]
    payload = FTA_503 | {"fta": None, "bands": bands, "duration_s": period}
    for where in (URL, f"{URL}/searches"):
        response = empty.post(where, json=payload)
        assert response.status_code == 422, response.text
        assert response.json()["code"] == code
        assert words in response.json()["detail"]


def test_long_phase_search_requires_task_or_is_refused(empty: TestClient):
    inputs = [
        {"name": f"u{index}", "harmonics": list(range(1 + index, 2001, 4))} for index in range(4)
    ]
    payload = FTA_503 | {"fta": None, "inputs": inputs, "duration_s": 100.0, "effort": "patient"}
    for where, words in ((URL, "POST /designs/searches"), (f"{URL}/searches", "less effort")):
        response = empty.post(where, json=payload)
        assert response.json()["code"] == "search-too-long", response.text
        assert words in response.json()["detail"]
        assert "500" in response.json()["detail"]


def test_amplitudes_in_degrees_are_refused(empty: TestClient):
    degrees = FTA_503 | {"peaks": [1.0, 2.0, 4.0]}
    for where in (URL, f"{URL}/searches"):
        response = empty.post(where, json=degrees)
        assert response.status_code == 422, response.text
        assert response.json()["code"] == "amplitude-too-large"
        assert "4 rad, 229.2 deg" in response.json()["detail"]
    made = empty.post(URL, json=FTA_503).headers["location"]
    louder = empty.post(f"{made}/rescaled", json={"name": "x", "gains": {"bfs": 57.3}})
    assert louder.json()["code"] == "amplitude-too-large"
    limits = f"{made}/checks?natural_frequency=60"
    assert empty.get(f"{limits}&position=0.4&rate=4").status_code == 200
    for wrong in ("position=25", "rate=200"):
        assert empty.get(f"{limits}&{wrong}").status_code == 422


def test_target_modes_within_band_are_listed(client: TestClient):
    """The fourth symmetric mode of FLEX-28, the last of HE, is at 15 Hz."""
    aircraft = client.get("/api/v1/aircraft").json()["items"][0]["id"]
    rows = {
        "FTA 503": ({}, {"SW1B"}, set()),
        "FTA 506": ({"fta": 506}, {"SW1B", "SW1T", "SFA"}, {"SWL"}),
        "FTA 515": (
            {"fta": 515, "duration_s": 96.0, "aircraft_id": aircraft},
            {"SW1B", "SW1T", "SFA", "SWL"},
            set(),
        ),
    }
    for name, (changes, within, outside) in rows.items():
        design = client.post(URL, json=FTA_503 | {"name": name} | changes)
        assert design.status_code == 201, design.text
        where = design.headers["location"]
        result = client.get(f"{where}/target-modes?aircraft_id={aircraft}").json()
        found = {mode["name"]: mode["in_band"] for mode in result["modes"]}
        assert {name for name, held in found.items() if held} == within
        assert {name for name, held in found.items() if not held} == outside
        assert all(name in result["sentence"] for name in outside)
        assert all(mode["harmonics_per_surface"] >= 3 for mode in result["modes"] if name in within)
    listed = f"{URL}/catalogue/targets?aircraft_id={aircraft}&airspeed_m_s=38&period_s=24"
    every = client.get(listed).json()["items"]
    assert [row["number"] for row in every][:3] == [500, 503, 506]
    row = every[2]
    assert (row["resolution_hz"], row["harmonics_per_surface"]) == (pytest.approx(1 / 24), 65)
    assert {"SP", "SW1B", "SWL"} <= {mode["name"] for mode in row["modes"]}
    assert row["reaches_targets"]
    assert row["fuel_burnt"] is None
    assert row["largest_fuel_burnt"] == 0.01
    assert set(every[9]["missing"]) == {"DR", "RS"}, "no lateral prediction"
    in_flight = {"fta": 500, "aircraft_id": aircraft, "airspeed_m_s": 59.0, "name": "fast"}
    made = client.post(URL, json=FTA_503 | in_flight).json()
    highest = max(max(own["harmonics"]) for own in made["specification"]["inputs"]) / 24.0
    assert highest > 7.0, "the short period is at 3.6 Hz there"
    assert client.post(URL, json=FTA_503 | {"airspeed_m_s": 59.0}).status_code == 422
    wrong = client.post(
        URL, json=FTA_503 | {"fta": None, "aircraft_id": aircraft, "inputs": [
            {"name": "bfs", "harmonics": [3]}
        ]}
    )  # fmt: skip
    assert wrong.status_code == 422


def test_evaluation_of_too_large_design_is_refused():
    inputs = tuple(
        InputSpecification(name=name, harmonics=tuple(range(1 + index, 2001, 2)))
        for index, name in enumerate(("a", "b"))
    )
    specification = DesignSpecification(
        duration_s=500.0, rate_hz=100.0, inputs=inputs, peaks=(0.1, 0.1, 0.1)
    )
    with pytest.raises(BadInput, match="at most 10000 samples of so many harmonics"):
        check_evaluation(specification)
    largest = excitation_designs.specify_design(574, 96.0, 100.0, 6, (0.01, 0.02, 0.04))
    check_evaluation(largest)


def test_mode_without_harmonic_has_no_signal(client: TestClient):
    run = output_error_run(client)
    inputs = [
        {"name": name, "harmonics": list(range(700 + index, 1000, 5))}
        for index, name in enumerate(("bfs", "wf1s", "wf2s", "wf3s", "wf4s"))
    ]
    far = FTA_503 | {"name": "far above", "fta": None, "inputs": inputs}
    where = client.post(URL, json=far).headers["location"]
    result = read_result(client, f"{where}/expected-response?run_id={run}")
    bending = next(mode for mode in result["modes"] if mode["name"] == "SW1B")
    assert (bending["n_harmonics"], bending["output"], bending["signal_to_noise"]) == (
        0,
        None,
        None,
    )


def test_bands_with_targets_and_power(empty: TestClient):
    own = {
        "fta": None,
        "bands": [
            {"name": "bfs", "low_hz": 0.3, "high_hz": 8.0, "count": 30, "targets_hz": [3.0]},
            {
                "name": "wf4a", "low_hz": 0.3, "high_hz": 12.0, "count": 30,
                "relative_peak": 0.5, "spectrum": [[0.3, 1.0], [12.0, 0.01]],
            },
        ],
    }  # fmt: skip
    made = empty.post(URL, json=FTA_503 | own)
    assert made.status_code == 201, made.text
    bfs, wf4a = made.json()["specification"]["inputs"]
    assert len(bfs["harmonics"]) == len(wf4a["harmonics"]) == 30
    assert not set(bfs["harmonics"]) & set(wf4a["harmonics"])
    assert wf4a["power"][0] > 20.0 * wf4a["power"][-1]
    both = empty.post(URL, json=FTA_503 | own | {"fta": 503})
    assert both.status_code == 422


def output_error_run(client: TestClient, out_of_band_modes: str = "omitted") -> int:
    settings = {"out_of_band_modes": out_of_band_modes}
    order = {"maneuver_id": 1, "method": "OE", "structure": {"modes": [7]}, "settings": settings}
    job = client.post("/api/v1/runs", json=order).headers["location"]
    return ended(client, job)["run_id"]


def read_result(client: TestClient, address: str) -> Any:
    """Request a prediction for a design, wait for its job, and read the result."""
    path, query = address.split("?")
    base, name = path.rsplit("/", 1)
    kind = "predicted-accuracy" if name.startswith("expected") else name
    begun = client.post(f"{base}/{kind}/results?{query}")
    assert begun.status_code == 202, begun.text
    assert ended(client, begun.headers["location"])["state"] == "succeeded"
    found = client.get(address)
    assert found.status_code == 200, found.text
    return found.json()


def test_predicted_errors_decrease_with_amplitude(client: TestClient):
    run = output_error_run(client)
    design = client.post(URL, json=FTA_503).headers["location"]
    low, medium = (
        read_result(client, f"{design}/expected-errors?run_id={run}&level={level}")["items"]
        for level in (0, 1)
    )
    assert {"CZ_alpha", "Cm_q", "Cm_bfs", "CQ7_eta7"} <= {row["name"] for row in low}
    for one, other in zip(low, medium, strict=True):
        # The unmodelled response grows with the amplitude, the noise does not.
        assert other["std_error"] < 1.3 * one["std_error"] <= 2.6 * other["std_error"]
    ee = client.post(f"{design}/predicted-accuracy/results?run_id=1")
    assert ee.status_code == 422
    assert ee.json()["code"] == "not-output-error"


def test_amplitudes_are_optimised_within_limits(client: TestClient):
    run = output_error_run(client)
    made = client.post(URL, json=FTA_503)
    where = made.headers["location"]
    limits = "deflection=0.012&load_factor=0.1"
    result = read_result(client, f"{where}/amplitudes?run_id={run}&{limits}")
    counted = [row for row in result["errors"] if row["counts"]]
    assert counted
    worst = {way: max(row[way] for row in counted) for way in ("flat", "minimax", "d_optimal")}
    assert worst["minimax"] <= 1.02 * worst["d_optimal"]
    for row in result["limited"]:
        assert row["limit"] == (0.1 if row["name"] == "load factor" else 0.012)
        assert max(row["minimax"], row["d_optimal"]) <= 1.01 * row["limit"]
    speeds = [row["airspeed_m_s"] for row in result["levels"]]
    assert speeds == sorted(speeds)
    assert {row["limited_by"] for row in result["levels"]} <= {"deflection", "rate", "load_factor"}
    for row in result["levels"]:
        # Below or beyond the largest amplitude: the noise decides, not the limits.
        assert (row["least"] < row["largest"]) == (row["signal_to_noise"] > 10.0)

    stored = client.post(
        f"{where}/rescaled", json={"name": "optimised", "gains": result["gains"]["minimax"]}
    )
    assert stored.status_code == 201, stored.text
    again = read_result(client, f"{stored.headers['location']}/expected-errors?run_id={run}")[
        "items"
    ]
    by_name = {row["name"]: row["std_error"] / abs(row["value"]) for row in again}
    for row in counted:
        assert by_name[row["name"]] == pytest.approx(row["minimax"], rel=1e-6)
    assert stored.json()["phases"] == made.json()["phases"]
    wrong = client.post(f"{where}/rescaled", json={"name": "x", "gains": {"rudder": 2.0}})
    assert wrong.json()["code"] == "unknown-input"


def test_optimal_design_is_stored_and_within_limits(client: TestClient):
    run = output_error_run(client)
    where = client.post(URL, json=FTA_503).headers["location"]
    query = f"run_id={run}&objective=derivatives&derivatives=Cm_alpha,CZ_alpha&load_factor=0.2"
    found = read_result(client, f"{where}/optimal-design?{query}")
    assert found["optimal"] < found["standard"]
    assert found["standard_time_s"] > found["duration_s"]
    for row in found["limits"]:
        assert max(row["optimal"], row["standard"]) <= 1.001 * row["limit"]
    optimal = client.get(f"{URL}/{found['optimal_design_id']}").json()
    assert optimal["name"].endswith(", optimal")
    # The error of the stored design at its high amplitude is what was stated.
    at = f"{URL}/{optimal['id']}/expected-errors?run_id={run}&level=2"
    rows = {row["name"]: row for row in read_result(client, at)["items"]}
    relative = [rows[name]["std_error"] / rows[name]["value"] for name in ("Cm_alpha", "CZ_alpha")]
    assert np.sqrt(np.mean(np.square(relative))) == pytest.approx(found["optimal"], rel=0.05)
    for impossible, code in (
        ("objective=derivatives", "bad-objective"),
        ("objective=flutter&mode=7", "bad-objective"),
        ("objective=derivatives&derivatives=Cm_rudder", "unknown-derivative"),
        ("objective=damping&mode=99", "unknown-mode"),
        (f"objective=structures&other_run_id={run}", "not-nested"),
    ):
        refused = client.post(f"{where}/optimal-design/results?run_id={run}&{impossible}")
        assert refused.status_code == 422, refused.text
        assert refused.json()["code"] == code


def test_predicted_response_by_mode_harmonic_and_surface(client: TestClient):
    run = output_error_run(client, "retained")
    made = client.post(URL, json=FTA_503 | {"peaks": [0.02, 0.04, 0.08]})
    where = made.headers["location"]
    result = read_result(client, f"{where}/expected-response?run_id={run}&level=0")
    louder = read_result(client, f"{where}/expected-response?run_id={run}&level=2")
    assert len(result["modes"]) >= 2
    for quiet, loud in zip(result["modes"], louder["modes"], strict=True):
        assert quiet["signal_to_noise"] < loud["signal_to_noise"]
    correlation = np.array(result["correlation"])
    assert np.allclose(np.diag(correlation), 1.0)
    assert np.abs(correlation - np.eye(5)).max() < 0.4
    rows = read_result(client, f"{where}/expected-errors?run_id={run}")["items"]
    # The prior of retained modes is information too; without them all of it is of the design.
    assert sum(result["information"].values()) < len(rows)
    bare = output_error_run(client, "omitted")
    rows = read_result(client, f"{where}/expected-errors?run_id={bare}")["items"]
    result = read_result(client, f"{where}/expected-response?run_id={bare}&level=0")
    assert sum(result["information"].values()) == pytest.approx(len(rows), rel=1e-6)
    where = f"design_id={made.json()['id']}&run_id={run}"
    information = client.get(f"/api/v1/figures/design-information?{where}").json()
    assert len(information["data"]) == 5
    signal = client.get(f"/api/v1/figures/design-signal?{where}").json()
    assert "dB" in signal["data"][0]["colorbar"]["title"]["text"]


def test_classic_inputs_within_limits_have_larger_errors(client: TestClient):
    run = output_error_run(client)
    where = client.post(URL, json=FTA_503).headers["location"]
    result = read_result(client, f"{where}/classic-inputs?run_id={run}&level=1")
    multisine, *others = result["inputs"]
    assert [one["kind"] for one in others] == ["doublet", "3-2-1-1", "sweep"]
    for one in others:
        assert one["deflection"] <= 1.001 * multisine["deflection"]
        assert one["load_factor"] <= 1.001 * multisine["load_factor"]
        ratios = np.array(one["std_errors"]) / np.array(multisine["std_errors"])
        assert np.median(ratios) > 1.0
