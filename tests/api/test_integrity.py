"""Altered results, corrected data and evidence of decisions, over REST."""

from __future__ import annotations

import pytest
import sqlalchemy as sa
from fastapi.testclient import TestClient
from tests.api.team import Act, propose, vote

from flexsid.storage.store import Store
from flexsid.storage.tables import runs


def test_altered_result_is_reported_and_not_used(client: TestClient, flown_url: str) -> None:
    assert client.get("/api/v1/runs/1").json()["altered"] is False
    store = Store.open(flown_url)
    result = store.runs.encode_field("result", store.runs.get(1).result)
    result["parameters"][0]["value"] *= 3.0
    with store.database.transaction() as connection:
        connection.execute(sa.update(runs).values(result=result))
    store.close()
    assert client.get("/api/v1/runs/1").json()["altered"] is True
    for address in (
        "figures/fit?run_id=1",
        "figures/derivatives?run_ids=1",
        "comparisons?run_ids=1",
        "runs/1/export",
        "runs/1/model",
        "reports/run/1",
        "reports/comparison?run_ids=1",
        "flutter?run_ids=1",
    ):
        response = client.get(f"/api/v1/{address}")
        assert (response.status_code, response.json()["code"]) == (409, "result-altered"), address


def test_corrected_data_are_reported_by_runs_lists_and_comparisons(
    client: TestClient,
) -> None:
    def shown() -> list[list[str]]:
        run = client.get("/api/v1/runs/1").json()
        (listed,) = client.get("/api/v1/runs").json()["items"]
        (source,) = client.get("/api/v1/comparisons?run_ids=1").json()["sources"]
        return [one["changed_since"] for one in (run, listed, source)]

    assert shown() == [[]] * 3
    step = client.post(
        "/api/v1/maneuvers/1/conditioning",
        json={"items": [{"channel": "q", "kind": "calibration", "scale": 1.1}]},
    )
    assert step.status_code == 201, step.text
    assert shown() == [["maneuver 1"]] * 3
    assert "Data changed since run 1" in client.get("/api/v1/reports/run/1").text
    assert "Data changed since run 1" in client.get("/api/v1/reports/comparison?run_ids=1").text


@pytest.mark.parametrize("resource", ["runs", "maneuvers"])
def test_evidence_of_baseline_is_not_deleted(act: Act, resource: str) -> None:
    decision = propose(act)
    vote(act, "Bo", decision)
    for response in (
        act("Ann", "delete", f"{resource}/1"),
        act("Ann", "post", f"{resource}/changes", {"ids": [1], "action": "delete"}),
    ):
        assert response.status_code == 409, response.text
        assert response.json()["code"] == "is-evidence"
        assert response.json()["decision_id"] == decision["id"]
    assert act("Ann", "get", f"{resource}/1").json()["deleted_at"] is None


def test_evidence_of_withdrawn_proposal_is_deleted(act: Act) -> None:
    decision = propose(act)
    assert act("Ann", "delete", "runs/1").status_code == 409
    body = {"revision": 1, "text": "no"}
    assert act("Ann", "post", f"decisions/{decision['id']}/withdrawal", body).status_code == 201
    assert act("Ann", "delete", "runs/1").status_code == 204


def test_a_deleted_run_is_no_evidence(act: Act) -> None:
    assert act("Ann", "delete", "runs/1").status_code == 204
    decision = {
        "title": "x",
        "structure": {"id": 1, "version": 1},
        "limits": {},
        "reasoning": "y",
        "run_ids": [1],
    }
    response = act("Ann", "post", "decisions", decision)
    assert (response.status_code, response.json()["code"]) == (409, "deleted")
