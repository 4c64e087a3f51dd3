"""Frequency responses from averaged spectra: bias, coherence and standard errors."""

from __future__ import annotations

import numpy as np
import pytest

from flexsid.errors import BadInput
from flexsid.sysid.spectra.response_estimators import (
    AveragedSpectra,
    EstimatedResponses,
    Estimator,
    Window,
    average_spectra,
    estimate_responses,
    find_block_length,
)

RATE = 100.0
GAIN = np.array([[2.0, -1.0], [0.5, 3.0], [1.0, 1.0]])  # outputs x forces


def record(
    rng: np.random.Generator, n: int, n_f: int = 1, force_noise: float = 0.0, noise: float = 0.0
) -> tuple[np.ndarray, np.ndarray]:
    """White forces and static responses; noise relative to the rms of each channel."""
    forces = rng.normal(size=(n, n_f)) * np.array([1.0, 5.0])[:n_f]
    responses = forces @ GAIN[:, :n_f].T
    return (
        forces + force_noise * forces.std(axis=0) * rng.normal(size=forces.shape),
        responses + noise * responses.std(axis=0) * rng.normal(size=responses.shape),
    )


def average(
    records: list[tuple[np.ndarray, np.ndarray]], window: Window, averages: int, overlap: float
) -> AveragedSpectra:
    length = find_block_length([[force.shape[0] for force, _ in records]], averages, overlap)
    return average_spectra(records, RATE, window, length, averages, overlap)


def estimate(
    records: list[tuple[np.ndarray, np.ndarray]],
    estimator: Estimator = "H1",
    averages: int = 40,
    window: Window = "hann",
    overlap: float = 0.5,
) -> EstimatedResponses:
    spectra = average(records, window, averages, overlap)
    return estimate_responses(spectra, estimator)


def test_all_estimators_are_exact_without_noise() -> None:
    records = [record(np.random.default_rng(1), 4000) for _ in range(2)]
    estimators: tuple[Estimator, ...] = ("H1", "H2", "Hv")
    for estimator in estimators:
        found = estimate(records, estimator)
        assert np.allclose(found.values, GAIN[:, :1], rtol=1e-9)
        assert np.allclose(found.multiple_coherence, 1.0)
        assert found.std.max() < 1e-6
    two = estimate([record(np.random.default_rng(1), 4000, 2)], "Hv")
    assert np.allclose(two.values, GAIN, rtol=1e-6)


@pytest.mark.parametrize(
    ("estimator", "n_f", "force_noise", "noise"),
    [
        ("H1", 1, 0.0, 0.5),
        ("H1", 2, 0.0, 0.5),
        ("H2", 1, 0.5, 0.0),
        ("Hv", 1, 0.5, 0.5),
        ("Hv", 2, 0.4, 0.4),
    ],
)
def test_an_estimator_is_unbiased_under_the_noise_that_it_assumes(
    estimator: Estimator, n_f: int, force_noise: float, noise: float
) -> None:
    """Mean over frequencies of many averages; H1 with noise on the force would be 20 % low."""
    rng = np.random.default_rng(2)
    data = record(rng, 150 * 128, n_f, force_noise, noise)
    found = estimate([data], estimator, averages=299)
    error = (found.values - GAIN[:, :n_f]).mean(axis=0)
    spread = found.std.mean(axis=0) / np.sqrt(found.omega.size / 2)
    assert np.all(np.abs(error) < 4.0 * spread)
    assert spread.max() < 0.1


def test_other_noise_biases_as_known() -> None:
    """Noise of variance .25 of the force lowers H1 by 1.25, of the response raises H2 by 1.25."""
    rng = np.random.default_rng(3)
    lowered = estimate([record(rng, 150 * 128, 1, 0.5, 0.0)], "H1", 299)
    assert np.real(lowered.values[:, 0, 0]).mean() == pytest.approx(2.0 / 1.25, rel=0.02)
    raised = estimate([record(rng, 150 * 128, 1, 0.0, 0.5)], "H2", 299)
    assert np.real(raised.values[:, 0, 0]).mean() == pytest.approx(2.0 * 1.25, rel=0.02)


def test_hv_is_independent_of_units() -> None:
    forces, responses = record(np.random.default_rng(4), 8000, 2, 0.3, 0.3)
    found = estimate([(forces, responses)], "Hv")
    other = estimate([(1e3 * forces, 1e-3 * responses)], "Hv")
    assert np.allclose(other.values, 1e-6 * found.values)
    assert np.allclose(other.std, 1e-6 * found.std)


