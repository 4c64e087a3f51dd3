"""The order of decisions does not depend on the clocks of the servers."""

from __future__ import annotations

import logging
from datetime import UTC, datetime, timedelta, tzinfo

import pytest
from fastapi.testclient import TestClient
from tests.api.team import Act, propose, vote

from flexsid.workflow.review import decision_review, notifications

HOUR = timedelta(hours=1)


class _Slow:
    """A clock one hour behind, as on a second server."""

    @staticmethod
    def now(tz: tzinfo) -> datetime:
        return datetime.now(tz) - HOUR


def test_baseline_approved_with_slow_clock_supersedes_earlier_one(
    act: Act, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    first = propose(act)
    vote(act, "Bo", first)
    monkeypatch.setattr(decision_review, "datetime", _Slow)
    second = propose(act, title="the better one")
    with caplog.at_level(logging.WARNING):
        vote(act, "Bo", second)
    states = {
        one["id"]: (one["state"], one["superseded_by"])
        for one in (act("Ann", "get", f"decisions/{d['id']}").json() for d in (first, second))
    }
    assert states == {
        first["id"]: ("superseded", second["id"]),
        second["id"]: ("approved", None),
    }
    baselines = act("Ann", "get", "baselines?aircraft_id=1").json()["items"]
    assert [one["decision_id"] for one in baselines] == [second["id"]]


def test_new_runs_use_later_of_two_overlapping_baselines(
    act: Act, monkeypatch: pytest.MonkeyPatch
) -> None:
    wide = propose(act, limits={"dynamic_pressure_pa": [0.0, 9000.0]})
    vote(act, "Bo", wide)
    monkeypatch.setattr(decision_review, "datetime", _Slow)
    edit = {"name": "SP + SW1B", "structure": {"modes": [7], "absent": ["CZ_q"]}, "version": 1}
    act("Bo", "put", "model-structures/1", edit)
    part = propose(
        act, structure={"id": 1, "version": 2}, limits={"dynamic_pressure_pa": [0.0, 5000.0]}
    )
    vote(act, "Bo", part)
    run = act("Ann", "post", "runs", {"maneuver_id": 1, "method": "EE"}).json()
    assert run["structure_version"] == 2


def test_changes_are_listed_in_order_of_entry(
    act: Act, client: TestClient, monkeypatch: pytest.MonkeyPatch
) -> None:
    decision = propose(act)
    address = f"decisions/{decision['id']}/comments"
    act("Bo", "post", address, {"text": "first"})
    monkeypatch.setattr(decision_review, "datetime", _Slow)
    act("Bo", "post", address, {"text": "second"})
    changes = act("Ann", "get", "notifications").json()["changes"]
    assert [change["text"] for change in changes] == ["second", "first"]


def test_changes_are_merged_by_time_within_their_order() -> None:
    def change(subject: str, number: int, hour: int) -> tuple[int, notifications.TeamChange]:
        at = datetime(2026, 1, 1, hour, tzinfo=UTC)
        return number, notifications.TeamChange(
            subject=subject, id=1, title="", what="", author="", text="", number=number, at=at
        )

    decisions = [change("decision", k, hour) for k, hour in ((1, 9), (2, 12), (3, 7))]
    structures = [change("structure", k, hour) for k, hour in ((1, 8), (2, 10))]
    merged = notifications._merge(decisions, structures)
    assert [(one.subject[0], one.number) for one in merged] == [
        ("d", 3),
        ("d", 2),
        ("s", 2),
        ("d", 1),
        ("s", 1),
    ]


def test_clock_behind_last_event_degrades_health(
    act: Act, client: TestClient, monkeypatch: pytest.MonkeyPatch
) -> None:
    propose(act)
    assert _clock_of(client)["state"] == "ok"
    monkeypatch.setattr(decision_review, "datetime", _Slow)
    part = _clock_of(client)
    assert part["state"] == "degraded"
    assert "behind the last stored event" in part["text"]
    assert client.get("/api/v1/health").json()["status"] == "degraded"


def _clock_of(client: TestClient) -> dict[str, str]:
    response = client.get("/api/v1/health")
    assert response.status_code == 200
    return next(part for part in response.json()["parts"] if part["name"] == "clock")
