"""Every job ends exactly once, in the right state, despite faults of workers and servers."""

from __future__ import annotations

import os
import signal
import sqlite3
import subprocess
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
import sqlalchemy as sa
from sqlalchemy import event

from flexsid.jobs import child
from flexsid.jobs.dispatcher import Dispatcher, execute_run
from flexsid.jobs.dispatcher_process import make_workers
from flexsid.jobs.worker import LoadKinds
from flexsid.records.decision import Structure
from flexsid.records.job import Job
from flexsid.records.maneuver import Maneuver
from flexsid.records.run import EstimationRun, Limits, Method, RunSettings, RunState
from flexsid.storage.files import DatabaseUnavailable
from flexsid.storage.jobs import job_log, queue
from flexsid.storage.store import Store

AddRun = Callable[..., EstimationRun]
AddJob = Callable[..., Job]
Until = Callable[..., Job]
ProcessOf = Callable[[Path], int]
IsOver = Callable[[int], None]
StartServer = Callable[..., subprocess.Popen[bytes]]


def _kinds(store: Store, job: Job | EstimationRun) -> list[str]:
    assert job.id is not None
    return [line.kind for line in job_log.read_log(store, job.id) if line.kind != "logged"]


def test_queued_runs_are_executed(
    store: Store, add_run: AddRun, dispatcher: Dispatcher, until: Until
) -> None:
    before = add_run(author="compute")
    dispatcher.start()
    later = [add_run(author=word) for word in ("compute", "threads", "compute")]
    dispatcher.wake()
    assert until(before).state is RunState.SUCCEEDED
    values = []
    for run in later:
        until(run)
        ended = store.runs.get(run.id or 0)
        assert ended.result is not None
        values.append(ended.result.parameters[0].value)
        assert ended.progress is not None
        assert (ended.progress.message, ended.progress.cost) == ("half way", None)
        assert ended.worker
        assert _kinds(store, run) == ["queued", "started", "succeeded"]
    # One BLAS thread: several workers share the cores.
    assert values == [2.0, 1.0, 2.0]


_FAILURES = {
    "refuse": ("not-identifiable", "never moves"),
    "unprepared": ("unknown-mode", "mode 99"),
    "stumble": ("internal-error", "IndexError"),
    "unpicklable": ("internal-error", "log of the server"),
    "crash": ("worker-died", "died 3 times"),
    "segfault": ("worker-died", "signal 11"),
    "devour": ("out-of-memory", "memory limit"),
    "sleep": ("time-limit", "longer than 0.5 s"),
}


def test_failed_runs_have_a_code_and_a_message_and_stop_no_other(
    store: Store, add_job: AddJob, dispatcher: Dispatcher, until: Until
) -> None:
    runs = {
        task: add_job(task, limits=Limits(time_s=0.5 if task == "sleep" else None, memory_mb=500))
        for task in _FAILURES
    }
    bystander = add_job("compute")
    dispatcher.start()
    for task, (code, words) in _FAILURES.items():
        failed = until(runs[task])
        assert failed.state is RunState.FAILED, task
        assert failed.error is not None
        assert failed.error["code"] == code, task
        assert words in failed.error["message"]
        assert "Traceback" not in failed.error["message"]
    assert until(bystander).state is RunState.SUCCEEDED


def test_an_endless_loop_is_stopped_and_leaves_no_process(
    store: Store,
    add_job: AddJob,
    dispatcher: Dispatcher,
    until: Until,
    process_of: ProcessOf,
    is_over: IsOver,
    tmp_path: Path,
) -> None:
    run = add_job(f"loop {tmp_path}/pid", limits=Limits(time_s=2.0))
    dispatcher.start()
    worker = process_of(tmp_path / "pid")
    assert until(run).state is RunState.FAILED
    is_over(worker)
    assert _kinds(store, run) == ["queued", "started", "failed"]


def test_a_killed_worker_costs_an_attempt_not_the_job(
    add_job: AddJob, dispatcher: Dispatcher, until: Until, tmp_path: Path
) -> None:
    run = add_job(f"crash-once {tmp_path}/pid")
    dispatcher.start()
    ended = until(run)
    assert (ended.state, ended.attempt) == (RunState.SUCCEEDED, 2)


