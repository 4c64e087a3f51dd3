"""Closed-loop stability of an identified model, over REST."""

from __future__ import annotations

from fastapi.testclient import TestClient
from waiting import ended


def test_margins_are_numbers_or_null_and_figures(client: TestClient):
    query = "run_ids=1&controller_id=1"
    response = client.get(f"/api/v1/closed-loop?{query}").json()
    assert "closed loop" in response["sentence"]
    rows = response["margins"]
    assert {row["surface"] for row in rows} == {"wf1s", "wf4s"}
    finite = [row for row in rows if row["disk"] is not None]
    assert finite
    assert all(0.0 < row["disk"] <= 2.0 for row in finite)
    assert all(row["gain_std"] >= 0.0 for row in finite)
    for kind, words in (("closed-loop-margins", "Gain margin"), ("closed-loop-roots", "Imaginary")):
        figure = client.get(f"/api/v1/figures/{kind}?{query}").json()
        assert words in figure["layout"]["yaxis"]["title"]["text"]
    missing = client.get("/api/v1/closed-loop?run_ids=1&controller_id=99")
    assert missing.status_code == 404


def test_closed_loop_analysis_runs_as_task(client: TestClient):
    begun = client.post("/api/v1/closed-loop/results?run_ids=1&controller_id=1")
    assert begun.status_code == 202, begun.text
    assert ended(client, begun.headers["location"])["state"] == "done"
    unknown = client.post("/api/v1/closed-loop/results?run_ids=1&controller_id=99")
    result = ended(client, unknown.headers["location"])
    assert result["state"] == "failed"
    assert "99" in result["message"]
