"""What the queue costs: a server, its workers, and browsers that read meanwhile.

``python backend/benchmarks/jobs.py [--maneuvers N] [--database URL] [--dask ADDRESS]`` prints
JSON lines.
"""

from __future__ import annotations

import os

for name in ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS"):
    os.environ[name] = "1"

import argparse
import json
import multiprocessing
import socket
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import replace
from http.client import HTTPConnection
from pathlib import Path
from typing import Any

import sqlalchemy as sa

from flexsid.demo import campaign
from flexsid.jobs.local import default_count
from flexsid.storage.migrate import upgrade
from flexsid.storage.store import Store
from flexsid.storage.tables import channels
from flexsid.workflow.runs import estimation

STRUCTURE = {"modes": [7, 9]}
DESIGN = {
    "name": "long",
    "duration_s": 20.0,
    "rate_hz": 100.0,
    "peaks": [0.01, 0.02, 0.04],
    "inputs": [
        {"name": name, "harmonics": list(range(4 + k, 800, 4))}
        for k, name in enumerate(("bfs", "wf1s", "wf2s", "wf3s"))
    ],
    "effort": "patient",
}
BROWSERS = 50
NICE = 5  # of workers: programs beside the benchmark then delay both sides of a ratio alike


def main() -> None:
    """Run the benchmarks."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--maneuvers", type=int, default=100, help="of the batches")
    parser.add_argument("--database", help="an empty database; by default a file")
    parser.add_argument("--dask", help="address of a scheduler; by default local processes")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        url = arguments.database or f"sqlite:///{folder}/flexsid.db"
        ids = fill(url, arguments.maneuvers)
        workers = default_count()
        with server(url, arguments.dask, workers) as port:
            trivial(port, ids)
            batch_against_direct(port, url, ids, workers)
            two_analysts(port)
            whole_campaign(port, ids, workers)


def fill(url: str, count: int) -> list[int]:
    """Store copies of the demonstration maneuvers with small differences."""
    upgrade(url)
    store = Store.open(url)
    campaign.add_campaign(store, lambda fraction, message: None)
    flown = [m for m in store.maneuvers.find() if m.excitation is not None and m.axis != "ground"]
    ids: list[int] = []
    with store.database.transaction() as connection:
        for k in range(count):
            first = flown[k % len(flown)]
            speed = first.condition.airspeed_m_s * (1.0 + 1e-7 * (k + 1))
            condition = replace(first.condition, airspeed_m_s=speed)
            copy = store.maneuvers.add(
                replace(first, id=None, label=f"copy {k}", condition=condition)
            )
            columns = [c.name for c in channels.c if c.name not in ("id", "maneuver_id")]
            rows = sa.select(sa.literal(copy.id), *(channels.c[n] for n in columns)).where(
                channels.c.maneuver_id == first.id
            )
            connection.execute(sa.insert(channels).from_select(["maneuver_id", *columns], rows))
            assert copy.id is not None
            ids.append(copy.id)
    store.close()
    return ids


def trivial(port: int, ids: list[int]) -> None:
    """Submit to done of two-mode equation-error runs, one after the other, over REST."""
    client, times, own = Client(port), [], []
    for k in range(25):
        body = {
            "maneuver_id": ids[k % len(ids)],
            "method": "EE",
            "structure": STRUCTURE,
            "settings": {"max_iterations": 500 + k},  # or it would be the run asked for before
        }
        start = time.perf_counter()
        run = client.post("/api/v1/runs", body)["id"]
        wait_for_job(client, run)
        times.append(1e3 * (time.perf_counter() - start))
        own.append(1e3 * client.get(f"/api/v1/runs/{run}")["fit"]["seconds"])
    times, own = times[5:], own[5:]
    report_result(
        "submit_to_done_vs_fit",
        statistics.median(t / (2.0 * o + 30.0) for t, o in zip(times, own, strict=True)),
        bar=1.0,
        baseline="twice the fit of the run and 30 ms",
        median_ms=statistics.median(times),
        p90_ms=percentile(times, 0.9),
        fit_ms=statistics.median(own),
    )


def batch_against_direct(port: int, url: str, ids: list[int], workers: int) -> None:
    """A batch of EE jobs against the same runs in a pool of as many processes."""
    client = Client(port)
    start = time.perf_counter()
    batch = client.post("/api/v1/batches", make_batch(ids, ["EE"]))
    wait_for_batch(client, batch["id"])
    seconds = time.perf_counter() - start
    jobs = client.get(f"/api/v1/jobs?batch_id={batch['id']}&limit=500")["items"]
    direct = _direct(url, [job["id"] for job in jobs], workers)
    report_result(
        "ee_batch_vs_direct",
        seconds / direct,
        bar=1.3,
        baseline="prepare, multiprocessing.Pool.imap with the priority of workers, nothing stored",
        seconds=seconds,
        jobs=len(jobs),
        jobs_per_s=len(jobs) / seconds,
    )


def _direct(url: str, run_ids: list[int], workers: int) -> float:
    store = Store.open(url)
    with multiprocessing.get_context("spawn").Pool(workers, os.nice, (NICE,)) as pool:
        first = estimation.prepare(store, store.runs.get(run_ids[0]))
        pool.map(_compute, [first] * workers)
        start = time.perf_counter()
        tasks = (estimation.prepare(store, store.runs.get(number)) for number in run_ids)
        for _ in pool.imap_unordered(_compute, tasks):
            pass
        seconds = time.perf_counter() - start
    store.close()
    return seconds


def _compute(task: Any) -> Any:
    return estimation.compute_run(task, lambda progress: None)


def two_analysts(port: int) -> None:
    """Flutter predictions of one analyst while the design of another is searched for a minute."""
    client = Client(port)
    run = client.get("/api/v1/runs?state=succeeded&limit=1")["items"][0]["id"]

    def predict(fuels: tuple[float, ...]) -> float:
        times = []
        for fuel in fuels:
            start = time.perf_counter()
            job = client.post(f"/api/v1/flutter/results?run_ids={run}&fuel={fuel}", None, "Eva")
            wait_for_job(client, job["id"])
            times.append(time.perf_counter() - start)
        return statistics.median(times)

    predict((0.3,))  # its refits are stored
    alone = predict((0.31, 0.32, 0.33))
    search = client.post("/api/v1/designs/searches", DESIGN, "Ann")["id"]
    while client.get(f"/api/v1/jobs/{search}")["state"] == "queued":
        time.sleep(0.02)
    beside = predict((0.34, 0.35, 0.36))
    state = client.get(f"/api/v1/jobs/{search}")["state"]
    if state == "running":
        client.post(f"/api/v1/jobs/{search}/cancel", None)
    report_result(
        "two_analysts",
        beside / alone,
        bar=2.0,
        baseline="the same predictions while no design is searched",
        alone_s=alone,
        beside_s=beside,
        design_meanwhile=state,
    )


def whole_campaign(port: int, ids: list[int], workers: int) -> None:
    """EE, OE and FRE of every maneuver while 50 browsers read; lists against idle ones."""
    client = Client(port)
    paths = ("/api/v1/maneuvers?limit=50", "/api/v1/runs?limit=50", "/api/v1/jobs?limit=100")
    idle = statistics.median(time_request(client, paths[k % 3]) for k in range(60))
    stop = threading.Event()
    body = make_batch(ids, ["EE", "OE", "FRE"], fixed={"Cm_q": -3.0})
    start = time.perf_counter()
    batch = client.post("/api/v1/batches", body)
    with ThreadPoolExecutor(BROWSERS) as browsers:
        phases = [k / BROWSERS for k in range(BROWSERS)]
        readings = [browsers.submit(browse, port, paths, stop, phase) for phase in phases]
        done = wait_for_batch(client, batch["id"])
        seconds = time.perf_counter() - start
        stop.set()
        found = [reading.result() for reading in readings]
    computed = _compute_seconds(client, batch["id"])
    report_result(
        "campaign_vs_compute",
        seconds / (computed / workers),
        bar=1.3,
        baseline="sum of compute over workers",
        seconds=seconds,
        compute_s=computed,
        states=done["states"],
    )
    times = [1e3 * t for times, _ in found for t in times]
    report_result(
        "p99_of_lists_vs_idle",
        percentile(times, 0.99) / (1e3 * idle),
        bar=5.0,
        baseline="median of the same lists on an idle server",
        p99_ms=percentile(times, 0.99),
        idle_ms=1e3 * idle,
        requests=len(times),
        errors=sum(errors for _, errors in found),
    )


def browse(
    port: int, paths: tuple[str, ...], stop: threading.Event, phase_s: float
) -> tuple[list[float], int]:
    """Read as a browser does: a list, then a while of looking at it; no two at once."""
    client, times, errors = Client(port), [], 0
    stop.wait(phase_s)
    while not stop.is_set():
        for path in paths:
            try:
                times.append(time_request(client, path))
            except ValueError:
                errors += 1
            stop.wait(1.0)
    return times, errors


def _compute_seconds(client: Client, batch_id: int) -> float:
    total, after = 0.0, ""
    while True:
        page = client.get(f"/api/v1/jobs?batch_id={batch_id}&limit=500{after}")
        for job in page["items"]:
            total += client.get(f"/api/v1/runs/{job['id']}")["fit"]["seconds"]
        if page["next"] is None:
            return total
        after = f"&after={page['next']}"


class Client:
    """One persistent connection, as a browser's."""

    def __init__(self, port: int) -> None:
        self._connection = HTTPConnection("127.0.0.1", port, timeout=600)

    def get(self, path: str) -> Any:
        """Read JSON."""
        return self._ask("GET", path)

    def post(self, path: str, body: Any, analyst: str = "") -> Any:
        """Send JSON and read the response."""
        headers = {"Content-Type": "application/json", "X-Flexsid-Analyst": analyst}
        return self._ask("POST", path, None if body is None else json.dumps(body), headers)

    def _ask(self, method: str, path: str, *more: Any) -> Any:
        self._connection.request(method, path, *more)
        response = self._connection.getresponse()
        content = response.read()
        if response.status >= 400:
            raise ValueError(f"{response.status}: {content[:300]!r}")
        return json.loads(content)


