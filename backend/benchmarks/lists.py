"""Response time of lists in a large database: ``python backend/benchmarks/lists.py``.

A campaign of 100,000 maneuvers and 1,000,000 runs on PostgreSQL is laid out of copies of three
flown maneuvers and their nine runs. Pages of lists are read over the interface, one after the
other: by default, filtered, sorted, searched, and the next page. Prints a JSON line per list and
one of all; the bar is 300 ms for the 95th percentile.

``--maneuvers`` and ``--runs`` set their number, ``--database URL`` an empty database of PostgreSQL;
by default a temporary server is started.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import jobs
import sqlalchemy as sa

from flexsid.demo.campaign import add_aircraft, add_maneuver
from flexsid.demo.flights import fly
from flexsid.jobs.dispatcher import execute_run
from flexsid.jobs.kinds import RUN
from flexsid.records.decision import Structure
from flexsid.records.maneuver import Flight
from flexsid.records.run import EstimationRun, Method, RunSettings
from flexsid.storage import tables
from flexsid.storage.migrate import upgrade
from flexsid.storage.store import Store

sys.path.insert(0, str(Path(__file__).parents[2] / "tests" / "servers"))

_PER_FLIGHT = 40
_REPETITIONS = 20
_BAR_MS = 300.0
_LISTS = {
    "maneuvers": "maneuvers?limit=50",
    "maneuvers_of_a_flight_test_aid": "maneuvers?limit=50&fta=506&min_airspeed_ratio=0.7",
    "maneuvers_by_airspeed": "maneuvers?limit=50&sort=-airspeed_ratio",
    "maneuvers_searched": "maneuvers?limit=50&search=copy 4321",
    "maneuver_facets": "maneuvers/facets",
    "runs": "runs?limit=50",
    "runs_of_a_method": "runs?limit=50&method=OE&state=succeeded",
    "runs_of_a_maneuver": "runs?limit=50&maneuver_id=777",
    "runs_by_airspeed": "runs?limit=50&sort=-airspeed_ratio",
    "runs_searched": "runs?limit=50&search=copy 4321",
    "run_facets": "runs/facets",
    "jobs": "jobs?limit=50",
}


@contextmanager
def provide_database(url: str | None) -> Iterator[str]:
    """Yield the URL of an empty database."""
    if url is not None:
        yield url
        return
    from postgresql import Cluster, find_programs

    programs = find_programs()
    if programs is None:
        raise SystemExit("PostgreSQL is not installed; name a database by --database")
    cluster = Cluster(programs)
    try:
        yield cluster.url(cluster.copy())
    finally:
        cluster.remove()


def fill(url: str, n_maneuvers: int, n_runs: int) -> None:
    """Lay the campaign out."""
    upgrade(url)
    store = Store.open(url)
    aircraft = add_aircraft(store).id or 0
    flight = store.flights.add(Flight(aircraft_id=aircraft, number=1)).id or 0
    for ratio in (0.56, 0.72, 0.8):
        flown = add_maneuver(store, fly(airspeed_ratio=ratio, label=f"flown at {ratio}"), flight)
        for method in Method:
            run = EstimationRun(
                maneuver_id=flown.id or 0,
                method=method,
                structure=Structure(modes=(7, 9), fixed={}),
                settings=RunSettings(),
            )
            execute_run(store, run, RUN, lambda progress: None)
    k = sa.column("k", sa.Integer)
    with store.database.transaction() as connection:

        def copy(table: sa.Table, n: int, template: sa.ColumnElement[int], **new: Any) -> None:
            """Copy the rows of a table, the ``template``-th of which is that of copy k."""
            (key,) = table.primary_key.columns
            series = sa.func.generate_series(1, n).table_valued("k").render_derived()
            names = [column.name for column in table.c]
            values = [new.get(name, table.c[name]) for name in names]
            rows = sa.select(*values).select_from(sa.join(series, table, key == template))
            connection.execute(sa.insert(table).from_select(names, rows))

        n_flights = n_maneuvers // _PER_FLIGHT + 1
        # pyrefly: ignore[unsupported-operation]
        copy(tables.flights, n_flights, sa.literal(flight), id=flight + k, number=k + 1)
        copy(
            tables.maneuvers,
            n_maneuvers,
            1 + k % 3,
            # pyrefly: ignore[unsupported-operation]
            id=3 + k,
            flight_id=flight + 1 + k / _PER_FLIGHT,
            label=sa.func.concat("copy ", k),
            fta=503 + 3 * (k % 2),
            airspeed_ratio=0.5 + 0.6 * (k * 37 % 100) / 100.0,
            airspeed_m_s=25.0 + 0.3 * (k * 37 % 100),
        )
        of_copy = 1 + k % 9
        # pyrefly: ignore[unsupported-operation]
        copy(tables.jobs, n_runs, of_copy, id=9 + k)
        copy(
            tables.runs,
            n_runs,
            of_copy,
            # pyrefly: ignore[unsupported-operation]
            id=9 + k,
            maneuver_id=4 + k % n_maneuvers,
            result=sa.null(),  # 50 kB that lists do not read
        )
        # pyrefly: ignore[unsupported-operation]
        copy(tables.run_summaries, n_runs, of_copy, run_id=9 + k)
    with store.database.engine.connect() as connection:
        connection.execution_options(isolation_level="AUTOCOMMIT").exec_driver_sql(
            "VACUUM ANALYZE"  # as a server does by itself, a minute after so many rows
        )
    store.close()


def main() -> None:
    """Fill a database, and read its lists."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--maneuvers", type=int, default=100_000)
    parser.add_argument("--runs", type=int, default=1_000_000)
    parser.add_argument("--database", help="an empty database; by default a temporary server")
    arguments = parser.parse_args()
    every: list[float] = []
    with provide_database(arguments.database) as url:
        fill(url, arguments.maneuvers, arguments.runs)
        with jobs.serve(url, None, 1) as port:
            client = jobs.Client(port)
            for name, path in _LISTS.items():
                address = "/api/v1/" + path.replace(" ", "%20")
                times: list[float] = []
                for _ in range(_REPETITIONS):
                    start = time.perf_counter()
                    client.get(address)
                    times.append(1e3 * (time.perf_counter() - start))
                every += times
                line = {
                    "name": f"lists_{name}",
                    "median_ms": round(sorted(times)[len(times) // 2], 1),
                }
                print(
                    json.dumps(line | {"p95_ms": round(jobs.percentile(times, 0.95), 1)}),
                    flush=True,
                )
    total = {"maneuvers": arguments.maneuvers, "runs": arguments.runs, "bar_ms": _BAR_MS}
    result = {"name": "lists_p95_ms", "value": round(jobs.percentile(every, 0.95), 1)}
    print(json.dumps(result | total), flush=True)


if __name__ == "__main__":
    main()
