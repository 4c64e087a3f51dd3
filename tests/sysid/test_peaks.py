"""A resonance in ratios of several inputs is fitted with its standard errors."""

from __future__ import annotations

import numpy as np

from flexsid.sysid.spectra.peaks import InputRatios, Peak, compute_channel_rms, fit_peak

FREQUENCY_HZ, DAMPING = 5.0, 0.015
RESIDUES = np.array([[3.0, -1.0 + 0.5j, 0.2], [1.0 + 1.0j, 2.0, -0.7]])  # of two inputs


def fit(noise: float, generator: np.random.Generator) -> Peak:
    """Fit a resonance with a background, and noise of a share of its residues."""
    natural, ratios = 2.0 * np.pi * FREQUENCY_HZ, []
    for first, residues in zip((3.5, 3.55), RESIDUES, strict=True):
        s = 2j * np.pi * np.arange(first, 6.5, 0.1)
        resonance = s**2 / (s**2 + 2.0 * DAMPING * natural * s + natural**2)
        values = np.outer(resonance, residues) + np.outer(s**2 / natural**2, [0.3, 0.1j, -0.2])
        parts = generator.standard_normal((2, *values.shape))
        ratios.append(InputRatios(s.imag, values + noise * (parts[0] + 1j * parts[1])))
    return fit_peak(ratios, 4.9, compute_channel_rms(ratios))


def test_a_resonance_without_noise_is_found_exactly() -> None:
    found = fit(0.0, np.random.default_rng(0))
    np.testing.assert_allclose(found.frequency_hz, FREQUENCY_HZ, rtol=1e-8)
    np.testing.assert_allclose(found.damping, DAMPING, rtol=1e-6)


def test_standard_errors_of_a_resonance_are_those_of_its_scatter() -> None:
    generator = np.random.default_rng(1)
    many = [fit(1.0, generator) for _ in range(100)]
    for name, true, std in (
        ("frequency_hz", FREQUENCY_HZ, "frequency_std_hz"),
        ("damping", DAMPING, "damping_std"),
    ):
        misses = [(getattr(one, name) - true) / getattr(one, std) for one in many]
        assert 0.8 < np.sqrt(np.mean(np.square(misses))) < 1.2, name
