"""A first record is written back: the truth is inside ±2σ of the second one, and σ is smaller."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from campaign import Flight, draw_flight
from doors import Faults, import_flight, wait_for_end
from drawn_aircraft import select
from shipped import Client, serving
from simulated_flight import fly
from user_files import write_files
from verdicts import judge_run

SEED, FLIGHTS, ROWS = 21, (0, 2, 5, 6), 3000
MODES, SENSORS = 6, 14
AIRSPEEDS = (0.86, 1.0)  # of both records, over that drawn


def draw(index: int) -> Flight:
    """Draw an aircraft of six modes, all in the table, with predictions 30 % wrong."""
    drawn = draw_flight(SEED, index, ROWS)
    truth = select(drawn.aircraft.truth, MODES)
    sensors = tuple(replace(one, delay=0.0) for one in drawn.aircraft.sensors[:SENSORS])
    shapes = drawn.aircraft.shapes[:MODES]
    aircraft = replace(drawn.aircraft, truth=truth, shapes=shapes, sensors=sensors)
    rng = np.random.default_rng([SEED, index, 77])
    zeta = truth.zeta * np.clip(1 + 0.3 * rng.normal(size=MODES), 0.2, None)
    assumed = drawn.knowledge.assumed
    errors = assumed.shapes[:MODES, :SENSORS]
    knowledge = replace(
        drawn.knowledge,
        numbers=truth.numbers,
        omega=truth.omega,
        zeta=zeta,
        table=truth.table * (1 + 0.3 * rng.normal(size=truth.table.shape)),
        fault="none",
        assumed=replace(assumed, shape_std=0.05, shapes=errors),
    )
    return replace(drawn, aircraft=aircraft, knowledge=knowledge)


def fly_record(client: Client, flight: Flight, index: int, number: int) -> tuple[Flight, int]:
    ratio, aircraft = AIRSPEEDS[number], flight.aircraft
    flown = replace(aircraft, airspeed=ratio * aircraft.airspeed, alpha=aircraft.alpha / ratio**2)
    rng = np.random.default_rng([SEED, index, 5, number])
    record = fly(rng, flown, in_band=min(flight.in_band, 3), rows=ROWS)
    faults = Faults([])
    with tempfile.TemporaryDirectory() as name:
        files = write_files(Path(name), flown, flight.knowledge, record, number + 1)
        maneuver = import_flight(client, faults, *files)
    assert maneuver is not None, faults.found
    return replace(flight, aircraft=flown, record=record), maneuver


def estimate(client: Client, maneuver: int, **settings: Any) -> dict[str, Any]:
    body = {"maneuver_id": maneuver, "method": "OE", **settings}
    return wait_for_end(client, f"runs/{client.send('post', 'runs', body)['id']}")


def collect(run: Mapping[str, Any]) -> dict[str, float]:
    return {one["name"]: one["std_error"] for one in run["parameters"] if one["std_error"]}


@pytest.mark.long
def test_the_second_record_starts_from_the_first_and_its_errors_hold(tmp_path: Path) -> None:
    distances: list[float] = []
    ratios: list[float] = []
    with serving(tmp_path, f"sqlite:///{tmp_path / 'flexsid.db'}") as server:
        client = server.connect()
        for index in FLIGHTS:
            flight = draw(index)
            _, first = fly_record(client, flight, index, 0)
            flown, second = fly_record(client, flight, index, 1)
            before, alone = estimate(client, first), estimate(client, second)
            client.send("post", "write-backs", {"run_id": before["id"], "reason": "test"})
            given = {"structure": alone["structure"], "settings": {"prior_spread": 0.3}}
            later = estimate(client, second, **given)
            assert any("posterior of run" in text for text in later["fit"]["warnings"])
            verdict = judge_run(flown.aircraft, MODES, "OE", later)
            distances += [abs(error.distance) for error in verdict.errors]
            std, own = collect(alone), collect(later)
            ratios += [own[name] / std[name] for name in own.keys() & std.keys()]
    assert len(ratios) > 80
    assert np.mean(np.array(distances) < 2.0) >= 0.93
    assert np.median(ratios) < 0.7
