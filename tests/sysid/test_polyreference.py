"""Modal parameters out of responses that a ground vibration test would measure."""

from __future__ import annotations

import numpy as np
import pytest

from flexsid.demo.flex28 import load_truth
from flexsid.errors import BadInput
from flexsid.sysid.modes.assurance import compute_mac, rotate_complex_shapes
from flexsid.sysid.modes.measured_modes import (
    MeasuredModes,
    compute_mode_indicator,
    compute_stabilisation,
    find_columns,
    identify_modes,
)

MODES = load_truth().modes.at(0.5).select((7, 8, 9, 10, 11, 12, 13, 14))
PHI = MODES.translation.reshape(-1, 8).T  # (mode, point and direction)
SHAKERS = (3 * MODES.points.index("ofl") + 2, 3 * MODES.points.index("oar") + 2)
POWERS = {"displacement": 0, "velocity": 1, "acceleration": 2}
OMEGA = 2.0 * np.pi * np.arange(2.0, 18.0, 0.02)


def synthesise(quantity, omega, natural, zeta, mass, phi, shakers):
    s = 1j * omega[:, None]
    gain = 1.0 / (mass * (s**2 + 2 * zeta * natural * s + natural**2))
    responses = np.einsum("wm,mo,mr->wor", gain, phi, phi[:, shakers])
    return responses * (1j * omega[:, None, None]) ** POWERS[quantity]


def add_noise(responses: np.ndarray, noise: float, seed: int = 1) -> np.ndarray:
    rng = np.random.default_rng(seed)
    level = noise * np.sqrt(np.mean(np.abs(responses) ** 2, axis=0))
    error = rng.normal(size=responses.shape) + 1j * rng.normal(size=responses.shape)
    return responses + level * error / np.sqrt(2.0)


def identify(omega, responses, quantity, order=40, driving=()) -> MeasuredModes:
    columns = find_columns(compute_stabilisation(omega, responses, order))
    return identify_modes(omega, responses, columns, quantity, driving)


@pytest.mark.parametrize("quantity", ["displacement", "acceleration"])
def test_modes_come_out_of_noisy_responses(quantity):
    """Six in the band, among them SW1T and AW1T within 0.5 Hz; two beyond it."""
    clean = synthesise(quantity, OMEGA, MODES.omega, MODES.zeta, MODES.mass, PHI, SHAKERS)
    responses = add_noise(clean, 0.01)
    driving = ((SHAKERS[0], 0), (SHAKERS[1], 1))
    found = identify(OMEGA, responses, quantity, driving=driving)
    assert found.omega == pytest.approx(MODES.omega[:6], rel=1e-3)
    assert found.damping == pytest.approx(MODES.zeta[:6], rel=0.02)
    assert not found.unmodelled.size
    turned, straight = rotate_complex_shapes(found.shapes)
    shapes = np.real(turned)
    assert straight.min() > 0.98
    assert np.diag(compute_mac(shapes, PHI[:6])).min() > 0.995
    # The driving points give the scale: one kg m2 of generalised mass.
    truth = PHI[:6] / np.sqrt(MODES.mass[:6])[:, None]
    size = np.linalg.norm(shapes, axis=1) / np.linalg.norm(truth, axis=1)
    assert size == pytest.approx(np.ones(6), rel=0.05)
    error = np.linalg.norm(found.fitted - responses) / np.linalg.norm(responses)
    assert error < 0.015


def test_one_reference_is_enough_without_noise():
    clean = synthesise("acceleration", OMEGA, MODES.omega, MODES.zeta, MODES.mass, PHI, SHAKERS)
    found = identify(OMEGA, clean[:, :, :1], "acceleration", 24)
    assert found.omega == pytest.approx(MODES.omega[:6], rel=1e-4)
    assert found.damping == pytest.approx(MODES.zeta[:6], rel=1e-2)
    assert not found.scaled
    assert np.abs(found.shapes).max(axis=1) == pytest.approx(np.ones(6))


