"""A day of flying on one live stream: ``python backend/benchmarks/live_day.py [hours]``.

Eight hours of simulated test points of FLEX-28 (eight-mode truth, below the flutter speed, still
air to moderate turbulence, one every two and a half minutes) are pushed to a server in fast motion
while 20 browsers look on. Prints a JSON line per tenth: memory of the server and its processes,
alarms, and seconds without an estimate because the computer was too slow. A maneuver in real time
before and after gives the 95th percentile of the time from the push of a frame to its arrival at
the browsers. Other programs falsify the latter.
"""

from __future__ import annotations

import os

for _name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[_name] = "1"

import itertools
import json
import sys
import tempfile
import time
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor

import jobs
import live
import numpy as np
from endurance import is_server, list_processes, measure
from live_browsers import BROWSERS, CHANNELS, Browser, Feed
from live_intervals import AIR, AIRSPEEDS

from flexsid.demo.campaign import add_aircraft, add_maneuver
from flexsid.demo.flights import FlownManeuver, fly, record_flight
from flexsid.records.decision import Structure
from flexsid.records.live import Frame, StreamHeader
from flexsid.records.maneuver import Flight
from flexsid.records.run import EstimationRun, Method, OutOfBandModes, RunSettings, RunState
from flexsid.storage.migrate import upgrade
from flexsid.storage.store import Store
from flexsid.workflow.live.live_fit import FRAME_S, prepare_live_task
from flexsid.workflow.runs.run_proposal import apply_proposal

HOURS, TENTHS = 8.0, 10
PAUSE_S = 120.0
AHEAD_S = 3.0  # of the newest estimate, as far as the source may be
PER_PUSH = round(1.0 / FRAME_S)
STABLE = [ratio for ratio in AIRSPEEDS if ratio < 1.0]


