"""The dispatcher in a separate process."""

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
from flexsid.jobs.dispatcher_process import DispatcherProcess, DispatcherSettings
from flexsid.jobs.worker import LoadKinds
from flexsid.records.job import Job
from flexsid.records.run import RunState
from flexsid.storage.jobs import leases
from flexsid.storage.jobs.queue import MOST_DEATHS
from flexsid.storage.store import Store

HERE = Path(__file__).parent

SERVER = """
import sys, time
import stub_kinds
from flexsid.jobs.dispatcher_process import DispatcherProcess, DispatcherSettings

dispatcher = DispatcherProcess(DispatcherSettings(sys.argv[1], stub_kinds.load, workers=1))
dispatcher.start()
dispatcher.wake()
time.sleep(120)
"""


@pytest.fixture
def settings(database_url: str, load_stub: LoadKinds) -> DispatcherSettings:
    import stub_kinds

    return DispatcherSettings(database_url, stub_kinds.load, workers=1)


@pytest.fixture
def changed() -> threading.Event:
    return threading.Event()


@pytest.fixture
def process(settings: DispatcherSettings, changed: threading.Event) -> Iterator[DispatcherProcess]:
    made = DispatcherProcess(settings, changed.set)
    made.start()
    yield made
    made.stop()


def test_queued_runs_are_executed_and_the_server_is_notified(
    add_job: Callable[..., Job],
    until: Callable[..., Job],
    process: DispatcherProcess,
    changed: threading.Event,
) -> None:
    assert process.is_starting
    process.wake()
    assert changed.wait(PATIENCE_S)  # it has begun
    assert not process.is_starting
    changed.clear()
    run = add_job("compute")
    process.wake()
    assert until(run).state is RunState.SUCCEEDED
    assert changed.wait(PATIENCE_S)


def test_a_run_is_resumed_after_its_dispatcher_is_killed(
    store: Store,
    add_job: Callable[..., Job],
    until: Callable[..., Job],
    process_of: Callable[[Path], int],
    is_over: Callable[[int], None],
    process: DispatcherProcess,
    tmp_path: Path,
) -> None:
    run = add_job(f"hold-once {tmp_path}/pid")
    process.wake()
    worker = process_of(tmp_path / "pid")
    os.kill(_dispatcher(store), signal.SIGKILL)
    is_over(worker)
    ended = until(run)
    assert (ended.state, ended.attempt) == (RunState.SUCCEEDED, 2)


def test_workers_that_are_stopped_do_not_count_against_their_job(
    add_job: Callable[..., Job],
    until: Callable[..., Job],
    process_of: Callable[[Path], int],
    is_over: Callable[[int], None],
    process: DispatcherProcess,
    tmp_path: Path,
) -> None:
    """A system that stops a service sends SIGTERM to each of its processes."""
    pid = tmp_path / "pid"
    run = add_job(f"hold {pid}")
    process.wake()
    for _ in range(MOST_DEATHS):
        worker = process_of(pid)
        pid.unlink()
        os.kill(worker, signal.SIGTERM)
        is_over(worker)
    process_of(pid)
    found = until(run, RunState.RUNNING)
    assert (found.attempt, found.error) == (MOST_DEATHS + 1, None)


def test_stopping_leaves_no_process_and_queues_the_run_again(
    store: Store,
    add_job: Callable[..., Job],
    until: Callable[..., Job],
    process_of: Callable[[Path], int],
    is_over: Callable[[int], None],
    settings: DispatcherSettings,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    # On a loaded machine it may take longer than the server waits before it kills the process,
    # and the job of a killed dispatcher stays marked as running until the next server starts.
    monkeypatch.setattr("flexsid.jobs.dispatcher_process._STOP_S", PATIENCE_S)
    run = add_job(f"hold {tmp_path}/pid")
    process = DispatcherProcess(settings)
    process.start()
    process.wake()
    worker, dispatcher = process_of(tmp_path / "pid"), _dispatcher(store)
    process.stop()
    is_over(worker)
    is_over(dispatcher)
    assert until(run, RunState.QUEUED).attempt == 1


def test_it_ends_with_a_server_that_is_killed(
    store: Store,
    add_job: Callable[..., Job],
    until: Callable[..., Job],
    process_of: Callable[[Path], int],
    is_over: Callable[[int], None],
    database_url: str,
    tmp_path: Path,
) -> None:
    run = add_job(f"hold {tmp_path}/pid")
    server = subprocess.Popen([sys.executable, "-c", SERVER, database_url])
    try:
        worker, dispatcher = process_of(tmp_path / "pid"), _dispatcher(store)
    finally:
        server.kill()
        server.wait()
    is_over(worker)
    is_over(dispatcher)
    assert until(run, RunState.QUEUED).attempt == 1


def test_a_server_without_its_cluster_does_not_start(
    load_stub: LoadKinds, monkeypatch: pytest.MonkeyPatch
) -> None:
    import stub_kinds

    monkeypatch.setattr("flexsid.jobs.cluster._CONNECT_S", 0.2)
    process = DispatcherProcess(DispatcherSettings("", stub_kinds.load, dask="tcp://127.0.0.1:1"))
    with pytest.raises(FlexsidError, match="no Dask scheduler responds"):
        process.start()


def _dispatcher(store: Store) -> int:
    """Return the PID of the process that has the lease."""
    holder = wait_until(lambda: leases.read(store).holder, "a dispatcher")
    return int(holder.split(" ")[2])
