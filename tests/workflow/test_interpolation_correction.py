"""A user relies on: no bias of frequency-response error by interpolation at a resonance."""

from __future__ import annotations

import numpy as np

from flexsid.demo.campaign import add_aircraft, add_maneuver
from flexsid.demo.flights import fly
from flexsid.records.decision import Structure
from flexsid.records.maneuver import Flight
from flexsid.records.run import EstimationRun, Method, OutOfBandModes, RunSettings
from flexsid.storage.store import Store
from flexsid.sysid.estimation.frequency_domain_model import FrequencyDomainModel
from flexsid.sysid.estimation.interpolation import compute_interpolation_bias, correct_interpolation
from flexsid.sysid.stability.poles import NamedPole
from flexsid.workflow.fits.estimation_task import (
    build_experiments,
    get_first_start,
    select_free_parameters,
)
from flexsid.workflow.fits.run_warnings import warn_of_interpolation
from flexsid.workflow.runs.estimation import compute_run, prepare


def test_errors_by_interpolation_are_removed(store: Store):
    """Near flutter the resonance is narrower than the spacing of the harmonics of one input."""
    aircraft = add_aircraft(store)
    flight = store.flights.add(Flight(aircraft_id=aircraft.id or 0, number=1))
    flown = fly(airspeed_ratio=0.95, seed=1, modes_in_truth=2, noise=False)
    run = EstimationRun(
        maneuver_id=add_maneuver(store, flown, flight.id or 0).id or 0,
        method=Method.FRE,
        structure=Structure(modes=(7, 9), fixed={}),
        settings=RunSettings(out_of_band_modes=OutOfBandModes.OMITTED),
    )
    task = prepare(store, run)
    truth = flown.truth.named()
    parameters = select_free_parameters(task, get_first_start(task), task.extras)
    exact = np.array([truth[name] for name in parameters.names])
    measured = build_experiments(task)
    corrected = correct_interpolation(task.maneuvers, measured, parameters, exact)
    before, after = (
        np.mean(np.abs(one.measured - model.respond(exact).outputs) ** 2)
        for (one,) in (measured, corrected)
        for model in [FrequencyDomainModel(one, parameters)]
    )
    assert after < 0.01 * before
    remaining = [
        compute_interpolation_bias(task.maneuvers, measured, data, parameters, exact)
        for data in (measured, corrected)
    ]
    assert remaining[0] > 0.1
    assert remaining[1] < 1e-6

    found = compute_run(task, lambda _: None)
    assert not any("Interpolation" in warning for warning in found.warnings)
    values = dict(zip(found.estimate.names, found.estimate.values, strict=True))
    errors = [abs(values[name] / truth[name] - 1.0) for name in ("CZ_alpha", "Cm_alpha", "Cm_q")]
    assert max(errors) < 0.02, errors


def test_a_bias_that_remains_names_the_mode_and_the_spacing():
    omega = 2.0 * np.pi * np.array([0.3, 0.4, 0.5, 0.6, 0.7, 0.8])
    poles = (
        NamedPole("DR", -0.2 + 3.0j, 0.0, 0.0, 0.0, 0.0),
        NamedPole("AW1B", -3.0 + 3.5j, 0.0, 0.0, 0.0, 0.0),
    )
    assigned = np.array([0, 1, 0, 1, 0, 1])
    (warning,) = warn_of_interpolation(0.8, poles, omega, assigned)
    assert "0.2 Hz apart" in warning
    assert "0.8 of their standard deviations" in warning
    assert "half-power bandwidth of DR (0.064 Hz) is narrower" in warning
    assert warn_of_interpolation(0.4, poles, omega, assigned) == ()
