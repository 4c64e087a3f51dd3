"""Flights of drawn aircraft through the doors of one server."""

from __future__ import annotations

import tempfile
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from doors import Faults, import_flight, run_methods
from drawn_aircraft import Aircraft, Knowledge, draw_aircraft, draw_knowledge, draw_sensors
from shipped import Client
from simulated_flight import Record, fly
from true_model import set_flutter
from user_files import write_files
from verdicts import Verdict, judge_run

ROWS = 24_000  # of a record, at most


@dataclass(frozen=True)
class Flight:
    """An aircraft with its record, and what its analysts know."""

    aircraft: Aircraft
    knowledge: Knowledge
    record: Record

    @property
    def traits(self) -> tuple[str, ...]:
        fault = "prediction as usual" if self.knowledge.fault == "none" else self.knowledge.fault
        return (*self.aircraft.traits, *self.record.traits, fault)


@dataclass(frozen=True)
class Outcome:
    """What became of a flight."""

    flight: Flight
    verdicts: tuple[Verdict, ...]
    faults: tuple[str, ...]


def draw_flight(seed: int, index: int, rows: int = ROWS) -> Flight:
    """Return flight ``index`` of a seed, whatever others were drawn."""
    for attempt in range(100):
        rng = np.random.default_rng([seed, index, attempt])
        drawn = set_flutter(draw_aircraft(rng, f"X-{seed}-{index}"), rng.uniform(0.5, 0.9))
        # A frequency far above those that are built makes the flutter speed; draw another one.
        if drawn is None or drawn.truth.omega[0] * drawn.wing.span > 2 * np.pi * 150:
            continue
        aircraft = replace(drawn, sensors=draw_sensors(rng, drawn))
        knowledge = draw_knowledge(rng, aircraft)
        in_band = int(rng.integers(2, 5))
        return Flight(aircraft, knowledge, fly(rng, aircraft, in_band=in_band, rows=rows))
    raise AssertionError("no aircraft was drawn")


def go_through_doors(client: Client, flight: Flight) -> Outcome:
    """Import a flight and request with defaults what there is to be requested."""
    faults = Faults([])
    with tempfile.TemporaryDirectory() as name:
        files, mapping = write_files(Path(name), flight.aircraft, flight.knowledge, flight.record)
        maneuver = import_flight(client, faults, files, mapping)
    if maneuver is None:
        return Outcome(flight, (), tuple(faults.found))
    runs = run_methods(client, faults, maneuver)
    n_known = len(flight.knowledge.numbers)
    verdicts = [judge_run(flight.aircraft, n_known, m, run) for m, run in runs.items()]
    return Outcome(flight, tuple(verdicts), tuple(faults.found))
