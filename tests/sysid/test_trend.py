"""A weighted trend agrees with the textbook, and its chi-square test is calibrated."""

from __future__ import annotations

import numpy as np
import pytest

from flexsid.sysid.estimation.agreement import fit_trend


@pytest.mark.parametrize("degree", [0, 1, 2])
def test_the_fit_is_that_of_numpy(degree: int):
    rng = np.random.default_rng(3)
    x, sigma = rng.uniform(300.0, 900.0, 12), rng.uniform(0.05, 0.2, 12)
    values = 1.0 - 2e-3 * x + sigma * rng.standard_normal(12)
    fit = fit_trend(x, values, sigma, degree)
    expected, covariance = np.polyfit(x, values, degree, w=1 / sigma, cov="unscaled")
    there = np.linspace(300.0, 900.0, 5)
    powers = np.vander(there, degree + 1)
    found, std = fit.at(there)
    np.testing.assert_allclose(found, powers @ expected, rtol=1e-7)
    unscaled = np.sqrt(np.einsum("ij,jk,ik->i", powers, covariance, powers))
    np.testing.assert_allclose(std, fit.inflation * unscaled, rtol=1e-6)
    if degree == 1:
        slope, error = fit.slope
        assert slope == pytest.approx(expected[0])
        assert error == pytest.approx(fit.inflation * np.sqrt(covariance[0, 0]))


def test_a_constant_is_the_weighted_mean_of_any_place():
    values, sigma = np.array([1.0, 2.0, 4.0]), np.array([0.1, 0.2, 0.4])
    fit = fit_trend(np.zeros(3), values, sigma, 0)
    weights = sigma**-2
    assert fit.coefficients[0] == pytest.approx(weights @ values / weights.sum())
    assert fit.covariance[0, 0] == pytest.approx(1 / weights.sum())
    assert fit.slope == (0.0, 0.0)


def test_the_probability_of_the_scatter_is_uniform_where_errors_are_right():
    rng = np.random.default_rng(11)
    x, sigma = np.linspace(0.0, 1.0, 8), np.linspace(0.5, 2.0, 8)
    found = [
        fit_trend(x, 3.0 + x + sigma * rng.standard_normal(8), sigma, 1).probability or 0.0
        for _ in range(2000)
    ]
    assert np.mean(found) == pytest.approx(0.5, abs=0.03)
    assert np.mean(np.array(found) < 0.05) == pytest.approx(0.05, abs=0.015)


def test_too_few_places_are_refused_and_nothing_is_judged_without_freedom():
    with pytest.raises(ValueError, match="2 coefficients"):
        fit_trend(np.array([1.0, 1.0]), np.array([1.0, 2.0]), np.array([0.1, 0.1]), 1)
    fit = fit_trend(np.array([1.0, 2.0]), np.array([1.0, 2.0]), np.array([0.1, 0.1]), 1)
    assert fit.probability is None
    assert fit.inflation == 1.0
