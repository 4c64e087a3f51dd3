"""Tables of modes as large as a real structure's: ``python backend/benchmarks/modal.py``.

Tables of 25 modes x 17 fuel weights x 8480 nodes and of 60 modes x 20,000 nodes (six components in
single precision, as Nastran writes them, with the edges of elements) are imported (tracked,
named, hashed, stored) beside writing the same bytes to SQLite in one transaction, one blob per
mode and fuel weight. Then modes at fuel weights between those of the table are served over the
interface. Cross-orthogonality is that of a model of 3000 nodes reduced to 60 points. Prints one
JSON line per figure; ratios are made in one run, ``serve_ms`` is a median with its sizes.
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
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
from fastapi.testclient import TestClient

from flexsid.api.app import create_app
from flexsid.demo.aircraft import describe_aircraft
from flexsid.demo.flex28 import load_truth
from flexsid.importers.modal_data import RawModalData
from flexsid.records.aircraft import Aircraft
from flexsid.records.modal_data import ModalKind
from flexsid.settings import Settings
from flexsid.storage.migrate import upgrade
from flexsid.storage.store import Store
from flexsid.workflow.modal_data.modal_import import store_modal_data
from flexsid.workflow.views.modal_assurance import correlate

ROUNDS = 5


class Size(NamedTuple):
    """Fuel weights, modes and nodes of a table."""

    n_fuel: int
    n_modes: int
    n_nodes: int


SIZES = {"": Size(17, 25, 8480), "_of_20000_nodes": Size(1, 60, 20_000)}
REDUCED_LIMIT_MS = 2000.0


def make_table(seed: int, size: Size) -> RawModalData:
    """A wing whose modes are smooth in fuel, with signs as a solver leaves them."""
    n_fuel, n_modes, n_nodes = size
    rng = np.random.default_rng(seed)
    y = np.linspace(-4.0, 4.0, n_nodes // 8)
    nodes = np.stack(
        [np.repeat(np.linspace(0.0, 1.0, 8), y.size), np.tile(y, 8), np.zeros(8 * y.size)], axis=1
    )
    fuel = np.linspace(0.0, 1.0, n_fuel)
    order = np.arange(1, n_modes + 1)
    shape = np.empty((n_fuel, n_modes, n_nodes, 6), dtype=np.float32)
    for row, f in enumerate(fuel):
        for mode, k in enumerate(order):
            phase = np.pi * k * (nodes[:, 1] + 4.0) / 8.0 + 0.1 * f
            values = np.cos(phase)[:, None] * (0.2 + rng.uniform(0, 1e-3, (n_nodes, 6)))
            shape[row, mode] = values * rng.choice([-1.0, 1.0])
    row = np.arange(8 * y.size).reshape(8, -1)
    omega = 2.0 * np.pi * (3.0 * order - 0.3 * fuel[:, None])
    return RawModalData(
        name=f"{n_nodes} nodes {seed}",
        kind=ModalKind.FEM,
        fuel=fuel,
        numbers=tuple(range(7, 7 + n_modes)),
        omega=omega,
        zeta=None,
        mass=np.ones(omega.shape),
        node_ids=np.arange(1, n_nodes + 1),
        nodes=nodes,
        shape=shape,
        lines=np.concatenate(
            [
                np.stack([row[:-1].ravel(), row[1:].ravel()], axis=1),
                np.stack([row[:, :-1].ravel(), row[:, 1:].ravel()], axis=1),
            ]
        ).astype(np.int32),
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
        stored = {}
        for name, size in SIZES.items():
            ratios, before, n_bytes = [], 0, 1
            for seed in range(ROUNDS):
                raw = make_table(seed, size)
                plain = write_to_sqlite(Path(folder) / f"plain{seed}.db", raw.shape)
                before, n_bytes = size_of(file), raw.shape.nbytes
                began = time.perf_counter()
                stored[name] = store_modal_data(store, aircraft, raw).id
                ratios.append((time.perf_counter() - began) / plain)
                (Path(folder) / f"plain{seed}.db").unlink()
            ratio = statistics.median(ratios)
            report(f"import_vs_sqlite3{name}", ratio, "writing the same bytes to SQLite")
            share = (size_of(file) - before) / n_bytes
            report(f"size_vs_raw{name}", share, f"{n_bytes / 1e6:.0f} MB of single precision")
        correlate_reduced(store, aircraft)
        store.close()
        address = "http://127.0.0.1:8000"
        with TestClient(create_app(Settings(database=url)), base_url=address) as client:
            for name, size in SIZES.items():
                serve(client, stored[name], name, size.n_modes)


def correlate_reduced(store: Store, aircraft: Aircraft) -> None:
    """Time the cross-orthogonality of a model of 3000 nodes with a test at 60 of them."""
    model = replace(make_table(1, Size(1, 12, 3000)), name="model")
    few = np.linspace(0, 2999, 60).astype(int)
    noise = 1e-3 * np.random.default_rng(2).normal(size=(1, 12, 60, 6))
    test = replace(
        model,
        name="test",
        kind=ModalKind.GVT,
        mass=None,
        node_ids=model.node_ids[few],
        nodes=model.nodes[few],
        shape=model.shape[:, :, few] + noise.astype(np.float32),
        lines=np.empty((0, 2), dtype=np.int32),
    )
    one, other = (store_modal_data(store, aircraft, raw) for raw in (model, test))
    assert one.id is not None
    assert other.id is not None
    began = time.perf_counter()
    found = correlate(store, one.id, 0.0, other.id, 0.0)
    elapsed = 1000.0 * (time.perf_counter() - began)
    assert all(pair.cross_orthogonality is not None for pair in found.pairs)
    report("cross_orthogonality", elapsed / REDUCED_LIMIT_MS, f"{REDUCED_LIMIT_MS:.0f} ms")


def serve(client: TestClient, identity: int | None, suffix: str, n_modes: int) -> None:
    """Time single modes at fuel weights between those of the table."""
    rng = np.random.default_rng(1)
    times, sizes = [], []
    for _ in range(40):
        fuel, number = rng.uniform(), int(rng.integers(7, 7 + n_modes))
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
                "name": f"serve_shape{suffix}",
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
