"""Transforms: exact where they claim to be, and the same whichever way they are computed."""

from __future__ import annotations

import numpy as np
import pytest

from flexsid.sysid.spectra.fourier import finite_fourier_transform


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
