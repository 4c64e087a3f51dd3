"""A user relies on: standard errors predicted before a flight agree with those after it."""

from __future__ import annotations

import numpy as np
import pytest

from flexsid.demo.campaign import add_aircraft, add_maneuver
from flexsid.demo.flights import fly
from flexsid.records.excitation import ExcitationDesign
from flexsid.records.maneuver import Flight
from flexsid.records.model_structure import Structure
from flexsid.records.run import EstimationRun, Method, OutOfBandModes, RunSettings
from flexsid.storage import queue
from flexsid.storage.store import Store
from flexsid.workflow.excitation.excitation_designs import (
    DesignOrder,
    compute_design,
    specify_design,
)
from flexsid.workflow.excitation.predicted_accuracy import predict_errors
from flexsid.workflow.runs.estimation import compute_run, prepare, store_result

BEFORE = 2.0  # degrees of the body flap in the maneuver that is known
PLANNED = [(506, 4.0, (7, 9)), (506, 1.0, (7, 9)), (503, 2.0, (7,))]  # aid, degrees, modes


def estimated(
    store: Store, flight: int, ratio: float, plan: tuple[int, float, tuple[int, ...]], seed: int
) -> EstimationRun:
    """Eight modes fly, fewer are fitted."""
    fta, peak_deg, modes = plan
    flown = fly(airspeed_ratio=ratio, fta=fta, peak_deg=peak_deg, seed=seed)
    maneuver = add_maneuver(store, flown, flight)
    request = EstimationRun(
        maneuver_id=maneuver.id or 0,
        method=Method.OE,
        structure=Structure(modes=modes, fixed={}),
        settings=RunSettings(out_of_band_modes=OutOfBandModes.RETAINED),
    )
    run = store.runs.add(request)
    claimed = queue.claim(store, run.id)
    assert claimed is not None
    computed = compute_run(prepare(store, run), lambda progress: None)
    return store_result(store, run.id or 0, claimed.attempt, computed)


def planned(store: Store, fta: int, peak_deg: float) -> ExcitationDesign:
    peak = float(np.deg2rad(peak_deg))
    specification = specify_design(fta, 24.0, 100.0, 6, (peak, 2 * peak, 4 * peak), "quick")
    order = DesignOrder(name=f"FTA {fta}", specification=specification, fta=fta)
    return store.designs.add(compute_design(order, lambda progress: None))


# Near flutter the noise spectrum of the flight gains more than the prediction knows of.
@pytest.mark.parametrize(("ratio", "most"), [(0.56, 1.25), (0.95, 1.5)])
def test_expected_errors_are_those_of_the_flight(store: Store, ratio: float, most: float):
    """The flight includes feedback, actuators, input noise and unmodelled modes."""
    aircraft = add_aircraft(store)
    flight = store.flights.add(Flight(aircraft_id=aircraft.id or 0, number=9)).id or 0
    for fta, peak_deg, modes in PLANNED:
        before = estimated(store, flight, ratio, (fta, BEFORE, modes), seed=1)
        predicted = predict_errors(store, planned(store, fta, peak_deg), before.id or 0)
        after = estimated(store, flight, ratio, (fta, peak_deg, modes), seed=2)
        assert after.result is not None
        found = {row.name: row.std_error for row in after.result.parameters}
        ratios = [row.std_error / (found[row.name] or np.nan) for row in predicted.items]
        assert 0.8 < np.median(ratios) < most
        assert predicted.harmonics_outside_band == 0
        assert "as recorded" in predicted.surfaces
