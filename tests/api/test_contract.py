"""Every route keeps what the description of the interface promises, whatever it is sent."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
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
]
STREAM = "/api/v1/events"  # it has no end
bounded = settings(
    max_examples=4,
    derandomize=True,
    deadline=None,
    database=None,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.filter_too_much],
)


@schema.exclude(method="DELETE").exclude(path=STREAM).parametrize()
@bounded
def test_a_route_answers_as_described(case: Any, changed_url: str) -> None:
    case.call_and_validate(base_url=changed_url, timeout=300, excluded_checks=LENIENT)


@schema.include(method="DELETE").parametrize()
@bounded
def test_what_is_deleted_is_deleted_as_described(case: Any, doomed_url: str) -> None:
    case.call_and_validate(base_url=doomed_url, timeout=300, excluded_checks=LENIENT)


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
