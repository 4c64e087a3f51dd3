"""Validation of runs: other maneuvers, held-out frequencies and held-out periods."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from flexsid.demo.campaign import add_aircraft, add_maneuver
from flexsid.demo.flights import fly
from flexsid.errors import BadInput, Cancelled
from flexsid.jobs.dispatcher import execute_request, execute_run
from flexsid.jobs.kind import get_result
from flexsid.jobs.kinds import CROSS_PREDICTION, CROSS_VALIDATION, RUN
from flexsid.records.decision import FixedTo, HeldBy, Structure
from flexsid.records.maneuver import Flight
from flexsid.records.run import EstimationRun, Method, OutOfBandModes, Progress, RunSettings
from flexsid.records.validation import Partition
from flexsid.storage.store import Store
from flexsid.workflow.flutter.flutter_models import FlutterQuery
from flexsid.workflow.validation.cross_prediction import (
    CrossPredictionQuery,
    compute_cross_predictions,
    compute_held_out_residuals,
    compute_prediction_residuals,
    correlate_residuals,
    identify_cross_prediction,
    measure_outputs,
    predict_maneuver,
    read_held_out_fit,
    read_prediction,
)
from flexsid.workflow.validation.cross_validation import CrossValidationQuery, cross_validate

Estimate = Callable[..., EstimationRun]


def ignore(progress: Progress) -> None:
    pass


@pytest.fixture(scope="module")
def store(migrated_file: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Store]:
    """Database with maneuvers 1 and 2, at 0.65 and 0.8 of the flutter speed."""
    file = tmp_path_factory.mktemp("validation") / "flexsid.db"
    shutil.copy(migrated_file, file)
    opened = Store.open(f"sqlite:///{file}")
    aircraft = add_aircraft(opened)
    flight = opened.flights.add(Flight(aircraft_id=aircraft.id or 0, number=90))
    for seed, ratio in enumerate((0.65, 0.8)):
        flown = fly(airspeed_ratio=ratio, modes_in_truth=2, seed=seed, label=f"at {ratio}")
        add_maneuver(opened, flown, flight.id or 0)
    yield opened
    opened.close()


@pytest.fixture(scope="module")
def estimate(store: Store) -> Estimate:
    """Return a function that estimates from a maneuver; equal estimates are one run."""

    @cache
    def execute(
        method: Method = Method.OE,
        retained: bool = False,
        modes: tuple[int, ...] = (7, 9),
        maneuver_id: int = 1,
        wrong: bool = False,
    ) -> EstimationRun:
        # Wrong: all held at the prediction, but pitch stiffness with the wrong sign.
        structure = Structure(
            modes=modes,
            free=("CZ_alpha",) if wrong else None,
            fixed={"Cm_alpha": 0.5} if wrong else {},
        )
        treatment = OutOfBandModes.RETAINED if retained else OutOfBandModes.OMITTED
        run = EstimationRun(
            maneuver_id=maneuver_id,
            method=method,
            structure=structure,
            settings=RunSettings(out_of_band_modes=treatment),
        )
        stored = execute_run(store, run, RUN, ignore)
        assert stored.error is None
        return stored

    return execute


def test_a_wrong_model_is_a_bad_row_of_the_matrix(store: Store, estimate: Estimate):
    right, wrong = estimate(), estimate(wrong=True)
    query = CrossPredictionQuery(run_ids=(right.id or 0, wrong.id or 0), maneuver_ids=(1, 2))
    identify_cross_prediction(store, query)
    found = compute_cross_predictions(store, query, ignore)
    assert [one.label for one in found.maneuvers] == ["at 0.65", "at 0.8"]
    r_squared = np.array([one.r_squared for one in found.predictions], dtype=float).reshape(2, 2)
    assert (r_squared[0] > 0.95).all()
    assert (r_squared[1] < 0.5).all()
    assert [one.is_fitted for one in found.predictions] == [True, False, True, False]
    assert all(one.n_frequencies > 300 and one.error is None for one in found.predictions)


def test_the_prediction_of_the_own_maneuver_is_the_fit_of_the_run(store: Store, estimate: Estimate):
    for retained in (False, True):
        run = estimate(retained=retained)
        assert run.result is not None
        assert (run.result.retained is not None) == retained
        for one in measure_outputs(predict_maneuver(store, run, 1).spectra):
            stored = run.result.fit.r_squared[one.output]
            assert one.r_squared == pytest.approx(stored, abs=1e-4)


@pytest.mark.parametrize("method", [pytest.param(Method.OE, marks=pytest.mark.long), Method.FRE])
def test_held_out_frequencies_are_predicted_as_well_as_fitted_ones(
    store: Store, estimate: Estimate, method: Method
):
    run = estimate(method, retained=method is Method.OE)
    seen: list[float] = []
    query = CrossValidationQuery(run_id=run.id or 0, folds=2)
    found = cross_validate(store, query, lambda progress: seen.append(progress.fraction))
    assert len(found.summary.refits) == 2
    assert sum(one.n_held_out for one in found.summary.refits) == found.spectra[0].omega.size
    assert found.summary.r_squared > 0.95
    assert (
        found.summary.fitted_r_squared - 0.03
        < found.summary.r_squared
        < found.summary.fitted_r_squared + 0.005
    )
    assert "2-fold" in found.summary.sentence
    assert seen == sorted(seen)
    output = found.summary.outputs[3].output
    (trace,) = read_held_out_fit(store, found, outputs=[output]).traces
    assert trace.r_squared == pytest.approx(found.summary.outputs[3].r_squared)
    assert np.isfinite(compute_held_out_residuals(found).relative).all()
    with pytest.raises(BadInput, match="not fitted to maneuver 2"):
        read_held_out_fit(store, found, maneuver_id=2)


def test_held_out_periods_are_predicted(store: Store, estimate: Estimate):
    flown = fly(modes_in_truth=2, seed=3, n_periods=3)
    maneuver = add_maneuver(store, flown, store.maneuvers.get(1).flight_id)
    run = estimate(maneuver_id=maneuver.id)
    query = CrossValidationQuery(run_id=run.id or 0, partition=Partition.PERIODS)
    found = cross_validate(store, query, ignore)
    (refit,) = found.summary.refits
    assert refit.n_frequencies == refit.n_held_out == found.spectra[0].omega.size
    assert found.summary.r_squared > 0.95
    assert found.summary.r_squared < found.summary.fitted_r_squared + 0.005


def test_periods_and_folds_that_the_data_do_not_have_are_refused(store: Store, estimate: Estimate):
    run_id = estimate().id or 0
    with pytest.raises(BadInput, match="has 1 period of its multisine; expected at least 3"):
        cross_validate(
            store, CrossValidationQuery(run_id=run_id, partition=Partition.PERIODS), ignore
        )
    with pytest.raises(BadInput, match="no run is selected"):
        identify_cross_prediction(store, CrossPredictionQuery(run_ids=()))


def test_the_same_runs_in_another_order_are_the_same_request():
    for build in (CrossPredictionQuery, FlutterQuery):
        assert build(run_ids=(2, 1, 2)) == build(run_ids=(1, 2))


def test_a_cancelled_refit_ends_the_validation(store: Store, estimate: Estimate):
    run_id = estimate().id or 0

    def cancel(progress: Progress) -> None:
        if progress.fraction > 0.3:
            raise Cancelled("cancelled")

    with pytest.raises(Cancelled):
        cross_validate(store, CrossValidationQuery(run_id=run_id), cancel)


def test_residuals_of_the_true_structure_are_independent_of_the_inputs(
    store: Store, estimate: Estimate
):
    run = estimate()
    found = correlate_residuals(store, run.id or 0, outputs=["q", "alpha"])
    pairs = [(one.output, one.other) for one in found.curves]
    assert pairs[0] == ("q", "q")
    assert pairs[-1] == ("q", "alpha")
    assert ("alpha", "bfs") in pairs
    assert found.share_outside < 0.15
    rigid = estimate(modes=())
    own, *_ = correlate_residuals(store, rigid.id or 0).curves
    assert np.mean(np.abs(own.values) > own.bound) > 0.3
    with pytest.raises(BadInput, match="no output 'nose'"):
        correlate_residuals(store, run.id or 0, outputs=["nose"])
    (trace,) = read_prediction(store, run.id or 0, 2, ["q"]).traces
    assert (trace.r_squared or 0.0) > 0.95
    assert compute_prediction_residuals(store, run.id or 0, 2).relative.shape[0] > 300


def test_a_maneuver_without_an_input_has_an_error_in_its_cell(store: Store, estimate: Estimate):
    run = estimate()
    second = store.maneuvers.get(2)
    with store.transaction():
        bare = store.maneuvers.add(replace(second, id=None, label="bare"))
        for channel in store.channels.find(maneuver_id=2):
            if channel.name not in ("wf1s", "q"):
                store.channels.add(replace(channel, id=None, maneuver_id=bare.id))
    query = CrossPredictionQuery(run_ids=(run.id or 0,), maneuver_ids=(bare.id or 0,))
    (cell,) = compute_cross_predictions(store, query, ignore).predictions
    assert cell.r_squared is None
    assert "'wf1s' is not a recorded input" in (cell.error or "")


def test_a_joint_run_that_is_fixed_to_another_run_is_validated_by_workers(
    store: Store, estimate: Estimate
):
    """Workers have the runs of the request only."""
    source = estimate(Method.EE)
    held = {"CZ_q": FixedTo(source=HeldBy.RUN, id=source.id or 0)}
    run = EstimationRun(
        maneuver_id=1,
        method=Method.EE,
        structure=Structure(modes=(7, 9), fixed={}, fixed_to=held),
        settings=RunSettings(additional_maneuver_ids=(2,)),
    )
    run_id = execute_run(store, run, RUN, ignore).id or 0
    query = CrossValidationQuery(run_id=run_id, folds=2)
    execute_request(store, CROSS_VALIDATION, query, ignore)
    found = get_result(store, CROSS_VALIDATION, query).summary
    assert {one.maneuver_id for one in found.outputs} == {1, 2}
    assert found.r_squared > 0.95
    matrix = CrossPredictionQuery(run_ids=(run_id,))
    execute_request(store, CROSS_PREDICTION, matrix, ignore)
    cells = get_result(store, CROSS_PREDICTION, matrix).predictions
    assert [(one.maneuver_id, one.is_fitted) for one in cells] == [(1, True), (2, True)]
    assert all((one.r_squared or 0.0) > 0.95 for one in cells)
