"""Global model of stored runs: identity, refusals, outlying runs, slices and coverage."""

from __future__ import annotations

import numpy as np
import pytest
from simulated_campaign import NAMES, VALUES, Truth, fly, reverse_surface, store_runs

from flexsid.errors import BadInput, UnknownRecord
from flexsid.figures.global_model import draw_coverage, draw_slice
from flexsid.jobs.dispatcher import execute_request
from flexsid.jobs.kind import get_result
from flexsid.jobs.kinds import GLOBAL_MODEL
from flexsid.records.aircraft import DerivativePrediction
from flexsid.records.decision import LimitedQuantity, Structure
from flexsid.workflow.global_model.estimates import GlobalModelQuery, prepare_global_model
from flexsid.workflow.global_model.versions import compute_coverage, slice_derivative

WRONG = 4


@pytest.fixture
def run_ids(store) -> tuple[int, ...]:
    """Runs of twenty maneuvers of four flights, one with a surface of wrong sign."""
    rng = np.random.default_rng(21)
    estimates = fly(rng, Truth.draw(rng, 0.3), 20, 4)
    return store_runs(store, reverse_surface(estimates, WRONG))


def test_a_stored_global_model_names_the_wrong_run_and_is_drawn(store, run_ids):
    prediction = store.predictions.add(
        DerivativePrediction(
            aircraft_id=store.aircraft.find()[0].id,
            source="vortex lattice",
            kind="panel code",
            fuel=(0.0, 1.0),
            names=NAMES[:3],
            values=store.arrays.put(np.tile(VALUES[:3], (2, 1))),
        )
    )
    query = GlobalModelQuery(run_ids=run_ids, prediction_id=prediction.id)
    execute_request(store, GLOBAL_MODEL, query, lambda progress: None)
    again = GlobalModelQuery(run_ids=tuple(reversed(run_ids)), prediction_id=prediction.id)
    result = get_result(store, GLOBAL_MODEL, again)
    summary = result.summary
    (outlier,) = summary.outliers
    assert outlier.run_id == run_ids[WRONG]
    assert "check the sign of wf4s" in outlier.sentence
    assert summary.n_flights == 4
    assert [run.run_id for run in summary.runs if run.is_outlying] == [run_ids[WRONG]]
    assert sum(score.is_selected for score in summary.scores) == 1
    assert summary.next_condition is not None
    assert 0.0 < summary.next_condition.reduction < 1.0
    assert [one.name for one in summary.derivatives] == list(NAMES)

    found = slice_derivative(result, "CZ_alpha", LimitedQuantity.FUEL, (500.0, 0.5))
    assert found.is_extrapolated[[0, -1]].any()
    assert not found.is_extrapolated[40]
    assert len(found.points) == 20
    figure = draw_slice(found)
    assert "vortex lattice" in [trace.get("name") for trace in figure["data"]]
    outlying = next(trace for trace in figure["data"] if trace.get("name") == "outlying")
    assert outlying["customdata"][0][0] == run_ids[WRONG]
    coverage = compute_coverage(result)
    assert np.nanmin(coverage.ratio) >= 1.0
    assert draw_coverage(coverage)["data"][0]["type"] == "heatmap"
    with pytest.raises(BadInput, match="does not have"):
        slice_derivative(result, "Cn_beta")
    with pytest.raises(BadInput, match="not a variable"):
        slice_derivative(result, "CZ_alpha", LimitedQuantity.ALPHA)
    with pytest.raises(BadInput, match="one for each"):
        slice_derivative(result, "CZ_alpha", condition=(1.0,))


def test_runs_that_share_data_count_once(store, run_ids, add_result):
    first = store.runs.get(run_ids[0])
    values = {one.name: (one.value, one.std_error) for one in first.result.parameters}
    twice = add_result(values, maneuver_id=first.maneuver_id, structure=first.structure)
    task = prepare_global_model(store, GlobalModelQuery(run_ids=(*run_ids, twice.id)))
    assert task.estimates.weights[[0, -1]].tolist() == [0.5, 0.5]
    assert task.n_maneuvers == 20


def test_runs_without_a_common_model_are_refused(store, run_ids, add_result):
    first = store.runs.get(run_ids[0])
    values = {one.name: (one.value, one.std_error) for one in first.result.parameters}
    other = add_result(
        values, maneuver_id=first.maneuver_id, structure=Structure(modes=(7,), fixed={})
    )
    ratio = (LimitedQuantity.AIRSPEED_RATIO,)
    for query, code in (
        (GlobalModelQuery(run_ids=run_ids[:2]), "bad-number-of-runs"),
        (GlobalModelQuery(run_ids=(*run_ids, other.id)), "mixed-modes"),
        (GlobalModelQuery(run_ids=run_ids, variables=()), "no-variable"),
        (GlobalModelQuery(run_ids=run_ids, variables=ratio), "unknown-condition"),
        (GlobalModelQuery(run_ids=run_ids, prediction_id=99), "wrong-prediction"),
    ):
        with pytest.raises(BadInput) as refused:
            prepare_global_model(store, query)
        assert refused.value.code == code
    with pytest.raises(UnknownRecord):
        prepare_global_model(store, GlobalModelQuery(run_ids=(*run_ids, 999)))
