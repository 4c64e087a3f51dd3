"""Response and drawing time of pages in a large campaign: ``python backend/benchmarks/pages.py``.

A campaign of 1000 maneuvers and 10 000 runs is laid out of copies: a few maneuvers of FLEX-28
are flown and estimated by all methods, so that every copy of a run weighs what a run weighs.
A browser then opens the first page, the filtered list, the dashboard, the comparison of 12 runs
and a Bode page. The requests that each page makes are noted and asked again, one after the
other; the slowest median of a page stands against 100 ms, the time until it is drawn against 1.5 s.

``--maneuvers`` sets their number, ``--database FILE`` reuses a database.
"""

from __future__ import annotations

import argparse
import gzip
import json
import os
import shutil
import socket
import statistics
import subprocess
import sys
import time
import urllib.request
from contextlib import closing
from pathlib import Path
from tempfile import TemporaryDirectory

import sqlalchemy as sa
from playwright.sync_api import Page, Request, expect, sync_playwright

from flexsid.demo.campaign import add_aircraft, add_maneuver
from flexsid.demo.flights import fly
from flexsid.jobs.dispatcher import execute_run
from flexsid.jobs.kinds import RUN
from flexsid.records.decision import Structure
from flexsid.records.maneuver import Flight
from flexsid.records.run import EstimationRun, Method, RunSettings
from flexsid.storage.lists.run_list import store_hash
from flexsid.storage.migrate import upgrade
from flexsid.storage.store import Store
from flexsid.storage.tables import channels, jobs, maneuvers, run_summaries, runs

RUNS_PER_MANEUVER, MANEUVERS_PER_FLIGHT = 10, 26
RESPONSE_MS, DRAWN_MS, JS_KB = 100.0, 1500.0, 250.0
TIMES, LOADS = 9, 5
FLEXSID = (
    sys.executable,
    "-c",
    "import sys; from flexsid.cli.main import main; sys.exit(main(sys.argv[1:]))",
)


def lay_out(url: str, n_maneuvers: int) -> None:
    """Fill a database with copies of a few maneuvers and their runs."""
    upgrade(url)
    store = Store.open(url)
    aircraft = add_aircraft(store)
    assert aircraft.id is not None
    first = store.flights.add(Flight(aircraft_id=aircraft.id, number=1))
    assert first.id is not None
    for ratio in (0.56, 0.72, 0.8):
        flown = add_maneuver(store, fly(airspeed_ratio=ratio, label=f"flown at {ratio}"), first.id)
        assert flown.id is not None
        for method in Method:
            run = EstimationRun(
                maneuver_id=flown.id,
                method=method,
                structure=Structure(modes=(7, 9), fixed={}),
                settings=RunSettings(),
                prediction_id=1,
            )
            execute_run(store, run, RUN, lambda progress: None)
    with store.transaction():
        for identity in (1, 2, 3):
            _copy_runs(store, identity, identity, RUNS_PER_MANEUVER - len(Method))
        flight_id = first.id
        for number in range(3, n_maneuvers):
            if number % MANEUVERS_PER_FLIGHT == 0:
                flight_number = 1 + number // MANEUVERS_PER_FLIGHT
                flight = store.flights.add(Flight(aircraft_id=aircraft.id, number=flight_number))
                assert flight.id is not None
                flight_id = flight.id
            _copy_maneuver(store, number, flight_id)
    store.close()


def _copy_maneuver(store: Store, number: int, flight_id: int) -> None:
    template = 1 + number % 3
    new: dict[str, object] = {
        "flight_id": flight_id,
        "label": f"maneuver {number}",
        "airspeed_ratio": 0.5 + 0.6 * ((number * 37) % 100) / 100,
        "fuel_fraction": ((number * 53) % 100) / 100,
        "airspeed_m_s": 25.0 + 0.3 * ((number * 37) % 100),
        "fta": 503 if number % 2 else 506,
    }
    with store.database.transaction() as connection:
        identity = connection.execute(_copies(maneuvers, maneuvers.c.id == template, new)).lastrowid
        where = channels.c.maneuver_id == template
        connection.execute(_copies(channels, where, {"maneuver_id": identity}))
    _copy_runs(store, template, identity, RUNS_PER_MANEUVER)


def _copy_runs(store: Store, template: int, maneuver_id: int, count: int) -> None:
    """Give a maneuver copies of the three runs of another."""
    with store.database.transaction() as connection:
        for index in range(count):
            run_id = 1 + 3 * (template - 1) + index % 3
            job = connection.execute(_copies(jobs, jobs.c.id == run_id, {})).lastrowid
            new: dict[str, object] = {"id": job, "maneuver_id": maneuver_id}
            connection.execute(_copies(runs, runs.c.id == run_id, new))
            of_run = run_summaries.c.run_id == run_id
            connection.execute(_copies(run_summaries, of_run, {"run_id": job}))
            # A copy is of its own maneuver.
            ids = sa.func.json_set(
                run_summaries.c.estimates, "$.maneuver_ids", sa.func.json_array(maneuver_id)
            )
            copied = sa.update(run_summaries).where(run_summaries.c.run_id == job)
            connection.execute(copied.values(estimates=ids))
            store_hash(connection, job)


