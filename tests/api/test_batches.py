"""Batches: request, progress, cancellation, retry, and reuse of equal runs."""

from __future__ import annotations

from typing import Any

import pytest
from fastapi import FastAPI
from fastapi.testclient import TestClient
from waiting import wait_until

from flexsid.storage.access import Quotas

API = "/api/v1"
SETTINGS = {"max_iterations": 90, "out_of_band_modes": "omitted"}  # the existing run has other ones
RUN = {"maneuver_id": 1, "method": "EE", "structure": {"modes": [7, 9]}, "settings": SETTINGS}
BATCH = {
    "name": "campaign",
    "maneuver_ids": [1],
    "methods": ["OE", "EE", "FRE"],
    "structures": [{"structure": {"modes": [7, 9]}}, {"structure": {"modes": [7]}}],
    "from_equation_error": True,
    "settings": SETTINGS,
}


def _finished(client: TestClient, batch_id: int) -> dict[str, Any]:
    def look() -> dict[str, Any] | None:
        response = client.get(f"{API}/batches/{batch_id}").json()
        return None if response["states"]["queued"] + response["states"]["running"] else response

    return wait_until(look, "the end of the batch")


def test_repeated_request_returns_existing_run(client: TestClient) -> None:
    first = client.post(f"{API}/runs", json=RUN)
    assert (first.status_code, first.json()["repeated"]) == (202, False)
    again = client.post(f"{API}/runs", json=RUN | {"priority": 5})
    assert (again.status_code, again.json()["repeated"]) == (200, True)
    assert again.json()["id"] == first.json()["id"]
    other = client.post(f"{API}/runs", json=RUN | {"structure": {"modes": [7]}})
    assert other.status_code == 202
    assert other.json()["data_hash"] == first.json()["data_hash"]
    assert other.json()["input_hash"] != first.json()["input_hash"]


def test_runs_beyond_the_quota_of_an_analyst_are_refused(
    client: TestClient, app: FastAPI, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(app.state.context.store, "quotas", Quotas(unfinished_jobs=5))
    before = client.get(f"{API}/jobs").json()
    refused = client.post(f"{API}/batches", json=BATCH)
    assert (refused.status_code, refused.json()["code"]) == (409, "queue-full")
    assert "more than 5" in refused.json()["detail"]
    assert client.get(f"{API}/jobs").json() == before, "none of the runs is queued"
    assert client.get(f"{API}/batches").json()["items"] == []
    fewer = BATCH | {"methods": ["EE", "OE"]}
    assert client.post(f"{API}/batches", json=fewer).status_code == 202


def test_cancelled_or_deleted_run_is_not_reused(client: TestClient) -> None:
    first = client.post(f"{API}/runs", json=RUN).json()["id"]
    client.post(f"{API}/jobs/{first}/cancel")
    state = client.get(f"{API}/jobs/{first}").json()["state"]
    if state == "succeeded":  # ended before it was cancelled
        client.delete(f"{API}/runs/{first}")
    assert client.post(f"{API}/runs", json=RUN).status_code == 202


def test_batch_runs_all_jobs_and_stores_provenance(client: TestClient) -> None:
    accepted = client.post(f"{API}/batches", json=BATCH)
    assert accepted.status_code == 202, accepted.text
    assert accepted.json() == {"id": 1, "total": 6, "repeated": 0}
    done = _finished(client, 1)
    assert done["states"]["succeeded"] == 6
    assert done["finished_at"] >= done["started_at"]
    jobs = client.get(f"{API}/jobs?batch_id=1").json()["items"]
    assert len(jobs) == 6
    by_id = {job["id"]: job for job in jobs}
    for job in jobs:
        run = client.get(f"{API}/runs/{job['id']}").json()
        assert run["worker"]
        assert run["versions"]["numpy"]
        assert len(run["data_hash"]) == len(run["input_hash"]) == 64
        if job["method"] == "EE":
            assert job["after_job_id"] is None
            continue
        first = by_id[job["after_job_id"]]
        assert first["method"] == "EE"
        assert run["settings"]["start_run_id"] == first["id"]
        assert run["fit"]["start"] == f"run {first['id']}"
        assert job["started_at"] >= first["finished_at"]
    kinds = [line["kind"] for line in client.get(f"{API}/jobs/{jobs[0]['id']}/log").json()["items"]]
    # A job that takes longer than a second also logs its progress.
    assert [kind for kind in kinds if kind != "logged"] == ["queued", "started", "succeeded"]
    again = client.post(f"{API}/batches", json=BATCH | {"name": "again"})
    assert again.json() == {"id": 2, "total": 6, "repeated": 6}
    assert [b["batch"]["name"] for b in client.get(f"{API}/batches").json()["items"]] == [
        "again",
        "campaign",
    ]
    status = client.get(f"{API}/jobs/status").json()
    assert status["states"]["queued"] == 0
    assert status["remaining_s"] == 0.0
    assert 1 <= status["ended"] <= 7  # within the last minute: a loaded machine takes longer


def test_cancelled_batch_is_retried(client: TestClient) -> None:
    payload = BATCH | {
        "structures": [{"structure": {"modes": [7, 9]}}],
        "settings": SETTINGS | {"max_iterations": 99},
    }
    batch = client.post(f"{API}/batches", json=payload).json()["id"]
    cancelled = client.post(f"{API}/batches/{batch}/cancel").json()
    assert cancelled["states"]["queued"] + cancelled["states"]["running"] == 0
    assert cancelled["states"]["cancelled"] >= 1
    client.post(f"{API}/batches/{batch}/retry")
    assert _finished(client, batch)["states"]["succeeded"] == 3


@pytest.mark.parametrize(
    ("change", "code"),
    [
        ({"maneuver_ids": []}, 422),
        ({"maneuver_ids": [1, 77]}, 404),
        ({"methods": ["OE"]}, 422),
        ({"methods": ["XY"]}, 422),
        ({"structures": [{"structure": {"modes": [99]}}]}, 422),
        ({"structures": [{"structure_id": 77}]}, 404),
        ({"limits": {"memory_mb": 1}}, 422),
        ({"priority": True}, 422),
    ],
)
def test_invalid_batch_queues_nothing(
    client: TestClient, change: dict[str, Any], code: int
) -> None:
    response = client.post(f"{API}/batches", json=BATCH | change)
    assert response.status_code == code, response.text
    assert response.json()["code"]
    assert client.get(f"{API}/batches").json()["items"] == []
    assert len(client.get(f"{API}/jobs").json()["items"]) == 1
