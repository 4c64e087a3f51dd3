"""Amplitude comparison of stored runs: levels of a linear aircraft, and what is refused."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from flexsid.demo.campaign import add_aircraft, add_maneuver
from flexsid.demo.flights import fly
from flexsid.errors import BadInput
from flexsid.jobs.dispatcher import execute_request, execute_run
from flexsid.jobs.kinds import AMPLITUDE_COMPARISON, RUN, list_compared_levels
from flexsid.records.decision import Structure
from flexsid.records.maneuver import Flight
from flexsid.records.run import EstimationRun, Method, OutOfBandModes, RunSettings, Start
from flexsid.records.validation import AmplitudeSubject
from flexsid.storage.store import Store
from flexsid.workflow.validation.amplitude_comparison import (
    AmplitudeComparisonQuery,
    find_odd_inputs,
    identify_amplitude_comparison,
)

# [deg] of maneuvers and runs 1 and 2; run 3 is of maneuver 1 by equation error.
PEAKS = (2.0, 4.0)


@pytest.fixture(scope="module")
def store(migrated_file: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Store]:
    file = tmp_path_factory.mktemp("amplitudes") / "flexsid.db"
    shutil.copy(migrated_file, file)
    store = Store.open(f"sqlite:///{file}")
    aircraft = add_aircraft(store)
    flight = store.flights.add(Flight(aircraft_id=aircraft.id or 0, number=1)).id or 0
    for seed, peak_deg in enumerate(PEAKS):
        flown = fly(fta=503, peak_deg=peak_deg, seed=seed, modes_in_truth=2)
        add_maneuver(store, flown, flight)
        estimate(store, seed + 1, Method.OE)
    estimate(store, 1, Method.EE)
    yield store
    store.close()


def estimate(store: Store, maneuver_id: int, method: Method) -> None:
    run = EstimationRun(
        maneuver_id=maneuver_id,
        method=method,
        structure=Structure(modes=(7,), fixed={}),
        settings=RunSettings(start=Start.PREDICTION, out_of_band_modes=OutOfBandModes.OMITTED),
    )
    execute_run(store, run, RUN, lambda progress: None)


def test_a_linear_aircraft_has_one_model_at_all_amplitudes(store: Store):
    """The model lacks a mode: its estimates are biased at every amplitude alike."""
    (listed,) = list_compared_levels(store, 1)
    assert listed.run_ids == (1, 2)
    assert listed.comparison is None
    amplitudes = [level.amplitude_rad for level in listed.levels]
    assert amplitudes[1] / amplitudes[0] == pytest.approx(2.0, rel=0.1)
    query = AmplitudeComparisonQuery(run_ids=(2, 1))
    execute_request(store, AMPLITUDE_COMPARISON, query, lambda progress: None)
    (listed,) = list_compared_levels(store, 1)
    found = listed.comparison
    assert found is not None
    assert found.is_linear, found.sentence
    assert {one.subject for one in found.tests} == set(AmplitudeSubject)
    (bending,) = (one for one in found.tests if one.name == "SW1B")
    frequency, damping = bending.quantities
    assert (frequency.unit, damping.name) == ("Hz", "damping")
    assert bending.degrees_of_freedom == 2
    assert np.ptp(frequency.values) < 5.0 * max(frequency.std_errors)


@pytest.mark.parametrize(
    ("run_ids", "code"),
    [
        ((1,), "number-of-runs"),
        ((1, 3), "not-output-error"),
    ],
)
def test_runs_that_cannot_be_compared_are_refused(
    store: Store, run_ids: tuple[int, ...], code: str
):
    with pytest.raises(BadInput) as refused:
        identify_amplitude_comparison(store, AmplitudeComparisonQuery(run_ids=run_ids))
    assert refused.value.code == code


def test_a_maneuver_with_a_stuck_surface_is_no_level_of_the_multisine():
    sound = {"wf1s": 0.01, "wf2s": 0.02, "wf3s": 0.01}
    larger = {name: 2.1 * value for name, value in sound.items()}
    assert find_odd_inputs([sound, larger]) == {}
    assert find_odd_inputs([sound, {**larger, "wf2s": 1e-4}, larger]) == {
        1: ("wf2s", pytest.approx(0.0, abs=0.01))
    }
    assert set(find_odd_inputs([sound, {**larger, "wf2s": 1e-4}])) == {0, 1}
