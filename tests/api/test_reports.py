"""Reports over HTTP, and on the command line."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path

import pytest
from fastapi.testclient import TestClient

from flexsid.api.app import create_app
from flexsid.cli.main import main
from flexsid.jobs import kinds
from flexsid.jobs.dispatcher import execute_request
from flexsid.settings import Settings
from flexsid.storage.store import Store
from flexsid.workflow.maintenance.printed_reports import ReportRequest

_WHO = {"X-Flexsid-Analyst": "Ann"}
_PDF = b"%PDF-1.4 stub"


def test_reports_are_sandboxed_html(client: TestClient) -> None:
    for path in ("run/1", "comparison?run_ids=1&prediction_ids=1", "campaign?fta=506"):
        response = client.get(f"/api/v1/reports/{path}")
        if "campaign" in path and response.status_code == 409:
            response = client.get("/api/v1/reports/campaign")
        assert response.status_code == 200, response.text
        assert response.headers["content-type"] == "text/html; charset=utf-8"
        assert response.headers["content-security-policy"].startswith("sandbox")
        assert 'filename="flexsid-' in response.headers["content-disposition"]
        assert response.text.startswith("<!doctype html>")
    assert client.get("/api/v1/reports/run/99").status_code == 404


def test_a_report_is_printed_by_one_job_and_stored(
    client: TestClient, flown_url: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    address = "/api/v1/reports/run/1"
    assert client.get(f"{address}?format=pdf").json()["code"] == "not-computed"
    begun = client.post(address)
    assert begun.status_code == 202, begun.text
    job = begun.json()
    assert (job["kind"], job["title"]) == ("report", "Equation error, run 1")
    waiting = client.get(f"{address}?format=pdf")
    if waiting.status_code == 409:  # it is queued or running
        assert waiting.json()["code"] == "not-ready"
    store = Store.open(flown_url)
    monkeypatch.setattr(kinds, "REPORT", replace(kinds.REPORT, compute=lambda task, report: _PDF))
    requested = ReportRequest(**job["request"])
    client.post(f"/api/v1/jobs/{job['id']}/cancel")
    other = execute_request(store, kinds.REPORT, requested, lambda progress: None)
    store.close()
    again = client.post(address).json()
    assert (again["id"], again["state"]) == (other.id, "succeeded"), "printed again"
    for stored in (f"{address}?format=pdf", f"/api/v1/reports/files/{other.id}"):
        response = client.get(stored)
        assert response.headers["content-type"] == "application/pdf"
        assert response.content.startswith(_PDF + b"\n%flexsid-signature")
    assert client.get(f"/api/v1/reports/files/{job['id']}").status_code == 404
    # The report of changed data is another.
    note = {"subject": "run", "key": "1", "text": "Checked."}
    assert client.post("/api/v1/notes", json=note, headers=_WHO).status_code == 201
    assert client.get(f"{address}?format=pdf").json()["code"] == "not-computed"


def test_a_figure_is_printed_on_a_page_of_its_size(client: TestClient) -> None:
    figure = "derivatives?run_ids=1"
    asked = {"figure": figure, "width_mm": 82.6, "height_mm": 62, "figure_title": "A <b> & c"}
    page = client.get("/api/v1/reports/figure", params=asked)
    assert page.headers["content-security-policy"].startswith("sandbox")
    assert "@page { size: 82.6mm 62.0mm; margin: 0; }" in page.text
    assert "<title>A &lt;b&gt; &amp; c</title>" in page.text
    drawn = client.get("/api/v1/figures/derivatives?run_ids=1").json()
    assert json.dumps(drawn["data"][0]["y"], separators=(",", ":")) in page.text
    job = client.post("/api/v1/reports/figure", params=asked).json()
    assert (job["kind"], job["title"]) == ("report", "A <b> & c")
    for address, part in (
        ("derivative?run_ids=1", "no figure is named 'derivative'"),
        ("derivatives?run_id=1", "no parameter 'run_id'; expected coefficient"),
        ("derivatives", "run_ids of derivatives"),
        ("fit?run_id=x", "run_id of fit"),
    ):
        for ask in (client.get, client.post):
            refused = ask("/api/v1/reports/figure", params={"figure": address})
            assert (refused.status_code, refused.json()["code"]) == (422, "bad-figure")
            assert part in refused.json()["detail"]


def test_decision_report_contains_evidence_and_history(client: TestClient) -> None:
    described = client.get("/api/v1/openapi.json").json()["paths"]

    def send(path: str) -> None:
        example = described[path]["post"]["requestBody"]["content"]["application/json"]["example"]
        response = client.post(path, json=example, headers=_WHO)
        assert response.status_code == 201, response.text

    send("/api/v1/model-structures")
    send("/api/v1/decisions")
    text = client.get("/api/v1/reports/decision/1").text
    assert "SP + SW1B below 400 Pa" in text
    assert "dynamic pressure 0 to 400 Pa" in text
    assert "<td>proposed</td>" in text
    assert "Comparison of runs 1, Cm" in text
    assert client.get("/api/v1/reports/decision/9").status_code == 404


def test_report_of_a_run_is_in_the_units_that_are_asked_for(client: TestClient) -> None:
    us = client.get("/api/v1/reports/run/1?units=us&frequency_unit=rad/s").text
    metric = client.get("/api/v1/reports/run/1").text
    for text, units in ((us, ("kt", "psf", "slug")), (metric, ("m/s", "Pa", "kg"))):
        for name, unit in zip(("Airspeed", "Dynamic pressure", "Mass"), units, strict=True):
            assert re.search(rf"<dt>{name}</dt><dd>[\d.]+ {unit}\b", text), (name, unit)
    assert "Frequency [rad/s]" in us
    assert "Frequency [Hz]" not in us


def test_reports_of_the_campaign_are_in_the_units_that_are_asked_for(client: TestClient) -> None:
    us = client.get("/api/v1/reports/campaign?units=us").text
    metric = client.get("/api/v1/reports/campaign").text
    for text, units in ((us, ("kt", "psf")), (metric, ("m/s", "Pa"))):
        assert f"V [{units[0]}]" in text
        assert f"q̄ [{units[1]}]" in text
        assert re.search(rf"<dt>Airspeed</dt><dd>[\d.]+ to [\d.]+ {units[0]}</dd>", text)


def test_custom_template_is_used(flown_url: str, tmp_path: Path) -> None:
    own = tmp_path / "own.html"
    own.write_text("<title>$title</title>$style ACME $body$script")
    settings = Settings(database=flown_url, report_template=str(own))
    with TestClient(create_app(settings), base_url="http://127.0.0.1:8000") as started:
        assert " ACME " in started.get("/api/v1/reports/run/1").text


def test_reports_are_written_by_command_line(flown_url: str, tmp_path: Path, capsys) -> None:
    to = ["--database", flown_url]
    template = str(tmp_path / "own.html")
    assert main(["report", "template", "--output", template, *to]) == 0
    Path(template).write_text(Path(template).read_text().replace(">flexsid<", ">ACME<"))
    for kind in (["run", "1"], ["comparison", "1", "--predictions", "1"], ["campaign"]):
        out = tmp_path / f"{kind[0]}.html"
        assert main(["report", *kind, "--template", template, "--output", str(out), *to]) == 0
        assert ">ACME<" in out.read_text()
    capsys.readouterr()
    assert main(["report", "run", "1", "--output", "a.doc", *to]) == 2
    assert "expected .html or .pdf" in capsys.readouterr().err
    assert main(["report", "run", "--output", str(tmp_path / "a.html"), *to]) == 2
    assert "give one id" in capsys.readouterr().err


@pytest.fixture(autouse=True)
def own_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS"):
        monkeypatch.setenv(name, "1")
    monkeypatch.delenv("FLEXSID_REPORT_TEMPLATE", raising=False)
