"""How a campaign grows: ``python backend/benchmarks/campaign_scale.py [--sizes N ...]``.

Copies of the demonstration maneuvers, whose samples are stored once, are estimated by EE, OE and
FRE on a Dask cluster with one worker per core. At each size the whole campaign is queued, and the
cluster computes for some minutes while the lists of the page are read. JSON lines have the time to
queue a run and its size in the database, runs per second, and the time of the lists.
"""

from __future__ import annotations

import os

for name in ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS"):
    os.environ[name] = "1"

import argparse
import sys
import tempfile
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import sqlalchemy as sa
from jobs import Client, browse, fill, make_batch, percentile, report_result, server

from flexsid.storage.store import Store
from flexsid.storage.tables import runs

METHODS = ["EE", "OE", "FRE"]
LISTS = ("/api/v1/maneuvers?limit=50", "/api/v1/runs?limit=50", "/api/v1/jobs?limit=100")
AT_ONCE = 5000  # maneuvers of a batch, which has at most 20,000 runs
WARM_S = 20.0


def main() -> None:
    """Measure each size beside the first."""
    parser = argparse.ArgumentParser(description=__doc__)
    sizes, window_s = [300, 3000, 30_000], 120.0
    parser.add_argument("--sizes", type=int, nargs="+", default=sizes, help="of the campaign")
    parser.add_argument("--seconds", type=float, default=window_s, help="of each size")
    arguments = parser.parse_args()
    sys.path.append(str(Path(__file__).parents[2] / "tests" / "servers"))
    from dask_cluster import Cluster

    workers = os.cpu_count() or 1
    first = None
    for size in arguments.sizes:
        with tempfile.TemporaryDirectory() as folder:
            cluster = Cluster(Path(folder), workers)
            try:
                found = measure(Path(folder), cluster.address, workers, size, arguments.seconds)
            finally:
                cluster.close()
        first = first or found["runs_per_s"]
        baseline = "runs per second of the smallest campaign"
        report_result("campaign_scale", first / found["runs_per_s"], baseline=baseline, **found)


def measure(folder: Path, dask: str, workers: int, size: int, window_s: float) -> dict[str, float]:
    """Queue a campaign and let it compute for a while."""
    file = folder / "flexsid.db"
    start = time.perf_counter()
    ids = fill(f"sqlite:///{file}", size)
    fill_s = time.perf_counter() - start
    store = Store.open(f"sqlite:///{file}")
    with server(f"sqlite:///{file}", dask, workers) as port:
        client, before = Client(port), count_bytes(store)
        start = time.perf_counter()
        for k in range(0, size, AT_ONCE):
            client.post("/api/v1/batches", make_batch(ids[k : k + AT_ONCE], METHODS))
        queue_s = time.perf_counter() - start
        queued_bytes = count_bytes(store) - before
        time.sleep(WARM_S)
        stop = threading.Event()
        with ThreadPoolExecutor(1) as browser:
            reading = browser.submit(browse, port, LISTS, stop, 0.0)
            done, start = count_done(store), time.perf_counter()
            while (passed_s := time.perf_counter() - start) < window_s:
                time.sleep(0.5)
                if count_done(store) >= size * len(METHODS):
                    break
            rate = (count_done(store) - done) / passed_s
            stop.set()
            times, errors = reading.result()
    store.close()
    n_runs = size * len(METHODS)
    return {
        "maneuvers": size,
        "queued": n_runs,
        "runs_per_s": rate,
        "worker_s_per_run": workers / rate,
        "queue_ms_per_run": 1e3 * queue_s / n_runs,
        "queued_bytes_per_run": queued_bytes / n_runs,
        "fill_ms_per_maneuver": 1e3 * fill_s / size,
        "lists_p95_ms": 1e3 * percentile(times, 0.95),
        "errors": errors,
    }


def count_bytes(store: Store) -> int:
    """Return the size of the database, whose file changes later."""
    with store.database.reading() as connection:
        pages, each = (
            connection.exec_driver_sql(f"PRAGMA {name}").scalar_one()
            for name in ("page_count", "page_size")
        )
        return pages * each


def count_done(store: Store) -> int:
    """Count the runs that have ended well."""
    with store.database.reading() as connection:
        query = sa.select(sa.func.count()).where(runs.c.state == "succeeded")
        return connection.execute(query).scalar_one()


if __name__ == "__main__":
    main()
