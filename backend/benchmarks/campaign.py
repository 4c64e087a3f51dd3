"""How fast a campaign comes in and is read: ``python backend/benchmarks/campaign.py [--full]``.

A campaign of 1000 maneuvers x 90 channels (a tenth of it by default) is imported from
recorder files, through everything an import does: the reading process, the mapping, the
checks of clock, samples and units, and one transaction per maneuver. The same bytes are
written with plain sqlite3, one row per channel and one transaction per maneuver; the two
take turns flight by flight, so that a busy disk slows both. Then 20 channels of one
maneuver are read, beside raw reads of the same blobs, and the list page is asked for.

Maneuvers of FLEX-28 (4 by default, 1000 with ``--full``, an hour of simulation) are stored and
estimated by three methods with nuisance modes on one core, and fitted by a global model: the
whole beside the fits alone. Their import is measured above, and not part of it.
"""

from __future__ import annotations

import argparse
import json
import sqlite3
import statistics
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from fastapi.testclient import TestClient
from scipy.io import savemat

from flexsid.api.app import create_app
from flexsid.demo.campaign import add_aircraft, add_maneuver
from flexsid.demo.flights import fly
from flexsid.jobs.dispatcher import execute_request, execute_run
from flexsid.jobs.kind import get_result
from flexsid.jobs.kinds import GLOBAL_MODEL, RUN
from flexsid.records.aircraft import Aircraft, Geometry, MassTable, Surface
from flexsid.records.decision import Structure
from flexsid.records.maneuver import Flight
from flexsid.records.run import EstimationRun, Method, OutOfBandModes, RunSettings
from flexsid.settings import Settings
from flexsid.storage.migrate import upgrade
from flexsid.storage.recordings import read_channels
from flexsid.storage.store import Store
from flexsid.workflow.global_model.estimates import GlobalModelQuery
from flexsid.workflow.importing.flight_import import Imported, import_each, read_upload

N_CHANNELS, N_SAMPLES, RATE_HZ, N_READ = 90, 8000, 200.0, 20
MANEUVERS_PER_FLIGHT = 26

MAPPING = """
[aircraft]
name = "Campaign"
[flight]
number = {flight}
[maneuver]
fta = 506
[maneuver.condition]
airspeed = {{ value = 40.0, unit = "m/s" }}
density = {{ value = 1.1, unit = "kg/m3" }}
fuel_fraction = {{ value = 0.5 }}
[time]
rate = {{ value = 200, unit = "Hz" }}
[[channels]]
array = "surfaces"
labels = ["bfs", "wf1s", "wf2s", "wf3s", "wf4s"]
unit = "deg"
role = "input"
[[channels]]
array = "sensors"
labels = [{labels}]
unit = "V"
role = "output"
"""


def aircraft() -> Aircraft:
    """A kite to which the maneuvers belong."""
    return Aircraft(
        name="Campaign",
        geometry=Geometry(area_m2=1.0, chord_m=0.3, span_m=3.4),
        mass=MassTable(
            fuel=(0.0,), mass_kg=(10.0,), pitch_inertia_kg_m2=(1.0,), x_cg_m=(0.5,), z_cg_m=(0.0,)
        ),
        surfaces=tuple(Surface(name=name) for name in ("bfs", "wf1s", "wf2s", "wf3s", "wf4s")),
        sensors=(),
        instruments={},
    )


def record(path: Path, samples: np.ndarray, number: int) -> None:
    """Write a recorder file whose samples no other has."""
    samples += 1e-6 * (number + 1)  # deflections of 1000 maneuvers remain plausible
    savemat(path, {"surfaces": samples[:, :5], "sensors": samples[:, 5:]})


