"""Frames of the screen that strip charts drop: ``python backend/benchmarks/live_page.py``.

A simulated maneuver of FLEX-28 is replayed in real time, and the page of the stream draws 12
channels in a browser without graphics processor. Frames are counted by ``requestAnimationFrame``.
Prints one JSON line: ``live_dropped_frames`` is the share of 60 per second that are dropped,
``empty_page`` the same on an empty page before, since the computer has other work too, and
``main_thread_share`` the busy time of the main thread of the page.
"""

from __future__ import annotations

import json
import os
import shutil
import socket
import subprocess
import sys
import time
import urllib.request
from contextlib import closing
from itertools import pairwise
from pathlib import Path
from tempfile import TemporaryDirectory

from playwright.sync_api import Page, expect, sync_playwright

from flexsid.client import Workbench
from flexsid.demo.campaign import add_aircraft, add_maneuver
from flexsid.demo.flights import fly
from flexsid.jobs.dispatcher import execute_run
from flexsid.jobs.kinds import RUN
from flexsid.records.decision import Structure
from flexsid.records.maneuver import Flight
from flexsid.records.run import EstimationRun, Method, RunSettings
from flexsid.storage.migrate import upgrade
from flexsid.storage.store import Store

TRACES, SECONDS, FRAME_MS = 12, 20.0, 1e3 / 60.0
FLEXSID = (
    sys.executable,
    "-c",
    "import sys; from flexsid.cli.main import main; sys.exit(main(sys.argv[1:]))",
)
COUNT = """(duration) => new Promise((done) => {
    const times = [];
    const tick = (now) => {
        times.push(now);
        if (now - times[0] < duration) requestAnimationFrame(tick);
        else done(times);
    };
    requestAnimationFrame(tick);
})"""


def add_flight(url: str) -> None:
    """Fly one maneuver and estimate it."""
    upgrade(url)
    store = Store.open(url)
    aircraft = add_aircraft(store)
    flight = store.flights.add(Flight(aircraft_id=aircraft.id or 0, number=1))
    flown = add_maneuver(store, fly(airspeed_ratio=0.65, label="FTA 506"), flight.id or 0)
    run = EstimationRun(
        maneuver_id=flown.id or 0,
        method=Method.OE,
        structure=Structure(modes=(7, 9), fixed={}),
        settings=RunSettings(),
        prediction_id=1,
    )
    execute_run(store, run, RUN, lambda progress: None)
    store.close()


def start_replay(address: str) -> tuple[int, list[str]]:
    """Start a replay in real time; return the stream and its first channels."""
    workbench = Workbench(address)
    receiver = {"name": "replay", "options": {"maneuver_id": 1, "speed": 1.0}}
    stream = workbench.post("live/streams", {"run_id": 1, "title": "Replay", "receiver": receiver})[
        "id"
    ]
    channels = workbench.get(f"live/streams/{stream}")["header"]["channels"]
    return stream, [channel["name"] for channel in channels[:TRACES]]


def count_dropped(page: Page) -> tuple[float, float]:
    """Share of dropped frames, and of the busy time of the main thread."""
    session = page.context.new_cdp_session(page)
    session.send("Performance.enable")

    def read() -> dict[str, float]:
        found = session.send("Performance.getMetrics")["metrics"]
        return {metric["name"]: metric["value"] for metric in found}

    before = read()
    times = page.evaluate(COUNT, 1e3 * SECONDS)
    after = read()
    steps = [later - now for now, later in pairwise(times)]
    dropped = sum(max(0, round(step / FRAME_MS) - 1) for step in steps)
    busy = after["TaskDuration"] - before["TaskDuration"]
    return dropped / (len(steps) + dropped), busy / (after["Timestamp"] - before["Timestamp"])


def main() -> None:
    """Measure and print one line."""
    program = next(filter(None, map(shutil.which, ("chromium", "chromium-browser"))), None)
    if program is None:
        sys.exit("no Chromium on PATH; on Debian: apt-get install chromium")
    with TemporaryDirectory() as folder, closing(socket.socket()) as probe:
        url = f"sqlite:///{Path(folder) / 'live.db'}"
        add_flight(url)
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
        probe.close()
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
                page.goto("about:blank")
                empty, _ = count_dropped(page)
                stream, names = start_replay(address)
                page.goto(f"{address}/live/{stream}?channels={','.join(names)}")
                strips = page.locator("[data-testid^=strip-] .strip-value")
                expect(strips).to_have_count(len(names), timeout=120_000)
                expect(page.get_by_test_id("live-modes")).to_be_visible(timeout=120_000)
                dropped, busy = count_dropped(page)
                browser.close()
        finally:
            server.terminate()
            server.wait(timeout=20)
    line = {
        "name": "live_dropped_frames",
        "value": round(dropped, 4),
        "empty_page": round(empty, 4),
        "main_thread_share": round(busy, 3),
        "traces": len(names),
        "seconds": SECONDS,
    }
    print(json.dumps(line), flush=True)


def _wait(address: str) -> None:
    for _ in range(1800):
        try:
            with urllib.request.urlopen(f"{address}/api/v1/health", timeout=2):
                return
        except OSError:
            time.sleep(0.1)
    sys.exit("the server does not respond")


if __name__ == "__main__":
    main()