def fly_one(number: int) -> FlownManeuver:
    """Fly one test point."""
    ratio, air = STABLE[number % len(STABLE)], AIR[number // len(STABLE) % len(AIR)]
    peak_deg = 2.0 if ratio < 0.9 else 1.6
    seed = (6200, number)
    return fly(airspeed_ratio=ratio, peak_deg=peak_deg, seed=seed, turbulence=air)


def add_run(store: Store) -> int:
    """Store the run that the stream is processed like: the structure proposed at .80 V_f."""
    flight = store.flights.add(Flight(aircraft_id=add_aircraft(store).id or 0, number=1))
    maneuver = add_maneuver(store, fly(airspeed_ratio=0.80, seed=(27, 1)), flight.id or 0)
    run = EstimationRun(
        maneuver_id=maneuver.id or 0,
        method=Method.OE,
        structure=Structure(fixed={}),
        settings=RunSettings(out_of_band_modes=OutOfBandModes.RETAINED),
        state=RunState.SUCCEEDED,
    )
    return store.runs.add(apply_proposal(store, run)).id or 0


def build_frames(header: StreamHeader, flown: list[FlownManeuver]) -> Iterator[Frame]:
    """Yield the frames of some test points with steady flight about them."""
    recorded = {c.name: c.samples.astype(float) for c in record_flight(flown, PAUSE_S)}
    groups = [np.stack([recorded[c.name] for c in group], axis=1) for group in header.groups]
    rows = [n for n, _ in header.frame_shapes]
    for k in range(min(len(g) // n for g, n in zip(groups, rows, strict=True))):
        samples = tuple(g[k * n : (k + 1) * n] for g, n in zip(groups, rows, strict=True))
        yield Frame(number=k, time_s=k * FRAME_S, samples=samples)


def push_fast(feed: Feed, browser: Browser, frames: Iterator[Frame]) -> None:
    """Push as fast as the server estimates, at least in real time."""
    while second := list(itertools.islice(frames, PER_PUSH)):
        begun = time.monotonic()
        feed.push(second)
        while is_ahead(feed, browser) and time.monotonic() < begun + 1.0:
            time.sleep(0.01)


def is_ahead(feed: Feed, browser: Browser) -> bool:
    """Whether estimates of many seconds are missing at a browser."""
    state = browser.snapshot["state"]
    estimate = state["estimate"] if state["phase"] == "excited" else None
    newest_s = state["time_s"] if estimate is None else estimate["time_s"]
    return feed.flown_s - newest_s > AHEAD_S


def read_states(port: int, stream_id: int, since_s: float) -> Iterator[dict]:
    """Yield the stored states of maneuvers after a time."""
    client, more = jobs.Client(port), True  # the server ends connections that are not used
    while more:
        address = f"/api/v1/live/streams/{stream_id}/history?since_s={since_s}&limit=1000"
        page = client.get(address)
        yield from page["states"]
        more, since_s = page["more"], page["states"][-1]["time_s"] if page["states"] else since_s


def report_delays(when: str, delays: list[list[float]]) -> None:
    """Print the 95th percentile over all frames and browsers."""
    live.report(f"live_day_p95_{when}_ms", float(np.percentile(np.concatenate(delays), 95)))


def main(hours: float) -> None:
    """Fly, and print what grows."""
    count = round(hours * 3600.0 / (PAUSE_S + 30.0) / TENTHS)
    with tempfile.TemporaryDirectory() as folder, ProcessPoolExecutor(1) as pool:
        address = f"sqlite:///{folder}/flexsid.db"
        upgrade(address)
        store = Store.open(address)
        run_id = add_run(store)
        header = prepare_live_task(store, store.runs.get(run_id)).header
        store.close()
        names = ",".join([c.name for group in header.groups for c in group][:CHANNELS])
        flights = pool.map(fly_one, range(TENTHS * count))
        with jobs.serve(address, None, 1) as port:
            body = {"run_id": run_id, "title": "benchmark", "receiver": {"name": "push"}}
            stream_id = jobs.Client(port).post("/api/v1/live/streams", body)["id"]
            browsers = [Browser(port, stream_id, names) for _ in range(BROWSERS)]
            for browser in browsers:
                browser.start()
            feed = Feed(port, stream_id, browsers)
            whole = list(build_frames(header, [fly_one(0)]))
            around = round(PAUSE_S / FRAME_S)
            maneuver = whole[around - PER_PUSH : len(whole) - around]
            feed.wait_for_browsers(whole[:PER_PUSH])
            report_delays("before", feed.push_slowly(maneuver))
            (root,) = (own for own in list_processes(os.getpid()) if is_server(own))
            found, since_s, begun = [], 0.0, time.monotonic()
            for tenth in range(TENTHS):
                flown = list(itertools.islice(flights, count))
                push_fast(feed, browsers[0], build_frames(header, flown))
                states = list(read_states(port, stream_id, since_s))
                since_s = states[-1]["time_s"]
                alarms = {(a["subject"], a["time_s"]) for s in states for a in s["state"]["alarms"]}
                skipped = sum("too slow" in s["state"]["reason"] for s in states)
                memory, files = measure(root)
                found.append((memory, files))
                line = {
                    "name": "live_day",
                    "tenth": tenth + 1,
                    "hours": round(feed.flown_s / 3600, 2),
                }
                line |= {"memory_mb": round(memory, 1), "files": files, "alarms": len(alarms)}
                line |= {"estimates": sum(s["state"]["estimate"] is not None for s in states)}
                line |= {"skipped": skipped, "elapsed_s": round(time.monotonic() - begun)}
                print(json.dumps(line), flush=True)
            report_delays("after", feed.push_slowly(maneuver))
            for browser in browsers:
                browser.is_over = True
            jobs.Client(port).post(f"/api/v1/live/streams/{stream_id}/stop", None)
    growth = np.array(found[-1]) / np.array(found[1]) - 1.0
    for name, value in zip(("memory", "files"), growth.tolist(), strict=True):
        live.report(f"live_day_{name}_growth", value, bar=0.05)


if __name__ == "__main__":
    main(float(sys.argv[1]) if len(sys.argv) > 1 else HOURS)
