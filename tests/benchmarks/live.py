"""What live identification costs and how fast it is: ``python tests/benchmarks/live.py``.

Prints one JSON line per figure. ``live_core_share``: transforms and checks of 100 channels at
200 Hz and 325 harmonics, CPU time over time of the record, without estimates.
``live_estimate_core_share``: estimates every second of a simulated maneuver, still air.
``sample_to_screen_p95_ms``: a frame from its arrival to the state that it completes; estimates
are computed in the same process, and frames that arrive meanwhile wait. ``alarm_delay_p95_ms``:
a sample beyond its limit to the state with the alarm, from the end of its frame on. Both are in
CPU time, as on a free core, so that a loaded machine does not change them; no network or browser
is included.
"""

from __future__ import annotations

import os

for _name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[_name] = "1"

import json
import tempfile
import time
from dataclasses import replace

import numpy as np

from flexsid.demo.campaign import add_aircraft, add_maneuver
from flexsid.demo.flights import fly
from flexsid.records.live import AlarmKind, Frame
from flexsid.records.maneuver import Flight
from flexsid.records.model_structure import Structure
from flexsid.records.run import EstimationRun, Method, OutOfBandModes, RunSettings
from flexsid.storage.migrate import upgrade
from flexsid.storage.store import Store
from flexsid.sysid.preparation.stream_checks import StreamChecks
from flexsid.sysid.spectra.growing_record import ChannelGroup, GrowingRecord
from flexsid.workflow.live.live_estimator import LiveProcessor
from flexsid.workflow.live.live_task import FRAME_S, LiveTask, prepare_live_task
from flexsid.workflow.live.replay import read_replay

CHANNELS, RATE_HZ, SECONDS = 100, 200.0, 30.0
OMEGA = 2.0 * np.pi * np.arange(6, 331) / 24.0


def main() -> None:
    """Measure and print everything."""
    print_core_share()
    task, frames = simulate_stream()
    print_latency(task, frames)
    print_alarm_delay(task, frames)


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


def simulate_stream() -> tuple[LiveTask, list[Frame]]:
    """Simulate a maneuver of FLEX-28, four modes identified and four retained with priors."""
    with tempfile.TemporaryDirectory() as folder:
        address = f"sqlite:///{folder}/flexsid.db"
        upgrade(address)
        store = Store.open(address)
        aircraft = add_aircraft(store)
        flight = store.flights.add(Flight(aircraft_id=aircraft.id or 0, number=1)).id or 0
        maneuver = add_maneuver(store, fly(airspeed_ratio=0.80, seed=(27, 1)), flight)
        run = EstimationRun(
            maneuver_id=maneuver.id or 0,
            method=Method.OE,
            structure=Structure(modes=(7, 9, 11, 12), fixed={}),
            settings=RunSettings(out_of_band_modes=OutOfBandModes.RETAINED),
        )
        task = prepare_live_task(store, run)
        frames = list(read_replay(store, run.maneuver_id, task.header).frames())
        store.close()
    return task, frames


def print_latency(task: LiveTask, frames: list[Frame]) -> None:
    """Process a maneuver as it would arrive, one frame every 50 ms.

    A frame that arrives during an estimate waits for it: arrival is that of the record, processing
    is measured.
    """
    processor = LiveProcessor(task)
    free_s, delays, cpu = 0.0, [], time.process_time()
    for count, frame in enumerate(frames, start=1):
        arrival_s = count * FRAME_S
        begun = time.process_time()
        processor.push(frame)
        free_s = max(free_s, arrival_s) + time.process_time() - begun
        delays.append(free_s - arrival_s)
    processor.finish()
    share = (time.process_time() - cpu) / (len(frames) * FRAME_S)
    report("live_estimate_core_share", share, channels=sum(map(len, task.header.groups)))
    p95 = 1e3 * float(np.percentile(delays, 95))
    report("sample_to_screen_p95_ms", p95, worst_ms=1e3 * max(delays), frames=len(frames))


def print_alarm_delay(task: LiveTask, frames: list[Frame]) -> None:
    """A sample beyond its limit at any time of the trim, to the state with the alarm."""
    group, column = next(
        (k, [c.name for c in g].index("q"))
        for k, g in enumerate(task.header.groups)
        if any(c.name == "q" for c in g)
    )
    limited = replace(task, limits={"q": (-1.0, 1.0)})
    delays = []
    for number in range(0, 30):
        processor = LiveProcessor(limited)
        raised_s = frames[number].time_s + FRAME_S
        processing = 0.0
        for frame in frames[:60]:
            if frame.number == number:
                samples = [x.copy() for x in frame.samples]
                samples[group][:, column] = 2.0
                frame = replace(frame, samples=tuple(samples))
            begun = time.process_time()
            states = processor.push(frame)
            processing = time.process_time() - begun
            alarms = [a for s in states for a in s.alarms if a.kind is AlarmKind.LIMIT]
            if alarms:
                delays.append(frame.time_s + FRAME_S - raised_s + processing)
                break
    report("alarm_delay_p95_ms", 1e3 * float(np.percentile(delays, 95)), alarms=len(delays))


def report(name: str, value: float, **values: float | int) -> None:
    """One JSON line."""
    rounded = {k: float(f"{v:.4g}") if isinstance(v, float) else v for k, v in values.items()}
    print(json.dumps({"name": name, "value": float(f"{value:.4g}"), **rounded}), flush=True)


if __name__ == "__main__":
    main()
