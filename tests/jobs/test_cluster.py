"""Several computers and an interrupted database server: no run is lost or executed twice."""

from __future__ import annotations

import gc
import threading
import time
from collections.abc import Callable
from datetime import UTC, datetime, timedelta
from pathlib import Path

import dask.config
import dask_cluster
import postgresql as postgresql_server
import pytest
from distributed import Client
from ruamel.yaml import YAML
from waiting import wait_until

from flexsid.errors import FlexsidError
from flexsid.jobs import cluster as cluster_module
from flexsid.jobs import health
from flexsid.jobs.cluster import write_cluster_certificate
from flexsid.jobs.dispatcher import Dispatcher
from flexsid.jobs.dispatcher_process import make_workers
from flexsid.jobs.worker import LoadKinds
from flexsid.records.job import Job
from flexsid.records.run import RunState
from flexsid.storage.jobs import job_log, leases
from flexsid.storage.store import Store

AddJob = Callable[..., Job]
Until = Callable[..., Job]


@pytest.mark.parametrize("executor", ["cluster"], indirect=True)
def test_two_dask_workers_share_a_batch_and_one_that_stops_loses_nothing(
    store: Store,
    add_job: AddJob,
    dispatcher: Dispatcher,
    until: Until,
    cluster: dask_cluster.Cluster,
) -> None:
    runs = [add_job("brief") for _ in range(60)]
    dispatcher.start()
    both = (until(run) for run in runs)
    seen: set[str | None] = set()
    while len(seen) < 2:  # one may start much later than the other
        seen.add(next(both).worker)
        if len(seen) < 2 and store.jobs.get(runs[-2].id or 0).state is not RunState.QUEUED:
            runs.append(add_job("brief"))
            dispatcher.wake()
    runs += [add_job("brief") for _ in range(20)]
    dispatcher.wake()
    victim = next(worker for worker in cluster.workers if worker.poll() is None)
    victim.kill()
    victim.wait()
    ended = [until(run) for run in runs]
    assert {run.state for run in ended} == {RunState.SUCCEEDED}
    places = {run.worker or "" for run in ended}
    assert len(places) == 2
    assert all(place.startswith("tls://") for place in places)
    for run in runs:
        assert run.id is not None
        kinds = [event.kind for event in job_log.read_log(store, run.id)]
        assert kinds.count("succeeded") == 1


@pytest.mark.parametrize("backend", ["postgresql"])
def test_a_database_that_restarts_is_waited_for(
    store: Store,
    add_job: AddJob,
    dispatcher: Dispatcher,
    until: Until,
    postgresql: postgresql_server.Cluster,
) -> None:
    runs = [add_job("brief") for _ in range(20)]
    dispatcher.start()
    until(runs[3])
    postgresql.stop()
    time.sleep(1.0)
    postgresql.start()
    for run in runs:
        assert until(run).state is RunState.SUCCEEDED
        assert run.id is not None
        kinds = [event.kind for event in job_log.read_log(store, run.id)]
        assert kinds.count("succeeded") == 1


@pytest.mark.parametrize("scheme", ["tls", "tcp"])
def test_a_cluster_refuses_whoever_has_no_certificate(
    cluster: dask_cluster.Cluster,
    load_stub: LoadKinds,
    monkeypatch: pytest.MonkeyPatch,
    scheme: str,
) -> None:
    monkeypatch.setattr(cluster_module, "_CONNECT_S", 1.0)
    reason = "requires a certificate" if scheme == "tls" else "no Dask scheduler responds"
    names = [f"distributed.comm.tls.{part}" for part in ("client.cert", "client.key", "ca-file")]
    nothing = {**dict.fromkeys(names), "distributed.comm.require-encryption": False}
    with (
        dask.config.set(nothing),
        pytest.raises(FlexsidError, match=reason),
    ):
        make_workers(load_stub, cluster.address.replace("tls", scheme))


@pytest.mark.parametrize("reason", ["no Dask scheduler responds", "requires a certificate"])
def test_a_failed_connection_leaves_nothing_to_the_garbage_collector(
    load_stub: LoadKinds, monkeypatch: pytest.MonkeyPatch, reason: str
) -> None:
    monkeypatch.setattr(cluster_module, "_CONNECT_S", 1.0)
    names = [f"distributed.comm.tls.{part}" for part in ("client.cert", "client.key", "ca-file")]
    changed = dict.fromkeys(names) if "certificate" in reason else {}
    dask_cluster.configuration()
    gc.collect()  # what other tests left
    gc.disable()
    try:
        before = set(threading.enumerate())
        with dask.config.set(changed), pytest.raises(FlexsidError, match=reason):
            make_workers(load_stub, "tls://127.0.0.1:9")
        left = [one for one in gc.get_objects() if isinstance(one, Client)]
        assert [client.status for client in left if client.status != "closed"] == []
        assert not [t for t in set(threading.enumerate()) - before if t.name == "IO loop"]
    finally:
        gc.enable()


