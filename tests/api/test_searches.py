"""Model structure determination over REST: progress, cancellation, candidates as runs."""

from __future__ import annotations

from typing import Any

from fastapi.testclient import TestClient
from waiting import ended

from flexsid.records.decision import Structure
from flexsid.records.run import Method, RunState
from flexsid.records.search import SearchSettings, StructureSearch
from flexsid.storage.jobs import queue
from flexsid.storage.store import Store
from flexsid.workflow.structure_determination import searches

SEARCH: dict[str, Any] = {
    "maneuver_ids": [1],
    "method": "OE",
    "structure": {"modes": [7, 9]},
    "settings": {"resamplings": 2},
}


def test_search_returns_candidates_that_open_as_runs(client: TestClient):
    response = client.post("/api/v1/searches", json=SEARCH, headers={"X-Flexsid-Analyst": "Ada"})
    assert response.status_code == 202
    address = response.headers["location"]
    found = ended(client, address)
    assert found["state"] == "succeeded", found["error"]
    assert found["author"] == "Ada"
    result = found["result"]
    (line,) = client.get("/api/v1/searches").json()["items"]
    assert line["sentence"] == result["sentence"]
    # all terms of the two simulated modes are real; some are insignificant
    candidate = max(result["candidates"], key=lambda one: one["n_terms"])
    assert candidate["n_terms"] >= 42
    index = result["candidates"].index(candidate)
    run = client.post(f"{address}/candidates/{index}/run").json()
    assert run["structure"]["free"] == candidate["structure"]["free"]
    proposal = client.get("/api/v1/maneuvers/1/run-proposal").json()
    assert run["settings"] == proposal["settings"]
    assert client.post(f"{address}/candidates/{index}/run").json()["id"] == run["id"]
    assert client.get(address).json()["result"]["candidates"][index]["run_id"] == run["id"]
    assert client.post(f"{address}/candidates/99/run").status_code == 404
    late = client.post(f"{address}/cancel")
    assert late.status_code == 409
    assert late.json()["code"] == "job-ended"


def test_interrupted_search_is_resumed_by_next_server(serve, flown_url):
    store = Store.open(flown_url)
    left = searches.add_search(
        store,
        StructureSearch(
            aircraft_id=1,
            maneuver_ids=(1,),
            method=Method.EE,
            structure=Structure(modes=(7, 9), fixed={}),
            settings=SearchSettings(resamplings=0),
        ),
    )
    assert queue.claim(store, left.job_id) is not None
    assert store.searches.get(left.id or 0).state is RunState.RUNNING
    store.close()
    with serve(flown_url) as client:
        found = ended(client, f"/api/v1/searches/{left.id}")
    assert found["state"] == "succeeded", found["error"]


def test_running_search_is_cancelled(client: TestClient):
    many = SEARCH | {"method": "EE", "settings": {"resamplings": 500}}
    address = client.post("/api/v1/searches", json=many).headers["location"]
    assert client.post(f"{address}/cancel").json()["state"] == "cancelled"
    after = client.post("/api/v1/searches", json=SEARCH | {"method": "EE"}).headers["location"]
    assert ended(client, after)["state"] == "succeeded"
    assert client.get(address).json()["state"] == "cancelled"


def test_invalid_search_is_refused(client: TestClient):
    for change, code in (
        ({"settings": {"f_in": 2.0}}, "bad-input"),
        ({"structure": {"modes": [7, 7]}}, None),
        ({"structure": {"modes": [99]}}, None),
        ({"settings": {"validate_on": [1]}}, "not-unseen"),
    ):
        response = client.post("/api/v1/searches", json=SEARCH | change)
        assert 400 <= response.status_code < 500, change
        if code is not None:
            assert response.json()["code"] == code
    assert client.post("/api/v1/searches", json=SEARCH | {"maneuver_ids": [9]}).status_code == 404
    assert client.get("/api/v1/searches").json()["items"] == []
