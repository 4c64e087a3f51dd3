"""Faults of surfaces that checks find: ``python backend/benchmarks/surface_faults.py``.

Maneuvers of FLEX-28, simulated in closed loop at .50 to .95 of the flutter speed, in still air to
moderate turbulence, with a fault of one surface at random: stuck, reversed, an oscillation of
.2 deg without command, or actuators that reach their rate limit for 3 % of the excitation; and
maneuvers without a fault. All actuators have the rate limit, without a fault 120 deg/s. Prints one
JSON line per kind: in how many flights the fault was named, and in how many there were false
warnings of surfaces: other ones than of a rate limit that the surface reached. An argument sets
the number of flights of each fault; five times as many have none.
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
from math import radians
from pathlib import Path

import numpy as np

from flexsid.demo.aircraft import describe_aircraft
from flexsid.demo.campaign import add_aircraft, add_maneuver
from flexsid.demo.flex28 import load_truth
from flexsid.demo.flights import FlownManeuver, fly
from flexsid.demo.truth_flight import RATE_HZ, FaultKind, SurfaceFault
from flexsid.records.maneuver import Flight
from flexsid.storage.migrate import upgrade
from flexsid.storage.store import Store
from flexsid.sysid.simulation.turbulence import Turbulence
from flexsid.workflow.quality.quality_warnings import warn_of_surfaces
from flexsid.workflow.quality.sensor_skews import check_surfaces

FLIGHTS = 20
RATIOS = (0.50, 0.65, 0.80, 0.95)
AIR = (Turbulence.NONE, Turbulence.LIGHT, Turbulence.MODERATE)
RATE_LIMIT = radians(120.0)  # of the actuators of FLEX-28
SATURATED = 0.03  # share of the excitation at the rate limit
NAMED = {
    FaultKind.STUCK: "does not follow",
    FaultKind.REVERSED: "moved against",
    FaultKind.OSCILLATING: "oscillates without command",
    FaultKind.SLOW: "is at its rate limit",
}


@dataclass(frozen=True, slots=True)
class Case:
    """One flight: its fault, None for none, and the seed of everything else."""

    kind: FaultKind | None
    seed: int


def main(flights: int = FLIGHTS) -> None:
    """Fly everything and print what was found."""
    cases = [Case(kind, seed) for kind in FaultKind for seed in range(flights)]
    cases += [Case(None, seed) for seed in range(5 * flights)]
    with ProcessPoolExecutor(os.cpu_count()) as processes:
        results = list(processes.map(inspect, cases))
    for kind in (*FaultKind, None):
        own = [one for case, one in zip(cases, results, strict=True) if case.kind is kind]
        line = {
            "name": f"surface_{'clean' if kind is None else kind.value}",
            "flights": len(own),
            "named": sum(named for named, _ in own),
            "with_false_warnings": sum(bool(false) for _, false in own),
            "false_warnings": [text for _, false in own for text in false],
        }
        print(json.dumps(line), flush=True)


def inspect(case: Case) -> tuple[bool, list[str]]:
    """Fly a case: whether the fault is named, and all false warnings of surfaces."""
    rng = np.random.default_rng([case.seed, *map(ord, case.kind or "clean")])
    ratio, air = rng.choice(RATIOS), AIR[rng.integers(len(AIR))]
    aircraft = describe_aircraft(load_truth())
    surface = str(rng.choice([one.name for one in aircraft.surfaces]))
    fault = None if case.kind is None else build_fault(case.kind, surface, float(ratio), rng)
    conditions = {"airspeed_ratio": float(ratio), "seed": case.seed, "turbulence": air}
    flown = fly(**conditions, fault=fault)
    with tempfile.TemporaryDirectory() as folder:
        address = f"sqlite:///{Path(folder) / 'flights.db'}"
        upgrade(address)
        store = Store.open(address)
        added = add_aircraft(store)
        flight = store.flights.add(Flight(aircraft_id=added.id or 0, number=1))
        maneuver = add_maneuver(store, flown, flight.id or 0)
        warnings = list(warn_of_surfaces(check_surfaces(store, maneuver, added)))
        store.close()
    is_named, false = False, []
    exact = fly(**conditions, fault=fault, noise=False) if warnings else flown
    for one in warnings:
        if fault is not None and one.channel == fault.surface and NAMED[fault.kind] in one.text:
            is_named = True
        elif NAMED[FaultKind.SLOW] not in one.text or not is_limited(exact, one.channel, fault):
            false.append(f"{ratio} V_f, {air}, seed {case.seed}: {one.text}")
    return is_named, false


def is_limited(exact: FlownManeuver, surface: str | None, fault: SurfaceFault | None) -> bool:
    """Whether a surface reached the rate limit of its actuator, in a flight without noise."""
    limit = min(RATE_LIMIT, np.inf if fault is None else fault.rate_limit)
    (moved,) = (one for one in exact.channels if one.name == surface)
    fastest = float(np.abs(np.gradient(moved.samples)).max())
    return RATE_HZ * fastest > 0.99 * limit


def build_fault(
    kind: FaultKind, surface: str, ratio: float, rng: np.random.Generator
) -> SurfaceFault:
    """Build a fault; the fastest surface of a flight without it exceeds the rate limit."""
    if kind is FaultKind.OSCILLATING:
        hz = float(rng.uniform(2.0, 8.0))
        amplitude = radians(0.2)
        return SurfaceFault(kind=kind, surface=surface, amplitude=amplitude, frequency_hz=hz)
    if kind is not FaultKind.SLOW:
        return SurfaceFault(kind=kind, surface=surface)
    clean = fly(airspeed_ratio=ratio, noise=False)
    excitation = clean.maneuver.excitation
    assert excitation is not None
    first, last = (round(RATE_HZ * time_s) for time_s in excitation.interval_s)
    reached = {
        one.name: float(np.quantile(np.abs(np.gradient(one.samples[first:last])), 1.0 - SATURATED))
        for one in clean.channels
        if one.name in excitation.harmonics
    }
    fastest = max(reached, key=lambda name: reached[name])
    return SurfaceFault(kind=kind, surface=fastest, rate_limit=RATE_HZ * reached[fastest])


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
