"""The dispatcher in a process of its own."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from waiting import PATIENCE_S, wait_until

from flexsid.errors import FlexsidError
from flexsid.jobs.apart import DispatcherApart, Duty
from flexsid.jobs.steps import Steps
from flexsid.records.run import EstimationRun, RunState
from flexsid.storage import leases
from flexsid.storage.store import Store

HERE = Path(__file__).parent

SERVER = """
import sys, time
import stub_steps
from flexsid.jobs.apart import DispatcherApart, Duty

dispatcher = DispatcherApart(Duty(sys.argv[1], stub_steps.load, workers=1))
dispatcher.start()
dispatcher.wake()
time.sleep(120)
"""


@pytest.fixture
def duty(database_url: str, steps: Steps) -> Duty:
    import stub_steps

    return Duty(database_url, stub_steps.load, workers=1)


@pytest.fixture
def changed() -> threading.Event:
    return threading.Event()


@pytest.fixture
def apart(duty: Duty, changed: threading.Event) -> Iterator[DispatcherApart]:
    made = DispatcherApart(duty, changed.set)
    made.start()
    yield made
    made.stop()


def test_what_is_queued_is_carried_out_and_the_server_hears_of_it(
    add_run: Callable[..., EstimationRun],
    until: Callable[..., EstimationRun],
    apart: DispatcherApart,
    changed: threading.Event,
) -> None:
    apart.wake()
    assert changed.wait(PATIENCE_S)  # it has begun
    changed.clear()
    run = add_run(author="compute")
    apart.wake()
    assert until(run).state is RunState.SUCCEEDED
    assert changed.wait(PATIENCE_S)


def test_a_run_goes_on_when_its_dispatcher_is_killed(
    store: Store,
    add_run: Callable[..., EstimationRun],
    until: Callable[..., EstimationRun],
    process_of: Callable[[Path], int],
    is_over: Callable[[int], None],
    apart: DispatcherApart,
    tmp_path: Path,
) -> None:
    run = add_run(author=f"hold-once {tmp_path}/pid")
    apart.wake()
    worker = process_of(tmp_path / "pid")
    os.kill(_dispatcher(store), signal.SIGKILL)
    is_over(worker)
    ended = until(run)
    assert (ended.state, ended.attempt) == (RunState.SUCCEEDED, 2)


def test_stopping_leaves_no_process_and_the_run_for_the_next_server(
    store: Store,
    add_run: Callable[..., EstimationRun],
    until: Callable[..., EstimationRun],
    process_of: Callable[[Path], int],
    is_over: Callable[[int], None],
    duty: Duty,
    tmp_path: Path,
) -> None:
    run = add_run(author=f"hold {tmp_path}/pid")
    apart = DispatcherApart(duty)
    apart.start()
    apart.wake()
    worker, dispatcher = process_of(tmp_path / "pid"), _dispatcher(store)
    apart.stop()
    is_over(worker)
    is_over(dispatcher)
    assert until(run, RunState.QUEUED).attempt == 1


def test_it_ends_with_a_server_that_is_killed(
    store: Store,
    add_run: Callable[..., EstimationRun],
    until: Callable[..., EstimationRun],
    process_of: Callable[[Path], int],
    is_over: Callable[[int], None],
    database_url: str,
    tmp_path: Path,
) -> None:
    run = add_run(author=f"hold {tmp_path}/pid")
    path = os.pathsep.join([str(HERE), *sys.path])
    server = subprocess.Popen(
        [sys.executable, "-c", SERVER, database_url], env={**os.environ, "PYTHONPATH": path}
    )
    try:
        worker, dispatcher = process_of(tmp_path / "pid"), _dispatcher(store)
    finally:
        server.kill()
        server.wait()
    is_over(worker)
    is_over(dispatcher)
    assert until(run, RunState.QUEUED).attempt == 1


def test_a_server_without_its_cluster_does_not_start(
    steps: Steps, monkeypatch: pytest.MonkeyPatch
) -> None:
    import stub_steps

    monkeypatch.setattr("flexsid.jobs.cluster._CONNECT_S", 0.2)
    apart = DispatcherApart(Duty("", stub_steps.load, dask="tcp://127.0.0.1:1"))
    with pytest.raises(FlexsidError, match="no Dask scheduler answers"):
        apart.start()


def _dispatcher(store: Store) -> int:
    """Number of the process that has the lease."""
    holder = wait_until(lambda: leases.read(store).holder, "a dispatcher")
    return int(holder.split(" ")[2])
