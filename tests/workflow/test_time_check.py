"""Time responses of the identified model against the recording."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from file_imports import import_maneuver
from rigid_record import NOISE, make_pulses, simulate, write_record

from flexsid.demo.campaign import add_aircraft, add_maneuver
from flexsid.demo.flights import fly
from flexsid.errors import BadInput
from flexsid.records.decision import Structure
from flexsid.records.maneuver import Flight
from flexsid.records.run import EstimationRun, Method, RunSettings
from flexsid.storage.jobs import queue
from flexsid.storage.store import Store
from flexsid.workflow.runs.estimation import compute_run, prepare, store_result
from flexsid.workflow.runs.run_proposal import apply_proposal, set_default_band
from flexsid.workflow.views.time_comparison import (
    check_in_time,
    compare_in_time,
    compute_fit_percent,
)


@pytest.mark.parametrize("ratio", [0.65, 1.09])
def test_model_follows_the_recording_also_beyond_flutter(store: Store, ratio: float):
    aircraft = add_aircraft(store)
    assert aircraft.id is not None
    flight = store.flights.add(Flight(aircraft_id=aircraft.id, number=90))
    assert flight.id is not None
    flown = fly(airspeed_ratio=ratio, fuel=0.5, fta=506, peak_deg=1.5, modes_in_truth=2, seed=3)
    maneuver = add_maneuver(store, flown, flight.id)
    assert maneuver.id is not None
    run = store.runs.add(
        EstimationRun(
            maneuver_id=maneuver.id,
            method=Method.OE,
            structure=Structure(modes=(7, 9), fixed={}),
            settings=RunSettings(),
        )
    )
    assert run.id is not None
    claimed = queue.claim(store, run.id)
    assert claimed is not None
    store_result(
        store, run.id, claimed.attempt, compute_run(prepare(store, run), lambda progress: None)
    )

    check = check_in_time(store, run.id, ["q", "az_ofs"])
    assert [trace.r_squared > 0.95 for trace in check.traces] == [True, True]
    with pytest.raises(BadInput, match="no output 'nose'"):
        check_in_time(store, run.id, ["nose"])
    compared = compare_in_time(store, [run.id], "q")
    (record,) = compared.records
    assert (record.maneuver_id, record.time_s[0]) == (maneuver.id, 0.0)
    fit = record.simulated[0].fit_percent
    # Without a mean in the record, R2 is one minus the square of the normalised error.
    assert fit == pytest.approx(100.0 * (1.0 - np.sqrt(1.0 - check.traces[0].r_squared)), abs=0.1)
    with pytest.raises(BadInput, match="at most 12"):
        compare_in_time(store, [run.id], "q", range(1, 18))


def test_a_simulation_holds_a_surface_that_moves_in_steps(store: Store, tmp_path: Path):
    def deflect(time: np.ndarray) -> np.ndarray:
        pulses = make_pulses(time, (0.6, 1), (0.6, -1))
        return pulses[np.arange(time.size) // 40 * 40]  # at 25 Hz

    record, mapping = write_record(tmp_path, simulate(7.5, deflect))
    column = 'column = "elevator"\n'
    text = mapping.read_text().replace(column, f'{column}between_samples = "held"\n')
    maneuver = import_maneuver(store, [record], text)
    assert maneuver.id is not None
    request = EstimationRun(
        maneuver_id=maneuver.id,
        method=Method.OE,
        structure=Structure(),
        settings=RunSettings(),
    )
    run = store.runs.add(set_default_band(store, apply_proposal(store, request)))
    assert run.id is not None
    claimed = queue.claim(store, run.id)
    assert claimed is not None
    found = compute_run(prepare(store, run), lambda progress: None)
    store_result(store, run.id, claimed.attempt, found)
    for trace in check_in_time(store, run.id, ["q", "alpha"]).traces:
        away = np.asarray(trace.measured) - np.asarray(trace.simulated)
        assert np.std(away) < 1.3 * NOISE[trace.name], trace.name


def test_fit_is_that_of_the_system_identification_toolbox():
    record = np.array([1.0, 3.0, 1.0, 3.0])
    assert compute_fit_percent(record, record) == 100.0
    assert compute_fit_percent(record, np.full(4, 2.0)) == pytest.approx(0.0)
    assert compute_fit_percent(record, record + 0.5) == pytest.approx(50.0)
    assert compute_fit_percent(np.ones(4), record) is None
