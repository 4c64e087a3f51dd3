"""Several computers and a database server that goes away: nothing is lost, nothing done twice."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path

import dask_cluster
import postgresql as postgresql_server
import pytest

from flexsid.jobs.dispatcher import Dispatcher
from flexsid.jobs.executors import make_workers
from flexsid.jobs.steps import Steps
from flexsid.records.run import EstimationRun, RunState
from flexsid.storage import run_log
from flexsid.storage.store import Store

AddRun = Callable[..., EstimationRun]
Until = Callable[..., EstimationRun]


@pytest.mark.parametrize("executor", ["cluster"], indirect=True)
def test_two_dask_workers_share_a_batch_and_one_that_stops_loses_nothing(
    store: Store,
    add_run: AddRun,
    dispatcher: Dispatcher,
    until: Until,
    cluster: dask_cluster.Cluster,
) -> None:
    runs = [add_run(author="brief") for _ in range(60)]
    dispatcher.start()
    both = (until(run) for run in runs)
    seen: set[str | None] = set()
    while len(seen) < 2:  # one may start much later than the other
        seen.add(next(both).worker)
        if len(seen) < 2 and store.runs.get(runs[-2].id or 0).state is not RunState.QUEUED:
            runs.append(add_run(author="brief"))
            dispatcher.wake()
    runs += [add_run(author="brief") for _ in range(20)]
    dispatcher.wake()
    victim = next(worker for worker in cluster.workers if worker.poll() is None)
    victim.kill()
    victim.wait()
    ended = [until(run) for run in runs]
    assert {run.state for run in ended} == {RunState.SUCCEEDED}
    places = {run.worker or "" for run in ended}
    assert len(places) == 2
    assert all(place.startswith("tcp://") for place in places)
    for run in runs:
        assert run.id is not None
        kinds = [event.kind for event in run_log.of_run(store, run.id)]
        assert kinds.count("succeeded") == 1


@pytest.mark.parametrize("backend", ["postgresql"])
def test_a_database_that_restarts_is_waited_for(
    store: Store,
    add_run: AddRun,
    dispatcher: Dispatcher,
    until: Until,
    postgresql: postgresql_server.Cluster,
) -> None:
    runs = [add_run(author="brief") for _ in range(20)]
    dispatcher.start()
    until(runs[3])
    postgresql.stop()
    time.sleep(1.0)
    postgresql.start()
    for run in runs:
        assert until(run).state is RunState.SUCCEEDED
        assert run.id is not None
        kinds = [event.kind for event in run_log.of_run(store, run.id)]
        assert kinds.count("succeeded") == 1


@pytest.mark.parametrize("backend", ["sqlite"])
def test_a_scheduler_that_goes_away_is_waited_for(
    store: Store,
    add_run: AddRun,
    steps: Steps,
    until: Until,
    tmp_path: Path,
) -> None:
    own = dask_cluster.Cluster(tmp_path, workers=1, path=Path(__file__).parent)
    runs = [add_run(author="brief") for _ in range(10)]
    dispatcher = Dispatcher(store, steps, make_workers(steps.compute, own.address))
    dispatcher.start()
    try:
        until(runs[2])
        own.restart()
        for run in runs:
            assert until(run).state is RunState.SUCCEEDED
    finally:
        dispatcher.stop()
        own.close()
