"""Stub kinds of jobs controlled by their requests, and both sorts of workers to execute them."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import dask_cluster
import pytest
from interpreter import make_interpreter
from waiting import wait_until

from flexsid.jobs.dispatcher import Dispatcher
from flexsid.jobs.dispatcher_process import make_workers
from flexsid.jobs.kinds import KINDS
from flexsid.jobs.worker import LoadKinds
from flexsid.records.job import NEW_JOB, Job
from flexsid.records.run import EstimationRun, RunState
from flexsid.storage.jobs import queue
from flexsid.storage.lists.run_list import ESTIMATION
from flexsid.storage.store import Store

HERE = Path(__file__).parent
AddJob = Callable[..., Job]
Until = Callable[..., Job]


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark all but one combination of kind, executor and database of each fault as long.

    ``make test-long`` runs all combinations.
    """
    cases: dict[str, list[pytest.Function]] = {}
    for item in items:
        if isinstance(item, pytest.Function) and item.path.parent == HERE:
            own = {
                k: v
                for k, v in _parameters(item).items()
                if k not in ("executor", "backend", "kind")
            }
            cases.setdefault(f"{item.path.name}::{item.originalname}{own}", []).append(item)
    for index, combinations in enumerate(cases.values()):
        for k, item in enumerate(combinations):
            if k != index % len(combinations):
                item.add_marker(pytest.mark.long)


def _parameters(item: pytest.Function) -> dict[str, object]:
    return item.callspec.params if hasattr(item, "callspec") else {}


@pytest.fixture(scope="session")
def interpreter(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A Python into which the stub kinds are installed."""
    return make_interpreter(tmp_path_factory.mktemp("interpreter"), HERE)


@pytest.fixture(scope="module", autouse=True)
def _run_by_interpreter(interpreter: Path) -> Iterator[None]:
    """Run servers, dispatchers and workers of these tests by it."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(sys, "executable", str(interpreter))
        yield


@pytest.fixture(scope="session")
def cluster(
    interpreter: Path, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[dask_cluster.Cluster]:
    """A Dask scheduler with two workers of one thread each, which run by the interpreter."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(sys, "executable", str(interpreter))
        made = dask_cluster.Cluster(tmp_path_factory.mktemp("dask"), path=HERE)
    yield made
    made.close()


@pytest.fixture(params=["local", "cluster"])
def executor(request: pytest.FixtureRequest) -> str | None:
    """Address of a Dask scheduler, or None for processes of this computer."""
    if request.param == "local":
        return None
    made: dask_cluster.Cluster = request.getfixturevalue("cluster")
    while len([w for w in made.workers if w.poll() is None]) < 2:
        made.add_worker()
    made.wait_for(2)
    return made.address


@pytest.fixture
def load_stub(monkeypatch: pytest.MonkeyPatch) -> LoadKinds:
    # The workers find the stub by the path that they inherit.
    monkeypatch.syspath_prepend(str(HERE))
    import stub_kinds

    return stub_kinds.load


@pytest.fixture
def dispatcher(store: Store, load_stub: LoadKinds, executor: str | None) -> Iterator[Dispatcher]:
    made = Dispatcher(store, load_stub(), make_workers(load_stub, executor, 2))
    yield made
    made.stop()


@pytest.fixture(params=sorted(KINDS))
def kind(request: pytest.FixtureRequest) -> str:
    """Name of a kind of job."""
    return request.param


@pytest.fixture
def add_job(store: Store, add_run: Callable[..., EstimationRun], kind: str) -> AddJob:
    """Queue a job of the kind whose request states what happens; keywords change its fields."""

    def add(text: str, **changes: Any) -> Job:
        if kind == ESTIMATION:
            return store.jobs.get(add_run(author=text, **changes).id or 0)
        return queue.add_job(store, replace(NEW_JOB, kind=kind, request={"text": text}, **changes))

    return add


@pytest.fixture
def until(store: Store) -> Until:
    """Wait until a job is in one of some states, by default ended, and return it."""

    def wait(job: Job | EstimationRun, *states: RunState) -> Job:
        assert job.id is not None
        identity, states = job.id, states or queue.ENDED
        wait_until(lambda: store.jobs.get(identity).state in states, f"job {identity} in {states}")
        return store.jobs.get(identity)

    return wait


@pytest.fixture
def start_server(
    database_url: str, executor: str | None
) -> Iterator[Callable[..., subprocess.Popen[bytes]]]:
    """Start a server of its own on the test's database, with one worker."""
    started: list[subprocess.Popen[bytes]] = []

    def start(lease_timeout_s: float = 60.0) -> subprocess.Popen[bytes]:
        server = subprocess.Popen(
            [
                *(sys.executable, str(HERE / "stub_server.py")),
                *(database_url, executor or "", str(lease_timeout_s)),
            ]
        )
        started.append(server)
        return server

    yield start
    for server in started:
        server.kill()
        server.wait()


@pytest.fixture
def process_of() -> Callable[[Path], int]:
    """Wait until a task has written its process number into a file, and return it."""

    def wait(file: Path) -> int:
        return int(wait_until(lambda: file.exists() and file.read_text(), "the start of the task"))

    return wait


@pytest.fixture
def is_over() -> Callable[[int], None]:
    """Fail unless a process ends soon."""

    def wait(process: int) -> None:
        wait_until(lambda: not _alive(process), f"the end of process {process}")

    return wait


def _alive(process: int) -> bool:
    try:
        state = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0]
    except OSError:
        return False
    return state != "Z"
