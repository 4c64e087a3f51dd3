"""Reconstruction of the motion of FLEX-28 from its sensors, with valid standard errors."""

from __future__ import annotations

import numpy as np
import pytest

from flexsid.demo.aircraft import describe_aircraft
from flexsid.demo.campaign import add_aircraft, add_maneuver
from flexsid.demo.flex28 import load_truth
from flexsid.demo.flights import SETTLE_S, TRIM_S, design_fta, fly
from flexsid.demo.truth_flight import RATE_HZ, fly_truth
from flexsid.records.decision import Structure
from flexsid.records.maneuver import Flight
from flexsid.records.run import EstimationRun, Method, RunSettings
from flexsid.storage.store import Store
from flexsid.workflow.measurements.reconstruction import (
    ReconstructionQuery,
    reconstruct,
    select_quantities,
)
from flexsid.workflow.runs.estimation import compute_run, prepare

CASES = [(0.65, 2.0, 11), (1.05, 1.2, 12)]
EXCITED = [(*case, fta) for case in CASES for fta in (503, 506)]
KINDS = ("eta", "etadot", "etaddot")


def true_motion(ratio: float, peak_deg: float, fta: int) -> dict[str, np.ndarray]:
    """What truly moved, at the rate of the simulation, by name."""
    truth = load_truth()
    multisine = design_fta(fta, peak_deg)
    n = round((TRIM_S + multisine.period_s + SETTLE_S) * RATE_HZ)
    excitation = np.zeros((n, 5))
    first, count = round(TRIM_S * RATE_HZ), round(multisine.period_s * RATE_HZ)
    excitation[first : first + count] = multisine.sample(np.arange(count) / RATE_HZ)
    speed = ratio * truth.flutter_speed_at(0.5)
    sensors = describe_aircraft(truth).sensors[:1]
    x = fly_truth(truth, sensors, speed, 0.5, 8, excitation).motion.states
    found = {"alpha": x[:, 0], "q": x[:, 1]}
    for index, number in enumerate(truth.symmetric[:8]):
        found[f"eta{number}"] = x[:, 3 + index]
        found[f"etadot{number}"] = x[:, 11 + index]
        found[f"etaddot{number}"] = np.gradient(x[:, 11 + index], 1.0 / RATE_HZ)
    return found


@pytest.fixture
def flight_id(store: Store) -> int:
    aircraft = add_aircraft(store)
    assert aircraft.id is not None
    flight = store.flights.add(Flight(aircraft_id=aircraft.id, number=60))
    assert flight.id is not None
    return flight.id


@pytest.mark.parametrize(
    ("ratio", "peak_deg", "seed", "fta"),
    [pytest.param(*case, marks=pytest.mark.long) for case in EXCITED[:-1]] + EXCITED[-1:],
)
def test_modal_motion_is_reconstructed_with_valid_standard_errors(
    store: Store, flight_id: int, ratio: float, peak_deg: float, seed: int, fta: int
):
    """The harmonics of FTA 503 end at half the frequency of the second mode."""
    flown = fly(airspeed_ratio=ratio, fuel=0.5, fta=fta, peak_deg=peak_deg, seed=seed)
    maneuver = add_maneuver(store, flown, flight_id)
    assert maneuver.id is not None
    modal = [f"{kind}{mode}" for mode in (7, 9) for kind in KINDS]
    found = reconstruct(store, ReconstructionQuery(maneuver_id=maneuver.id))
    found = select_quantities(found, ["alpha", "q", *modal])
    assert np.all(found.rank == found.n_motions)
    assert np.all(np.isfinite(found.condition))
    truth = true_motion(ratio, peak_deg, fta)
    covered = []
    for trace in found.traces:
        clock = np.arange(truth[trace.name].size) / RATE_HZ
        true = np.interp(found.time_s, clock, truth[trace.name])
        error = trace.values - true
        assert 1.0 - np.sum(error**2) / np.sum(true**2) > 0.99, trace.name
        if trace.name in modal:
            covered.append(np.mean(np.abs(error) < 2.0 * trace.std))
            assert covered[-1] > 0.8, trace.name
    assert 0.90 < np.mean(covered) < 0.99


@pytest.mark.parametrize(("ratio", "peak_deg", "seed"), CASES)
def test_equation_error_from_reconstruction_is_unbiased(
    store: Store, flight_id: int, ratio: float, peak_deg: float, seed: int
):
    flown = fly(airspeed_ratio=ratio, fuel=0.5, peak_deg=peak_deg, modes_in_truth=2, seed=seed)
    maneuver = add_maneuver(store, flown, flight_id)
    assert maneuver.id is not None
    run = EstimationRun(
        maneuver_id=maneuver.id,
        method=Method.EE,
        structure=Structure(modes=(7, 9), fixed={}),
        settings=RunSettings(),
    )
    estimate = compute_run(prepare(store, run), lambda progress: None).estimate
    truth = flown.truth.named()
    z = (estimate.values - [truth[name] for name in estimate.names]) / estimate.std_errors
    assert np.sqrt(np.mean(z**2)) < 1.5