def _copies(table: sa.Table, where: sa.ColumnElement[bool], new: dict[str, object]) -> sa.Insert:
    names = [column.name for column in table.c if column.name != "id" or "id" in new]
    values = [sa.literal(new[n], table.c[n].type) if n in new else table.c[n] for n in names]
    return sa.insert(table).from_select(names, sa.select(*values).where(where))


def pages(url: str) -> dict[str, tuple[str, str]]:
    """Return the address of each page and the element that shows that it is drawn."""
    store = Store.open(url)
    last = store.maneuver_page(sort="-id", limit=4).items
    compared = [run.id for run in store.run_page(state=None, limit=12).items]
    own = [run.id for run in store.run_page(maneuver_id=last[0].id, limit=2).items]
    store.close()
    drawn = "[data-testid=figure-{}][data-drawn=true]"
    listed = ",".join(map(str, compared))
    models = ",".join(map(str, own))
    return {
        "first_page": ("/", ".lines li"),
        "list_filter": (
            "/campaign?min_ratio=0.8&fta=506&method=OE&sort=-airspeed_ratio",
            drawn.format("envelope"),
        ),
        "dashboard": ("/dashboard", drawn.format("derivative-coverage")),
        "run_filter": ("/runs?method=FRE&state=succeeded&sort=maneuver_label", "#content tbody tr"),
        "comparison": (f"/compare?runs={listed}&predictions=1,2", drawn.format("derivatives")),
        "bode": (f"/maneuvers/{last[0].id}?tab=bode&models={models}", drawn.format("bode")),
    }


def measure(address: str, page: Page, name: str, path: str, drawn: str) -> dict[str, object]:
    """Open a page several times, then ask its requests again."""
    asked: list[Request] = []

    def requested(request: Request) -> None:
        asked.append(request)

    page.on("request", requested)
    page.goto(address + path)
    expect(page.locator(drawn).first).to_be_visible(timeout=30_000)
    page.wait_for_timeout(1500)  # never idle: the stream of job events holds one request open
    page.remove_listener("request", requested)
    took = []
    for _ in range(LOADS):
        page.goto("about:blank")
        start = time.perf_counter()
        page.goto(address + path, wait_until="commit")
        page.locator(drawn).first.wait_for(state="visible")
        took.append(1e3 * (time.perf_counter() - start))
    urls = dict.fromkeys(
        request.url
        for request in asked
        if "/api/v1/" in request.url and "/events" not in request.url
    )
    scripts = {request.url for request in asked if request.url.endswith(".js")}
    weight = sum(len(gzip.compress(_get(url))) for url in scripts if "plotly" not in url)
    medians = {url: _median_ms(url) for url in urls}
    slowest = max(medians, key=lambda url: medians[url])
    return {
        "name": name,
        "ratio": round(medians[slowest] / RESPONSE_MS, 3),
        "baseline": f"{RESPONSE_MS:g} ms per request",
        "slowest_ms": round(medians[slowest], 1),
        "slowest": slowest.removeprefix(address),
        "requests": len(urls),
        "drawn_ms": round(statistics.median(took)),
        "drawn_limit_ms": DRAWN_MS,
        "js_kb_gz": round(weight / 1000, 1),
        "js_limit_kb_gz": JS_KB,
    }


def _median_ms(url: str) -> float:
    took = []
    for _ in range(TIMES):
        start = time.perf_counter()
        _get(url)
        took.append(1e3 * (time.perf_counter() - start))
    return statistics.median(took)


def _get(url: str) -> bytes:
    with urllib.request.urlopen(url) as response:
        return response.read()


def main() -> None:
    """Print one line per page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--maneuvers", type=int, default=1000)
    parser.add_argument("--database", type=Path, help="database to use, created if missing")
    arguments = parser.parse_args()
    program = next(filter(None, map(shutil.which, ("chromium", "chromium-browser"))), None)
    if program is None:
        sys.exit("no Chromium on PATH; on Debian: apt-get install chromium")
    with TemporaryDirectory() as folder:
        file = arguments.database or Path(folder) / "campaign.db"
        url = f"sqlite:///{file}"
        if not file.is_file():
            lay_out(url, arguments.maneuvers)
        with closing(socket.socket()) as probe:
            probe.bind(("127.0.0.1", 0))
            port = probe.getsockname()[1]
        environment = {**os.environ, "FLEXSID_PORT": str(port), "OPENBLAS_NUM_THREADS": "1"}
        server = subprocess.Popen([*FLEXSID, "serve", "--database", url], env=environment)
        address = f"http://127.0.0.1:{port}"
        try:
            _wait(address)
            with sync_playwright() as playwright:
                browser = playwright.chromium.launch(
                    executable_path=program, args=["--no-sandbox", "--disable-gpu"]
                )
                page = browser.new_page(viewport={"width": 1440, "height": 1000})
                for name, (path, drawn) in pages(url).items():
                    print(json.dumps(measure(address, page, name, path, drawn)), flush=True)
                browser.close()
        finally:
            server.terminate()
            server.wait(timeout=20)


def _wait(address: str) -> None:
    for _ in range(300):
        try:
            with urllib.request.urlopen(f"{address}/api/v1/health", timeout=2):
                return
        except OSError:
            time.sleep(0.1)
    sys.exit("the server does not respond")


if __name__ == "__main__":
    main()
