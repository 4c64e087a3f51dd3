"""Coherence, averages, windowed spectra, blanking and collinearity on numbers known before."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import signal

from flexsid.errors import BadInput
from flexsid.sysid.signals import FrequencyResponse
from flexsid.sysid.spectra.collinearity import assess_collinearity
from flexsid.sysid.spectra.response import (
    ILL_CONDITIONED,
    UNCERTAIN,
    combine_responses,
    compute_coherence,
    compute_windowed_responses,
    find_unreliable_points,
)


def circular(rng: np.random.Generator, *shape: int) -> np.ndarray:
    """Complex noise of unit variance."""
    return (rng.standard_normal(shape) + 1j * rng.standard_normal(shape)) / np.sqrt(2.0)


def test_coherence_is_the_share_that_repeats():
    rng = np.random.default_rng(0)
    reference = np.exp(1j * rng.uniform(0, 6, (400, 3)))
    clean = 2.0 * reference[:, :, None]
    outputs = np.concatenate([clean, clean + 2.0 * circular(rng, 400, 3, 1)], axis=2)
    found = compute_coherence(reference, outputs)
    assert found[:, 0] == pytest.approx(1.0)
    assert found[:, 1] == pytest.approx(0.5, abs=0.1)
    with pytest.raises(BadInput, match="repetitions"):
        compute_coherence(reference[:1], outputs[:1])


def std_of(response: FrequencyResponse) -> np.ndarray:
    assert response.std is not None
    return response.std


def measured(rng: np.random.Generator, omega: np.ndarray, std: float, factor: float = 1.0):
    true = factor / (1.0 + 1j * omega)[:, None, None] * np.ones((1, 4, 1))
    spread = np.full(true.shape, std)
    values = true + std * circular(rng, *true.shape)
    return FrequencyResponse(omega, values, tuple("abcd"), ("u",), spread)


def test_maneuvers_are_averaged_by_what_each_is_worth():
    rng = np.random.default_rng(1)
    omega = np.linspace(1.0, 4.0, 200)
    good, poor = measured(rng, omega, 0.01), measured(rng, omega, 0.05)
    both = combine_responses([poor, good])
    error = np.sqrt(
        np.mean(np.abs(both.response.values - 1 / (1 + 1j * omega)[:, None, None]) ** 2)
    )
    assert error == pytest.approx(float(std_of(both.response)[0, 0, 0]), rel=0.1)
    assert std_of(both.response)[0, 0, 0] == pytest.approx(1 / np.hypot(100, 20))
    assert both.probability > 0.01
    changed = combine_responses([good, measured(rng, omega, 0.01, 1.1)])
    assert changed.probability < 1e-6, "ten percent apart at one percent noise"


def test_other_frequencies_are_interpolated_and_the_rest_is_dropped():
    rng = np.random.default_rng(2)
    first = measured(rng, np.linspace(1.0, 4.0, 61), 1e-6)
    other = measured(rng, np.linspace(1.52, 6.0, 300), 1e-6)
    both = combine_responses([first, other])
    assert both.response.omega[0] >= 1.52
    assert both.response.omega[-1] == pytest.approx(4.0)
    with pytest.raises(BadInput, match="without a common frequency"):
        combine_responses([first, measured(rng, np.linspace(5.0, 6.0, 9), 1e-6)])


def test_windowed_spectra_find_two_inputs_of_a_doublet_and_a_sweep():
    """H1 recovers both paths at once, and its standard errors cover the truth."""
    rng = np.random.default_rng(3)
    rate_hz, time_s = 100.0, np.arange(20_000) / 100.0
    u = np.stack(
        [
            signal.chirp(time_s, 0.2, 200.0, 12.0),
            0.5 * np.sign(np.sin(2 * np.pi * 0.13 * time_s**1.2))
            + 0.2 * rng.standard_normal(20_000),
        ],
        axis=1,
    )
    filters = (signal.butter(2, 4.0, fs=rate_hz), signal.butter(1, 2.0, fs=rate_hz))
    z = np.sum([signal.lfilter(*f, u[:, k]) for k, f in enumerate(filters)], axis=0)
    z = (z + 0.05 * rng.standard_normal(z.size))[:, None]
    found = compute_windowed_responses(u, z, rate_hz, 8.0, ("sweep", "doublet"), ("z",))
    band = (found.response.omega > 2 * np.pi * 0.5) & (found.response.omega < 2 * np.pi * 8.0)
    hit = []
    for column, f in enumerate(filters):
        _, true = signal.freqz(*f, worN=found.response.omega / rate_hz)
        error = np.abs(found.response.values[:, 0, column] - true)[band]
        assert np.median(error) < 0.05
        hit.append(error < 2.0 * std_of(found.response)[band, 0, column])
    assert 0.85 < np.mean(hit) <= 1.0
    assert np.median(found.coherence[band]) > 0.8
    with pytest.raises(BadInput, match="cannot resolve 2 inputs"):
        compute_windowed_responses(u[:1600], z[:1600], rate_hz, 8.0, ("sweep", "doublet"), ("z",))


def test_points_are_blanked_for_a_reason():
    values = np.ones((3, 1, 1), dtype=complex)
    std = np.array([0.1, 0.31, 0.1])[:, None, None]
    response = FrequencyResponse(
        np.array([1.0, 2.0, 3.0]), values, ("q",), ("u",), std, None, np.array([2.0, 2.0, 1e4])
    )
    reasons = find_unreliable_points(response)
    assert reasons[UNCERTAIN].ravel().tolist() == [False, True, False]
    assert reasons[ILL_CONDITIONED].ravel().tolist() == [False, False, True]


def test_collinearity_of_samples():
    rng = np.random.default_rng(4)
    a, b = rng.standard_normal((2, 5000))
    found = assess_collinearity(np.stack([a, b, a + 0.1 * b, np.full(5000, 0.1)], axis=1))
    assert found.correlation[0, 2] == pytest.approx(0.995, abs=0.002)
    assert np.isnan(found.correlation[3]).all(), "a channel at rest has no correlation"
    # x3 = x1 + 0.1 x2 exactly: not separable
    assert np.isinf(found.inflation[:3]).all()
    assert found.condition == np.inf
    pair = assess_collinearity(np.stack([a, 0.6 * a + 0.8 * b], axis=1))
    r = float(pair.correlation[0, 1])
    assert pair.inflation == pytest.approx([1 / (1 - r**2)] * 2)
    assert pair.condition == pytest.approx(np.sqrt((1 + r) / (1 - r)))


def test_collinearity_of_spectra_knows_phase():
    """Twins a quarter of a turn apart: complex correlation one, regression untroubled."""
    line = np.exp(1j * np.linspace(0.0, 60.0, 500))
    found = assess_collinearity(np.stack([line, 1j * line], axis=1), remove_mean=False)
    assert abs(found.correlation[0, 1]) == pytest.approx(1.0)
    assert found.inflation == pytest.approx([1.0, 1.0], abs=0.01)
