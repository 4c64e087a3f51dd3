"""What live identification costs and how fast it is: ``python backend/benchmarks/live.py``.

Prints one JSON line per figure. ``live_core_share``: transforms and checks of 100 channels at
200 Hz and 325 harmonics, CPU time over time of the record, without estimates.
``live_estimate_core_share``: estimates every second of a simulated maneuver, still air, CPU time of
one process. ``sample_to_screen_p95_ms``: from the arrival of a frame to its columns in the
server, in real time, with the processes of the server, while estimates are computed; the network
and the browser are not included. ``estimate_age_p95_ms``: from the arrival of the last sample to
the state with its estimate. ``alarm_delay_p95_ms``: from the arrival of a sample beyond its limit
to the state with the alarm. The last three are in the time of the clock, with the load of the
computer when they began.
"""

from __future__ import annotations

import os

for _name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[_name] = "1"

import json
import tempfile
import threading
import time
from dataclasses import replace

import numpy as np

from flexsid.demo.campaign import add_aircraft, add_maneuver
from flexsid.demo.flights import fly
from flexsid.records.decision import Structure
from flexsid.records.live import Frame, LiveStream, ReceiverSettings
from flexsid.records.maneuver import Flight
from flexsid.records.run import EstimationRun, Method, OutOfBandModes, RunSettings, RunState
from flexsid.storage.live_history import list_states
from flexsid.storage.migrate import upgrade
from flexsid.storage.store import Store
from flexsid.streams.live_streams import LiveStreams
from flexsid.sysid.preparation.spikes_and_dropouts import StreamChecks
from flexsid.sysid.spectra.growing_record import ChannelGroup, GrowingRecord
from flexsid.workflow.live.frame_assembler import encode_frame, pace, read_replay
from flexsid.workflow.live.live_estimator import LiveProcessor
from flexsid.workflow.live.live_fit import FRAME_S, prepare_live_task

CHANNELS, RATE_HZ, SECONDS = 100, 200.0, 30.0
OMEGA = 2.0 * np.pi * np.arange(6, 331) / 24.0


def main() -> None:
    """Measure and print everything."""
    print_core_share()
    with tempfile.TemporaryDirectory() as folder:
        store, stream = simulate_stream(folder)
        print_estimate_share(store, stream)
        print_latency(store, stream)
        print_alarm_delay(store, stream)
        store.close()


def print_core_share() -> None:
    """Transforms and checks of a wide stream."""
    rng = np.random.default_rng(0)
    names = tuple(f"c{k}" for k in range(CHANNELS))
    delays = tuple(rng.choice([0.011, 0.015, 0.016, 0.021, 0.028], CHANNELS).tolist())
    record = GrowingRecord(OMEGA, [ChannelGroup(RATE_HZ, names, delays)])
    checks = StreamChecks(RATE_HZ, CHANNELS, np.ones(CHANNELS, dtype=bool))
    block = round(FRAME_S * RATE_HZ)
    samples = rng.normal(size=(round(SECONDS * RATE_HZ), CHANNELS))
    begun, taken = time.process_time(), 0
    for first in range(0, len(samples), block):
        checks.append(samples[first : first + block])
        while checks.ready >= block:
            checked = checks.take(block, moving=True)
            record.append(taken * FRAME_S, [checked.samples])
            taken += 1
            if taken % round(1.0 / FRAME_S) == 0:
                record.compute_spectra()
    share = (time.process_time() - begun) / SECONDS
    report("live_core_share", share, channels=CHANNELS, harmonics=OMEGA.size, rate_hz=RATE_HZ)


def simulate_stream(folder: str) -> tuple[Store, LiveStream]:
    """Simulate a maneuver of FLEX-28, four modes identified and four retained with priors."""
    address = f"sqlite:///{folder}/flexsid.db"
    upgrade(address)
    store = Store.open(address)
    aircraft = add_aircraft(store)
    flight = store.flights.add(Flight(aircraft_id=aircraft.id or 0, number=1)).id or 0
    maneuver = add_maneuver(store, fly(airspeed_ratio=0.80, seed=(27, 1)), flight)
    run = store.runs.add(
        EstimationRun(
            maneuver_id=maneuver.id or 0,
            method=Method.OE,
            structure=Structure(modes=(7, 9, 11, 12), fixed={}),
            settings=RunSettings(out_of_band_modes=OutOfBandModes.RETAINED),
            state=RunState.SUCCEEDED,
        )
    )
    stream = LiveStream(
        aircraft_id=aircraft.id or 0,
        run_id=run.id or 0,
        title="benchmark",
        receiver=ReceiverSettings(name="push"),
    )
    return store, stream


