"""Every route keeps what the description of the interface promises, whatever it is sent."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from fastapi.testclient import TestClient
from hypothesis import HealthCheck, settings

from flexsid.api.app import create_app
from flexsid.settings import Settings

schemathesis = pytest.importorskip("schemathesis", reason="schemathesis is not installed")

# The server runs in the process of the test and draws random numbers of its own.
pytestmark = pytest.mark.filterwarnings("ignore:Do not use the `random` module")

DESCRIBED = create_app(Settings()).openapi()
schema = schemathesis.openapi.from_dict(DESCRIBED)
# Boundaries of every field, one by one, would be most of the time; these are drawn at random.
schema.config.phases.coverage.enabled = False
LENIENT = [
    # What is described as valid may still be refused: there may be no such record.
    schemathesis.checks.positive_data_acceptance,
    # GET /runs/changes is read as a run whose id is no number, and refused as that.
    schemathesis.checks.unsupported_method,
]
STREAM = "/api/v1/events"  # it has no end
bounded = settings(
    max_examples=6,
    derandomize=True,
    deadline=None,
    database=None,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.filter_too_much],
)


@schema.exclude(method="DELETE").exclude(path=STREAM).parametrize()
@bounded
def test_a_route_answers_as_described(case: Any, changed_url: str) -> None:
    case.call_and_validate(base_url=changed_url, timeout=60, excluded_checks=LENIENT)


@schema.include(method="DELETE").parametrize()
@bounded
def test_what_is_deleted_is_deleted_as_described(case: Any, doomed_url: str) -> None:
    case.call_and_validate(base_url=doomed_url, timeout=60, excluded_checks=LENIENT)


@pytest.fixture(scope="session")
def changed_url(
    flown_file: Path, listening: Any, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[str]:
    """A server of its own, for what is sent may change anything."""
    file = tmp_path_factory.mktemp("changed") / "flown.db"
    shutil.copy(flown_file, file)
    with listening(file) as url:
        yield url


@pytest.fixture(scope="session")
def doomed_url(
    flown_file: Path, listening: Any, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[str]:
    """A server of its own, for what others need would be gone."""
    file = tmp_path_factory.mktemp("doomed") / "flown.db"
    shutil.copy(flown_file, file)
    with listening(file) as url:
        yield url


def _operations() -> list[tuple[str, str, dict[str, Any]]]:
    return [
        (method, path, operation)
        for path, methods in DESCRIBED["paths"].items()
        for method, operation in methods.items()
    ]


def _required(operation: dict[str, Any]) -> list[dict[str, Any]]:
    return [part for part in operation.get("parameters", ()) if part["required"]]


def test_every_route_comes_with_an_example() -> None:
    for method, path, operation in _operations():
        for part in _required(operation):
            assert "example" in part, f"{method} {path}: {part['name']}, in api/description.py"
        body = operation.get("requestBody", {}).get("content", {})
        if "application/json" in body:
            assert "example" in body["application/json"], f"{method} {path}: its body"


def test_examples_are_read(client: TestClient) -> None:
    """Answered, or refused for want of a record: never as something that cannot be."""
    for method, path, operation in _operations():
        if "/uploads" in path or path == STREAM or method not in ("get", "post", "put"):
            continue
        content = operation.get("requestBody", {}).get("content", {})
        if content and "application/json" not in content:
            continue
        query = {p["name"]: p["example"] for p in _required(operation) if p["in"] == "query"}
        headers = {p["name"]: p["example"] for p in _required(operation) if p["in"] == "header"}
        body = content.get("application/json", {}).get("example")
        address = path
        for part in _required(operation):
            address = address.replace(f"{{{part['name']}}}", str(part["example"]))
        answer = client.request(method, address, params=query, headers=headers, json=body)
        if answer.status_code >= 300:
            assert answer.json()["code"] != "invalid-request", f"{method} {path}: {answer.text}"
