"""A user relies on: noise at harmonics of little power does not pass for a response."""

from __future__ import annotations

import numpy as np
import pytest

from flexsid.sysid.spectra.response_estimators import LEAST_HARMONICS, smooth_response

OMEGA = 2.0 * np.pi * np.arange(6, 330, 5) / 24.0


def respond(omega: np.ndarray) -> np.ndarray:
    """An actuator, a mode of 30 % damping in the feedback, and a surface that does not move."""
    s = 1j * omega
    actuator = 40.0 / (s + 40.0) * np.exp(-0.01 * s)
    mode = 0.1 * 12.0**2 / (s**2 + 7.2 * s + 12.0**2)
    return np.stack([actuator, actuator * mode, 0.0 * s], axis=1)


def test_a_response_without_noise_remains():
    found = smooth_response(OMEGA, respond(OMEGA), np.ones(OMEGA.size))
    assert found == pytest.approx(respond(OMEGA), abs=3e-3)
    few = respond(OMEGA)[: LEAST_HARMONICS - 1]
    assert smooth_response(OMEGA[: len(few)], few, np.ones(len(few))) is few


def test_weak_harmonics_follow_the_strong_ones():
    """Every third harmonic has a thousandth of the amplitude: 300 % noise, 0.3 % at the others."""
    rng = np.random.default_rng(0)
    excitation = np.where(np.arange(OMEGA.size) % 3 == 1, 1e-3, 1.0)
    noise = rng.standard_normal((OMEGA.size, 3, 2)) @ np.array([1.0, 1j]) * 3e-3 / np.sqrt(2.0)
    measured = respond(OMEGA) + noise / excitation[:, None]
    found = smooth_response(OMEGA, measured, excitation)
    error = np.sqrt(np.mean(np.abs(found - respond(OMEGA)) ** 2, axis=0))
    assert error[0] < 2e-3
    assert error[1] < 6e-3  # the curvature of the mode between the strong harmonics is a guess
    assert error[2] < 2e-3