@pytest.mark.parametrize("executor", ["local"], indirect=True)
def test_a_worker_that_cannot_start_costs_an_attempt_not_the_job(
    add_job: AddJob, dispatcher: Dispatcher, until: Until, monkeypatch: pytest.MonkeyPatch
) -> None:
    left = [OSError("Resource temporarily unavailable")]

    def refuse_once(load_kinds: LoadKinds) -> child.Child:
        if left:
            raise left.pop()
        return started(load_kinds)

    started = child.Child
    monkeypatch.setattr(child, "Child", refuse_once)
    run = add_job("compute")
    dispatcher.start()
    ended = until(run)
    assert (ended.state, ended.attempt) == (RunState.SUCCEEDED, 2)


def test_a_task_that_cannot_be_sent_fails(
    add_job: AddJob, dispatcher: Dispatcher, until: Until, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(*task: Any) -> None:
        raise ValueError("no such task")

    run = add_job("compute")
    monkeypatch.setattr(dispatcher._workers, "submit", refuse)
    dispatcher.start()
    assert until(run).state is RunState.FAILED


def test_cancelling_stops_the_work_at_once(
    store: Store,
    add_job: AddJob,
    dispatcher: Dispatcher,
    until: Until,
    process_of: ProcessOf,
    is_over: IsOver,
    tmp_path: Path,
) -> None:
    run = add_job(f"hold {tmp_path}/pid")
    dispatcher.start()
    worker = process_of(tmp_path / "pid")
    assert run.id is not None
    queue.request_cancel(store, run.id)
    dispatcher.wake()
    is_over(worker)
    following = add_job("compute")
    dispatcher.wake()
    assert until(following).state is RunState.SUCCEEDED
    assert store.jobs.get(run.id).state is RunState.CANCELLED


def test_stopping_is_quick_and_leaves_the_run_for_the_next_server(
    store: Store,
    add_job: AddJob,
    dispatcher: Dispatcher,
    until: Until,
    process_of: ProcessOf,
    is_over: IsOver,
    tmp_path: Path,
) -> None:
    run = add_job(f"hold {tmp_path}/pid")
    dispatcher.start()
    worker = process_of(tmp_path / "pid")
    dispatcher.stop()  # the task would hold for minutes
    dispatcher.stop()
    is_over(worker)
    assert until(run, RunState.QUEUED).attempt == 1


def test_the_most_urgent_starts_first(
    store: Store, load_stub: LoadKinds, add_run: AddRun, until: Until
) -> None:
    single = Dispatcher(store, load_stub(), make_workers(load_stub, None, 1))
    runs = [add_run(author="compute", priority=k) for k in (0, 5, -1, 5)]
    single.start()
    ended = [until(run) for run in runs]
    single.stop()
    order = sorted(range(4), key=lambda k: ended[k].started_at or 0)  # type: ignore[arg-type]
    assert order == [1, 3, 0, 2]


def test_a_run_waits_for_the_one_it_starts_from(
    store: Store, add_run: AddRun, dispatcher: Dispatcher, until: Until
) -> None:
    first = add_run(author="brief")
    second = add_run(author="compute", after_run_id=first.id, priority=9)
    dispatcher.start()
    ended, begun = until(second), until(first)
    assert ended.state is RunState.SUCCEEDED
    assert ended.started_at is not None
    assert begun.finished_at is not None
    assert ended.started_at >= begun.finished_at


def test_runs_that_depend_on_a_failed_run_fail_and_can_be_retried(
    store: Store, add_run: AddRun, dispatcher: Dispatcher, until: Until
) -> None:
    first = add_run(author="refuse")
    second = add_run(author="compute", after_run_id=first.id)
    third = add_run(author="compute", after_run_id=second.id)
    dispatcher.start()
    for run in (second, third):
        ended = until(run)
        assert (ended.state, ended.attempt) == (RunState.FAILED, 0)
        assert ended.error is not None
        assert ended.error["code"] == "start-missing"
    assert first.id is not None
    store.runs.replace(replace(store.runs.get(first.id), author="compute"))
    assert queue.retry(store, [run.id for run in (first, second, third) if run.id]) == 3
    dispatcher.wake()
    assert until(third, RunState.SUCCEEDED).attempt == 1


def test_a_run_can_be_executed_without_a_server(
    store: Store, maneuver: Maneuver, load_stub: LoadKinds
) -> None:
    messages: list[str] = []
    assert maneuver.id is not None
    requested = EstimationRun(
        maneuver_id=maneuver.id,
        method=Method.EE,
        structure=Structure(fixed={}),
        settings=RunSettings(),
    )

    def state(task: str) -> RunState:
        run = replace(requested, author=task)
        return execute_run(
            store,
            run,
            load_stub()["estimation"],
            lambda progress: messages.append(progress.message),
        ).state

    assert state("compute") is RunState.SUCCEEDED
    assert state("refuse") is RunState.FAILED
    assert state("stumble") is RunState.FAILED
    assert messages == ["half way"] * 3


def test_a_full_disk_loses_no_result(
    store: Store, add_job: AddJob, dispatcher: Dispatcher, until: Until, backend: str
) -> None:
    run = add_job("brief")
    lift = _fill_disk(store, backend)
    dispatcher.start()
    until(run, RunState.RUNNING)
    time.sleep(2.0)  # the result is computed meanwhile and cannot be stored
    assert run.id is not None
    assert store.jobs.get(run.id).state is RunState.RUNNING
    lift()
    ended = until(run)
    assert (ended.state, ended.attempt) == (RunState.SUCCEEDED, 1)


def test_a_claim_that_was_stored_but_not_confirmed_is_repeated(
    store: Store,
    add_job: AddJob,
    dispatcher: Dispatcher,
    until: Until,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    claim, lost = queue.claim, []

    def lose(*known: Any, **options: Any) -> Job | None:
        run = claim(*known, **options)
        if run is not None and not lost:
            lost.append(run)
            raise DatabaseUnavailable("the connection is gone")
        return run

    monkeypatch.setattr(queue, "claim", lose)
    run = add_job("compute")
    dispatcher.start()
    ended = until(run)
    assert (ended.state, ended.attempt) == (RunState.SUCCEEDED, 2)
    assert _kinds(store, run) == ["queued", "started", "queued", "started", "succeeded"]


def _fill_disk(store: Store, backend: str) -> Callable[[], None]:
    """Refuse to store results; progress and leases still fit into the reserved space."""
    if backend == "sqlite":

        def refuse(connection, cursor, statement, parameters, context, executemany) -> None:
            if statement.startswith("INSERT INTO arrays"):
                raise sqlite3.OperationalError("database or disk is full")

        event.listen(store.database.engine, "before_cursor_execute", refuse)
        return lambda: event.remove(store.database.engine, "before_cursor_execute", refuse)
    with store.database.transaction() as connection:
        connection.execute(
            sa.text(
                "CREATE FUNCTION full_disk() RETURNS trigger LANGUAGE plpgsql AS $$ BEGIN"
                " RAISE EXCEPTION 'could not extend file' USING ERRCODE = '53100'; END $$"
            )
        )
        connection.execute(
            sa.text(
                "CREATE TRIGGER full_disk BEFORE INSERT ON arrays"
                " FOR EACH ROW EXECUTE FUNCTION full_disk()"
            )
        )

    def lift() -> None:
        with store.database.transaction() as connection:
            connection.execute(sa.text("DROP TRIGGER full_disk ON arrays"))

    return lift


def test_a_killed_server_leaves_no_orphans_and_its_runs_resume(
    store: Store,
    add_job: AddJob,
    start_server: StartServer,
    dispatcher: Dispatcher,
    until: Until,
    process_of: ProcessOf,
    is_over: IsOver,
    tmp_path: Path,
) -> None:
    run = add_job(f"hold {tmp_path}/pid")
    server = start_server()
    worker = process_of(tmp_path / "pid")
    os.kill(server.pid, signal.SIGKILL)
    server.wait()
    is_over(worker)
    assert until(run, RunState.RUNNING).attempt == 1
    (tmp_path / "pid").unlink()
    dispatcher.start()
    process_of(tmp_path / "pid")
    assert until(run, RunState.RUNNING).attempt == 2


def test_a_stopped_server_loses_the_lease_and_detects_it_when_continued(
    store: Store,
    add_job: AddJob,
    start_server: StartServer,
    until: Until,
    process_of: ProcessOf,
    is_over: IsOver,
    tmp_path: Path,
) -> None:
    held = add_job(f"hold-once {tmp_path}/pid")
    first = start_server(lease_timeout_s=4.0)
    frozen_worker = process_of(tmp_path / "pid")
    start_server(lease_timeout_s=4.0)
    with store.database.transaction():
        # Stopped within a transaction of its own it would hold the lock of SQLite.
        os.kill(first.pid, signal.SIGSTOP)
    others = [add_job("compute") for _ in range(5)]
    for run in (held, *others):
        assert until(run, RunState.SUCCEEDED)
    os.kill(first.pid, signal.SIGCONT)
    is_over(frozen_worker)
    late = [add_job("compute") for _ in range(5)]
    for run in late:
        assert until(run).attempt == 1
    assert store.jobs.get(held.id or 0).attempt == 2
    for run in (held, *others, *late):
        assert _kinds(store, run).count("succeeded") == 1
