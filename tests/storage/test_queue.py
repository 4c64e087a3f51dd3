"""State transitions of a run occur once; messages of outdated attempts have no effect."""

from __future__ import annotations

import random
import threading
from collections.abc import Callable
from dataclasses import replace
from datetime import UTC, datetime, timedelta

import pytest
import sqlalchemy as sa

from flexsid.errors import Conflict
from flexsid.records.job import NEW_JOB
from flexsid.records.run import (
    Batch,
    EstimationRun,
    Fit,
    Method,
    ParameterEstimate,
    Progress,
    RunResult,
    RunState,
)
from flexsid.storage.jobs import batches, job_list, queue
from flexsid.storage.store import Store
from flexsid.storage.tables import jobs

AddRun = Callable[..., EstimationRun]
RESULT = RunResult(
    parameters=(ParameterEstimate(name="Cm_q", value=-3.0, std_error=None),),
    covariance="0" * 64,
    fit=Fit(
        outcome="converged",
        message="",
        iterations=(),
        cost=None,
        r_squared={"q": 0.9},
        n_lines=3,
        n_parameters=1,
        seconds=0.1,
        start="equation-error",
    ),
    poles=(),
    blocks=(),
)


def _claimed(store: Store, run: EstimationRun) -> EstimationRun:
    claimed = queue.claim(store)
    assert claimed is not None
    assert claimed.id == run.id
    return store.runs.get(claimed.id or 0)


