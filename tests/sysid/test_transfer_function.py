"""Transfer functions of one input and output: recovery, standard errors, equivalent delay."""

from __future__ import annotations

import numpy as np
import pytest

from flexsid.errors import BadInput, NotIdentifiable
from flexsid.sysid.spectra.residual_spectrum import estimate_noise_in_motion
from flexsid.sysid.stability.transfer_function import (
    TransferFunctionForm,
    compute_mismatch_cost,
    fit_transfer_function,
)
from flexsid.verification.requirements import FLIGHTS, build_rigid_model

OMEGA = np.linspace(0.5, 15.0, 60)
S = 1j * OMEGA
GAIN, ZERO, FREQUENCY, DAMPING, DELAY = 3.0, 1.2, 4.0, 0.6, 0.08
SHORT_PERIOD = TransferFunctionForm(1, 2)
H = GAIN * (S + ZERO) * np.exp(-DELAY * S) / (S**2 + 2 * DAMPING * FREQUENCY * S + FREQUENCY**2)


def test_a_response_without_noise_gives_the_function_back():
    found = fit_transfer_function(SHORT_PERIOD, OMEGA, H)
    assert found.gain == pytest.approx(GAIN, rel=1e-9)
    assert found.zeros[0].real_rad_s == pytest.approx(-ZERO, rel=1e-9)
    assert found.poles[0].frequency_rad_s == pytest.approx(FREQUENCY, rel=1e-9)
    assert found.poles[0].damping == pytest.approx(DAMPING, rel=1e-9)
    assert found.delay == pytest.approx(DELAY, rel=1e-9)
    assert found.cost < 1e-12
    np.testing.assert_allclose(found.response(OMEGA), H, rtol=1e-9)


@pytest.mark.parametrize("colour", [pytest.param(0.0, marks=pytest.mark.long), 2.0])
@pytest.mark.parametrize("fits", [80, pytest.param(1000, marks=pytest.mark.long)])
def test_two_standard_errors_hold_the_truth(fits, colour):
    """Also where noise rises over frequency, but only its mean was known."""
    rng = np.random.default_rng(1)
    level = 0.05 * np.abs(H).mean() * np.exp(colour * (OMEGA / OMEGA[-1] - 0.5))
    inside = []
    for _ in range(fits):
        noise = level * (rng.normal(size=OMEGA.size) + 1j * rng.normal(size=OMEGA.size))
        std = np.full(OMEGA.size, np.sqrt(np.mean(level**2)))
        found = fit_transfer_function(SHORT_PERIOD, OMEGA, H + noise / np.sqrt(2.0), std)
        (zero,), (pole,) = found.zeros, found.poles
        pairs = (
            (found.gain - GAIN, found.gain_std),
            (zero.frequency_rad_s - ZERO, zero.frequency_std_rad_s),
            (pole.frequency_rad_s - FREQUENCY, pole.frequency_std_rad_s),
            (pole.damping - DAMPING, pole.damping_std),
            (found.delay - DELAY, found.delay_std),
        )
        inside += [abs(error) < 2.0 * std for error, std in pairs]
    assert 0.91 < np.mean(inside) < 0.985, f"{np.mean(inside):.3f}"


def test_noise_of_the_measured_input_does_not_bias():
    """Lines weighted by the power of a noisy input attenuate the gain by 1 + rho^2: 4 %."""
    rng = np.random.default_rng(4)
    omega, rho = np.linspace(0.5, 15.0, 1200), 0.2
    s = 1j * omega
    truth = GAIN * (s + ZERO) * np.exp(-DELAY * s) / (s**2 + 4.8 * s + FREQUENCY**2)
    u, at_output = (
        (rng.normal(size=s.size) + 1j * rng.normal(size=s.size)) / np.sqrt(2.0) for _ in range(2)
    )
    u, measured, level = np.exp(1j * omega), np.exp(1j * omega) + rho * u, 0.05
    std = np.hypot(level, rho * np.abs(truth)) / np.abs(measured)
    response = (truth * u + level * at_output) / measured
    exact = fit_transfer_function(SHORT_PERIOD, omega, response, std)
    found = fit_transfer_function(
        SHORT_PERIOD, omega, response, std, input_std=rho / np.abs(measured)
    )
    assert abs(found.gain - GAIN) < 2.0 * found.gain_std
    assert (
        abs(found.poles[0].frequency_rad_s - FREQUENCY) < 2.5 * found.poles[0].frequency_std_rad_s
    )
    assert GAIN - exact.gain > 2.5 * exact.gain_std


