"""Estimate with a mass, inertia and airspeed that are wrong, as those of every aircraft are.

The records state by how much; the flight is that of the true ones.
"""

from __future__ import annotations

from dataclasses import astuple, replace

import numpy as np
import pytest

from flexsid.demo.campaign import add_aircraft, add_maneuver
from flexsid.demo.flex28 import load_truth
from flexsid.demo.flights import fly
from flexsid.records.decision import Structure
from flexsid.records.maneuver import Flight
from flexsid.records.run import EstimationRun, Method, OutOfBandModes, RunSettings
from flexsid.storage.store import Store
from flexsid.workflow.runs.estimation import compute_run, prepare

MASS, AIRSPEED = 0.02, 0.01
WRONG = {
    "mass_kg": 1.0 + 1.3 * MASS,
    "pitch_inertia_kg_m2": 1.0 - 1.1 * MASS,
    "airspeed_m_s": 1.0 + 0.9 * AIRSPEED,
}


@pytest.mark.parametrize("method", [Method.OE, pytest.param(Method.EE, marks=pytest.mark.long)])
def test_stated_errors_of_mass_and_airspeed_are_part_of_every_standard_error(
    store: Store, method: Method
) -> None:
    aircraft = add_aircraft(store)
    assert aircraft.id is not None
    flight = store.flights.add(Flight(aircraft_id=aircraft.id, number=50)).id
    assert flight is not None
    flown = fly(airspeed_ratio=0.65, fuel=0.5, fta=506, modes_in_truth=2, seed=3)
    maneuver = add_maneuver(store, flown, flight)
    assert maneuver.id is not None
    true = maneuver.condition
    wrong = replace(true, **{name: f * getattr(true, name) for name, f in WRONG.items()})
    store.maneuvers.replace(replace(maneuver, condition=replace(wrong, airspeed_std=AIRSPEED)))
    table = replace(aircraft.mass, mass_std=MASS, inertia_std=MASS)
    store.aircraft.replace(replace(aircraft, mass=table))
    request = EstimationRun(
        maneuver_id=maneuver.id,
        method=method,
        structure=Structure(modes=(7, 9), fixed={}),
        settings=RunSettings(out_of_band_modes=OutOfBandModes.OMITTED),
    )
    found = compute_run(prepare(store, request), lambda progress: None)
    truth = load_truth().derivatives_at(0.5, 2).named()
    names, std = found.estimate.names, found.estimate.std_errors
    error = np.abs(found.estimate.values - [truth[name] for name in names])
    of_table = np.array([found.modal_std.get(name, 0.0) for name in names])
    of_condition = np.array([found.condition_std[name] for name in names])
    assert np.mean(error < 2.0 * np.hypot(std, of_table)) < 0.75, "the errors are large"
    whole = np.sqrt(std**2 + of_table**2 + of_condition**2)
    assert np.mean(error < 2.0 * whole) > 0.9
    shares = [found.shares[name] for name in names]
    assert [sum(astuple(one)) for one in shares] == pytest.approx(np.ones(len(names)))
    of_both = [one.mass + one.condition for one in shares]
    assert of_both == pytest.approx((of_condition / whole) ** 2)
    assert found.shares["CZ_alpha"].mass > found.shares["CZ_alpha"].condition > 0.1
