"""Invalid flutter queries are refused with the valid range."""

from __future__ import annotations

import html

import pytest
from waiting import ended

from flexsid.cli.main import main


@pytest.mark.parametrize(
    ("query", "status"),
    [
        ("run_ids=", 422),
        ("run_ids=x", 422),
        ("run_ids=999", 404),
        ("run_ids=1&fuel=2", 422),
        ("run_ids=1&altitude_m=90000", 422),
        ("run_ids=1&next_m_s=-3", 422),
        (f"run_ids={','.join(map(str, range(1, 102)))}", 422),
    ],
)
def test_invalid_queries_are_refused(client, query: str, status: int):
    for path in ("flutter", "figures/v-omega-zeta", "figures/flutter-map"):
        response = client.get(f"/api/v1/{path}?{query}")
        assert response.status_code == status, response.text
        assert response.headers["content-type"].startswith("application/problem+json")


def test_values_in_other_units_are_refused_by_command_line(flown_url: str, capsys):
    for asked, words in (
        (["--fuel", "50"], "fuel is 50.0; expected 0 to 1"),
        (["--altitude", "35000"], "altitude_m is 35000.0; expected -1000 to 11000"),
        (["--next", "4500"], "next_m_s is 4500.0; expected 0.1 to 1000"),
    ):
        assert main(["flutter", "1", *asked, "--database", flown_url]) != 0
        assert words in capsys.readouterr().err


def test_flutter_prediction_is_stored(client):
    begun = client.post("/api/v1/flutter/results?run_ids=1")
    assert begun.status_code == 202, begun.text
    assert ended(client, begun.headers["location"])["state"] == "succeeded"
    found = client.get("/api/v1/flutter?run_ids=1").json()
    assert found["sentence"]
    (derived,) = found["derived_runs"]
    run = client.get(f"/api/v1/runs/{derived['derived_run_id']}").json()
    assert (run["derived_from_run_id"], run["state"]) == (1, "succeeded")
    assert f"/api/v1/jobs/{run['derivation']['job_id']}" == begun.headers["location"]
    listed = [
        [item["id"] for item in client.get(f"/api/v1/runs?{query}").json()["items"]]
        for query in ("", "derived=true", "derived=true&derived_from_run_id=1")
    ]
    assert listed == [[1], [run["id"]], [run["id"]]]
    for along in ("airspeed", "dynamic_pressure", "fuel"):
        figure = client.get(f"/api/v1/figures/v-omega-zeta?run_ids=1&along={along}")
        assert figure.json()["data"]
    for kind in ("root-locus", "equivalent-modes", "flutter-forecast", "flutter-map"):
        assert client.get(f"/api/v1/figures/{kind}?run_ids=1").json()["data"]
    assert client.post("/api/v1/flutter/results?run_ids=999").status_code == 404
    draw_beside_prediction(client, found)
    report = client.get("/api/v1/reports/flutter?run_ids=1")
    assert report.status_code == 200, report.text
    for part in (
        found["test_point_margin"],
        "Runs that the prediction rests on",
        "flexsid-signature",
    ):
        assert html.escape(part, quote=False) in report.text
    unknown = client.get("/api/v1/reports/flutter?run_ids=1&fuel=0.31")
    assert (unknown.status_code, unknown.json()["code"]) == (409, "not-computed")


def test_flutter_of_a_prediction_is_drawn_alone(client):
    alone = "prediction_id=1"
    begun = client.post(f"/api/v1/flutter/predicted/results?{alone}")
    assert begun.status_code == 202, begun.text
    assert ended(client, begun.headers["location"])["state"] == "succeeded"
    found = client.get(f"/api/v1/flutter/predicted?{alone}").json()
    assert found["sentence"]
    assert found["searched_from_m_s"] < found["searched_to_m_s"]
    for kind in ("predicted-v-omega-zeta", "predicted-root-locus"):
        assert client.get(f"/api/v1/figures/{kind}?{alone}").json()["data"]
    for wrong in ("prediction_id=999", "prediction_id=1&fuel=2"):
        refused = client.post(f"/api/v1/flutter/predicted/results?{wrong}")
        assert refused.status_code in (404, 422)


def draw_beside_prediction(client, flight) -> None:
    beside = {
        "prediction_id": 1,
        "axis": flight["axis"],
        "fuel": flight["fuel_fraction"],
        "density_kg_m3": flight["density_kg_m3"],
        "from_m_s": flight["searched_from_m_s"],
        "to_m_s": flight["searched_to_m_s"],
    }
    figure = "/api/v1/figures/v-omega-zeta?run_ids=1&prediction_id=1"
    assert client.get(figure).status_code == 409  # not computed yet
    begun = client.post("/api/v1/flutter/predicted/results", params=beside)
    assert ended(client, begun.headers["location"])["state"] == "succeeded"
    for along in ("airspeed", "dynamic_pressure"):
        drawn = client.get(f"{figure}&along={along}").json()["data"]
        assert any(trace["name"].endswith(", predicted") for trace in drawn)
