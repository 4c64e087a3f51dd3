"""Data quality over REST: maneuvers, campaign and corrections."""

from __future__ import annotations

from fastapi.testclient import TestClient
from pydantic import TypeAdapter
from waiting import ended, wait_until

from flexsid.api.models import responses
from flexsid.records.quality import ManeuverQuality

API = "/api/v1"


def test_campaign_is_assessed_and_listed(client: TestClient):
    unassessed = client.get(f"{API}/maneuvers/1/quality").json()
    assert unassessed == {"quality": None, "job": None}, "reading assesses nothing"
    before = client.get(f"{API}/quality").json()
    assert before["counts"] == {
        "good": 0,
        "questionable": 0,
        "bad": 0,
        "unchecked": 0,
        "missing": 1,
    }
    assert before["items"][0]["verdict"] is None
    begun = client.post(f"{API}/quality/assess", json={})
    assert begun.status_code == 202
    wait_until(lambda: not client.get(f"{API}/quality").json()["assessing"]["running"])
    response = client.get(f"{API}/quality?verdict=good&sort=-signal_to_noise_db&search=flow")
    TypeAdapter(responses.QualityList).validate_json(response.content)
    (item,) = response.json()["items"]
    assert item["verdict"] == "good"
    assert item["figures"]["signal_to_noise_db"] > 15.0
    assert response.json()["assessing"]["failed"] == 0
    table = client.get(f"{API}/maneuvers?verdict=good&sort=-signal_to_noise_db").json()["items"]
    assert {name: table[0][name] for name in ("verdict", "summary", "figures")} == {
        name: item[name] for name in ("verdict", "summary", "figures")
    }
    (choice,) = client.get(f"{API}/maneuvers/facets").json()["choices"]["verdict"]
    assert choice == {"value": "good", "label": "good", "count": 1}
    one = client.get(f"{API}/maneuvers/1/quality")
    found = TypeAdapter(ManeuverQuality).validate_python(one.json()["quality"])
    assert found.summary == item["summary"]
    assert client.get(f"{API}/quality?verdict=missing").json()["items"] == []
    assert client.get(f"{API}/quality?sort=colour").status_code == 422
    assert client.post(f"{API}/quality/assess", json={"maneuver_ids": [99]}).status_code == 404
    assert client.delete(f"{API}/quality/assess").json()["running"] is False


def test_corrections_are_applied_listed_and_undone(client: TestClient):
    address = f"{API}/maneuvers/1/conditioning"
    spectra = f"{API}/figures/spectrum?maneuver_id=1&channels=q&format=csv"
    before = client.get(spectra).text
    calibration = {"channel": "q", "kind": "calibration", "scale": 2.0}
    refused = client.post(
        address, json={"items": [calibration, {"channel": "no", "kind": "delay", "delay_s": 0.1}]}
    )
    assert refused.status_code == 422
    assert refused.json()["code"] == "unknown-channel"
    assert client.get(address).json()["items"] == []
    taken = client.post(
        address, json={"items": [calibration]}, headers={"X-Flexsid-Analyst": "Eva"}
    )
    assert taken.status_code == 201
    (step,) = taken.json()["items"]
    assert step["author"] == "Eva"
    assert client.get(spectra).text != before
    again = client.post(address, json={"items": [calibration]})
    assert again.status_code == 409
    undone = client.delete(f"{address}/{step['id']}")
    assert undone.json()["undone_at"] is not None
    assert client.get(spectra).text == before
    assert len(client.get(address).json()["items"]) == 1
    assert client.delete(f"{address}/{step['id']}").status_code == 409
    assert client.delete(f"{API}/maneuvers/2/conditioning/{step['id']}").status_code == 404


def test_reconstruction_in_time_and_frequency_domain(client: TestClient):
    figure = f"{API}/figures/reconstruction?maneuver_id=1&modes=7,9"
    results = f"{API}/maneuvers/1/reconstruction/results?modes=7,9"
    assert client.get(results).json() == {"job": None}
    assert client.get(figure).json()["code"] == "not-computed"
    job = client.post(results)
    assert ended(client, job.headers["location"])["state"] == "succeeded"
    assert client.get(results).json()["job"]["id"] == job.json()["id"]
    for parameters in ("", "&quantities=CZ,Cm,eta7", "&domain=frequency"):
        response = client.get(f"{figure}{parameters}")
        assert response.status_code == 200
        assert response.json()["data"]
    unknown = client.get(f"{figure}&quantities=nothing")
    assert unknown.json()["code"] == "unknown-quantity"
    assert "CQ7" in unknown.json()["detail"]
