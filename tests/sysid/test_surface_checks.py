"""A user relies on: surfaces that do not fly what was commanded are found, and only they."""

from __future__ import annotations

import numpy as np
import pytest

from flexsid.sysid.preparation.surface_checks import check_surface, fit_servo
from flexsid.sysid.spectra.fourier import finite_fourier_transform

PERIOD_S, RATE_HZ, COUNT = 20.0, 200.0, 600
HARMONICS = tuple(range(6, 200, 4))
K = np.arange(1, COUNT + 1)
OMEGA = 2.0 * np.pi * K / PERIOD_S
NATURAL, DAMPING, DELAY_S = 60.0, 0.7, 0.02


def servo(omega, gain=1.0):
    lag = NATURAL**2 / (NATURAL**2 - omega**2 + 2j * DAMPING * NATURAL * omega)
    return gain * np.exp(-1j * omega * DELAY_S) * lag


class Flown:
    """Amplitudes of a surface with feedback of a lightly damped mode, and noise."""

    def __init__(self, seed: int, gain: float = 1.0, noise: float = 1e-5) -> None:
        rng = np.random.default_rng(seed)

        def white(size: float) -> np.ndarray:
            return size * (rng.standard_normal(COUNT) + 1j * rng.standard_normal(COUNT))

        self.command = np.zeros(COUNT, dtype=complex)
        own = np.array(HARMONICS) - 1
        self.command[own] = 3e-3 * np.exp(2j * np.pi * rng.uniform(size=own.size))
        mode = 1.0 / (17.0**2 - OMEGA**2 + 2j * 0.01 * 17.0 * OMEGA)
        inside = K < 200
        self.outputs = np.stack([mode * white(0.5) * inside, white(1e-3)], axis=1)
        self.deflection = servo(OMEGA, gain) * (self.command + 0.3 * self.outputs[:, 0])
        self.deflection = self.deflection + white(noise)

    def check(self):
        return check_surface(
            "flap",
            HARMONICS,
            200,
            PERIOD_S,
            self.command,
            self.deflection,
            self.outputs,
            ("q", "p"),
        )


@pytest.mark.parametrize("gain", [1.0, -0.8])
def test_servo_of_a_surface_is_found_beside_feedback(gain):
    found = Flown(0, gain).check()
    assert found.servo is not None
    assert found.servo.gain == pytest.approx(gain, rel=2e-3)
    assert found.servo.delay_s == pytest.approx(DELAY_S, abs=2e-4)
    assert found.servo.natural_frequency == pytest.approx(NATURAL, rel=1e-2)
    assert found.servo.damping == pytest.approx(DAMPING, rel=1e-2)
    assert found.fed_back == ("q",)
    assert not found.stuck


def test_a_surface_as_commanded_has_no_warning():
    for seed in range(20):
        found = Flown(seed).check()
        assert found.uncommanded is None, seed
        assert found.rate_limit is None, seed
        assert found.lost == (), seed


@pytest.mark.parametrize("hz", [3.0, 7.35, 14.0])
def test_an_oscillation_without_command_is_found_with_its_frequency_and_size(hz):
    flown = Flown(1)
    flown.deflection[round(hz * PERIOD_S) - 1] += 2e-3j
    found = flown.check().uncommanded
    assert found is not None
    assert found.frequency_hz == pytest.approx(hz)
    assert found.amplitude == pytest.approx(2e-3, rel=0.05)


def test_a_surface_that_is_stuck_has_no_servo():
    found = Flown(2, gain=0.0).check()
    assert found.stuck
    assert found.servo is None


def test_harmonics_that_did_not_arrive_are_named():
    flown = Flown(3)
    flown.deflection[HARMONICS[10] - 1] -= (servo(OMEGA) * flown.command)[HARMONICS[10] - 1]
    assert flown.check().lost == (HARMONICS[10],)


@pytest.mark.parametrize("share", [0.03, 0.1])
def test_a_rate_limit_is_found_with_its_size(share):
    flown = Flown(4)
    time = np.arange(0.0, PERIOD_S, 1.0 / 1000.0)
    order = np.real(np.exp(1j * np.outer(time, OMEGA[:200])) @ flown.command[:200])
    rest = np.zeros_like(order)
    linear = _fly(np.concatenate([order, order, rest]), np.inf)
    rate = np.abs(np.gradient(linear[20_000:40_000], 1e-3))
    limit = float(np.quantile(rate, 1.0 - share))
    moved = _fly(np.concatenate([order, order, rest]), limit)[20_000:40_000]
    spectrum = finite_fourier_transform(moved[:, None], 1000.0, OMEGA)[:, 0] * 2.0 / PERIOD_S
    rng = np.random.default_rng(5)
    noise = 1e-5 * (rng.standard_normal(COUNT) + 1j * rng.standard_normal(COUNT))
    flown.deflection = spectrum + noise
    found = flown.check().rate_limit
    assert found is not None
    assert found.rate == pytest.approx(limit, rel=0.05)
    assert found.share == pytest.approx(share, rel=0.7)


def _fly(order: np.ndarray, limit: float) -> np.ndarray:
    """Integrate a servo with a rate limit by small steps."""
    step, position, rate = 1e-3, 0.0, 0.0
    moved = np.empty_like(order)
    for k, ordered in enumerate(order):
        moved[k] = position
        rate += step * (NATURAL**2 * (ordered - position) - 2.0 * DAMPING * NATURAL * rate)
        rate = min(max(rate, -limit), limit)
        position += step * rate
    return moved


def test_no_servo_is_fitted_to_noise():
    rng = np.random.default_rng(6)
    noise = rng.standard_normal(80) + 1j * rng.standard_normal(80)
    assert fit_servo(np.linspace(2.0, 80.0, 80), noise) is None
