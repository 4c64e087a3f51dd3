"""Questions about flutter that cannot be answered are refused with what would be right."""

from __future__ import annotations

import time

import pytest


@pytest.mark.parametrize(
    ("query", "status"),
    [
        ("run_ids=", 422),
        ("run_ids=x", 422),
        ("run_ids=999", 404),
        ("run_ids=1&fuel=2", 422),
        ("run_ids=1&altitude_m=90000", 422),
        ("run_ids=1&next_m_s=-3", 422),
    ],
)
def test_impossible_questions_are_refused(client, query: str, status: int):
    for path in ("flutter", "figures/v-omega-zeta", "figures/flutter-map"):
        answer = client.get(f"/api/v1/{path}?{query}")
        assert answer.status_code == status, answer.text
        assert answer.headers["content-type"].startswith("application/problem+json")


def test_an_answer_is_found_as_a_task_and_then_at_hand(client):
    begun = client.post("/api/v1/flutter/answers?run_ids=1")
    assert begun.status_code == 202, begun.text
    deadline = time.monotonic() + 60.0
    while (now := client.get(begun.headers["location"]).json())["state"] in ("waiting", "running"):
        assert time.monotonic() < deadline
        time.sleep(0.05)
    assert (now["state"], now["made"]) == ("done", None)
    assert client.get("/api/v1/flutter?run_ids=1").json()["sentence"]
    missing = client.post("/api/v1/flutter/answers?run_ids=999")
    assert missing.status_code == 202
    while (now := client.get(missing.headers["location"]).json())["state"] in (
        "waiting",
        "running",
    ):
        time.sleep(0.05)
    assert now["state"] == "failed"
    assert "999" in now["message"]