def print_estimate_share(store: Store, stream: LiveStream) -> None:
    """Process a maneuver in this process."""
    task = prepare_live_task(store, store.runs.get(stream.run_id))
    frames = list(read_replay(store, 1, task.header).frames())
    processor = LiveProcessor(task)
    begun = time.process_time()
    for frame in frames:
        processor.push(frame)
    processor.finish()
    share = (time.process_time() - begun) / (len(frames) * FRAME_S)
    report("live_estimate_core_share", share, channels=sum(map(len, task.header.groups)))


def print_latency(store: Store, stream: LiveStream) -> None:
    """Push a maneuver in real time; read what the server has."""
    load = os.getloadavg()[0]
    sent: dict[int, float] = {}
    seen: dict[int, float] = {}

    def notice(stream_id: int) -> None:
        newest_s = streams.find_newest_s(stream_id)
        if newest_s is not None:
            seen.setdefault(round(newest_s / FRAME_S) - 1, time.monotonic())

    streams = LiveStreams(store, on_change=notice)
    stored, frames = start(streams, store, stream)
    for frame in pace(frames, FRAME_S, 1.0):
        sent[frame.number] = time.monotonic()
        streams.push(stored.id or 0, encode_frame(frame))
    streams.stop(stored.id or 0)
    delays = 1e3 * np.array([seen[number] - at for number, at in sent.items()])
    states, _ = list_states(store, stored.id or 0, None, 1000)
    fresh = [
        one.delay_s
        for one in states
        if one.state.estimate is not None and one.state.estimate.time_s == one.time_s
    ]
    streams.close()
    p95 = float(np.percentile(delays, 95))
    report("sample_to_screen_p95_ms", p95, worst_ms=delays.max(), frames=delays.size, load=load)
    age = 1e3 * np.array(fresh)
    p95 = float(np.percentile(age, 95))
    report("estimate_age_p95_ms", p95, worst_ms=age.max(), estimates=age.size, load=load)


def print_alarm_delay(store: Store, stream: LiveStream) -> None:
    """Let one channel after the other leave its limits, in real time."""
    load = os.getloadavg()[0]
    task = prepare_live_task(store, store.runs.get(stream.run_id))
    names = [c.name for group in task.header.groups for c in group][:30]
    raised: dict[str, float] = {}
    changed = threading.Event()
    streams = LiveStreams(store, on_change=lambda _: changed.set())
    limited = replace(stream, limits=dict.fromkeys(names, (-1e6, 1e6)))
    stored, frames = start(streams, store, limited)

    def watch() -> None:
        while len(raised) < len(names) and changed.wait(30.0):
            changed.clear()
            snapshot = streams.find_snapshot(stored.id or 0)
            if snapshot is not None and snapshot.state is not None:
                for alarm in snapshot.state.alarms:
                    raised.setdefault(alarm.subject, time.monotonic())

    watcher = threading.Thread(target=watch)
    watcher.start()
    sent: dict[str, float] = {}
    for frame in pace(frames[: 2 * len(names)], FRAME_S, 1.0):
        name = names[(frame.number - 1) // 2]  # the first frame started the stream
        if name not in sent:
            for group, samples in zip(task.header.groups, frame.samples, strict=True):
                for column, channel in enumerate(group):
                    if channel.name == name:
                        samples[:, column] = 2e6
            sent[name] = time.monotonic()
        streams.push(stored.id or 0, encode_frame(frame))
    watcher.join()
    streams.close()
    delays = [1e3 * (raised[name] - sent[name]) for name in names]
    p95 = float(np.percentile(delays, 95))
    report("alarm_delay_p95_ms", p95, worst_ms=max(delays), alarms=len(delays), load=load)


def start(streams: LiveStreams, store: Store, stream: LiveStream) -> tuple[LiveStream, list[Frame]]:
    """Start a stream and wait until its process takes frames; return its frames."""
    stored = streams.start(stream)
    assert stored.id is not None
    task = streams.find_task(stored.id)
    header = None if task is None else task.header
    assert header is not None
    frames = [
        replace(frame, samples=tuple(x.copy() for x in frame.samples))
        for frame in read_replay(store, 1, header).frames()
    ]
    # Frames before those of the maneuver, until one comes back.
    first = replace(frames[0], number=0)
    while streams.find_newest_s(stored.id) is None:
        streams.push(stored.id, encode_frame(first))
        time.sleep(1.0)
    moved = [replace(f, number=f.number + 1, time_s=f.time_s + FRAME_S) for f in frames]
    time.sleep(2.0)
    return stored, moved


def report(name: str, value: float, **values: float | int) -> None:
    """One JSON line."""
    rounded = {k: float(f"{v:.4g}") if isinstance(v, float) else v for k, v in values.items()}
    print(json.dumps({"name": name, "value": float(f"{value:.4g}"), **rounded}), flush=True)


if __name__ == "__main__":
    main()
