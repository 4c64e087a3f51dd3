"""Flights of drawn aircraft through the doors of one server."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from doors import (
    METHODS,
    Faults,
    fit_global_model,
    follow_live,
    import_flight,
    predict_flutter,
    run_methods,
    search_structure,
    simulate_design,
)
from drawn_aircraft import (
    Aircraft,
    Knowledge,
    draw_aircraft,
    draw_assumptions,
    draw_delays,
    draw_knowledge,
    draw_sensors,
)
from shipped import Client
from simulated_flight import Record, fly
from true_model import set_flutter
from user_files import write_files
from verdicts import (
    FlutterVerdict,
    SearchVerdict,
    ValuesVerdict,
    Verdict,
    WidthVerdict,
    judge_flutter,
    judge_global_model,
    judge_live,
    judge_run,
    judge_search,
    judge_simulation,
    judge_widths,
)

ROWS = 24_000  # of a record, at most
AIRSPEEDS = (0.93, 0.86, 0.8)  # of further flights, over that of the first


@dataclass(frozen=True)
class Flight:
    """An aircraft with its record, and what its analysts know."""

    aircraft: Aircraft
    knowledge: Knowledge
    record: Record
    in_band: int  # modes of the truth in the band
    seeds: tuple[int, ...]  # of further flights

    @property
    def traits(self) -> tuple[str, ...]:
        fault = "prediction as usual" if self.knowledge.fault == "none" else self.knowledge.fault
        shapes = self.aircraft.shapes[: self.in_band]
        unseen = ("in-plane mode in the band",) if any(one.in_plane for one in shapes) else ()
        assumed = self.knowledge.assumed
        known = "shapes stated" if assumed.states else "shapes not stated"
        wrong = "shapes 2 to 6 % wrong" if assumed.shape_std < 0.06 else "shapes 6 to 20 % wrong"
        return (*self.aircraft.traits, *self.record.traits, fault, *unseen, known, wrong)


@dataclass(frozen=True)
class Outcome:
    """What became of a flight."""

    flight: Flight
    verdicts: tuple[Verdict, ...]
    faults: tuple[str, ...]
    flutter: tuple[FlutterVerdict, ...] = ()
    searches: tuple[SearchVerdict, ...] = ()
    values: tuple[ValuesVerdict, ...] = ()
    widths: WidthVerdict | None = None


def draw_flight(seed: int, index: int, rows: int = ROWS) -> Flight:
    """Return flight ``index`` of a seed, whatever others were drawn."""
    for attempt in range(100):
        rng = np.random.default_rng([seed, index, attempt])
        drawn = set_flutter(draw_aircraft(rng, f"X-{seed}-{index}"), rng.uniform(0.5, 0.9))
        # A frequency far above those that are built makes the flutter speed; draw another one.
        if drawn is None or drawn.truth.omega[0] * drawn.wing.span > 2 * np.pi * 150:
            continue
        own = np.random.default_rng([seed, index, attempt, 1])
        aircraft = draw_delays(own, replace(drawn, sensors=draw_sensors(rng, drawn)))
        knowledge = draw_knowledge(rng, aircraft, draw_assumptions(own, aircraft))
        in_band = int(rng.integers(2, 5))
        record = fly(rng, aircraft, in_band=in_band, rows=rows)
        return Flight(aircraft, knowledge, record, in_band, (seed, index, attempt, 2))
    raise AssertionError("no aircraft was drawn")


def go_through_doors(
    client: Client,
    flight: Flight,
    searched: Sequence[str] = METHODS,
    predicted: Sequence[str] = METHODS,
    airspeeds: Sequence[float] = AIRSPEEDS,
) -> Outcome:
    """Import a flight, run, predict flutter and search, all with their defaults.

    At ``airspeeds``, over that of the flight, the aircraft flies again; with any, all further doors
    are gone through with runs by output error.
    """
    faults = Faults([])
    with tempfile.TemporaryDirectory() as name:
        files, mapping = write_files(Path(name), flight.aircraft, flight.knowledge, flight.record)
        maneuver = import_flight(client, faults, files, mapping)
    if maneuver is None:
        return Outcome(flight, (), tuple(faults.found))
    runs = run_methods(client, faults, maneuver)
    n_known = len(flight.knowledge.numbers)
    verdicts = [judge_run(flight.aircraft, n_known, m, run) for m, run in runs.items()]
    flutter, searches = [], []
    for method, run in runs.items():
        if run["state"] != "succeeded":
            continue
        converged = run["fit"]["outcome"] == "converged"
        if (
            method in predicted
            and converged
            and (found := predict_flutter(client, faults, run["id"]))
        ):
            flutter.append(judge_flutter(flight.aircraft, method, found))
        if method not in searched:
            continue
        if search := search_structure(client, faults, maneuver, method):
            searches.append(judge_search(flight.aircraft, n_known, method, search, run))
    values, widths = [], None
    run = runs.get("OE")
    if airspeeds and run is not None and run["state"] == "succeeded":
        if flight.record.records_commands:  # a stream needs them
            live = follow_live(client, faults, maneuver, run["id"])
            values.append(judge_live(flight.aircraft, n_known, live))
        inputs, multisine = flight.aircraft.truth.inputs, flight.record.multisine
        simulated = simulate_design(client, faults, multisine, inputs, run["id"])
        values.append(judge_simulation(simulated))
        ids = [run["id"], *fly_again(client, faults, flight, airspeeds)]
        predictions = [predict_flutter(client, faults, *ids[: k + 1]) for k in range(len(ids))]
        widths = judge_widths(flight.aircraft, "OE", predictions)
        model = fit_global_model(client, faults, ids)
        values.append(judge_global_model(flight.aircraft, n_known, model))
    return Outcome(
        flight, tuple(verdicts), tuple(faults.found), tuple(flutter), tuple(searches),
        tuple(values), widths,
    )  # fmt: skip


def fly_again(
    client: Client, faults: Faults, flight: Flight, airspeeds: Sequence[float]
) -> list[int]:
    """Fly an aircraft at further airspeeds, over that of its flight; return the default runs."""
    found = []
    for k, ratio in enumerate(airspeeds):
        aircraft = replace(
            flight.aircraft,
            airspeed=ratio * flight.aircraft.airspeed,
            alpha=flight.aircraft.alpha / ratio**2,
        )
        record = fly(
            np.random.default_rng([*flight.seeds, k]),
            aircraft,
            in_band=flight.in_band,
            rows=len(flight.record.outputs),
        )
        with tempfile.TemporaryDirectory() as name:
            files = write_files(Path(name), aircraft, flight.knowledge, record, k + 2)
            maneuver = import_flight(client, faults, *files)
        if maneuver is None:
            continue
        run = run_methods(client, faults, maneuver, ("OE",)).get("OE")
        if run is not None and run["state"] == "succeeded":
            found.append(run["id"])
    return found