def test_runs_are_claimed_oldest_first_each_once(store: Store, add_run: AddRun) -> None:
    ids = [add_run().id for _ in range(30)]
    claimed: list[int | None] = []

    def take() -> None:
        while (run := queue.claim(store)) is not None:
            claimed.append(run.id)

    threads = [threading.Thread(target=take) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(claimed) == 30
    assert set(claimed) == set(ids)


def test_the_next_job_is_the_least_of_all_queued_ones(store: Store) -> None:
    """The same as by sorting every queued job, for queues of any composition."""
    rng = random.Random(7)
    for _ in range(60):
        job = replace(
            NEW_JOB,
            kind="run",
            author=rng.choice(["Ann", "Bo", ""]),
            priority=rng.choice([-1, 0, 2]),
        )
        earlier = rng.choice([None, None, *(one.id for one in store.jobs.find()[-3:])])
        queue.add_job(store, replace(job, after_job_id=earlier))
    while (queued := store.jobs.find(state="queued")) and queue.find_next(store, {}):
        states = {one.id: one.state for one in store.jobs.find()}
        authors = [one.author for one in store.jobs.find(state="running")]
        served = {name: rng.random() for name in ("Ann", "Bo")}
        ready = [
            one for one in queued if states.get(one.after_job_id) in (None, RunState.SUCCEEDED)
        ]
        least = min(
            ready,
            key=lambda one: (
                *(-one.priority, authors.count(one.author), served.get(one.author, 0.0)),
                one.id,
            ),
        )
        assert queue.find_next(store, served) == least.id
        claimed = queue.claim(store, least.id)
        assert claimed is not None
        if rng.random() < 0.7:
            queue.finish_job(store, least.id or 0, claimed.attempt, {}, {})


def test_an_analyst_does_not_wait_for_the_runs_of_a_batch(store: Store, add_run: AddRun) -> None:
    """Of one analyst what is no run starts first, then single runs; positions show the same."""
    flown = store.runs.get(add_run().id or 0)
    requested = [(replace(flown, id=None, input_hash=f"{k:064}"), None) for k in range(3)]
    batch, _ = batches.add(store, Batch(name="several"), requested)
    of_batch = [one.id for one in store.runs.find() if one.id != flown.id]
    single = add_run().id
    design = queue.add_job(store, replace(NEW_JOB, kind="excitation-design")).id
    other = queue.add_job(store, replace(NEW_JOB, kind="excitation-design", author="Bo")).id
    assert batch.id is not None
    shown = {one.id: one.position for one in job_list.read_page(store).items}
    order = [design, other, flown.id, single, *of_batch]
    assert sorted(shown, key=lambda number: shown[number] or 0) == order
    started = []
    while (job := queue.claim(store)) is not None:
        started.append(job.id)
        queue.cancel(store, [job.id or 0])
    assert started == [design, flown.id, single, *of_batch, other]


def test_one_run_can_be_claimed_by_name(store: Store, add_run: AddRun) -> None:
    add_run()
    second = add_run()
    claimed = queue.claim(store, second.id)
    assert claimed is not None
    assert (claimed.id, claimed.state, claimed.attempt) == (second.id, RunState.RUNNING, 1)
    assert claimed.started_at is not None
    assert queue.claim(store, second.id) is None


def test_progress_and_result_are_stored(store: Store, add_run: AddRun) -> None:
    run = _claimed(store, add_run())
    assert run.id is not None
    assert queue.note_progress(store, run.id, 1, Progress(iteration=2, fraction=0.1))
    finished = queue.finish(store, run.id, 1, RESULT, {"flexsid": "0.1.0"})
    assert finished.state is RunState.SUCCEEDED
    assert finished.result == RESULT
    assert finished.progress == Progress(iteration=2, fraction=0.1)
    assert finished.finished_at is not None
    assert store.runs.get(run.id) == finished


def test_a_cancelled_run_takes_no_result(store: Store, add_run: AddRun) -> None:
    run = _claimed(store, add_run())
    assert run.id is not None
    assert queue.find_running(store, [(run.id, 1)]) == {run.id}
    assert queue.request_cancel(store, run.id).state is RunState.CANCELLED
    assert queue.find_running(store, [(run.id, 1)]) == set()
    with pytest.raises(queue.StaleAttempt, match="cancelled"):
        queue.finish(store, run.id, 1, RESULT, {})
    assert not queue.fail(store, run.id, 1, "x", "y")
    assert not queue.note_progress(store, run.id, 1, Progress())
    assert store.runs.get(run.id).state is RunState.CANCELLED
    assert queue.request_cancel(store, run.id).state is RunState.CANCELLED


def test_a_queued_run_that_is_cancelled_never_starts(store: Store, add_run: AddRun) -> None:
    run = add_run()
    assert run.id is not None
    queue.request_cancel(store, run.id)
    assert queue.claim(store) is None


def test_an_ended_run_cannot_be_cancelled(store: Store, add_run: AddRun) -> None:
    run = _claimed(store, add_run())
    assert run.id is not None
    queue.fail(store, run.id, 1, "not-identifiable", "too little data")
    with pytest.raises(Conflict, match="failed"):
        queue.request_cancel(store, run.id)
    error = store.runs.get(run.id).error
    assert error == {"code": "not-identifiable", "message": "too little data"}


def test_an_earlier_attempt_is_fenced_off(store: Store, add_run: AddRun) -> None:
    run = _claimed(store, add_run())
    assert run.id is not None
    queue.requeue(store, run.id, 1)
    assert _claimed(store, run).attempt == 2
    with pytest.raises(queue.StaleAttempt):
        queue.finish(store, run.id, 1, RESULT, {})
    assert queue.finish(store, run.id, 2, RESULT, {}).attempt == 2


def test_run_of_a_dead_server_is_repeated_until_the_limit(store: Store, add_run: AddRun) -> None:
    run = add_run()
    assert run.id is not None
    for attempt in range(1, queue.MOST_DEATHS + 1):
        assert _claimed(store, run).attempt == attempt
        assert queue.requeue_orphans(store) == 1
    assert queue.claim(store) is None
    left = store.runs.get(run.id)
    assert left.state is RunState.FAILED
    assert left.error is not None
    assert left.error["code"] == "worker-died"


def test_remaining_time_is_known_where_jobs_take_minutes(store: Store, add_run: AddRun) -> None:
    run = _claimed(store, add_run())
    assert run.id is not None
    queue.finish(store, run.id, 1, RESULT, {})
    add_run(Method.OE)
    ended = datetime.now(UTC) - timedelta(seconds=100.0)
    with store.database.transaction() as connection:
        begun = ended - timedelta(seconds=200.0)
        statement = sa.update(jobs).where(jobs.c.id == run.id)
        connection.execute(statement.values(started_at=begun, finished_at=ended))
    rate = job_list.count_throughput(store)
    assert (rate.ended, rate.typical_s) == (1, {"estimation": pytest.approx(200.0)})
    assert rate.remaining_s == pytest.approx(300.0, rel=0.2)  # one job in the last 300 s


def test_pages_of_jobs_go_from_new_to_old(store: Store, add_run: AddRun) -> None:
    runs = [add_run(method) for method in (Method.OE, Method.EE, Method.OE)]
    first = job_list.read_page(store, limit=2)
    assert [job.id for job in first.items] == [runs[2].id, runs[1].id]
    second = job_list.read_page(store, limit=2, after=first.next)
    assert ([job.id for job in second.items], second.next) == ([runs[0].id], None)
    assert len(job_list.read_page(store, state=RunState.QUEUED).items) == 3
    assert job_list.read_page(store, state=RunState.RUNNING).items == []
