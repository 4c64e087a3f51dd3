"""Transforms: exact where they claim to be, and the same whichever way they are computed."""

from __future__ import annotations

import numpy as np
import pytest

from flexsid.sysid.preparation.resampling import BetweenSamples, fill_between
from flexsid.sysid.spectra.fourier import finite_fourier_transform, integrate_steps


def integral(omega: float, duration_s: float, other: float, phase: float) -> complex:
    """Of cos(other t + phase) exp(-j omega t) from 0 to the end."""
    total = 0j
    for sign in (1.0, -1.0):
        rate = 1j * (sign * other - omega)
        part = duration_s if rate == 0 else (np.exp(rate * duration_s) - 1.0) / rate
        total += 0.5 * np.exp(1j * sign * phase) * part
    return total


def test_end_correction_integrates_records_that_do_not_repeat():
    """3 Hz over 10 s at 50 Hz: six digits where the plain sum has two."""
    time_s = np.arange(501) / 50.0
    omega = 2 * np.pi * 3.0
    for other, phase in ((0.4, 0.1), (2.7, 0.3), (9.0, 1.0), (omega, 0.3)):
        samples = np.cos(other * time_s + phase)[:, None]
        exact = integral(omega, 10.0, other, phase)
        corrected = finite_fourier_transform(samples, 50.0, np.array([omega]), end_corrected=True)
        plain = finite_fourier_transform(samples, 50.0, np.array([omega]))
        assert abs(corrected[0, 0] / exact - 1.0) < 1e-6
        assert abs(plain[0, 0] / exact - 1.0) > 1e-3


@pytest.mark.parametrize("hz", [0.0, 1e-6, 0.3, 11.0, 49.0])
def test_end_correction_is_exact_for_polynomials_at_every_frequency(hz: float):
    t = np.arange(41) / 100.0
    omega = 2 * np.pi * hz
    samples = (1.0 - 4.0 * t + 2.0 * t**2 + 60.0 * t**5)[:, None]
    nodes, weights = np.polynomial.legendre.leggauss(120)
    at = 0.2 * (nodes + 1.0)
    values = (1.0 - 4.0 * at + 2.0 * at**2 + 60.0 * at**5) * np.exp(-1j * omega * at)
    found = finite_fourier_transform(samples, 100.0, np.array([omega]), end_corrected=True)
    assert abs(found[0, 0] - 0.2 * weights @ values) < 1e-12


def test_a_straight_line_is_integrated_exactly_at_rest():
    samples = (3.0 + 0.5 * np.arange(101) / 10.0)[:, None]
    area = finite_fourier_transform(samples, 10.0, np.array([0.0]), end_corrected=True)[0, 0]
    assert area == pytest.approx(30.0 + 0.25 * 100.0)


@pytest.mark.parametrize("n_frequencies", [100, 400, 2000])
def test_dense_even_frequencies_agree_with_the_sum_itself(n_frequencies: int):
    rng = np.random.default_rng(2)
    samples = rng.standard_normal((700, 3))
    omega = 2 * np.pi * np.linspace(0.37, 41.3, n_frequencies)
    kernel = np.exp(-1j * np.outer(omega, 2.0 + np.arange(700) / 100.0)) / 100.0
    found = finite_fourier_transform(samples, 100.0, omega, start_s=2.0)
    np.testing.assert_allclose(found, kernel @ samples, atol=1e-11)


@pytest.mark.parametrize("linear", [False, True])
def test_a_held_or_linear_signal_is_integrated_exactly_between_any_times(*, linear: bool):
    rate, start, window = 50.0, 0.1, (0.513, 1.0377)
    samples = np.random.default_rng(0).normal(size=(60, 2))
    omega = np.array([3.0, 20.0, 100.0])
    edges = start + np.arange(60) / rate
    inside = edges[(edges > window[0]) & (edges < window[1])]
    cuts = np.concatenate([[window[0]], inside, [window[1]]])
    node, weight = np.polynomial.legendre.leggauss(12)
    middle, half = 0.5 * (cuts[1:] + cuts[:-1]), 0.5 * np.diff(cuts)
    time = (middle[:, None] + half[:, None] * node).ravel()
    share = (half[:, None] * weight).ravel()
    below = np.floor((time - start) * rate).astype(int)
    for column in range(2):
        x = samples[:, column]
        signal = np.interp(time, edges, x) if linear else x[below]
        expected = (np.exp(-1j * np.outer(omega, time)) * share) @ signal
        found = integrate_steps(samples, rate, omega, start, window, linear=linear)
        np.testing.assert_allclose(found[:, column], expected, atol=1e-12)


def test_repeated_samples_are_filled_by_what_was_between_them():
    time = np.arange(200) / 100.0
    smooth = np.sin(2.0 * np.pi * time)
    repeated = smooth[np.arange(200) // 4 * 4]
    assert fill_between(repeated, BetweenSamples.HELD) is repeated
    for between, error in ((BetweenSamples.LINEAR, 9e-3), (BetweenSamples.SMOOTH, 1e-3)):
        filled = fill_between(repeated, between)
        assert np.abs(filled - smooth)[:197].max() < error
    assert fill_between(smooth, BetweenSamples.LINEAR) is smooth
