"""Modal parameters of FLEX-28 out of responses that a ground vibration test would measure."""

from __future__ import annotations

import numpy as np
import pytest

from flexsid.demo.flex28 import load_truth
from flexsid.errors import BadInput
from flexsid.sysid.modes.assurance import compute_mac, compute_real_shapes
from flexsid.sysid.modes.polyreference import compute_stabilisation, find_columns, fit_shapes

MODES = load_truth().modes.at(0.5).select((7, 8, 9, 10, 11, 12, 13, 14))
PHI = MODES.translation.reshape(-1, 8).T  # (mode, point and direction)
SHAKERS = (3 * MODES.points.index("ofl") + 2, 3 * MODES.points.index("oar") + 2)
POWERS = {"displacement": 0, "velocity": 1, "acceleration": 2}


def measured(quantity: str, noise: float, seed: int = 1) -> tuple[np.ndarray, np.ndarray]:
    omega = 2.0 * np.pi * np.arange(2.0, 18.0, 0.02)
    s = 1j * omega[:, None]
    gain = 1.0 / (MODES.mass * (s**2 + 2 * MODES.zeta * MODES.omega * s + MODES.omega**2))
    responses = np.einsum("wm,mo,mr->wor", gain, PHI, PHI[:, SHAKERS])
    responses *= (1j * omega[:, None, None]) ** POWERS[quantity]
    rng = np.random.default_rng(seed)
    level = noise * np.sqrt(np.mean(np.abs(responses) ** 2, axis=0))
    error = rng.normal(size=responses.shape) + 1j * rng.normal(size=responses.shape)
    return omega, responses + level * error / np.sqrt(2.0)


@pytest.mark.parametrize("quantity", ["displacement", "acceleration"])
def test_modes_come_out_of_noisy_responses(quantity):
    """Six in the band, among them SW1T and AW1T within 0.5 Hz; two beyond it."""
    omega, responses = measured(quantity, 0.01)
    columns = find_columns(compute_stabilisation(omega, responses, 30))
    driving = ((SHAKERS[0], 0), (SHAKERS[1], 1))
    found = fit_shapes(omega, responses, columns, quantity, driving)
    assert found.omega == pytest.approx(MODES.omega[:6], rel=1e-3)
    assert found.damping == pytest.approx(MODES.zeta[:6], rel=0.05)
    shapes, straight = compute_real_shapes(found.shapes)
    assert straight.min() > 0.98
    assert np.diag(compute_mac(shapes, PHI[:6])).min() > 0.995
    # The driving points give the scale: one kg m2 of generalised mass.
    truth = PHI[:6] / np.sqrt(MODES.mass[:6])[:, None]
    size = np.linalg.norm(shapes, axis=1) / np.linalg.norm(truth, axis=1)
    assert size == pytest.approx(np.ones(6), rel=0.05)
    error = np.linalg.norm(found.fitted - responses) / np.linalg.norm(responses)
    assert error < 0.03


def test_one_reference_is_enough_without_noise():
    omega, responses = measured("acceleration", 0.0)
    columns = find_columns(compute_stabilisation(omega, responses[:, :, :1], 24))
    found = fit_shapes(omega, responses[:, :, :1], columns, "acceleration")
    assert found.omega == pytest.approx(MODES.omega[:6], rel=1e-4)
    assert found.damping == pytest.approx(MODES.zeta[:6], rel=1e-2)
    assert not found.scaled
    assert np.abs(found.shapes).max(axis=1) == pytest.approx(np.ones(6))


def test_what_cannot_be_fitted_is_refused():
    omega, responses = measured("acceleration", 0.01)
    with pytest.raises(BadInput, match="too few"):
        compute_stabilisation(omega[:20], responses[:20], 30)
    with pytest.raises(BadInput, match="no pole is stable"):
        fit_shapes(omega, responses, (), "acceleration")
