"""Every route keeps what the description of the interface promises, whatever it is sent.

On both databases, always: what one of them refuses or cannot keep the other may let pass.
"""

from __future__ import annotations

import shutil
import uuid
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, settings
from postgresql import Cluster
from tests.conftest import Listening

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
    max_examples=2,  # on each of two databases
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


@pytest.fixture(scope="session", params=["sqlite", "postgresql"])
def flown(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> Callable[[], str]:
    """Make a database with a maneuver that was flown, on either kind; returns its address."""
    if request.param == "sqlite":
        template: Path = request.getfixturevalue("flown_file")
        folder = tmp_path_factory.mktemp("contract")
        return lambda: f"sqlite:///{shutil.copy(template, folder / f'{uuid.uuid4().hex}.db')}"
    cluster: Cluster = request.getfixturevalue("postgresql")
    name: str = request.getfixturevalue("flown_template")
    return lambda: cluster.url(cluster.copy(name))


@pytest.fixture(scope="session")
def changed_url(flown: Callable[[], str], listening: Listening) -> Iterator[str]:
    """A server of its own, for what is sent may change anything."""
    with listening(flown()) as url:
        yield url


@pytest.fixture(scope="session")
def doomed_url(flown: Callable[[], str], listening: Listening) -> Iterator[str]:
    """A server of its own, for what others need would be gone."""
    with listening(flown()) as url:
        yield url
