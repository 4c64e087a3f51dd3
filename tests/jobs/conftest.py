"""A stub pipeline controlled by its tasks, and both kinds of workers to execute it."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import dask_cluster
import pytest
from waiting import wait_until

from flexsid.jobs.dispatcher import Dispatcher
from flexsid.jobs.executors import make_workers
from flexsid.jobs.pipeline import JobPipeline
from flexsid.records.run import EstimationRun, RunState
from flexsid.storage.store import Store

HERE = Path(__file__).parent
Until = Callable[..., EstimationRun]


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark all but one combination of executor and database of each fault as long.

    ``make test-long`` runs all combinations.
    """
    cases: dict[str, list[pytest.Function]] = {}
    for item in items:
        if isinstance(item, pytest.Function) and item.path.parent == HERE:
            own = {k: v for k, v in _parameters(item).items() if k not in ("executor", "backend")}
            cases.setdefault(f"{item.path.name}::{item.originalname}{own}", []).append(item)
    for place, combinations in enumerate(cases.values()):
        for k, item in enumerate(combinations):
            if k != place % len(combinations):
                item.add_marker(pytest.mark.long)


def _parameters(item: pytest.Function) -> dict[str, object]:
    return item.callspec.params if hasattr(item, "callspec") else {}


@pytest.fixture(scope="session")
def cluster(tmp_path_factory: pytest.TempPathFactory) -> Iterator[dask_cluster.Cluster]:
    """A Dask scheduler with two workers of one thread each."""
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
def pipeline(monkeypatch: pytest.MonkeyPatch) -> JobPipeline:
    # The workers find the stub by the path that they inherit.
    monkeypatch.syspath_prepend(str(HERE))
    import stub_pipeline

    return stub_pipeline.load()


@pytest.fixture
def dispatcher(store: Store, pipeline: JobPipeline, executor: str | None) -> Iterator[Dispatcher]:
    made = Dispatcher(store, pipeline, make_workers(pipeline.compute, executor, 2))
    yield made
    made.stop()


@pytest.fixture
def until(store: Store) -> Until:
    """Wait until a run is in one of some states, by default ended, and return it."""

    def wait(run: EstimationRun, *states: RunState) -> EstimationRun:
        assert run.id is not None
        states = states or (RunState.SUCCEEDED, RunState.FAILED, RunState.CANCELLED)
        identity = run.id
        wait_until(lambda: store.runs.get(identity).state in states, f"run {identity} in {states}")
        return store.runs.get(identity)

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
            ],
            env={**os.environ, "PYTHONPATH": os.pathsep.join([str(HERE), *sys.path])},
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