def test_noise_of_a_record_in_motion_is_the_scatter_about_its_responses():
    """The spectrum of the input is random, as that of turbulence or a stick is."""
    rng = np.random.default_rng(5)
    u, noise = (rng.normal(size=(400, 1)) + 1j * rng.normal(size=(400, 1)) for _ in range(2))
    omega = np.linspace(0.5, 15.0, 400)
    smooth, free = (1.0 / (1j * omega + p) for p in (2.0, 3.0 + 4.0j))
    ends = np.exp(-3j * omega)[:, None]
    z = smooth[:, None] * u + free[:, None] * ends + 0.01 / np.sqrt(2.0) * noise
    found = estimate_noise_in_motion(omega, u, z, ends, omega[::40])
    assert found is not None
    np.testing.assert_allclose(found[:, 0], 0.01, rtol=0.4)
    assert np.mean(found) == pytest.approx(0.01, rel=0.15)
    assert estimate_noise_in_motion(omega[:8], u[:8], z[:8], ends[:8], omega[:1]) is None


def test_the_delay_stands_for_dynamics_that_are_omitted():
    """Of an actuator and a filter: the sum of their low-frequency delays, nearly."""
    actuator, filtered = 20.0 / (S + 20.0), 900.0 / (S**2 + 42.0 * S + 900.0)
    found = fit_transfer_function(SHORT_PERIOD, OMEGA, H * actuator * filtered)
    assert found.delay == pytest.approx(DELAY + 1 / 20 + 42 / 900, abs=0.015)
    assert found.poles[0].frequency_rad_s == pytest.approx(FREQUENCY, rel=0.03)
    assert found.mismatch == pytest.approx(0.05, abs=0.02)
    assert found.cost < 10.0
    without = fit_transfer_function(TransferFunctionForm(1, 2, 0, False), OMEGA, H * actuator)
    assert without.delay == 0.0
    assert without.cost > 10.0


def test_mismatch_cost_is_that_of_decibels_and_degrees():
    measured = H * 10 ** (1.0 / 20.0) * np.exp(1j * np.deg2rad(5.0))
    assert compute_mismatch_cost(OMEGA, measured, H) == pytest.approx(20 * (1 + 0.02 * 25))


@pytest.mark.parametrize("flight", [41, 15])
def test_short_period_of_a_published_aircraft(flight):
    """NASA T-2: pitch rate over elevator, and its integral."""
    model, table = build_rigid_model(flight)
    omega = np.linspace(0.5, 14.0, 40)
    q = model.response(table, omega)[:, model.outputs.index("q"), 0]
    for response, integrators in ((q, 0), (q / (1j * omega), 1)):
        found = fit_transfer_function(TransferFunctionForm(1, 2, integrators), omega, response)
        (pole,) = found.poles
        assert pole.frequency_rad_s == pytest.approx(FLIGHTS[flight]["natural"], rel=0.005)
        assert pole.damping == pytest.approx(FLIGHTS[flight]["zeta"], rel=0.01)
        assert abs(found.delay) < 1e-6


def test_two_real_poles_and_unstable_ones_are_found():
    roll = 5.0 * np.exp(-0.02 * S) / ((S + 2.0) * (S - 0.4))
    found = fit_transfer_function(TransferFunctionForm(0, 2), OMEGA, roll)
    assert [pole.real_rad_s for pole in found.poles] == pytest.approx([0.4, -2.0], rel=1e-6)
    assert [pole.damping for pole in found.poles] == [-1.0, 1.0]


def test_what_cannot_be_fitted_is_refused():
    with pytest.raises(BadInput, match="zeros exceed"):
        TransferFunctionForm(3, 2)
    with pytest.raises(BadInput, match="at least one pole"):
        TransferFunctionForm(0, 0)
    with pytest.raises(NotIdentifiable, match="frequencies do not determine"):
        fit_transfer_function(SHORT_PERIOD, OMEGA[:3], H[:3])
    with pytest.raises(BadInput, match="finite and not zero"):
        fit_transfer_function(SHORT_PERIOD, OMEGA, 0.0 * H)
    first_order = 1.0 / (S + 2.0)
    with pytest.raises(NotIdentifiable, match="lower its orders"):
        fit_transfer_function(TransferFunctionForm(3, 4), OMEGA, first_order)
