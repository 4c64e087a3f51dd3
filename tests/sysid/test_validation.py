"""Validation: folds, prediction of a maneuver, and false alarms of residual correlations."""

from __future__ import annotations

import numpy as np
import pytest

from flexsid.errors import BadInput
from flexsid.sysid.adequacy.validation import (
    assign_folds,
    autocorrelate_residual,
    cross_correlate_residual,
    predict_outputs,
)
from flexsid.sysid.spectra.fourier import compute_harmonic_frequencies, finite_fourier_transform
from flexsid.sysid.spectra.residual_spectrum import compute_noise_correlation

RATE_HZ = 50.0
PERIOD_S = 20.0
OMEGA = compute_harmonic_frequencies(np.arange(5, 205), PERIOD_S)
START_S = 0.4
# One input of five has every fifth harmonic; with feedback it also moves a little at the others.
INPUT = np.where(np.arange(OMEGA.size) % 5 == 0, 1.0, 0.1) * np.exp(1j * np.arange(OMEGA.size) ** 2)


def transform_noise(duration_s: float, n_records: int, seed: int, corner: float = np.inf):
    """Transforms of records of noise, one row each, and the correlation between frequencies.

    Noise is white, or of first order with a corner frequency. [rad/s]
    """
    rng = np.random.default_rng(seed)
    samples = rng.normal(size=(round(duration_s * RATE_HZ), n_records))
    spectra = finite_fourier_transform(samples, RATE_HZ, OMEGA, START_S).T
    return spectra / (1.0 + 1j * OMEGA / corner), compute_noise_correlation(
        OMEGA, START_S, START_S + duration_s
    )


@pytest.mark.parametrize("n_folds", [2, 5])
def test_every_fold_has_every_input_over_the_whole_band(n_folds: int):
    assigned = np.tile([0, 1, 2, 1], 30)
    folds = assign_folds(assigned, n_folds)
    for index in range(3):
        own = folds[assigned == index]
        counts = np.bincount(own, minlength=n_folds)
        assert counts.max() - counts.min() <= 1
        assert all(set(own[k : k + n_folds]) == set(range(n_folds)) for k in (0, len(own) // 2))


def test_fewer_frequencies_than_folds_are_refused():
    with pytest.raises(BadInput, match="3 frequencies, fewer than 5 folds") as refused:
        assign_folds(np.array([0, 0, 0, 0, 0, 1, 1, 1]), 5)
    assert refused.value.code == "bad-folds"


@pytest.mark.parametrize("duration_s", [20.0, 24.0])
def test_white_residuals_exceed_the_bounds_at_five_percent_of_the_lags(duration_s: float):
    spectra, correlation = transform_noise(duration_s, 400, seed=1)
    own = [autocorrelate_residual(OMEGA, row, correlation).share_outside for row in spectra]
    assert np.mean(own) == pytest.approx(0.05, abs=0.01)
    pairs = zip(spectra[:200], spectra[200:], strict=True)
    found = [cross_correlate_residual(OMEGA, a, b, correlation).share_outside for a, b in pairs]
    assert np.mean(found) == pytest.approx(0.05, abs=0.015)


@pytest.mark.parametrize("duration_s", [20.0, 24.0])
@pytest.mark.parametrize("corner", [np.inf, 15.0])
def test_residuals_independent_of_an_input_exceed_the_bounds_at_five_percent(
    duration_s: float, corner: float
):
    """Also where they are coloured."""
    spectra, correlation = transform_noise(duration_s, 400, seed=2, corner=corner)
    found = [
        cross_correlate_residual(OMEGA, row, INPUT, correlation).share_outside for row in spectra
    ]
    assert np.mean(found) == pytest.approx(0.05, abs=0.015)


def test_coloured_residuals_and_unmodelled_response_exceed_the_bounds():
    spectra, correlation = transform_noise(20.0, 60, seed=3, corner=15.0)
    own = [autocorrelate_residual(OMEGA, row, correlation).share_outside for row in spectra]
    assert np.mean(own) > 0.15
    spectra, correlation = transform_noise(20.0, 60, seed=4)
    s = 1j * OMEGA
    mode = INPUT / (s**2 + 2.0 * 0.05 * 18.0 * s + 18.0**2)
    size = np.sqrt(np.mean(np.abs(spectra) ** 2) / np.mean(np.abs(mode) ** 2))
    missed = [
        cross_correlate_residual(OMEGA, row + size * mode, INPUT, correlation).share_outside
        for row in spectra
    ]
    assert np.min(missed) > 0.1
    assert np.mean(missed) > 0.15


def test_the_lag_of_a_delayed_input_is_positive():
    delay_s = 5 * np.pi / OMEGA.max()
    found = cross_correlate_residual(OMEGA, INPUT * np.exp(-1j * OMEGA * delay_s), INPUT)
    assert found.lags_s[np.argmax(found.values)] == pytest.approx(delay_s)
    assert found.values.max() == pytest.approx(1.0)


def test_a_wrong_sign_shows_in_the_prediction(make_case):
    case = make_case(1)
    u, z = case.spectra(seed=5)
    experiment, parameters = case.experiment(u, z), case.free()
    theta = parameters.start.copy()
    np.testing.assert_allclose(predict_outputs(experiment, parameters, theta).r_squared(), 1.0)
    theta[parameters.names.index("Cm_alpha")] *= -1.0
    assert predict_outputs(experiment, parameters, theta).r_squared().mean() < 0.5
