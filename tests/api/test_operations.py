"""What operations need: liveness, readiness, metrics, request ids, and logs without secrets."""

from __future__ import annotations

import json
import logging
from collections.abc import Iterator

import pytest
from fastapi.testclient import TestClient
from tests.api.accounts import API, PASSWORD, SAME_ORIGIN, add_member
from tests.api.conftest import Serve

from flexsid.api.middleware.request_log import LARGEST_HEADERS, JsonFormatter
from flexsid.jobs.health import PartHealth, PartState, QueueHealth
from flexsid.records.account import AccountRole
from flexsid.settings import Mode

pytestmark = pytest.mark.parametrize("backend", ["sqlite"])


@pytest.fixture
def team(serve: Serve, flown_url: str, app) -> Iterator[TestClient]:
    with serve(flown_url) as client:
        app.state.settings = app.state.settings.model_copy(update={"mode": Mode.TEAM})
        yield client


def test_without_workers_the_server_lives_but_is_not_ready(
    team: TestClient, monkeypatch: pytest.MonkeyPatch
) -> None:
    for state, expected in ((PartState.OK, 204), (PartState.DEGRADED, 503)):
        part = PartHealth(name="workers", state=state, text="none")
        monkeypatch.setattr(QueueHealth, "check", lambda self, part=part: (part,))
        assert team.get(f"{API}/health/live").status_code == 204
        response = team.get(f"{API}/health/ready")
        assert response.status_code == expected
    assert response.json()["code"] == "not-ready"


def test_metrics_count_requests_by_route(team: TestClient, app) -> None:
    ann = add_member(team, app.state.context.store, "Ann", AccountRole.VIEWER)
    assert ann.get("runs/1").status_code == 200
    text = ann.get("/metrics").text
    assert 'flexsid_requests_total{method="GET",route="/runs/{run_id}",status="200"}' in text
    assert 'flexsid_request_duration_seconds_bucket{le="+Inf"}' in text
    assert 'flexsid_jobs{state="succeeded"} 1' in text
    assert "flexsid_workers " in text
    assert team.get("/metrics").status_code == 401


def test_oversized_headers_are_refused(team: TestClient) -> None:
    response = team.get(f"{API}/health/live", headers={"X-Long": "x" * LARGEST_HEADERS})
    assert (response.status_code, response.json()["code"]) == (431, "headers-too-large")


def test_log_names_the_account_and_no_secret(
    team: TestClient, app, caplog: pytest.LogCaptureFixture
) -> None:
    ann = add_member(team, app.state.context.store, "Ann", AccountRole.VIEWER)
    with caplog.at_level(logging.INFO, "flexsid.requests"):
        response = ann.get("runs/1", params={"x": PASSWORD})
        sent = {"name": "Ann", "password": PASSWORD}
        team.post(f"{API}/session", json=sent, headers=SAME_ORIGIN)
    lines = [JsonFormatter().format(record) for record in caplog.records]
    first = json.loads(lines[0])
    assert first["account"] == "Ann"
    assert first["path"] == "/api/v1/runs/1"
    assert first["request_id"] == response.headers["x-request-id"]
    assert not [secret for secret in (PASSWORD, ann.secret) if secret in "".join(lines)]