class Plain:
    """What anybody would write who knows sqlite3: one row per channel."""

    def __init__(self, file: Path) -> None:
        self.connection = sqlite3.connect(file, isolation_level=None)
        self.connection.execute("PRAGMA journal_mode = WAL")
        self.connection.execute("PRAGMA synchronous = NORMAL")
        self.connection.execute(
            "CREATE TABLE channels (maneuver INTEGER, number INTEGER, data BLOB)"
        )

    def write(self, number: int, samples: np.ndarray) -> None:
        """Write one maneuver."""
        self.connection.execute("BEGIN IMMEDIATE")
        for column in range(samples.shape[1]):
            data = np.ascontiguousarray(samples[:, column]).tobytes()
            row = (number, column, data)
            self.connection.execute("INSERT INTO channels VALUES (?, ?, ?)", row)
        self.connection.execute("COMMIT")


def seconds(work: Callable[[], object]) -> float:
    """Time of one call. [s]"""
    start = time.perf_counter()
    work()
    return time.perf_counter() - start


def report(name: str, ratio: float, baseline: str, **more: float) -> None:
    """Print one figure."""
    print(json.dumps({"name": name, "ratio": round(ratio, 3), "baseline": baseline, **more}))


def import_campaign(folder: Path, store: Store, n_maneuvers: int) -> None:
    """Import a flight, then write the same bytes plainly, and so on."""
    plain = Plain(folder / "plain.db")
    samples = np.random.default_rng(1).standard_normal((N_SAMPLES, N_CHANNELS))
    samples = np.asfortranarray(samples)
    labels = ", ".join(f'"s{number}"' for number in range(N_CHANNELS - 5))
    ours, theirs = [], []
    record(folder / "first.mat", samples, 0)
    read_upload(
        [folder / "first.mat"], MAPPING.format(flight=1, labels=labels)
    )  # starts the reader
    for first in range(0, n_maneuvers, MANEUVERS_PER_FLIGHT):
        numbers = range(first, min(first + MANEUVERS_PER_FLIGHT, n_maneuvers))
        paths = [folder / f"m{number}.mat" for number in numbers]
        for number, path in zip(numbers, paths, strict=True):
            record(path, samples, number)
        mapping = MAPPING.format(flight=1 + first // MANEUVERS_PER_FLIGHT, labels=labels)
        start = time.perf_counter()
        for path, result in import_each(store, paths, mapping):
            assert isinstance(result, Imported), f"{path}: {result}"
        ours.append(time.perf_counter() - start)
        start = time.perf_counter()
        for number in numbers:
            plain.write(number, samples)
        theirs.append(time.perf_counter() - start)
        for path in paths:
            path.unlink()
    plain.connection.close()
    megabytes = n_maneuvers * samples.nbytes / 1e6
    report(
        "import_vs_sqlite3",
        sum(theirs) / sum(ours),
        "the same bytes written with plain sqlite3",
        maneuvers=n_maneuvers,
        megabytes=round(megabytes),
        megabytes_per_s=round(megabytes / sum(ours), 1),
        maneuver_ms=round(1e3 * sum(ours) / n_maneuvers, 1),
        plain_ms=round(1e3 * sum(theirs) / n_maneuvers, 1),
    )


def read_maneuvers(file: Path, store: Store, n_maneuvers: int) -> None:
    """Read 20 channels of one maneuver, and the same blobs raw."""
    raw = sqlite3.connect(file)
    selected = np.random.default_rng(2).permutation(np.arange(1, n_maneuvers + 1))[:50]

    def ours(identity: int, names: list[str]) -> None:
        assert len(read_channels(store.database, identity, names)) == N_READ

    def plain(names: list[str]) -> None:
        for name in names:
            raw.execute("SELECT data FROM arrays WHERE hash = ?", (name,)).fetchone()

    of_maneuver = {
        int(identity): store.channels.find(maneuver_id=int(identity))[:N_READ]
        for identity in selected
    }
    read, blobs = [], []
    # Each maneuver once, as in use: neither side finds it in the cache of its connection.
    for turn, (identity, channels) in enumerate(of_maneuver.items()):
        both = [
            (read, partial(ours, identity, [channel.name for channel in channels])),
            (blobs, partial(plain, [channel.array for channel in channels])),
        ]
        for times, work in both if turn % 2 else reversed(both):
            times.append(seconds(work))
    raw.close()
    report(
        "read_vs_raw",
        statistics.median(read) / statistics.median(blobs),
        "the same blobs read with plain sqlite3",
        channels=N_READ,
        read_ms=round(1e3 * statistics.median(read), 2),
        plain_ms=round(1e3 * statistics.median(blobs), 2),
    )


def list_page(url: str) -> None:
    """Ask for the list as the page does."""
    with TestClient(create_app(Settings(database=url)), base_url="http://127.0.0.1") as client:
        times = []
        for _ in range(40):
            times.append(
                seconds(lambda: client.get("/api/v1/maneuvers?limit=50").raise_for_status())
            )
        whole = seconds(lambda: client.get("/api/v1/maneuvers?limit=1000").raise_for_status())
    median = statistics.median(times)
    report(
        "list_page",
        median / 0.1,
        "100 ms",
        median_ms=round(1e3 * median, 2),
        thousand_ms=round(1e3 * whole, 1),
    )


def fit_global_model(store: Store, n_maneuvers: int) -> None:
    """Estimate maneuvers over the envelope by three methods, and fit their global model."""
    aircraft = add_aircraft(store)
    rng = np.random.default_rng(3)
    flights = [
        store.flights.add(Flight(aircraft_id=aircraft.id or 0, number=number)).id or 0
        for number in range(1, 2 + (n_maneuvers - 1) // MANEUVERS_PER_FLIGHT)
    ]
    run_ids, whole, fits = [], 0.0, 0.0
    for number in range(n_maneuvers):
        ratio, fuel = rng.uniform(0.5, 0.95), rng.uniform(0.1, 0.9)
        flown = fly(airspeed_ratio=ratio, fuel=fuel, seed=(7, number), label=f"maneuver {number}")
        start = time.perf_counter()
        maneuver = add_maneuver(store, flown, flights[number // MANEUVERS_PER_FLIGHT])
        for method in Method:
            requested = EstimationRun(
                maneuver_id=maneuver.id or 0,
                method=method,
                structure=Structure(modes=(7, 9), fixed={}),
                settings=RunSettings(out_of_band_modes=OutOfBandModes.RETAINED),
            )
            run = execute_run(store, requested, RUN, lambda progress: None)
            assert run.result is not None, run.error
            fits += run.result.fit.seconds
            run_ids.append(run.id or 0)
        whole += time.perf_counter() - start
    query = GlobalModelQuery(run_ids=tuple(run_ids))
    start = time.perf_counter()
    execute_request(store, GLOBAL_MODEL, query, lambda progress: None)
    seconds_model = time.perf_counter() - start
    summary = get_result(store, GLOBAL_MODEL, query).summary
    report(
        "global_model_vs_fits",
        (whole + seconds_model) / fits,
        "the sum of the fits on one core",
        maneuvers=n_maneuvers,
        runs=len(run_ids),
        derivatives=len(summary.derivatives),
        outlying=len(summary.outliers),
        fits_s=round(fits, 1),
        global_model_s=round(seconds_model, 2),
    )


def main() -> None:
    """Run all of it."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--full", action="store_true", help="1000 maneuvers, 6 GB twice")
    n_maneuvers = 1000 if parser.parse_args().full else 100
    with TemporaryDirectory(prefix="flexsid-campaign-") as name:
        folder = Path(name)
        url = f"sqlite:///{folder / 'flexsid.db'}"
        upgrade(url)
        store = Store.open(url)
        store.aircraft.add(aircraft())
        import_campaign(folder, store, n_maneuvers)
        read_maneuvers(folder / "flexsid.db", store, n_maneuvers)
        store.close()
        list_page(url)
        url = f"sqlite:///{folder / 'flex28.db'}"
        upgrade(url)
        store = Store.open(url)
        fit_global_model(store, 1000 if n_maneuvers == 1000 else 4)
        store.close()


if __name__ == "__main__":
    main()
