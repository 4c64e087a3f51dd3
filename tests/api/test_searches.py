"""A search over REST: asked for, followed, cancelled, its candidates opened as runs."""

from __future__ import annotations

from typing import Any

from fastapi.testclient import TestClient
from waiting import ended

from flexsid.records.model_structure import Structure
from flexsid.records.run import Method, RunState
from flexsid.records.search import SearchSettings, StructureSearch
from flexsid.storage.store import Store

WANTED: dict[str, Any] = {
    "maneuver_ids": [1],
    "method": "OE",
    "structure": {"modes": [7, 9]},
    "settings": {"draws": 2},
}


def test_a_search_is_followed_to_its_candidates_and_they_open_as_runs(client: TestClient):
    answer = client.post("/api/v1/searches", json=WANTED, headers={"X-Flexsid-Analyst": "Ada"})
    assert answer.status_code == 202
    address = answer.headers["location"]
    found = ended(client, address)
    assert found["state"] == "succeeded", found["error"]
    assert found["author"] == "Ada"
    proposed = next(one for one in found["result"]["candidates"] if one["proposed"])
    # all terms of the two modes that flew are real, one or the other too small to tell
    assert proposed["n_terms"] >= 42
    (line,) = client.get("/api/v1/searches").json()["items"]
    assert line["sentence"].startswith("OE over flown asks for")
    place = found["result"]["candidates"].index(proposed)
    run = client.post(f"{address}/candidates/{place}/run").json()
    assert run["structure"]["free"] == proposed["structure"]["free"]
    assert client.post(f"{address}/candidates/{place}/run").json()["id"] == run["id"]
    assert client.get(address).json()["result"]["candidates"][place]["run_id"] == run["id"]
    assert client.post(f"{address}/candidates/99/run").status_code == 404
    late = client.post(f"{address}/cancel")
    assert late.status_code == 409
    assert late.json()["code"] == "search-ended"


def test_a_search_that_a_stopped_server_left_is_carried_out_by_the_next(serve, flown_url):
    store = Store.open(flown_url)
    left = store.searches.add(
        StructureSearch(
            aircraft_id=1,
            maneuver_ids=(1,),
            method=Method.EE,
            structure=Structure(modes=(7, 9), fixed={}),
            settings=SearchSettings(draws=0),
            state=RunState.RUNNING,
        )
    )
    store.close()
    with serve(flown_url) as client:
        found = ended(client, f"/api/v1/searches/{left.id}")
    assert found["state"] == "succeeded", found["error"]


def test_a_search_under_way_is_cancelled(client: TestClient):
    many = WANTED | {"method": "EE", "settings": {"draws": 500}}
    address = client.post("/api/v1/searches", json=many).headers["location"]
    assert client.post(f"{address}/cancel").json()["state"] == "cancelled"
    after = client.post("/api/v1/searches", json=WANTED | {"method": "EE"}).headers["location"]
    assert ended(client, after)["state"] == "succeeded"
    assert client.get(address).json()["state"] == "cancelled"


def test_what_cannot_be_searched_is_refused_at_once(client: TestClient):
    for change, code in (
        ({"settings": {"f_in": 2.0}}, "bad-input"),
        ({"structure": {"modes": [7, 7]}}, None),
        ({"structure": {"modes": [99]}}, None),
        ({"settings": {"validate_on": [1]}}, "not-unseen"),
    ):
        answer = client.post("/api/v1/searches", json=WANTED | change)
        assert 400 <= answer.status_code < 500, change
        if code is not None:
            assert answer.json()["code"] == code
    assert client.post("/api/v1/searches", json=WANTED | {"maneuver_ids": [9]}).status_code == 404
    assert client.get("/api/v1/searches").json()["items"] == []
