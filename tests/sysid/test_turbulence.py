"""A user relies on: turbulence of the named intensity, and standard errors that hold in it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy import signal

from flexsid.demo.flex28 import load_truth
from flexsid.demo.flights import fly
from flexsid.errors import Cancelled
from flexsid.sysid.estimation.likelihood import (
    FitSettings,
    count_effective_parameters,
    maximize,
)
from flexsid.sysid.estimation.noise import estimate_noise_spectrum
from flexsid.sysid.estimation.output_error import output_error
from flexsid.sysid.estimation.weighted_fit import (
    compute_weighting_change,
    weight_by_noise_spectrum,
    widen_by_change,
)
from flexsid.sysid.signals import FrequencyData
from flexsid.sysid.simulation.airframe import assemble_airframe
from flexsid.sysid.simulation.turbulence import (
    GUST,
    Turbulence,
    add_gust_input,
    compute_gust_density,
    generate_gust,
)

OMEGA = 2.0 * np.pi * np.arange(6, 206) / 24.0  # five inputs, forty harmonics each
FITS = 40


@pytest.mark.parametrize(
    ("intensity", "feet_per_s"), [(Turbulence.LIGHT, 2.53), (Turbulence.MODERATE, 5.06)]
)
def test_gust_has_the_dryden_spectrum_of_its_intensity(intensity, feet_per_s):
    airspeed, rate_hz = 40.0, 100.0
    rng = np.random.default_rng(0)
    gust = airspeed * generate_gust(intensity, airspeed, 1_000_000, rate_hz, rng)
    sigma = feet_per_s * 0.3048
    assert np.std(gust) == pytest.approx(sigma, rel=0.1)
    hz, density = signal.welch(gust, rate_hz, nperseg=20_000)
    inside = (hz > 0.05) & (hz < 10.0)
    x = (1000.0 * 0.3048 * 2.0 * np.pi * hz[inside] / airspeed) ** 2
    dryden = 2.0 * sigma**2 * 304.8 / airspeed * (1.0 + 3.0 * x) / (1.0 + x) ** 2
    assert np.mean(density[inside] / dryden) == pytest.approx(1.0, abs=0.03)
    computed = airspeed**2 * compute_gust_density(intensity, airspeed, 2.0 * np.pi * hz[inside])
    assert np.mean(density[inside] / (2.0 * computed)) == pytest.approx(1.0, abs=0.03)


def test_a_gust_acts_as_angle_of_attack_on_forces_and_not_on_the_motion():
    truth = load_truth()
    condition = truth.condition_at(0.65 * truth.flutter_speed_at(0.5), 0.5)
    frame = assemble_airframe(condition, truth.modes_at(0.5, 2), truth.derivatives_at(0.5, 2))
    derivatives = truth.derivatives_at(0.5, 2)
    factors = derivatives.body.row_factors(condition, truth.modes_at(0.5, 2).mass)
    expected = derivatives.values[:, 0] * factors
    assert frame.gust_rates[[0, 1, 5, 6]] == pytest.approx(expected)
    assert not frame.gust_rates[2:5].any()


def test_a_maneuver_in_turbulence_begins_in_motion_and_differs_from_one_in_still_air():
    calm = fly(modes_in_truth=1, noise=False)
    rough = fly(modes_in_truth=1, noise=False, turbulence=Turbulence.LIGHT)
    rate = {c.name: c.samples for c in calm.channels}["q"]
    felt = {c.name: c.samples for c in rough.channels}["q"]
    assert felt.shape == rate.shape
    assert np.std(felt[:1000]) > 10.0 * np.std(rate[:1000])
    assert "light turbulence" in rough.maneuver.note


class Flight:
    """Spectra of a maneuver in turbulence, without feedback."""

    def __init__(self, case, gust: float, report=lambda number: None) -> None:
        self.report = report
        rng = np.random.default_rng(1)
        self.case, self.gust = case, gust
        self.command = np.zeros((OMEGA.size, 5), dtype=complex)
        turns = np.exp(2j * np.pi * rng.uniform(size=OMEGA.size))
        self.command[np.arange(OMEGA.size), np.arange(OMEGA.size) % 5] = turns
        self.H = case.model.response(case.truth, OMEGA)
        # A gust acts like the angle of attack: the response to a surface of the same forces.
        table = case.truth.values.copy()
        table[:, -1] = table[:, 0]
        as_surface = type(case.truth)(case.truth.modes, case.truth.inputs, table)
        self.G = case.model.response(as_surface, OMEGA)[:, :, -1]
        y = self.H @ self.command[:, :, None]
        self.level = 0.01 * np.sqrt(np.mean(np.abs(y[:, :, 0]) ** 2, axis=0))

    def fit(self, seed: int):
        rng = np.random.default_rng(100 + seed)

        def white(*shape: int) -> np.ndarray:
            return (rng.normal(size=shape) + 1j * rng.normal(size=shape)) / np.sqrt(2.0)

        model = self.case.model
        w = self.gust * white(OMEGA.size, 1) * self.G
        z = (self.H @ self.command[:, :, None])[:, :, 0] + w + self.level * white(*w.shape)
        inputs = FrequencyData(OMEGA, self.command, model.inputs)
        experiment = output_error(
            model,
            inputs,
            FrequencyData(OMEGA, z, model.outputs),
            np.ones(z.shape, dtype=complex),
        )
        first = maximize([experiment], self.case.free())
        return first, weight_by_noise_spectrum(
            [experiment], self.case.free(), first, FitSettings(), self.report
        )


@pytest.mark.parametrize("gust", [0.0, 0.03])
def test_two_standard_errors_hold_the_truth_and_turbulence_costs_little(make_case, gust):
    flight = Flight(make_case(1), gust)
    truth = flight.case.truth.values.ravel()
    errors, sigmas, bounds, before = [], [], [], []
    for seed in range(FITS):
        first, found = flight.fit(seed)
        assert found.noise is not None
        assert found.noise.degrees_of_freedom == 30
        assert "spectral matrix" in found.noise.description
        # Without feedback the weights change nothing but the precision.
        assert compute_weighting_change(first, found) < 2.2
        errors.append(found.values - truth)
        sigmas.append(found.std_errors)
        bounds.append(np.sqrt(np.diag(found.covariance)))
        before.append(first.std_errors)
    inside = np.abs(errors) <= 2.0 * np.array(sigmas)
    assert 0.92 <= np.mean(inside) <= 0.975, f"{np.mean(inside):.3f}"
    scatter = np.std(errors, axis=0) / np.median(sigmas, axis=0)
    assert np.median(scatter) < 1.3
    # A bound: reached in still air, where the noise spectrum has no directions to estimate.
    of_bound = float(np.median(np.std(errors, axis=0) / np.median(bounds, axis=0)))
    assert of_bound > 0.85, of_bound
    assert gust or of_bound < 1.15, of_bound
    gain = float(np.median(np.median(before, axis=0) / np.median(sigmas, axis=0)))
    assert gain > (1.1 if gust else 0.9), gain


def test_a_weighted_fit_is_cancelled_between_noise_spectra(make_case):
    def cancel_second(number: int) -> None:
        if number == 2:
            raise Cancelled("cancelled")

    with pytest.raises(Cancelled):
        Flight(make_case(1), 0.03, cancel_second).fit(0)


def test_change_by_the_weights_is_counted_as_a_bias(make_case):
    first, found = Flight(make_case(1), 0.0).fit(0)
    moved = replace(found, values=first.values + 3.0 * first.std_errors)
    assert compute_weighting_change(first, moved) == pytest.approx(3.0)
    nuisance = replace(first, nuisance=frozenset(first.names[1:]))
    one = replace(moved, values=np.r_[first.values[0], moved.values[1:]])
    assert compute_weighting_change(nuisance, one) == 0.0
    wide = widen_by_change(moved, moved.values - first.values)
    expected = np.hypot(moved.std_errors, 3.0 * first.std_errors)
    assert wide.std_errors == pytest.approx(expected)


def test_too_few_frequencies_for_a_spectral_matrix_leave_the_fit_as_it_is(make_case):
    assert estimate_noise_spectrum(np.ones((40, 20), dtype=complex)) is None
    case = make_case(1)
    rng = np.random.default_rng(0)
    omega = OMEGA[:40]
    u, y = case.spectra(0, omega)
    noise = rng.normal(size=y.shape) + 1j * rng.normal(size=y.shape)
    experiment = case.experiment(u, y + 0.01 * np.abs(y).mean(axis=0) * noise, omega)
    first = maximize([experiment], case.free())
    found = weight_by_noise_spectrum([experiment], case.free(), first, FitSettings())
    assert np.array_equal(found.values, first.values)
    assert found.noise is not None
    assert "one diagonal covariance" in found.noise.description


def test_parameters_that_their_priors_hold_take_no_degrees_of_freedom():
    information = np.diag([4.0, 4.0, 1e6])
    assert count_effective_parameters(information, np.zeros((3, 3))) == 3.0
    held = count_effective_parameters(information, np.diag([0.0, 2.0, 1e6]))
    assert held == pytest.approx(1.5)


def test_more_parameters_than_data_are_fitted_where_priors_hold_them(make_case):
    case = make_case(1, n_outputs=2)
    omega = OMEGA[:5]  # twenty real numbers for 27 parameters
    u, y = case.spectra(0, omega)
    free = case.free()
    priors = {n: (v, 0.1 * abs(v) + 1e-3) for n, v in zip(free.names, free.start, strict=True)}
    found = maximize([case.experiment(u, 1.001 * y, omega)], free, FitSettings(priors=priors))
    assert np.isfinite(found.values).all()


def test_a_gust_of_a_model_acts_like_the_angle_of_the_flow(make_case):
    case = make_case(1)
    vanes = np.arange(len(case.model.outputs)) == 0
    plant = add_gust_input(case.model, case.truth, vanes.astype(float))
    assert plant.inputs == (*case.model.inputs, GUST)
    still = case.model.state_space(case.truth)
    assert np.array_equal(plant.A, still.A)
    assert np.array_equal(plant.B[:, :-1], still.B)
    # The forces of the angle of attack: its column without the terms of motion.
    moment, mode = plant.states.index("q"), plant.states.index("etadot7")
    assert plant.B[[moment, mode], -1] == pytest.approx(still.A[[moment, mode], 0])
    assert np.array_equal(plant.D[:, :-1], still.D)
