"""Write-backs by REST and the Python client; what is refused names the reason."""

from __future__ import annotations

from fastapi.testclient import TestClient

from flexsid.jobs.dispatcher import execute_run
from flexsid.jobs.kinds import RUN
from flexsid.records.decision import Structure
from flexsid.records.run import EstimationRun, Method, RunSettings
from flexsid.storage.store import Store


def estimate(url: str) -> int:
    """Estimate maneuver 1 with retained modes."""
    structure = Structure(modes=(7, 9), fixed={})
    request = EstimationRun(
        maneuver_id=1, method=Method.EE, structure=structure, settings=RunSettings()
    )
    store = Store.open(url)
    run = execute_run(store, request, RUN, lambda progress: None)
    store.close()
    assert run.id is not None
    return run.id


def test_a_run_is_written_back_once_until_it_is_undone(flown_url: str, client: TestClient) -> None:
    made = estimate(flown_url)
    proposal = client.get("/api/v1/write-backs/proposal", params={"run_id": made})
    assert proposal.status_code == 200, proposal.text
    assert proposal.json()["maneuver_ids"] == [1]
    body = {"run_id": made, "reason": "both methods agree"}
    written = client.post("/api/v1/write-backs", json=body)
    assert written.status_code == 201, written.text
    again = client.post("/api/v1/write-backs", json=body)
    assert (again.status_code, again.json()["code"]) == (409, "already-exists")
    number = written.json()["prediction_id"]
    run = {"maneuver_id": 1, "method": "EE", "prediction_id": number}
    refused = client.post("/api/v1/runs", json=run)
    assert (refused.status_code, refused.json()["code"]) == (422, "counted-twice")
    address = f"/api/v1/write-backs/{written.json()['id']}"
    assert client.delete(address).json()["undone_at"] is not None
    assert client.delete(address).json()["code"] == "already-undone"
    (listed,) = client.get("/api/v1/write-backs", params={"aircraft_id": 1}).json()["items"]
    assert listed["reason"] == "both methods agree"
    assert client.get(f"/api/v1/predictions/{number}").status_code == 200
    assert client.post("/api/v1/write-backs", json={**body, "reason": ""}).status_code == 422
