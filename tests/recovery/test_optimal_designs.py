"""A user relies on: the design that is optimal for the flutter speed is so, also in flight."""

from __future__ import annotations

import numpy as np
import pytest
from flown_runs import estimated, planned

from flexsid.demo.campaign import add_aircraft
from flexsid.demo.flex28 import load_truth
from flexsid.demo.flights import fly
from flexsid.records.maneuver import Flight
from flexsid.records.run import EstimationRun
from flexsid.storage.store import Store
from flexsid.sysid.excitation.multisine import Multisine
from flexsid.sysid.stability.poles import Aeroelastic
from flexsid.sysid.stability.root_tracking import track_roots
from flexsid.workflow.excitation.excitation_designs import build_multisine
from flexsid.workflow.excitation.optimal_designs import (
    FoundDesign,
    Objective,
    OptimalDesignQuery,
    compute_optimal_design,
)
from flexsid.workflow.runs.exports import load_identified_model

RATIO, PEAK_DEG, MODES, SEEDS = 0.8, 2.0, (7, 9), 20


def predict_crossing(store: Store, run: EstimationRun) -> float:
    """Flutter speed of the model of a run. [m/s]"""
    found = load_identified_model(store, run)
    aircraft = Aeroelastic(found.model.condition, found.model.modes, found.derivatives)
    speeds = np.linspace(0.5, 1.8, 60) * found.model.condition.airspeed
    crossing = track_roots(aircraft, speeds).flutter
    assert crossing is not None
    return crossing.airspeed


def optimise(
    store: Store, run: EstimationRun, design_id: int, *, after_run: bool = False
) -> FoundDesign:
    query = OptimalDesignQuery(
        design_id=design_id,
        run_id=run.id or 0,
        level=0,
        objective=Objective.FLUTTER,
        after_run=after_run,
    )
    return compute_optimal_design(store, query, lambda progress: None)


def measure_scatter(
    store: Store, flight: int, multisine: Multisine, seeds: range
) -> tuple[float, float, float]:
    """Fly a multisine with several seeds: mean and scatter of the flutter speed, peak reading.

    [m/s], [m/s], [g] of the accelerometer next to the centre of gravity
    """
    flown = fly(airspeed_ratio=RATIO, seed=seeds[0], noise=False, multisine=multisine)
    (reading,) = (one.samples for one in flown.channels if one.name == "az_egi")
    peak = float(np.abs(reading - np.mean(reading[:50])).max())
    plan = (506, PEAK_DEG, MODES)
    speeds = [
        predict_crossing(store, estimated(store, flight, RATIO, plan, seed, multisine))
        for seed in seeds
    ]
    return float(np.mean(speeds)), float(np.std(speeds, ddof=1)), peak


def test_a_second_maneuver_designed_after_the_first_beats_flying_it_again(store: Store):
    """The standard errors are those with the data of both maneuvers."""
    aircraft = add_aircraft(store)
    flight = store.flights.add(Flight(aircraft_id=aircraft.id or 0, number=9)).id or 0
    flown = estimated(store, flight, RATIO, (506, PEAK_DEG, MODES), seed=1)
    gain = optimise(store, flown, planned(store, 506, PEAK_DEG).id or 0, after_run=True).gain
    print(gain)
    assert gain.optimal < 0.9 * gain.standard
    assert gain.standard_time_s is not None
    assert gain.standard_time_s > 1.5 * gain.duration_s
    for row in gain.limits:
        assert max(row.standard, row.optimal) <= 1.001 * row.limit


@pytest.mark.long
def test_optimal_design_has_a_quarter_less_scatter_of_the_flutter_speed(store: Store):
    """At a smaller peak load factor; the scatter is the predicted standard error."""
    aircraft = add_aircraft(store)
    flight = store.flights.add(Flight(aircraft_id=aircraft.id or 0, number=9)).id or 0
    before = estimated(store, flight, RATIO, (506, PEAK_DEG, MODES), seed=1)
    standard = planned(store, 506, PEAK_DEG)
    found = optimise(store, before, standard.id or 0)
    assert found.gain.optimal < 0.75 * found.gain.standard
    for row in found.gain.limits:
        assert max(row.standard, row.optimal) <= 1.001 * row.limit
    results = [
        measure_scatter(store, flight, multisine, range(first, first + SEEDS))
        for first, multisine in (
            (100, build_multisine(standard, 0)),
            (200, build_multisine(found.design, 2)),
        )
    ]
    print(
        found.gain, *(f"{mean:.3f} ± {std:.4f} m/s, peak {peak:.2f}" for mean, std, peak in results)
    )
    assert results[1][1] < 0.75 * results[0][1]
    assert results[1][2] < results[0][2]
    truth = load_truth().flutter_speed_at(0.5)
    for (mean, std, _), predicted in zip(
        results, (found.gain.standard, found.gain.optimal), strict=True
    ):
        assert 0.7 < std / predicted < 1.3  # 20 flights resolve a scatter to 16 %
        assert abs(mean - truth) < 3.0 * predicted / np.sqrt(SEEDS) + 0.02  # the airspeed is noisy


@pytest.mark.long
def test_a_flight_of_an_optimal_design_predicts_the_standard_one(store: Store):
    """Noise of the measured surfaces at harmonics of little power is no information."""
    aircraft = add_aircraft(store)
    flight = store.flights.add(Flight(aircraft_id=aircraft.id or 0, number=9)).id or 0
    plan = (506, PEAK_DEG, MODES)
    before = estimated(store, flight, RATIO, plan, seed=1)
    standard = planned(store, 506, PEAK_DEG)
    found = optimise(store, before, standard.id or 0)
    after = estimated(store, flight, RATIO, plan, 2, build_multisine(found.design, 2))
    again = optimise(store, after, standard.id or 0)
    print(found.gain, again.gain)
    assert 0.8 < again.gain.standard / found.gain.standard < 1.25
    assert 0.8 < again.gain.optimal / found.gain.optimal < 1.25