def test_a_cluster_refuses_a_certificate_of_another(
    cluster: dask_cluster.Cluster,
    load_stub: LoadKinds,
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
) -> None:
    monkeypatch.setattr(cluster_module, "_CONNECT_S", 1.0)
    other = tmp_path / "other.yaml"
    write_cluster_certificate(other, datetime.now(UTC))
    tls = YAML(typ="safe").load(other)["distributed"]["comm"]["tls"]
    with (
        dask.config.set({f"distributed.comm.tls.{name}": part for name, part in tls.items()}),
        pytest.raises(FlexsidError, match="no Dask scheduler responds"),
    ):
        make_workers(load_stub, cluster.address)


@pytest.mark.parametrize(("age_days", "state"), [(0, "ok"), (3 * 365 - 29, "degraded")])
def test_the_end_of_the_certificate_is_announced(
    store: Store,
    load_stub: LoadKinds,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    age_days: int,
    state: str,
) -> None:
    own = dask_cluster.Cluster(tmp_path, workers=1, path=Path(__file__).parent)
    aged = tmp_path / "aged.yaml"
    written = datetime.now(UTC) - timedelta(days=age_days)
    end = write_cluster_certificate(aged, written)
    certificate = YAML(typ="safe").load(aged)["distributed"]["comm"]["tls"]["client"]["cert"]
    file = tmp_path / "certificate.pem"
    file.write_text(certificate)
    read = cluster_module.find_end_of_validity
    for text in (certificate, str(file)):
        monkeypatch.setattr(cluster_module, "find_end_of_validity", lambda _, t=text: read(t))
        dispatcher = Dispatcher(store, load_stub(), make_workers(load_stub, own.address))
        dispatcher.start()
        watch = health.QueueHealth(store)
        part = wait_until(watch.check_certificate, "the report of the workers")
        assert part.state == state
        assert f"{end:%Y-%m-%d}" in part.text
        dispatcher.stop()
    own.close()
    assert read("no certificate") is None


def test_a_scheduler_that_goes_away_is_waited_for(
    store: Store,
    add_job: AddJob,
    load_stub: LoadKinds,
    until: Until,
    tmp_path: Path,
) -> None:
    own = dask_cluster.Cluster(tmp_path, workers=1, path=Path(__file__).parent)
    runs = [add_job("brief") for _ in range(10)]
    dispatcher = Dispatcher(store, load_stub(), make_workers(load_stub, own.address))
    dispatcher.start()
    try:
        until(runs[2])
        own.restart()
        for run in runs:
            assert until(run).state is RunState.SUCCEEDED
    finally:
        dispatcher.stop()
        own.close()


def test_a_run_without_a_worker_waits_in_the_queue_and_health_is_degraded(
    store: Store,
    add_job: AddJob,
    load_stub: LoadKinds,
    until: Until,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(cluster_module, "_NO_WORKER_S", 0.2)
    monkeypatch.setattr(health, "_GRACE_S", 0.5)
    own = dask_cluster.Cluster(tmp_path, workers=1, path=Path(__file__).parent)
    watch = health.QueueHealth(store)
    runs = [add_job(f"hold-once {tmp_path}/begun"), add_job("brief")]
    workers = make_workers(load_stub, own.address)
    dispatcher = Dispatcher(store, load_stub(), workers, lease_timeout_s=1.0)
    dispatcher.start()
    try:
        wait_until(lambda: (tmp_path / "begun").exists())
        own.workers[0].kill()
        wait_until(lambda: {run.state for run in store.jobs.find()} == {RunState.QUEUED})
        wait_until(lambda: watch.check()[1].state is health.PartState.DEGRADED)
        dispatch, computing = watch.check()
        assert dispatch.state is health.PartState.OK
        assert "No worker" in computing.text
        assert "dask worker" in computing.text
        own.add_worker()
        assert {until(run).state for run in runs} == {RunState.SUCCEEDED}
        wait_until(lambda: watch.check()[1].state is health.PartState.OK)
    finally:
        dispatcher.stop()
        own.close()


def test_a_dispatcher_that_is_gone_or_stands_still_is_found(
    store: Store, monkeypatch: pytest.MonkeyPatch
) -> None:
    is_starting = True
    watch = health.QueueHealth(store, lambda: is_starting)
    monkeypatch.setattr(health, "_GRACE_S", 1e-9)
    for _ in range(2):  # the libraries of its process may load for longer than a replacement
        assert [part.state for part in watch.check()] == [health.PartState.STARTING] * 2
    is_starting = False
    assert [part.state for part in watch.check()] == [health.PartState.DEGRADED] * 2
    lease = leases.take(store, leases.read(store), "elsewhere")
    assert lease is not None
    status = {"server": "s", "location": "p", "workers": 1, "running": []}
    assert leases.renew(store, lease, status) is not None
    assert [part.state for part in watch.check()] == [health.PartState.OK] * 2
    monkeypatch.setattr(health, "_STALLED_S", 0.0)
    assert "not responded" in watch.check()[0].text
