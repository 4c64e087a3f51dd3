"""Comparison of derivatives between runs and with a prediction."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from flexsid.errors import BadInput, Conflict
from flexsid.records.aircraft import DerivativePrediction
from flexsid.records.run import Method
from flexsid.records.validation import AgreementCount
from flexsid.workflow.comparison.derivative_comparison import compare, select_coefficient


def row(comparison, name):
    return next(row for row in comparison.rows if row.name == name)


def test_predictions_are_taken_at_the_fuel_of_the_maneuver(store, add_result, prediction):
    run = add_result({"Cm_alpha": (-1.6, 0.1)})
    comparison = compare(store, [run.id], [prediction.id])
    assert [source.kind for source in comparison.sources] == ["OE", "prediction"]
    assert comparison.sources[1].label == "vortex lattice"
    predicted = row(comparison, "Cm_alpha").values[1]
    assert predicted is not None
    assert predicted.value == pytest.approx(-1.5), "half fuel"
    assert predicted.std_error is None


def test_runs_are_judged_in_combined_standard_errors(store, add_result, prediction):
    first = add_result({"Cm_alpha": (-1.0, 0.3), "Cm_q": (-8.0, 0.1)})
    second = add_result({"Cm_alpha": (-1.5, 0.4), "Cm_q": (-9.0, 0.1)}, method=Method.EE)
    comparison = compare(store, [first.id, second.id], [prediction.id])
    agreed, apart = row(comparison, "Cm_alpha"), row(comparison, "Cm_q")
    assert agreed.max_difference_sigma == pytest.approx(0.5 / 0.5)
    assert agreed.consistent is True
    assert apart.max_difference_sigma == pytest.approx(1.0 / (0.1 * 2**0.5))
    assert apart.consistent is False


def test_errors_of_the_modal_table_are_shared_by_runs(store, add_result, wind_tunnel):
    own, shared = 0.03, 0.4
    std_error = float(np.hypot(own, shared))
    runs = [
        add_result({"Cm_alpha": (value, std_error)}, method=method, modal_std={"Cm_alpha": shared})
        for value, method in ((-1.0, Method.OE), (-1.1, Method.EE))
    ]
    found = row(compare(store, [run.id for run in runs], [wind_tunnel.id]), "Cm_alpha")
    assert found.max_difference_sigma == pytest.approx(0.1 / (own * 2**0.5))
    assert found.consistent is False
    predicted = found.values[2]
    assert predicted is not None, "a prediction does not share them"
    assert predicted.difference_sigma == pytest.approx(2.0 / np.hypot(std_error, 0.1))


def test_runs_of_one_maneuver_share_its_noise_and_their_priors(store, add_result):
    """Standard errors 0.6, of which 0.3 and 0.32 (noise) and 0.24 (prior) are common."""
    noise, prior = (0.3, 0.32, 0.0), 0.24
    runs = [
        add_result({"Cm_alpha": (value, 0.6)}, method=method, components=((*noise, prior),))
        for value, method in ((-1.0, Method.OE), (-1.3, Method.FRE))
    ]
    alone = 0.6**2 - 0.3**2 - 0.32**2 - 0.24**2
    found = row(compare(store, [run.id for run in runs], []), "Cm_alpha")
    assert found.max_difference_sigma == pytest.approx(0.3 / (2.0 * alone) ** 0.5, rel=1e-4)
    assert found.limit_sigma == 2.0
    assert found.mean_std_error == pytest.approx((0.36 - alone / 2.0) ** 0.5, rel=1e-4)
    independent = add_result({"Cm_alpha": (-1.3, 0.6)}, method=Method.EE)
    three = row(compare(store, [*(run.id for run in runs), independent.id], []), "Cm_alpha")
    assert 2.0 < (three.limit_sigma or 0.0) < 2.4, "the largest of three differences"


@pytest.fixture
def wind_tunnel(store, aircraft):
    """A prediction with standard errors that differs from the runs."""
    return store.predictions.add(
        DerivativePrediction(
            aircraft_id=aircraft.id,
            source="wind tunnel",
            kind="wind tunnel",
            fuel=(0.5,),
            names=("Cm_alpha", "Cm_q"),
            values=store.arrays.put(np.array([[-3.0, -8.0]])),
            std_errors=store.arrays.put(np.array([[0.1, 0.1]])),
        )
    )


def test_prediction_does_not_change_agreement_of_runs(store, add_result, wind_tunnel):
    runs = [
        add_result({"Cm_alpha": (-1.0 - 0.01 * k, 0.1), "Cm_q": (-8.0, 0.1)}, method=method)
        for k, method in enumerate((Method.OE, Method.EE))
    ]
    numbers = [run.id for run in runs]
    alone, beside = compare(store, numbers, []), compare(store, numbers, [wind_tunnel.id])
    assert beside.runs_verdict == alone.runs_verdict == AgreementCount(n_judged=2, n_consistent=2)
    for one, other in zip(alone.rows, beside.rows, strict=True):
        assert replace(one, values=()) == replace(other, values=())
    (verdict,) = beside.prediction_verdicts
    key = f"prediction-{wind_tunnel.id}"
    assert verdict == AgreementCount(source=key, n_judged=2, n_consistent=1)
    far, near = (row(beside, name).values[2] for name in ("Cm_alpha", "Cm_q"))
    assert far is not None
    assert near is not None
    assert (far.consistent, near.consistent) == (False, True)
    assert far.difference_sigma == pytest.approx(2.0 / (0.1 * 2**0.5)), "from the farthest run"
    (only,) = select_coefficient(beside, "Cm").prediction_verdicts
    assert only == verdict


def test_single_run_is_compared_with_the_prediction_only(store, add_result, wind_tunnel):
    run = add_result({"Cm_alpha": (-1.0, 0.1)})
    comparison = compare(store, [run.id], [wind_tunnel.id])
    assert comparison.runs_verdict.n_judged == 0
    assert row(comparison, "Cm_alpha").consistent is None
    assert row(comparison, "Cm_alpha").mean is None
    assert comparison.prediction_verdicts[0].n_judged == 1


def test_missing_standard_error_is_not_compared(store, add_result, prediction):
    run = add_result({"Cm_alpha": (-1.0, 0.1), "Cm_q": (-8.0, None)})
    comparison = compare(store, [run.id], [prediction.id])
    for name in ("Cm_alpha", "Cm_q"):
        assert row(comparison, name).consistent is None
        assert row(comparison, name).max_difference_sigma is None


def test_derivatives_are_in_the_order_of_the_table(store, add_result):
    small = add_result({"tau_q": (0.01, 0.001), "Cm_wf4s": (1.0, 0.1), "Cm_alpha": (1.0, 0.1)})
    large = add_result(
        {
            "CQ10_eta7": (1.0, 0.1),
            "CQ9_eta7": (1.0, 0.1),
            "Cm_etadot7": (1.0, 0.1),
            "Cm_eta10": (1.0, 0.1),
            "Cm_eta9": (1.0, 0.1),
            "CZ_q": (1.0, 0.1),
        }
    )
    comparison = compare(store, [small.id, large.id], [])
    assert [row.name for row in comparison.rows] == [
        *("CZ_q", "Cm_alpha", "Cm_eta9", "Cm_eta10", "Cm_etadot7", "Cm_wf4s"),
        *("CQ9_eta7", "CQ10_eta7", "tau_q"),
    ]
    assert row(comparison, "CZ_q").values[0] is None


def test_residualized_prediction_is_a_source_of_its_own_shown_once(store, add_result, prediction):
    runs = [
        add_result(
            {"Cm_alpha": (-1.0, 0.1)},
            residualized={"Cm_alpha": -1.2},
            prediction_id=prediction.id,
        )
        for _ in range(2)
    ]
    comparison = compare(store, [run.id for run in runs], [prediction.id])
    labels = [source.label for source in comparison.sources]
    assert labels[2:] == ["vortex lattice", "vortex lattice, residualized"]
    residualized = row(comparison, "Cm_alpha").values[3]
    assert residualized is not None
    assert residualized.value == -1.2
    assert len(compare(store, [runs[0].id], []).sources) == 1, "only what was asked for"


def test_one_coefficient_can_be_picked(store, add_result):
    run = add_result({"CZ_alpha": (-4.0, 0.1), "CQ7_eta7": (-1.0, 0.1)})
    comparison = compare(store, [run.id], [])
    assert [row.name for row in select_coefficient(comparison, "CQ7").rows] == ["CQ7_eta7"]
    assert select_coefficient(comparison, "first") == select_coefficient(comparison, "CZ")
    with pytest.raises(BadInput, match="CZ, CQ7"):
        select_coefficient(comparison, "Cm")


def test_a_run_without_result_cannot_be_compared(store, add_run):
    run = add_run()
    with pytest.raises(Conflict, match="queued"):
        compare(store, [run.id], [])
    with pytest.raises(BadInput, match="at least one run"):
        compare(store, [], [])


def test_scatter_and_pairs_are_tested_by_chi_square(store, add_result):
    runs = [
        add_result({"Cm_alpha": (value, 0.1), "Cm_q": (-8.0, 0.2)}, method=method)
        for value, method in ((-1.0, Method.OE), (-1.1, Method.FRE), (-1.6, Method.EE))
    ]
    comparison = compare(store, [run.id for run in runs], [])
    alpha = row(comparison, "Cm_alpha")
    assert alpha.mean is not None
    assert alpha.probability is not None
    assert alpha.mean == pytest.approx((-1.0 - 1.1 - 1.6) / 3)
    assert alpha.mean_std_error == pytest.approx(0.1 / 3**0.5)
    assert alpha.chi_square == pytest.approx(
        sum((value - alpha.mean) ** 2 for value in (-1.0, -1.1, -1.6)) / 0.01
    )
    assert alpha.probability < 1e-3
    assert row(comparison, "Cm_q").probability == pytest.approx(1.0)
    near, far, _ = comparison.pairs
    assert (near.n, near.worst) == (2, "Cm_alpha")
    assert near.worst_sigma == pytest.approx(0.1 / (0.1 * 2**0.5))
    assert far.chi_square == pytest.approx((0.6 / (0.1 * 2**0.5)) ** 2)
    assert far.probability < 0.01 < near.probability


def test_only_different_settings_are_listed(store, add_result):
    first = add_result({"Cm_alpha": (-1.0, 0.1)})
    second = add_result({"Cm_alpha": (-1.0, 0.1)}, method=Method.EE)
    setup = {one.name: one.values for one in compare(store, [first.id, second.id], []).setup}
    assert setup["method"] == ("OE", "EE")
    assert "modes" not in setup
