"""Questions about flutter that cannot be answered are refused with what would be right."""

from __future__ import annotations

import pytest
from waiting import ended

from flexsid.cli.main import main


@pytest.mark.parametrize(
    ("query", "status"),
    [
        ("run_ids=", 422),
        ("run_ids=x", 422),
        ("run_ids=999", 404),
        ("run_ids=1&fuel=2", 422),
        ("run_ids=1&altitude_m=90000", 422),
        ("run_ids=1&next_m_s=-3", 422),
        (f"run_ids={','.join(map(str, range(1, 102)))}", 422),
    ],
)
def test_impossible_questions_are_refused(client, query: str, status: int):
    for path in ("flutter", "figures/v-omega-zeta", "figures/flutter-map"):
        answer = client.get(f"/api/v1/{path}?{query}")
        assert answer.status_code == status, answer.text
        assert answer.headers["content-type"].startswith("application/problem+json")


def test_a_loading_in_other_units_is_refused_from_the_command_line_too(flown_url: str, capsys):
    for asked, words in (
        (["--fuel", "50"], "0.5 for 50 %"),
        (["--altitude", "35000"], "expected -1000 to 11000 m"),
        (["--next", "4500"], "expected 0.1 to 1000 m/s"),
    ):
        assert main(["flutter", "1", *asked, "--database", flown_url]) != 0
        assert words in capsys.readouterr().err


def test_an_answer_is_found_as_a_task_and_then_at_hand(client):
    begun = client.post("/api/v1/flutter/answers?run_ids=1")
    assert begun.status_code == 202, begun.text
    now = ended(client, begun.headers["location"])
    assert (now["state"], now["made"]) == ("done", None)
    assert client.get("/api/v1/flutter?run_ids=1").json()["sentence"]
    missing = client.post("/api/v1/flutter/answers?run_ids=999")
    assert missing.status_code == 202
    now = ended(client, missing.headers["location"])
    assert now["state"] == "failed"
    assert "999" in now["message"]
