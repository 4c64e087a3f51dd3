"""Intervals of live estimates: ``python backend/benchmarks/live_intervals.py [flights]``.

Maneuvers of FLEX-28 (eight-mode truth) are simulated in closed loop at .65 to 1.05 of the flutter
speed, in still air and in light and moderate turbulence, and identified as they fly, with the
proposed structure of output error. Prints one JSON line per kind of air: in how many seconds from
5 s on the 95 % interval holds the flutter speed, and frequency and damping of SW1B; alarms of an
instability below the flutter speed; the time until the flutter speed is known to 2 %; and the
duration of all flights. An argument sets the number of flights.
"""

from __future__ import annotations

import os

for _name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[_name] = "1"

import json
import sys
import tempfile
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

from flexsid.demo.campaign import add_aircraft, add_maneuver
from flexsid.demo.flex28 import Truth, load_truth
from flexsid.demo.flights import fly
from flexsid.records.decision import Structure
from flexsid.records.live import AlarmKind, LiveState
from flexsid.records.maneuver import Flight
from flexsid.records.run import EstimationRun, Method, OutOfBandModes, RunSettings
from flexsid.storage.migrate import upgrade
from flexsid.storage.store import Store
from flexsid.sysid.simulation.turbulence import Turbulence
from flexsid.sysid.stability.poles import Aeroelastic
from flexsid.sysid.stability.root_tracking import track_roots
from flexsid.workflow.live.frame_assembler import read_replay
from flexsid.workflow.live.live_estimator import LiveProcessor
from flexsid.workflow.live.live_fit import adjust_live_task, prepare_live_task
from flexsid.workflow.runs.run_proposal import apply_proposal

AIRSPEEDS = (0.65, 0.80, 0.90, 0.95, 1.05)
AIR = (Turbulence.NONE, Turbulence.LIGHT, Turbulence.NONE, Turbulence.MODERATE)
FUEL = 0.5
FLUTTER_MODE = "7"  # SW1B
NORMAL_95 = 1.96  # half width of a 95 % interval in standard errors
FIRST_S = 5.0
FLIGHTS = 50


@dataclass(frozen=True, slots=True)
class Outcome:
    """Counts of one flight."""

    seed: int
    asked: int
    speeds: tuple[bool, ...]
    modes: tuple[bool, ...]
    false_alarms: int
    known_s: float | None
    duration_s: float


def get_air(seed: int) -> Turbulence:
    """Turbulence of a flight."""
    return AIR[seed // len(AIRSPEEDS) % len(AIR)]


def fly_one(seed: int) -> Outcome:
    """Fly and identify one maneuver."""
    truth = load_truth()
    ratio = AIRSPEEDS[seed % len(AIRSPEEDS)]
    flown = fly(
        airspeed_ratio=ratio,
        fuel=FUEL,
        peak_deg=2.0 if ratio < 0.9 else 1.6,
        seed=(6100, seed),
        turbulence=get_air(seed),
    )
    with tempfile.TemporaryDirectory() as folder:
        address = f"sqlite:///{Path(folder) / 'flexsid.db'}"
        upgrade(address)
        store = Store.open(address)
        flight = store.flights.add(Flight(aircraft_id=add_aircraft(store).id or 0, number=1))
        maneuver = add_maneuver(store, flown, flight.id or 0)
        request = EstimationRun(
            maneuver_id=maneuver.id or 0,
            method=Method.OE,
            structure=Structure(fixed={}),
            settings=RunSettings(out_of_band_modes=OutOfBandModes.RETAINED),
        )
        run = apply_proposal(store, request)
        task = prepare_live_task(store, run, 1.05 * maneuver.condition.airspeed_m_s)
        processor = LiveProcessor(task, partial(adjust_live_task, store, run))
        frames = read_replay(store, run.maneuver_id, task.header).frames()
        states = [state for frame in frames for state in processor.push(frame)]
        states += processor.finish()
        store.close()
    flutter = truth.flutter_speed_at(FUEL)
    pole = find_pole(truth, ratio * flutter)
    return count(seed, states, flutter, pole, ratio < 1.0)


def find_pole(truth: Truth, airspeed: float) -> complex:
    """Return the true pole of the flutter mode, followed from low airspeeds. [rad/s]"""
    modes, derivatives = truth.modes_at(FUEL, 8), truth.derivatives_at(FUEL, 8)
    aircraft = Aeroelastic(truth.condition_at(airspeed, FUEL), modes, derivatives)
    roots = track_roots(aircraft, np.linspace(0.4, 1.0, 61) * airspeed)
    return complex(roots.roots[-1, roots.names.index(FLUTTER_MODE)])


def count(
    seed: int, states: list[LiveState], flutter: float, pole: complex, is_stable: bool
) -> Outcome:
    """Count intervals that hold the truth, and alarms."""
    speeds: list[bool] = []
    modes: list[bool] = []
    known_s = None
    later = [s for s in states if s.estimate is not None and s.maneuver_s >= FIRST_S]
    for state in later:
        one = state.estimate
        assert one is not None
        if one.flutter_m_s is not None and one.flutter_std_m_s:
            half = NORMAL_95 * one.flutter_std_m_s
            speeds.append(abs(one.flutter_m_s - flutter) <= half)
            if known_s is None and half <= 0.02 * one.flutter_m_s:
                known_s = state.maneuver_s
        for mode in one.modes:
            if mode.name == "SW1B" and mode.damping_std is not None:
                omega, zeta = abs(pole), -pole.real / abs(pole)
                modes.append(abs(mode.damping - zeta) <= NORMAL_95 * mode.damping_std)
                modes.append(abs(mode.frequency - omega) <= NORMAL_95 * (mode.frequency_std or 0.0))
    alarms = {a.subject for s in states for a in s.alarms if a.kind is AlarmKind.UNSTABLE}
    return Outcome(
        seed=seed,
        asked=len(later),
        speeds=tuple(speeds),
        modes=tuple(modes),
        false_alarms=len(alarms) if is_stable else 0,
        known_s=known_s,
        duration_s=states[-1].time_s if states else 0.0,
    )


def main(flights: int) -> None:
    """Fly in processes, and print what holds."""
    with ProcessPoolExecutor() as pool:
        every = list(pool.map(fly_one, range(flights)))
    for air in dict.fromkeys(AIR):
        own = [one for one in every if get_air(one.seed) is air]
        known = [one.known_s for one in own if one.known_s is not None]
        print(
            json.dumps(
                {
                    "name": f"live_intervals_{air.value}",
                    "flights": len(own),
                    "seconds": sum(one.asked for one in own),
                    "flutter_speed_held": sum(sum(one.speeds) for one in own),
                    "flutter_speed_given": sum(len(one.speeds) for one in own),
                    "mode_held": sum(sum(one.modes) for one in own),
                    "mode_given": sum(len(one.modes) for one in own),
                    "false_alarms": sum(one.false_alarms for one in own),
                    "known_to_2_percent": len(known),
                    "median_known_s": float(np.median(known)) if known else None,
                    "hours": round(sum(one.duration_s for one in own) / 3600.0, 3),
                }
            ),
            flush=True,
        )


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else FLIGHTS)
