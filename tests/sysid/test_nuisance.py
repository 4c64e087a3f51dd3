"""Prior of the derivatives of out-of-band modes, and its spread."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from scipy import integrate, stats

from flexsid.sysid.estimation.estimate import Estimate, Outcome
from flexsid.sysid.estimation.nuisance import (
    NuisancePrior,
    build_nuisance_prior,
    compute_prior_shares,
    compute_prior_std,
    estimate_shape_spread,
    estimate_spread,
)
from flexsid.sysid.model.derivatives import list_derivative_names

MODES, INPUTS = (7, 9, 11), ("bf", "wf")
NAMES = list_derivative_names(MODES, INPUTS)


def predict(seed: int = 0) -> dict[str, float]:
    sizes = np.random.default_rng(seed).normal(size=len(NAMES))
    return dict(zip(NAMES, sizes.tolist(), strict=True))


def build_estimate(values: np.ndarray, std: float, nuisance: frozenset[str]) -> Estimate:
    covariance = np.diag(np.full(values.size, std**2))
    return Estimate(
        NAMES, values, values, covariance, covariance, (), (), Outcome.CONVERGED, "", nuisance
    )


def get_prior_std(prior: NuisancePrior, spread: float) -> dict[str, float]:
    return {name: std for name, (_, std) in prior.list_priors(NAMES, spread).items()}


def test_prior_of_predicted_derivatives_is_relative_to_their_size():
    predicted = predict()
    prior = build_nuisance_prior(MODES, INPUTS, predicted)
    std = get_prior_std(prior, 0.1)
    row = [abs(predicted[name]) for name in NAMES if name.startswith("Cm_")]
    for name in NAMES:
        if name.startswith("Cm_"):
            size = np.hypot(predicted[name], np.median(row))
            assert 0.1 * size <= std[name] < 0.12 * size
        assert prior.list_priors((name,), 0.2)[name][0] == predicted[name]


def integrate_deviation(p: float, median: float, spread: float) -> float:
    """Root mean square of theta - p, given p, by adaptive quadrature."""

    def compute_density(theta: float) -> float:
        std = spread * np.hypot(theta, median)
        return float(stats.norm.pdf(p, theta, std) * stats.t.pdf(theta, 4.0))

    def compute_integral(power: int) -> float:
        ends = sorted({-50.0, -5.0, -1.0, -median, 0.0, median, 0.8 * p, p, 1.2 * p, 5.0, 50.0})
        parts = (
            integrate.quad(lambda x: compute_density(x) * (x - p) ** power, low, high, limit=200)[0]
            for low, high in pairwise(ends)
        )
        return float(sum(parts))

    return float(np.sqrt(compute_integral(2) / compute_integral(0)))


@pytest.mark.parametrize("spread", [0.1, 0.3, 0.5])
def test_standard_deviations_are_those_of_errors_relative_to_the_truth(spread: float):
    predicted = np.array([0.02, 0.1, 0.5, 1.0, 3.0])
    std = compute_prior_std(predicted, np.array(0.1), np.array(1.0), spread)
    expected = [integrate_deviation(p, 0.1, spread) for p in predicted.tolist()]
    least = spread * np.hypot(predicted, 0.1)
    np.testing.assert_allclose(std, np.maximum(expected, least), rtol=5e-3)
    scaled = compute_prior_std(-7.0 * predicted, np.array(0.7), np.array(7.0), spread)
    np.testing.assert_allclose(scaled, 7.0 * std, rtol=1e-12)


def test_derivatives_that_are_predicted_near_zero_can_be_large():
    near_zero, large = compute_prior_std(np.array([0.0, 1.0]), np.array(0.1), np.array(1.0), 0.5)
    assert near_zero > 0.4
    assert large < 0.6


def test_prior_of_a_mode_without_prediction_is_centred_at_zero_with_a_similar_size():
    predicted = {n: 2.0 for n in NAMES if "11" not in n}
    prior = build_nuisance_prior(MODES, INPUTS, predicted)
    for name in ("CQ11_alpha", "CZ_eta11", "CQ11_etadot11"):
        mean, std = prior.list_priors((name,), 0.1)[name]
        assert mean == 0.0
        # The median of |x| of a normal x is 0.6745 standard deviations
        assert std == pytest.approx(2.0 / 0.6745)  # whatever the spread of predictions is


@pytest.mark.parametrize("spread", [0.1, 0.3, 0.6])
def test_spread_is_found_from_the_modes_in_the_band(spread: float):
    true = np.array(list(predict(1).values()))
    nuisance = frozenset(n for n in NAMES if "11" in n)
    rng = np.random.default_rng(2)
    found = []
    for _ in range(20):
        predicted = true * (1.0 + spread * rng.normal(size=len(NAMES)))
        prior = build_nuisance_prior(MODES, INPUTS, dict(zip(NAMES, predicted, strict=True)))
        values = true + 0.02 * rng.normal(size=len(NAMES))
        found.append(estimate_spread(build_estimate(values, 0.02, nuisance), prior))
    # The upper standard deviation of the posterior: above the truth, by less than half of it.
    assert spread < np.mean(found) < 1.5 * spread


def test_errors_of_the_modal_table_do_not_increase_the_spread():
    prior = build_nuisance_prior(MODES, INPUTS, predict(1))
    place = NAMES.index("CQ9_eta9")
    modal_std = np.zeros(prior.similar.shape)
    modal_std.ravel()[place] = 5.0 * prior.similar.ravel()[place]
    values = prior.mean.values.ravel().copy()
    values[place] += 5.0 * prior.similar.ravel()[place]
    estimate = build_estimate(values, 0.02, frozenset(n for n in NAMES if "11" in n))
    known = replace(prior, modal_std=modal_std)
    assert estimate_spread(estimate, known) < estimate_spread(estimate, prior)
    assert known.list_priors(("CQ9_eta9",), 0.1)["CQ9_eta9"][1] > modal_std.max()


def test_spread_does_not_use_nuisance_parameters_or_missing_errors():
    prior = build_nuisance_prior(MODES, INPUTS, predict(3))
    far = prior.mean.values.ravel() + 5.0 * prior.similar.ravel()
    every = build_estimate(far, 0.1, frozenset(NAMES))
    unknown = build_estimate(far, np.nan, frozenset())
    assert estimate_spread(every, prior) == estimate_spread(unknown, prior) == 0.3


@pytest.mark.parametrize(("true", "least", "most"), [(0.05, 0.04, 0.08), (2.0, 0.3, 1.0 / 3.0)])
def test_spread_of_mode_shapes_is_that_of_a_correlated_model(
    true: float, least: float, most: float
):
    errors = true * np.random.default_rng(5).normal(size=len(NAMES))
    estimate = build_estimate(errors, 0.01, frozenset(NAMES))
    spread = 0.1
    for _ in range(3):  # each from the one before, as a fit does
        spread = estimate_shape_spread(estimate, dict.fromkeys(NAMES, 1.0), spread, 0.1)
    assert least < spread <= most


def test_shares_of_priors_are_those_of_a_linear_model():
    rng = np.random.default_rng(4)
    H = rng.normal(size=(40, 3))
    priors = {"c": (0.0, 0.05)}
    information = H.T @ H + np.diag([0.0, 0.0, 0.05**-2.0])
    covariance = np.linalg.inv(information)
    of_noise = covariance @ H.T @ H @ covariance
    estimate = Estimate(
        ("a", "b", "c"),
        np.zeros(3),
        np.zeros(3),
        covariance,
        covariance,
        (),
        (),
        Outcome.CONVERGED,
        "",
        frozenset({"c"}),
    )
    shares = compute_prior_shares(estimate, priors)
    assert shares.shape == (2, 1)
    for k, share in enumerate(shares[:, 0]):
        assert share == pytest.approx(1.0 - of_noise[k, k] / covariance[k, k])
