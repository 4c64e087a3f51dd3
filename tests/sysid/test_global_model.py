"""Global model: its intervals hold the truth, drift and outlying runs are found, and only those."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy import optimize
from simulated_campaign import FLUTTER_PA, NAMES, VALUES, Truth, fly, scale_run

from flexsid.errors import NotIdentifiable
from flexsid.sysid.global_model.fit import GlobalFit, build_basis, combine_terms, fit_global_model
from flexsid.sysid.global_model.selection import (
    compute_variance_reductions,
    find_outlying_runs,
    select_global_model,
)

GRID = np.stack(
    np.meshgrid(FLUTTER_PA * np.linspace(0.5, 0.95, 8) ** 2, np.linspace(0.0, 1.0, 7)), axis=-1
).reshape(-1, 2)


def measure(seed: int, drift: float, n_runs: int = 40) -> tuple[float, float, float]:
    """Return coverage of ±2σ, error over that of single runs, and the largest |slope| / σ."""
    rng = np.random.default_rng(seed)
    truth = Truth.draw(rng, drift)
    runs = fly(rng, truth, n_runs)
    model = select_global_model([runs]).model
    inside = GRID[~model.basis.is_extrapolated(GRID)]
    values, covariance = model.predict(inside)
    error = values - truth.at(inside)
    std = np.sqrt(np.diagonal(covariance, axis1=1, axis2=2))
    single = np.sqrt(np.mean(((runs.values - truth.at(runs.conditions)) / VALUES) ** 2))
    slopes = [model.average_slopes(runs.conditions, variable) for variable in range(2)]
    return (
        float(np.mean(np.abs(error) <= 2.0 * std)),
        float(np.sqrt(np.mean((error / VALUES) ** 2)) / single),
        max(float(np.max(np.abs(slope / std))) for slope, std in slopes),
    )


@pytest.mark.parametrize("drift", [0.0, 0.3, 0.8])
def test_intervals_hold_the_truth_over_the_envelope(drift: float):
    coverage, ratio, _ = np.mean([measure(seed, drift) for seed in range(5)], axis=0)
    assert 0.92 <= coverage <= 0.985
    assert ratio <= 0.7


@pytest.mark.long
@pytest.mark.parametrize("drift", [0.0, 0.3, 0.8])
def test_intervals_hold_the_truth_in_many_campaigns(drift: float):
    found = np.array([measure(seed, drift) for seed in range(200)])
    assert 0.93 <= found[:, 0].mean() <= 0.975
    assert found[:, 1].mean() <= 0.4
    if drift == 0.0:  # two-sided 5 % in 28 slopes
        assert np.mean(found[:, 2] > 3.12) <= 0.08


@pytest.mark.parametrize("kind", ["sign", "mass", "none"])
@pytest.mark.parametrize("seed", [1, pytest.param(2, marks=pytest.mark.long)])
def test_a_wrong_run_is_named_with_its_cause(kind: str, seed: int):
    rng = np.random.default_rng(seed)
    runs = fly(rng, Truth.draw(rng, 0.3), 20)
    factors = {
        "sign": np.where([name.endswith("_wf4s") for name in NAMES], -1.0, 1.0),
        "mass": np.where([name.startswith("CZ_") for name in NAMES], 1.2, 1.0),
        "none": np.ones(len(NAMES)),
    }[kind]
    found = find_outlying_runs(scale_run(runs, 3, factors))
    if kind == "none":
        assert found == ()
        return
    (outlying,) = found
    assert outlying.index == 3
    assert outlying.cause is not None
    place = ("CZ", None) if kind == "mass" else (None, "wf4s")
    assert (outlying.cause.coefficient, outlying.cause.variable) == place
    assert outlying.cause.factor == pytest.approx(1.2 if kind == "mass" else -1.0, abs=0.15)


def test_equal_runs_of_a_constant_are_averaged():
    rng = np.random.default_rng(3)
    runs = fly(rng, Truth.draw(rng, 0.0), 12)
    runs = replace(runs, conditions=np.tile([500.0, 0.5], (12, 1)))
    fit = GlobalFit(runs, build_basis(runs.conditions), 1)
    components = replace(fit.maximize(), scatter=np.full(len(NAMES), 1e-6))
    model = fit.solve(components)
    information = np.linalg.inv(runs.covariances)
    covariance = np.linalg.inv(information.sum(axis=0))
    mean = covariance @ np.einsum("rij,rj->i", information, runs.values)
    np.testing.assert_allclose(model.coefficients[:, 0], mean, rtol=1e-6)
    np.testing.assert_allclose(model.covariance, covariance, rtol=1e-5, atol=1e-12)


def test_the_gradient_of_the_likelihood_is_its_derivative():
    rng = np.random.default_rng(4)
    runs = fly(rng, Truth.draw(rng, 0.3), 14)
    runs.values[::3, 5] = np.nan
    fit = GlobalFit(
        replace(runs, weights=rng.uniform(0.3, 1.0, 14)), build_basis(runs.conditions), 1
    )

    def solve(x: np.ndarray):
        return fit._solve(*np.split(np.exp(x), 2))

    x = rng.uniform(-1.0, 1.0, 2 * len(NAMES))
    expected = optimize.approx_fprime(x, lambda at: solve(at).objective, 1e-6)
    np.testing.assert_allclose(solve(x).gradient, expected, rtol=1e-3, atol=1e-3)


def test_the_prediction_of_a_run_is_that_of_a_fit_without_it():
    rng = np.random.default_rng(5)
    runs = fly(rng, Truth.draw(rng, 0.3), 16, n_flights=16)
    runs.values[2, 3] = np.nan
    fit, components, model = fit_global_model(runs, build_basis(runs.conditions), 1)
    residual, covariance = fit.predict_runs(components, model)
    expected, expected_covariance = fit.predict_flights(components)
    np.testing.assert_allclose(residual, expected, atol=1e-7)
    np.testing.assert_allclose(covariance, expected_covariance, atol=1e-6)


def test_a_good_prediction_is_selected_as_mean_and_a_wrong_one_is_not():
    rng = np.random.default_rng(6)
    truth = Truth.draw(rng, 0.8)
    runs = fly(rng, truth, 12)
    good = replace(runs, mean=1.05 * truth.at(runs.conditions))
    wrong = replace(runs, mean=VALUES * (1.0 + rng.standard_normal(runs.values.shape)))
    assert select_global_model([runs, good]).candidate == 1
    assert select_global_model([runs, wrong]).candidate == 0


def test_terms_that_were_not_flown_are_omitted_and_extrapolation_is_marked():
    corners = np.array([[300.0, 0.2], [300.0, 0.8], [700.0, 0.2], [700.0, 0.8], [500.0, 0.5]])
    basis = build_basis(corners)
    terms = basis.evaluate(corners)
    np.testing.assert_allclose(terms.T @ terms / 5.0, np.eye(terms.shape[1]), atol=1e-12)
    assert (basis.degrees <= 2).all()
    assert not basis.is_extrapolated(corners).any()
    assert basis.is_extrapolated(np.array([[800.0, 0.5], [500.0, 0.9]])).all()
    line = build_basis(np.array([[300.0, 0.2], [500.0, 0.5], [700.0, 0.8]]))
    assert line.is_extrapolated(np.array([[300.0, 0.8]])).all(), "a corner that nobody flew"
    step = np.array([1e-3, 0.0])
    slope = (basis.evaluate(corners + step) - basis.evaluate(corners - step)) / 2e-3
    np.testing.assert_allclose(basis.differentiate(corners, 0), slope, atol=1e-7)


def test_the_next_run_reduces_the_variance_as_predicted():
    rng = np.random.default_rng(7)
    runs = fly(rng, Truth.draw(rng, 0.3), 12)
    fit, components, model = fit_global_model(runs, build_basis(runs.conditions), 1)
    grid = GRID[::5]
    reduction = compute_variance_reductions(model, runs.covariances[0], grid)
    best = int(np.argmax(reduction))
    more = replace(
        runs,
        values=np.vstack([runs.values, runs.values[:1]]),
        covariances=np.concatenate([runs.covariances, runs.covariances[:1]]),
        conditions=np.vstack([runs.conditions, grid[best : best + 1]]),
        mean=np.vstack([runs.mean, runs.mean[:1]]),
        flights=np.append(runs.flights, 99),
        weights=np.append(runs.weights, 1.0),
    )
    extended = GlobalFit(more, fit.basis, 1)
    share = fit.scale / extended.scale
    again = replace(
        components,
        scale=extended.scale,
        scatter=components.scatter * share,
        curvature=components.curvature * share,
    )
    terms = fit.basis.evaluate(grid)
    before, after = (
        np.diagonal(combine_terms(one.covariance, terms), axis1=1, axis2=2).mean(axis=0)
        for one in (model, extended.solve(again))
    )
    assert reduction[best] == pytest.approx(float(np.mean(1.0 - after / before)), rel=1e-3)


def test_a_singular_covariance_is_refused():
    rng = np.random.default_rng(8)
    runs = fly(rng, Truth.draw(rng, 0.0), 6)
    runs.covariances[2] = -runs.covariances[2]
    with pytest.raises(NotIdentifiable, match="not positive definite"):
        fit_global_model(runs, build_basis(runs.conditions), 1)