@contextmanager
def server(url: str, dask: str | None, workers: int) -> Iterator[int]:
    """Serve a database; the workers are warm when the port is returned."""
    with serve(url, dask, workers) as port:
        client = Client(port)
        ids = [m["id"] for m in client.get("/api/v1/maneuvers?limit=20&search=copy")["items"]]
        warm = client.post("/api/v1/batches", make_batch(ids[: 4 * workers], ["EE"], modes=[7]))
        wait_for_batch(client, warm["id"])
        yield port


@contextmanager
def serve(url: str, dask: str | None, workers: int) -> Iterator[int]:
    """Serve a database."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    environment = {
        **os.environ,
        "FLEXSID_PORT": str(port),
        "FLEXSID_WORKERS": str(workers),
        "FLEXSID_DASK": dask or "",
        "PYTHONPATH": os.pathsep.join(filter(None, sys.path)),
    }
    command = [sys.executable, "-m", "flexsid.cli.main", "serve", "--database", url]
    process = subprocess.Popen(command, env=environment, cwd=Path.home())
    try:
        client = Client(port)
        while not _is_ready(client):
            assert process.poll() is None
            time.sleep(0.2)
            client = Client(port)
        yield port
    finally:
        process.terminate()
        process.wait()


def _is_ready(client: Client) -> bool:
    try:
        client.get("/api/v1/health")
    except OSError:
        return False
    return True


def make_batch(ids: list[int], methods: list[str], **structure: Any) -> dict[str, Any]:
    return {
        "name": "benchmark",
        "maneuver_ids": ids,
        "methods": methods,
        "structures": [{"structure": STRUCTURE | structure}],
    }


def wait_for_job(client: Client, job: int) -> None:
    while client.get(f"/api/v1/jobs/{job}")["state"] in ("queued", "running"):
        time.sleep(0.005)


def wait_for_batch(client: Client, batch_id: int) -> Any:
    while True:
        response = client.get(f"/api/v1/batches/{batch_id}")
        if response["states"]["queued"] + response["states"]["running"] == 0:
            assert response["states"]["failed"] == 0, response
            return response
        time.sleep(0.05)


def time_request(client: Client, path: str) -> float:
    start = time.perf_counter()
    client.get(path)
    return time.perf_counter() - start


def percentile(values: list[float], share: float) -> float:
    return sorted(values)[min(len(values) - 1, int(share * len(values)))]


def report_result(name: str, ratio: float, **more: Any) -> None:
    load = {"cores": os.cpu_count(), "load": round(os.getloadavg()[0], 1)}
    print(json.dumps({"name": name, "ratio": ratio, **more, **load}), flush=True)


if __name__ == "__main__":
    main()
