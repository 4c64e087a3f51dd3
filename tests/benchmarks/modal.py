"""Tables of modes as large as a real structure's: ``python tests/benchmarks/modal.py``.

A table of 25 modes x 17 fuel weights x 8480 nodes x 6 in single precision, as Nastran writes
it, is imported (followed, named, hashed, stored) beside writing the same bytes to SQLite in
one transaction, one blob per mode and fuel weight. Then modes at fuel weights between those
of the table are served over the interface. Prints one JSON line per figure; ratios are made
in one run, ``serve_ms`` is a median with its sizes.
"""

from __future__ import annotations

import os

for _name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[_name] = "1"

import json
import sqlite3
import statistics
import tempfile
import time
from pathlib import Path

import numpy as np
from fastapi.testclient import TestClient

from flexsid.api.app import create_app
from flexsid.demo.aircraft import describe_aircraft
from flexsid.demo.flex28 import load_truth
from flexsid.importers.modal_data import RawModalData
from flexsid.records.modal_data import ModalKind
from flexsid.settings import Settings
from flexsid.storage.migrate import upgrade
from flexsid.storage.store import Store
from flexsid.workflow.modal_data.modal_import import store_modal_data

N_FUEL, N_MODES, N_NODES = 17, 25, 8480
ROUNDS = 5


def paper_table(seed: int) -> RawModalData:
    """A wing whose modes are smooth in fuel, with signs as a solver leaves them."""
    rng = np.random.default_rng(seed)
    y = np.linspace(-4.0, 4.0, N_NODES // 8)
    nodes = np.stack(
        [np.repeat(np.linspace(0.0, 1.0, 8), y.size), np.tile(y, 8), np.zeros(8 * y.size)], axis=1
    )
    fuel = np.linspace(0.0, 1.0, N_FUEL)
    order = np.arange(1, N_MODES + 1)
    shape = np.empty((N_FUEL, N_MODES, N_NODES, 6), dtype=np.float32)
    for row, f in enumerate(fuel):
        for mode, k in enumerate(order):
            phase = np.pi * k * (nodes[:, 1] + 4.0) / 8.0 + 0.1 * f
            values = np.cos(phase)[:, None] * (0.2 + rng.uniform(0, 1e-3, (N_NODES, 6)))
            shape[row, mode] = values * rng.choice([-1.0, 1.0])
    omega = 2.0 * np.pi * (3.0 * order - 0.3 * fuel[:, None])
    return RawModalData(
        name=f"paper size {seed}",
        kind=ModalKind.FEM,
        fuel=fuel,
        numbers=tuple(range(7, 7 + N_MODES)),
        omega=omega,
        zeta=None,
        mass=np.ones(omega.shape),
        node_ids=np.arange(1, N_NODES + 1),
        nodes=nodes,
        shape=shape,
        lines=np.empty((0, 2), dtype=np.int32),
        points={},
        origin="benchmark",
        notes=(),
    )


def write_to_sqlite(file: Path, shape: np.ndarray) -> float:
    """Seconds to write the same bytes, with the settings of the workbench's database."""
    with sqlite3.connect(file, isolation_level=None) as connection:
        connection.execute("PRAGMA journal_mode=WAL")
        connection.execute("PRAGMA synchronous=NORMAL")
        connection.execute("CREATE TABLE blobs (id INTEGER PRIMARY KEY, data BLOB)")
        began = time.perf_counter()
        connection.execute("BEGIN IMMEDIATE")
        for row in shape:
            for mode in row:
                connection.execute("INSERT INTO blobs (data) VALUES (?)", (mode.tobytes(),))
        connection.execute("COMMIT")
        return time.perf_counter() - began


def size_of(file: Path) -> int:
    """Bytes of a database once its log is written back."""
    with sqlite3.connect(file) as connection:
        connection.execute("PRAGMA wal_checkpoint(TRUNCATE)")
    return file.stat().st_size


def main() -> None:
    """Measure and print."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "flexsid.db"
        url = f"sqlite:///{file}"
        upgrade(url)
        store = Store.open(url)
        aircraft = store.aircraft.add(describe_aircraft(load_truth()))
        ratios, table, before, n_bytes = [], None, 0, 1
        for seed in range(ROUNDS):
            raw = paper_table(seed)
            plain = write_to_sqlite(Path(folder) / f"plain{seed}.db", raw.shape)
            before, n_bytes = size_of(file), raw.shape.nbytes
            began = time.perf_counter()
            table = store_modal_data(store, aircraft, raw)
            ratios.append((time.perf_counter() - began) / plain)
            (Path(folder) / f"plain{seed}.db").unlink()
        assert table is not None
        store.close()
        report("import_vs_sqlite3", statistics.median(ratios), "writing the same bytes to SQLite")
        share = (size_of(file) - before) / n_bytes
        report("size_vs_raw", share, f"{n_bytes / 1e6:.0f} MB of single precision")
        address = "http://127.0.0.1:8000"
        with TestClient(create_app(Settings(database=url)), base_url=address) as client:
            serve(client, table.id)


def serve(client: TestClient, identity: int | None) -> None:
    """Time single modes at fuel weights between those of the table."""
    rng = np.random.default_rng(1)
    times, sizes = [], []
    for _ in range(40):
        fuel, number = rng.uniform(), int(rng.integers(7, 7 + N_MODES))
        at = f"/api/v1/modal-tables/{identity}/shape?number={number}&fuel={fuel:.4f}"
        began = time.perf_counter()
        response = client.get(at)
        times.append(1000.0 * (time.perf_counter() - began))
        assert response.status_code == 200, response.text
        sizes.append(len(response.content) / 1000.0)
    median = statistics.median(times)
    print(
        json.dumps(
            {
                "name": "serve_shape",
                "ratio": round(median / 150.0, 3),
                "baseline": "150 ms",
                "serve_ms": round(median, 1),
                "response_kb": round(statistics.median(sizes)),
            }
        )
    )


def report(name: str, ratio: float, baseline: str) -> None:
    """Print one figure."""
    print(json.dumps({"name": name, "ratio": round(ratio, 3), "baseline": baseline}), flush=True)


if __name__ == "__main__":
    main()
