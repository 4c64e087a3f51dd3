"""A controller around what a run identified, over the interface."""

from __future__ import annotations

from fastapi.testclient import TestClient
from waiting import ended


def test_margins_come_as_numbers_or_null_and_as_figures(client: TestClient):
    query = "run_ids=1&controller_id=1"
    answer = client.get(f"/api/v1/closed-loop?{query}").json()
    assert "closed loop" in answer["sentence"]
    rows = answer["margins"]
    assert {row["surface"] for row in rows} == {"wf1s", "wf4s"}
    held = [row for row in rows if row["disk"] is not None]
    assert held
    assert all(0.0 < row["disk"] <= 2.0 for row in held)
    assert all(row["gain_std"] >= 0.0 for row in held)
    for kind, words in (("closed-loop-margins", "Gain margin"), ("closed-loop-roots", "Imaginary")):
        figure = client.get(f"/api/v1/figures/{kind}?{query}").json()
        assert words in figure["layout"]["yaxis"]["title"]["text"]
    missing = client.get("/api/v1/closed-loop?run_ids=1&controller_id=99")
    assert missing.status_code == 404


def test_an_answer_is_found_as_a_task_and_then_at_hand(client: TestClient):
    begun = client.post("/api/v1/closed-loop/answers?run_ids=1&controller_id=1")
    assert begun.status_code == 202, begun.text
    assert ended(client, begun.headers["location"])["state"] == "done"
    nobody = client.post("/api/v1/closed-loop/answers?run_ids=1&controller_id=99")
    told = ended(client, nobody.headers["location"])
    assert told["state"] == "failed"
    assert "99" in told["message"]
