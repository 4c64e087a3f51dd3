"""Predictions computed from a planform over REST."""

from __future__ import annotations

from typing import Any

from fastapi.testclient import TestClient
from waiting import ended

URL = "/api/v1/predictions"
WING: dict[str, Any] = {
    "left": [0.9906, 0.0, 0.0],
    "left_chord": 0.94488,
    "right": [2.34696, 4.2672, 0.0],
    "right_chord": 0.64008,
    "chordwise": 4,
    "spanwise": 8,
}


def test_a_prediction_is_computed_as_a_job_and_listed(client: TestClient):
    aircraft = client.get("/api/v1/aircraft").json()["items"][0]
    body = {
        "aircraft_id": aircraft["id"],
        "source": "Own lattice",
        "panels": [WING],
        "surfaces": [{"name": "wf3s", "span": [2.6, 3.4]}],
        "modes": [7],
        "mach": 0.1,
        "highest_k": 0.5,
    }
    begun = client.post(URL, json=body)
    assert begun.status_code == 202, begun.text
    job = ended(client, begun.headers["location"])
    assert job["state"] == "succeeded", job
    found = [one for one in client.get(URL).json()["items"] if one["source"] == "Own lattice"]
    assert found[0]["unsteady"]["n_boxes"] == 32
    detail = client.get(f"{URL}/{found[0]['id']}", params={"fuel": 0.5}).json()
    derivatives = {one["name"]: one for one in detail["derivatives"]}
    assert derivatives["CZ_alpha"]["value"] < -2.0
    assert derivatives["CZ_wf3s"]["std_error"] > 0.0
    again = client.post(URL, json=body)
    assert again.status_code == 409
    assert again.json()["code"] == "already-exists"


def test_impossible_requests_are_refused_before_they_are_queued(client: TestClient):
    aircraft = client.get("/api/v1/aircraft").json()["items"][0]
    body = {"aircraft_id": aircraft["id"], "source": "Own lattice", "panels": [WING]}
    for more, code in (
        ({"panels": []}, "no-panels"),
        ({"panels": [{**WING, "left_chord": -1.0}]}, "bad-request"),
        ({"mach": 0.95}, "bad-mach"),
        ({"surfaces": [{"name": "rudder", "span": [1.0, 2.0]}]}, "unknown-input"),
        ({"panels": [], "deck": "CAERO1,1,1,0,x"}, "unreadable-file"),
    ):
        refused = client.post(URL, json={**body, **more})
        assert 400 <= refused.status_code < 500, refused.text
        if code != "bad-request":
            assert refused.json()["code"] == code
