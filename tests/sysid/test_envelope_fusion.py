"""Flutter from the global model of slow runs: its interval holds the truth, drifting or not."""

from __future__ import annotations

import numpy as np
import pytest
from identified_campaign import FUEL, DriftingAircraft, plan_runs, predict_flutter_speed

from flexsid.errors import BadInput
from flexsid.sysid.stability.derivative_fusion import DerivativePrior, fit_envelope, remove_prior


def measure(seed: int, drift: float, n_runs: int) -> tuple[float, bool]:
    """Return the relative error of the flutter speed, and whether the interval holds it.

    Runs are at 0.5 to 0.8 of the flutter speed of the aircraft itself.
    """
    rng = np.random.default_rng(seed)
    truth = DriftingAircraft.draw(rng, drift)
    while np.isnan(expected := truth.find_flutter(FUEL)):
        truth = DriftingAircraft.draw(rng, drift)
    planned = np.random.default_rng(99)
    airspeeds = expected * planned.uniform(0.5, 0.8, n_runs)
    runs = plan_runs(airspeeds, planned.uniform(0.0, 1.0, n_runs))
    prediction = predict_flutter_speed(runs, runs.identify(rng, truth), truth)
    assert prediction.crossing is not None
    assert prediction.interval is not None
    low, high = prediction.interval
    return prediction.crossing.airspeed / expected - 1.0, low < expected < high


@pytest.mark.parametrize("drift", [pytest.param(0.0, marks=pytest.mark.long), 0.3])
def test_flutter_of_slow_runs_is_that_of_the_truth(drift: float):
    error, inside = measure(0, drift, 20)
    assert abs(error) < 0.015
    assert inside


@pytest.mark.long
@pytest.mark.parametrize("drift", [0.0, 0.3])
def test_flutter_intervals_hold_the_truth_in_many_campaigns(drift: float):
    errors, inside = zip(*[measure(seed, drift, 40) for seed in range(100)], strict=True)
    assert np.median(np.abs(errors)) < 0.005
    assert np.mean(inside) >= 0.92


def test_a_prior_is_removed_from_an_estimate():
    rng = np.random.default_rng(1)
    factor = rng.standard_normal((5, 9))
    of_data, data = np.linalg.inv(factor @ factor.T), rng.standard_normal(5)
    nuisance = np.array([False, False, True, False, False])
    precision, mean = np.diag([2.0, 0.0, 3.0, 0.5, 0.0]), rng.standard_normal(5)
    precision[0, 2] = precision[2, 0] = 1.5  # the nuisance parameter alone has 3 - 1.5^2 / 2
    shared = precision.copy()
    shared[2, 2] = 1.5**2 / 2.0
    information = np.linalg.inv(of_data)
    C = np.linalg.inv(information + shared)
    theta = C @ (information @ data + shared @ mean)
    values, covariance = remove_prior(theta, C, DerivativePrior(mean, precision, nuisance))
    np.testing.assert_allclose(values, data, rtol=1e-8)
    np.testing.assert_allclose(covariance, of_data, rtol=1e-8)


def test_too_few_runs_have_no_global_model():
    runs = plan_runs([30.0, 36.0, 42.0], [0.5, 0.5, 0.5])
    truth = DriftingAircraft.draw(np.random.default_rng(1), 0.0)
    parts = runs.identify(np.random.default_rng(2), truth)
    with pytest.raises(BadInput, match="4 runs or more"):
        fit_envelope(parts, runs.conditions, np.arange(3), np.ones(3))
