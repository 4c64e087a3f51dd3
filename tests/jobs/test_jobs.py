"""Every run ends once, in the right state, whatever happens to workers and servers."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from flexsid.jobs.direct import carry_out
from flexsid.jobs.dispatcher import Dispatcher
from flexsid.jobs.steps import Steps
from flexsid.records.maneuver import Maneuver
from flexsid.records.model_structure import Structure
from flexsid.records.run import EstimationRun, Method, RunSettings, RunState
from flexsid.storage import queue
from flexsid.storage.store import Store

AddRun = Callable[..., EstimationRun]
PATIENCE_S = 20.0


@pytest.fixture
def steps(monkeypatch: pytest.MonkeyPatch) -> Steps:
    # The workers find the stub by the path that they inherit.
    monkeypatch.syspath_prepend(str(Path(__file__).parent))
    import stub_steps

    return Steps(stub_steps.prepare, stub_steps.compute, stub_steps.keep)


@pytest.fixture
def dispatcher(store: Store, steps: Steps) -> Iterator[Dispatcher]:
    made = Dispatcher(store, steps, count=2)
    yield made
    made.stop()


def _until(store: Store, run: EstimationRun, *states: RunState) -> EstimationRun:
    assert run.id is not None
    deadline = time.monotonic() + PATIENCE_S
    while (now := store.runs.get(run.id)).state not in states:
        assert time.monotonic() < deadline, f"still {now.state}"
        time.sleep(0.01)
    return now


def _ended(store: Store, run: EstimationRun) -> EstimationRun:
    return _until(store, run, RunState.SUCCEEDED, RunState.FAILED, RunState.CANCELLED)


def _process_of(file: Path) -> int:
    deadline = time.monotonic() + PATIENCE_S
    while not (file.exists() and file.read_text()):
        assert time.monotonic() < deadline
        time.sleep(0.01)
    return int(file.read_text())


def _alive(process: int) -> bool:
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    return True


def test_what_is_queued_is_carried_out(
    store: Store, add_run: AddRun, dispatcher: Dispatcher
) -> None:
    before = add_run(author="compute")
    dispatcher.start()
    later = [add_run(author=word) for word in ("compute", "threads", "compute")]
    dispatcher.wake()
    assert _ended(store, before).state is RunState.SUCCEEDED
    values = []
    for run in later:
        ended = _ended(store, run)
        assert ended.result is not None
        values.append(ended.result.parameters[0].value)
        assert ended.progress is not None
        assert (ended.progress.message, ended.progress.cost) == ("half way", None)
    # One BLAS thread: several workers share the cores.
    assert values == [2.0, 1.0, 2.0]


@pytest.mark.parametrize(
    ("task", "code", "words"),
    [
        ("refuse", "not-identifiable", "never moves"),
        ("unprepared", "unknown-mode", "mode 99"),
        ("stumble", "internal-error", "IndexError"),
        ("unpicklable", "internal-error", "log of the server"),
        ("crash", "worker-died", "died 3 times"),
    ],
)
def test_a_run_that_cannot_be_done_fails_in_words(
    store: Store, add_run: AddRun, dispatcher: Dispatcher, task: str, code: str, words: str
) -> None:
    run, bystander = add_run(author=task), add_run(author="compute")
    dispatcher.start()
    failed = _ended(store, run)
    assert failed.state is RunState.FAILED
    assert failed.error is not None
    assert failed.error["code"] == code
    assert words in failed.error["message"]
    assert "Traceback" not in failed.error["message"]
    assert _ended(store, bystander).state is RunState.SUCCEEDED


def test_a_killed_worker_costs_an_attempt_not_the_run(
    store: Store, add_run: AddRun, dispatcher: Dispatcher
) -> None:
    run = add_run(author="crash-once")
    dispatcher.start()
    ended = _ended(store, run)
    assert (ended.state, ended.attempt) == (RunState.SUCCEEDED, 2)


def test_cancelling_stops_the_work_at_once(
    store: Store, add_run: AddRun, dispatcher: Dispatcher, tmp_path: Path
) -> None:
    run = add_run(author=f"hold {tmp_path}/pid")
    dispatcher.start()
    worker = _process_of(tmp_path / "pid")
    assert run.id is not None
    start = time.monotonic()
    queue.request_cancel(store, run.id)
    dispatcher.wake()
    while _alive(worker):
        assert time.monotonic() - start < 5.0
        time.sleep(0.01)
    following = add_run(author="compute")
    dispatcher.wake()
    assert _ended(store, following).state is RunState.SUCCEEDED
    assert store.runs.get(run.id).state is RunState.CANCELLED


def test_stopping_is_quick_and_leaves_the_run_for_the_next_server(
    store: Store, add_run: AddRun, steps: Steps, tmp_path: Path
) -> None:
    first = Dispatcher(store, steps, count=1)
    run = add_run(author=f"hold {tmp_path}/pid")
    first.start()
    worker = _process_of(tmp_path / "pid")
    start = time.monotonic()
    first.stop()
    first.stop()
    assert time.monotonic() - start < 1.0
    assert not _alive(worker)
    assert _until(store, run, RunState.QUEUED).attempt == 1


def test_a_killed_server_leaves_no_orphans_and_its_runs_resume(
    store: Store, add_run: AddRun, steps: Steps, database_url: str, tmp_path: Path
) -> None:
    run = add_run(author=f"hold {tmp_path}/pid")
    server = subprocess.Popen(
        [sys.executable, str(Path(__file__).with_name("stub_server.py")), database_url],
        env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
    )
    worker = _process_of(tmp_path / "pid")
    server.send_signal(signal.SIGKILL)
    server.wait()
    deadline = time.monotonic() + 5.0
    while _alive(worker):
        assert time.monotonic() < deadline
        time.sleep(0.01)
    assert _until(store, run, RunState.RUNNING).attempt == 1
    following = Dispatcher(store, steps, count=1)
    following.start()
    (tmp_path / "pid").unlink()
    _process_of(tmp_path / "pid")
    assert _until(store, run, RunState.RUNNING).attempt == 2
    following.stop()


def test_one_run_can_be_carried_out_without_a_server(
    store: Store, maneuver: Maneuver, steps: Steps
) -> None:
    said: list[str] = []
    assert maneuver.id is not None
    wanted = EstimationRun(
        maneuver_id=maneuver.id,
        method=Method.EE,
        structure=Structure(fixed={}),
        settings=RunSettings(),
    )

    def state(task: str) -> RunState:
        run = replace(wanted, author=task)
        return carry_out(store, run, steps, lambda progress: said.append(progress.message)).state

    assert state("compute") is RunState.SUCCEEDED
    assert state("refuse") is RunState.FAILED
    assert state("stumble") is RunState.FAILED
    assert said == ["half way"] * 3
