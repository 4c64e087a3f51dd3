"""Every route conforms to the OpenAPI description for generated requests.

On both databases, since one may refuse values that the other accepts. What draws or reports a
record, which reads it by its number, is on PostgreSQL in `make test-long` only.
"""

from __future__ import annotations

import shutil
import uuid
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from postgresql import Cluster
from tests.conftest import Listening

from flexsid.api.permissions import PERMISSIONS, Permission

schemathesis = pytest.importorskip("schemathesis", reason="schemathesis is not installed")

# The server runs in the process of the test and draws random numbers of its own.
pytestmark = pytest.mark.filterwarnings("ignore:Do not use the `random` module")

LENIENT = [
    # Valid requests may be refused: the record may not exist.
    schemathesis.checks.positive_data_acceptance,
]
# A stream without end, and 503 without dispatcher, as here (see test_operations).
OTHERS = {"stream_events", "check_readiness"}
bounded = settings(
    max_examples=2,  # on each of two databases
    derandomize=True,
    database=None,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.filter_too_much],
)


Operations = Mapping[str, Any]


NAMES = sorted(PERMISSIONS.keys() - OTHERS)
SHOWN = [
    name
    for name in NAMES
    if name.startswith(("draw_", "get_", "report_", "print_", "download_"))
    and PERMISSIONS[name] is Permission.VIEWER
]


# One operation after the other is prepared in its test: all of them take seconds, of each process
# that collects tests.
@pytest.mark.parametrize("name", [name for name in NAMES if name not in SHOWN])
@pytest.mark.parametrize("flown", ["sqlite", "postgresql"], indirect=True, scope="session")
def test_route_conforms_to_description(
    name: str, operations: Operations, changed_url: str, doomed_url: str
) -> None:
    check_conformity(operations[name], changed_url, doomed_url)


@pytest.mark.parametrize("name", SHOWN)
@pytest.mark.parametrize(
    "flown",
    ["sqlite", pytest.param("postgresql", marks=pytest.mark.long)],
    indirect=True,
    scope="session",
)
def test_route_that_shows_a_record_conforms_to_description(
    name: str, operations: Operations, changed_url: str, doomed_url: str
) -> None:
    check_conformity(operations[name], changed_url, doomed_url)


def check_conformity(operation: Any, changed_url: str, doomed_url: str) -> None:
    """Send a request of each example, and generated ones."""
    url = doomed_url if operation.method == "delete" else changed_url

    def conform(case: Any) -> None:
        case.call_and_validate(base_url=url, timeout=300, excluded_checks=LENIENT)

    for example in operation.get_strategies_from_examples():
        settings(bounded, max_examples=1)(given(case=example)(conform))()
    bounded(given(case=operation.as_strategy())(conform))()


@pytest.fixture(scope="module")
def operations() -> Operations:
    """The operations of the description by their ids."""
    from interface import DESCRIPTION

    schema = schemathesis.openapi.from_dict(DESCRIPTION)
    return {
        operation["operationId"]: schema[path][method]
        for path, methods in DESCRIPTION["paths"].items()
        for method, operation in methods.items()
    }


@pytest.fixture(scope="session")
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