def wing(low_hz, high_hz, n_modes, n_points, seed, pair=0.0):
    """Modes of a wing with random shapes, the last two above the band; a close pair on request."""
    rng = np.random.default_rng(seed)
    hertz = np.geomspace(1.25 * low_hz, 0.9 * high_hz, n_modes)
    if pair:
        hertz[n_modes // 2] = hertz[n_modes // 2 - 1] * (1.0 + pair)
    natural = 2.0 * np.pi * np.append(hertz, [1.3 * high_hz, 1.8 * high_hz])
    phi = rng.normal(size=(natural.size, n_points))
    return natural, rng.uniform(0.008, 0.025, natural.size), phi


@pytest.mark.parametrize(("noise", "order"), [(0.02, 40), (0.1, 40), (0.02, 8)])
def test_no_mode_is_missed_and_none_is_false(noise, order):
    """Low modes of a wide band, of few frequencies each, among them; at any model order."""
    omega = 2.0 * np.pi * np.linspace(1.0, 40.0, 900)
    natural, zeta, phi = wing(1.0, 40.0, 10, 12, 5)
    clean = synthesise("acceleration", omega, natural, zeta, 1.0, phi, (0, 11))
    found = identify(omega, add_noise(clean, noise), "acceleration", order)
    assert found.omega == pytest.approx(natural[:10], rel=5e-3)


def test_standard_deviations_cover_and_a_close_pair_is_resolved():
    """Two modes 0.75 % apart, two references; 30 draws of noise."""
    omega = 2.0 * np.pi * np.linspace(4.0, 12.0, 240)
    natural, zeta, phi = wing(4.0, 12.0, 6, 8, 3, pair=0.0075)
    clean = synthesise("acceleration", omega, natural, zeta, 1.0, phi, (0, 7))
    errors = []
    for seed in range(30):
        found = identify(omega, add_noise(clean, 0.02, seed), "acceleration", 16)
        assert found.omega.size == 6
        errors.append((found.omega - natural[:6]) / found.std_omega)
        errors.append((found.damping - zeta[:6]) / found.std_damping)
        assert np.diag(compute_mac(found.shapes, phi[:6].astype(complex))).min() > 0.99
    assert 0.93 <= np.mean(np.abs(errors) < 2.0) <= 0.97


@pytest.mark.parametrize("seed", [2, 4, 17])
def test_one_mode_is_not_split_into_two(seed):
    """Noise of 10 %: two modes in place of one explain it as well."""
    omega = 2.0 * np.pi * np.linspace(4.0, 12.0, 240)
    natural, zeta, phi = wing(4.0, 12.0, 6, 8, 3, pair=0.0075)
    clean = synthesise("acceleration", omega, natural, zeta, 1.0, phi, (0, 7))
    found = identify(omega, add_noise(clean, 0.1, 1000 + seed), "acceleration")
    assert found.omega.size == 6


def test_out_of_band_modes_do_not_bias_frequencies():
    """Two modes 20 and 30 % above the band, whose sum no polynomial of s^2 represents."""
    clean = synthesise("acceleration", OMEGA, MODES.omega, MODES.zeta, MODES.mass, PHI, SHAKERS)
    found = [
        identify(OMEGA, add_noise(clean, 0.02, seed), "acceleration", order=24) for seed in range(3)
    ]
    errors = [(one.omega - MODES.omega[:6]) / one.std_omega for one in found]
    assert np.abs(np.mean(errors, axis=0)).max() < 2.0


def test_both_indicators_peak_at_a_close_pair():
    omega = 2.0 * np.pi * np.linspace(4.0, 12.0, 2000)
    natural, zeta, phi = wing(4.0, 12.0, 6, 8, 3, pair=0.0075)
    zeta = 0.3 * zeta
    clean = synthesise("displacement", omega, natural, zeta, 1.0, phi, (0, 7))
    indicator = compute_mode_indicator(clean)
    near = np.abs(omega / natural[2] - 1.0) < 0.02
    peaks = omega[near][np.argmax(indicator[near], axis=0)]
    assert np.abs(peaks / natural[[2, 3]][:, None] - 1.0).min(axis=1).max() < 2e-3
    assert indicator[near, 1].max() > 3.0 * np.median(indicator[:, 1])


def test_noise_and_bad_requests_are_refused():
    clean = synthesise("acceleration", OMEGA, MODES.omega, MODES.zeta, MODES.mass, PHI, SHAKERS)
    with pytest.raises(BadInput, match="too few"):
        compute_stabilisation(OMEGA[:20], clean[:20], 30)
    with pytest.raises(BadInput, match="not 'force'"):
        identify_modes(OMEGA, clean, (), "force")
    rng = np.random.default_rng(0)
    noise = rng.normal(size=(300, 6, 1)) + 1j * rng.normal(size=(300, 6, 1))
    with pytest.raises(BadInput, match="do not differ from noise"):
        identify(OMEGA[:300], noise, "displacement", 20)
