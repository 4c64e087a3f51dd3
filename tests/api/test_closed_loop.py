"""Closed-loop stability of an identified model, over REST."""

from __future__ import annotations

import html

from fastapi.testclient import TestClient
from waiting import ended


def test_margins_are_numbers_or_null_and_figures(client: TestClient):
    query = "run_ids=1&controller_id=1"
    begun = client.post(f"/api/v1/closed-loop/results?{query}")
    assert begun.status_code == 202, begun.text
    assert ended(client, begun.headers["location"])["state"] == "succeeded"
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
    report = client.get(f"/api/v1/reports/closed-loop?{query}").text
    assert response["sentence"] in html.unescape(report)
    assert "Margins of the loop of wf4s" in report
    missing = client.get("/api/v1/closed-loop?run_ids=1&controller_id=99")
    assert missing.status_code == 404
    assert client.post("/api/v1/closed-loop/results?run_ids=1&controller_id=99").status_code == 404
