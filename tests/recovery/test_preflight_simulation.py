"""A user relies on: a pre-flight simulation of a design gives the estimates of its flight."""

from __future__ import annotations

import numpy as np
import pytest

from flexsid.demo.campaign import add_aircraft, add_maneuver
from flexsid.demo.flights import fly
from flexsid.errors import BadInput
from flexsid.jobs.inline import execute_run
from flexsid.jobs.pipeline import load_estimation_pipeline
from flexsid.records.flight import Flight
from flexsid.records.model_structure import Structure
from flexsid.records.run import EstimationRun, Method, RunSettings, RunState
from flexsid.storage import queue
from flexsid.storage.store import Store
from flexsid.workflow.excitation.excitation_designs import create_design, specify_design
from flexsid.workflow.excitation.preflight_simulation import list_simulations, simulate_design
from flexsid.workflow.runs.estimation import compute_run, prepare, store_result


def flown(store: Store, ratio: float) -> EstimationRun:
    aircraft = add_aircraft(store)
    flight = store.flights.add(Flight(aircraft_id=aircraft.id or 0, number=9))
    maneuver = add_maneuver(store, fly(airspeed_ratio=ratio, seed=4), flight.id or 0)
    run = EstimationRun(
        maneuver_id=maneuver.id or 0,
        method=Method.OE,
        structure=Structure(modes=(7, 9), fixed={}),
        settings=RunSettings(),
    )
    return execute_run(store, run, load_estimation_pipeline(), lambda progress: None)


def test_a_preflight_simulation_beyond_flutter_needs_the_controller_and_recovers_what_flew(
    store: Store,
):
    run = flown(store, 1.05)
    (controller,) = store.controllers.find()
    peak = float(np.deg2rad(1.0))
    design = create_design(
        store,
        "FTA 506",
        specify_design(506, 24.0, 100.0, 6, (peak, 2 * peak, 4 * peak), "quick"),
        506,
    )
    with pytest.raises(BadInput, match="needs a controller"):
        simulate_design(store, design, run.id or 0)
    simulated = simulate_design(store, design, run.id or 0, 1, controller.id)
    (waiting,) = list_simulations(store, design)
    assert waiting.state is RunState.QUEUED
    assert waiting.derivatives == ()

    claimed = queue.claim(store, simulated.run_id)
    assert claimed is not None
    computed = compute_run(prepare(store, claimed), lambda progress: None)
    store_result(store, simulated.run_id, claimed.attempt, computed)
    (done,) = list_simulations(store, design)
    assert done.correlation is not None
    assert 0.02 < done.correlation < 0.6
    z = [(row.estimate - row.flown) / (row.std_error or np.nan) for row in done.derivatives]
    assert len(z) == 44
    assert np.sqrt(np.mean(np.square(z))) < 2.0
    ratios = [row.expected / (row.std_error or np.nan) for row in done.derivatives]
    assert 0.7 < np.median(ratios) < 1.4
    maneuver = store.maneuvers.get(simulated.maneuver_id)
    assert "Simulated" in maneuver.note
    assert store.flights.get(maneuver.flight_id).number == 0
