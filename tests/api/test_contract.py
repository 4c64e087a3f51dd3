"""Every route conforms to the OpenAPI description for generated requests.

On both databases, since one may refuse values that the other accepts.
"""

from __future__ import annotations

import shutil
import uuid
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, settings
from interface import DESCRIPTION
from postgresql import Cluster
from tests.conftest import Listening

schemathesis = pytest.importorskip("schemathesis", reason="schemathesis is not installed")

# The server runs in the process of the test and draws random numbers of its own.
pytestmark = pytest.mark.filterwarnings("ignore:Do not use the `random` module")

schema = schemathesis.openapi.from_dict(DESCRIPTION)
# Boundaries of every field, one by one, would be most of the time; these are drawn at random.
schema.config.phases.coverage.enabled = False
LENIENT = [
    # Valid requests may be refused: the record may not exist.
    schemathesis.checks.positive_data_acceptance,
]
STREAM = "/api/v1/events"  # it has no end
READY = "/api/v1/health/ready"  # 503 without dispatcher, as here; see test_operations
bounded = settings(
    max_examples=2,  # on each of two databases
    derandomize=True,
    deadline=None,
    database=None,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.filter_too_much],
)


@schema.exclude(method="DELETE").exclude(path=[STREAM, READY]).parametrize()
@bounded
def test_route_conforms_to_description(case: Any, changed_url: str) -> None:
    case.call_and_validate(base_url=changed_url, timeout=300, excluded_checks=LENIENT)


@schema.include(method="DELETE").parametrize()
@bounded
def test_delete_route_conforms_to_description(case: Any, doomed_url: str) -> None:
    case.call_and_validate(base_url=doomed_url, timeout=300, excluded_checks=LENIENT)


@pytest.fixture(scope="session", params=["sqlite", "postgresql"])
def flown(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> Callable[[], str]:
    """Return a function that creates a database with a flown maneuver and returns its URL."""
    if request.param == "sqlite":
        template: Path = request.getfixturevalue("flown_file")
        folder = tmp_path_factory.mktemp("contract")
        return lambda: f"sqlite:///{shutil.copy(template, folder / f'{uuid.uuid4().hex}.db')}"
    cluster: Cluster = request.getfixturevalue("postgresql")
    name: str = request.getfixturevalue("flown_template")
    return lambda: cluster.url(cluster.copy(name))


@pytest.fixture(scope="session")
def changed_url(flown: Callable[[], str], listening: Listening) -> Iterator[str]:
    """A separate server, since requests may change any record."""
    with listening(flown()) as url:
        yield url


@pytest.fixture(scope="session")
def doomed_url(flown: Callable[[], str], listening: Listening) -> Iterator[str]:
    """A separate server, since requests delete shared records."""
    with listening(flown()) as url:
        yield url
