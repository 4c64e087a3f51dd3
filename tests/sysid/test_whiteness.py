"""Whiteness test of residuals: no alarm for white noise, an alarm for unmodelled response."""

from __future__ import annotations

import numpy as np
import pytest

from flexsid.sysid.estimation.estimate import whiten, whiteness
from flexsid.sysid.spectra.fourier import compute_harmonic_frequencies, finite_fourier_transform
from flexsid.sysid.spectra.residual_spectrum import compute_noise_correlation

RATE_HZ = 50.0
PERIOD_S = 20.0
FREQUENCIES = compute_harmonic_frequencies(np.arange(4, 104), PERIOD_S)
START_S = 0.4


def spectra(duration_s: float, n_records: int, seed: int) -> np.ndarray:
    """Transforms of records of white noise, one column each."""
    samples = np.random.default_rng(seed).normal(size=(round(duration_s * RATE_HZ), n_records))
    return finite_fourier_transform(samples, RATE_HZ, FREQUENCIES, START_S)


def alarms(noise: np.ndarray, duration_s: float) -> float:
    """Share of the columns with a probability below 5 %."""
    known = compute_noise_correlation(FREQUENCIES, START_S, START_S + duration_s)
    white = whiten(noise, known)
    return float(np.mean([whiteness(column) < 0.05 for column in white.T]))


@pytest.mark.parametrize("duration_s", [20.0, 23.0, 24.0, 26.0])
def test_white_noise_raises_an_alarm_in_five_percent(duration_s):
    assert alarms(spectra(duration_s, 600, seed=1), duration_s) == pytest.approx(0.05, abs=0.02)


def test_without_the_known_correlation_white_noise_would_raise_an_alarm():
    noise = spectra(24.0, 200, seed=2)
    assert np.mean([whiteness(column) < 0.05 for column in noise.T]) > 0.3


@pytest.mark.parametrize("duration_s", [20.0, 24.0])
def test_what_a_model_misses_raises_an_alarm(duration_s):
    """A mode of the size of the noise, over a tenth of the band."""
    noise = spectra(duration_s, 200, seed=3)
    s = 1j * FREQUENCIES
    mode = 1.0 / (s**2 + 2.0 * 0.03 * 18.0 * s + 18.0**2)
    size = np.sqrt(np.mean(np.abs(noise) ** 2) / np.mean(np.abs(mode) ** 2))
    assert alarms(noise + size * mode[:, None], duration_s) > 0.95


def test_the_correlation_of_frequencies_is_that_of_their_noise():
    noise = spectra(24.0, 4000, seed=4)[:12]
    found = noise @ noise.conj().T
    size = np.sqrt(np.real(np.diag(found)))
    known = compute_noise_correlation(FREQUENCIES[:12], START_S, START_S + 24.0)
    np.testing.assert_allclose(found / np.outer(size, size), known, atol=0.06)
    assert abs(known[0, 1]) == pytest.approx(0.156, abs=2e-3)
