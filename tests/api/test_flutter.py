"""Questions about flutter that cannot be answered are refused with what would be right."""

from __future__ import annotations

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