def test_coherence_is_that_of_the_simulation() -> None:
    """Two forces of powers 1 and 25; noise of variance .25 of the response."""
    rng = np.random.default_rng(5)
    found = estimate([record(rng, 150 * 128, 2, 0.0, 0.5)], "H1", 299)
    share = GAIN**2 * np.array([1.0, 25.0])
    expected = share / share.sum(axis=1, keepdims=True) / 1.25
    assert found.multiple_coherence.mean(axis=0) == pytest.approx(1.0 / 1.25, abs=0.008)
    assert found.ordinary_coherence.mean(axis=0) == pytest.approx(expected, abs=0.02)


@pytest.mark.parametrize(
    ("estimator", "n_f", "force_noise", "noise", "window", "overlap"),
    [
        ("H1", 1, 0.0, 0.5, "hann", 0.5),
        ("H1", 2, 0.0, 0.5, "rectangular", 0.0),
        ("H1", 1, 0.0, 0.5, "hann", 0.75),
        ("H2", 1, 0.3, 0.0, "hann", 0.5),
        ("Hv", 1, 0.3, 0.3, "hann", 0.5),
        ("Hv", 2, 0.2, 0.2, "hann", 0.66),
    ],
)
def test_standard_errors_agree_with_monte_carlo(
    estimator: Estimator, n_f: int, force_noise: float, noise: float, window: Window, overlap: float
) -> None:
    rng = np.random.default_rng(6)
    draws = [
        estimate([record(rng, 2400, n_f, force_noise, noise)], estimator, 40, window, overlap)
        for _ in range(24)
    ]
    spread = np.sqrt(np.mean(np.var([draw.values for draw in draws], axis=0, ddof=1), axis=0))
    stated = np.sqrt(np.mean([draw.std**2 for draw in draws], axis=(0, 1)))
    assert stated / spread == pytest.approx(np.ones_like(spread), abs=0.1)


def test_blocks_are_as_long_as_the_number_of_averages_allows() -> None:
    data = record(np.random.default_rng(7), 1000)
    spectra = average([data, data], "rectangular", 8, 0.0)
    assert spectra.n_blocks == 8
    assert spectra.n_independent == 8.0
    assert spectra.omega[0] / 2 / np.pi == pytest.approx(RATE / 250)
    assert spectra.line_correlation == pytest.approx(1.0)
    hann = average([data], "hann", 9, 0.5)
    assert hann.omega[0] / 2 / np.pi == pytest.approx(RATE / 200)
    assert hann.n_independent == pytest.approx(9 / (1 + 2 * 8 / 9 / 36), rel=1e-3)
    assert hann.line_correlation == pytest.approx(1 + 2 * (2 / 3) ** 2 + 2 / 36)


def test_periodic_forces_have_no_leakage() -> None:
    """A resonance of .5 % damping, excited by a multisine with one period per block."""
    rng = np.random.default_rng(8)
    hertz = np.fft.rfftfreq(500, 1 / RATE)
    s = 2j * np.pi * hertz
    H = s**2 / (s**2 + 2 * 0.005 * 60.0 * s + 60.0**2)
    F = np.exp(2j * np.pi * rng.random(hertz.size))
    force, response = (np.tile(np.fft.irfft(one, 500), 4)[:, None] for one in (F, H * F))
    found = estimate([(force, response)], "H1", 4, "rectangular", 0.0)
    assert np.allclose(found.values[:, 0, 0], H[1:-1], rtol=1e-9)


def test_records_without_information_are_refused() -> None:
    rng = np.random.default_rng(9)
    forces, responses = record(rng, 2000, 2)
    cases: tuple[tuple[tuple[np.ndarray, np.ndarray], Estimator, int, str], ...] = (
        ((forces, responses), "H2", 20, "several-forces"),
        ((forces, responses), "H1", 2, "too-few-averages"),
        ((forces, responses), "H1", 900, "too-many-averages"),
        ((forces[:, [0, 0]], responses), "H1", 20, "not-excited"),
        ((0.0 * forces, responses), "H1", 20, "not-excited"),
    )
    for data, estimator, averages, code in cases:
        with pytest.raises(BadInput) as caught:
            estimate([data], estimator, averages)
        assert caught.value.code == code
