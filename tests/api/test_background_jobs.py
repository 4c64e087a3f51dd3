"""Jobs of all kinds over REST: submission, listing, cancellation, stored results."""

from __future__ import annotations

import sqlite3
import time
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import pytest
from fastapi.testclient import TestClient
from waiting import ended, wait_until

DESIGN: dict[str, Any] = {
    "name": "interleaved",
    "duration_s": 20.0,
    "rate_hz": 100.0,
    "peaks": [0.01, 0.02, 0.04],
    "inputs": [
        {"name": "bfs", "harmonics": list(range(4, 120, 2))},
        {"name": "wf1s", "harmonics": list(range(5, 121, 2))},
    ],
    "effort": "quick",
}
API = "/api/v1"


def test_design_is_created_by_a_job(empty: TestClient):
    begun = empty.post(f"{API}/designs/searches", json=DESIGN, headers={"X-Flexsid-Analyst": "Ada"})
    assert begun.status_code == 202, begun.text
    now = ended(empty, begun.headers["location"])
    assert (now["state"], now["kind"], now["author"]) == ("succeeded", "excitation-design", "Ada")
    stored = empty.get(f"{API}/designs/{now['result']['design_id']}").json()
    assert stored["name"] == now["title"] == "interleaved"
    wrong = empty.post(f"{API}/designs/searches", json=DESIGN | {"rate_hz": 10.0})
    assert wrong.json()["code"] == "above-nyquist"
    (item,) = empty.get(f"{API}/jobs?kind=excitation-design").json()["items"]
    assert item["id"] == now["id"]
    log = [line["kind"] for line in empty.get(f"{begun.headers['location']}/log").json()["items"]]
    assert log[0] == "queued"
    assert log[-1] == "succeeded"
    typical = empty.get(f"{API}/jobs/status").json()["typical_s"]
    assert typical["excitation-design"] > 0.0
    assert typical["mode-identification"] == 36.0, "that of the demonstration, until one has ended"


def test_a_running_design_is_cancelled_and_can_be_retried(empty: TestClient):
    long = DESIGN | {"effort": "patient"}
    address = empty.post(f"{API}/designs/searches", json=long).headers["location"]
    wait_until(lambda: empty.get(address).json()["state"] == "running")
    assert empty.post(f"{address}/cancel").json()["state"] == "cancelled"
    assert empty.post(f"{address}/cancel").status_code == 202  # nothing changes
    assert empty.post(f"{address}/retry").json()["state"] == "queued"
    empty.post(f"{address}/cancel")
    assert empty.get(f"{API}/designs").json()["items"] == []


def test_the_long_job_of_one_analyst_does_not_delay_another(client: TestClient):
    long = DESIGN | {"effort": "patient"}
    ann, eva = {"X-Flexsid-Analyst": "Ann"}, {"X-Flexsid-Analyst": "Eva"}
    addresses = [
        client.post(f"{API}/designs/searches", json=long, headers=ann).headers["location"]
        for _ in range(9)
    ]
    wait_until(lambda: client.get(addresses[0]).json()["state"] == "running")
    flutter = client.post(f"{API}/flutter/results?run_ids=1", headers=eva).headers["location"]
    assert ended(client, flutter)["state"] == "succeeded"
    assert client.get(addresses[-1]).json()["state"] == "queued"
    for address in addresses:
        client.post(f"{address}/cancel")


def test_an_equal_request_is_the_stored_result(client: TestClient):
    first = client.post(f"{API}/flutter/results?run_ids=1").json()
    address = f"{API}/jobs/{first['id']}"
    assert ended(client, address)["state"] == "succeeded"
    again = client.post(f"{API}/flutter/results?run_ids=1").json()
    assert (again["id"], again["state"]) == (first["id"], "succeeded")
    twice = client.post(f"{API}/flutter/results?run_ids=1,1").json()
    assert twice["id"] == first["id"]
    other = client.post(f"{API}/flutter/results?run_ids=1&fuel=0.3").json()
    assert other["id"] != first["id"]
    client.post(f"{API}/jobs/{other['id']}/cancel")


@pytest.mark.parametrize(
    "path",
    [
        *("flutter?", "closed-loop?controller_id=1&", "figures/v-omega-zeta?"),
        *("figures/flutter-map?", "figures/closed-loop-roots?controller_id=1&"),
    ],
)
def test_reading_computes_no_fit_and_adds_no_job(client: TestClient, path: str):
    response = client.get(f"{API}/{path}run_ids=1")
    assert response.status_code == 409
    assert response.json()["code"] == "not-computed"
    assert [job["kind"] for job in client.get(f"{API}/jobs").json()["items"]] == ["estimation"]


@pytest.mark.parametrize("backend", ["sqlite"])
def test_reading_does_not_wait_for_writers(client: TestClient, flown_url: str):
    other = sqlite3.connect(flown_url.removeprefix("sqlite:///"), isolation_level=None)
    other.execute("BEGIN IMMEDIATE")
    body = {"maneuver_id": 1, "method": "EE", "structure": {"modes": [7]}}
    with ThreadPoolExecutor(6) as pool:
        writers = [pool.submit(client.post, f"{API}/runs", json=body) for _ in range(6)]
        time.sleep(2.0)
        assert client.get(f"{API}/runs").status_code == 200
        # If the reader had waited for a thread of a writer, that writer would have ended.
        assert not any(writer.done() for writer in writers)
        other.execute("ROLLBACK")
        other.close()
        # Equal requests: one is queued, the others return its run.
        codes = sorted(writer.result().status_code for writer in writers)
        assert codes == [200, 200, 200, 200, 200, 202]
