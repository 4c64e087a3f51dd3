"""Modes against fuel, models of fewer modes, and poles with their error bars."""

from __future__ import annotations

import numpy as np
import pytest
from tests.sysid.conftest import OMEGA, add_noise

from flexsid.demo.flex28 import load_truth
from flexsid.sysid.estimation.experiment import select_parameters
from flexsid.sysid.estimation.likelihood import maximize
from flexsid.sysid.model.reduction import residualize
from flexsid.sysid.modes import ModeTable
from flexsid.sysid.modes.table import align_modes
from flexsid.sysid.stability.order import compute_reduced_response, study_order
from flexsid.sysid.stability.poles import compute_named_poles

# Design notes, section 6: C_m_alpha of residualised models with 0 to 4 modes, half fuel.
RESIDUALISED = {
    0.65: (-0.859, -0.812, -0.714, -0.690, -0.700),
    1.09: (-1.482, -1.083, -0.744, -0.675, -0.703),
}


@pytest.mark.parametrize("ratio", [0.65, 1.09])
def test_residualised_stiffness_is_that_of_the_design_notes(ratio):
    truth = load_truth()
    full = truth.derivatives_at(0.5, 8)
    condition = truth.condition_at(ratio * truth.flutter_speed_at(0.5), 0.5)
    for n, published in enumerate(RESIDUALISED[ratio]):
        retained = residualize(full, truth.modes_at(0.5, 8), condition, full.modes[:n])
        assert retained.named()["Cm_alpha"] == pytest.approx(published, abs=0.0005)


def test_residualising_preserves_the_static_response(make_case):
    full, reduced = make_case(4), make_case(1)
    truth = full.truth
    retained = residualize(truth, full.model.modes, full.model.condition, (7,))
    slow = np.array([1e-4])  # alpha and the retained mode under unit inputs, far below any pole
    rigid = full.model.sensors.names.index("alpha")
    one = full.model.response(truth, slow)[:, rigid]
    two = reduced.model.response(retained, slow)[:, rigid]
    assert np.abs(one - two).max() < 0.02 * np.abs(one).max()


@pytest.mark.parametrize(("ratio", "needed"), [(0.65, 3), (1.09, 4)])
def test_the_number_of_modes_a_condition_needs_is_proposed(make_case, ratio, needed):
    case = make_case(8, ratio)
    study = study_order(case.model, case.truth, OMEGA)
    assert study.needed == needed
    assert [len(step.errors.modes) for step in study.steps] == list(range(9))
    for step, published in zip(study.steps, RESIDUALISED[ratio], strict=False):
        assert step.residualized.derivatives.named()["Cm_alpha"] == pytest.approx(
            published, abs=0.0005
        )
        assert step.truncated.derivatives.named()["Cm_alpha"] == pytest.approx(-0.698, abs=0.0005)
    assert study.steps[needed].errors.sufficient
    assert not study.steps[needed - 1].errors.sufficient
    errors = [step.errors.response_error or 0.0 for step in study.steps]
    assert errors == sorted(errors, reverse=True)  # each mode makes the responses better
    assert errors[-1] == pytest.approx(0.0, abs=1e-9)
    assert study.steps[0].errors.pole_error is None  # no pole where SW1B is


def test_sensors_measure_the_static_response_of_residualised_modes(make_case):
    case = make_case(4)
    slow = np.array([0.01])
    full = case.model.response(case.truth, slow)
    assert np.allclose(
        compute_reduced_response(case.model, case.truth, (7,), slow), full, rtol=1e-3
    )
    assert not np.allclose(
        case.model.with_modes(1).response(case.truth.select((7,), case.model.inputs), slow),
        full,
        rtol=1e-2,
    )


def test_modes_are_followed_through_a_crossing_and_a_flip():
    rng = np.random.default_rng(1)
    shapes = rng.normal(size=(2, 5, 6))
    fuel = np.array([0.0, 0.5, 1.0])
    omega = np.array([[10.0, 20.0], [14.0, 16.0], [12.0, 18.0]])  # they cross after the second
    shape = np.stack([shapes, shapes, shapes[::-1]])
    shape[1, 1] *= -1.0
    strain = np.ones((3, 2, 1))
    flat = np.full((3, 2), 0.02)
    table = ModeTable(
        fuel, (7, 8), omega, flat, np.ones((3, 2)), tuple("abcde"), shape, ("g",), strain
    )
    followed = align_modes(table)
    assert np.allclose(followed.omega[2], [18.0, 12.0])
    assert np.allclose(followed.shape, shapes)
    middle = followed.at(0.75)
    assert middle.omega == pytest.approx([16.0, 14.0])
    assert np.allclose(middle.translation[:, :, 0], shapes[0, :, :3])
    assert followed.at(2.0).omega == pytest.approx([18.0, 12.0])


def test_error_bars_of_poles_are_those_of_draws(make_case):
    case = make_case(2)
    u, y = case.spectra(2)
    experiment = case.experiment(u, add_noise(y, 0.05, np.random.default_rng(2)))
    parameters = case.free()
    estimate = maximize([experiment], parameters)
    covariance = estimate.corrected_covariance
    names = ("SW1B", "SW1T")
    poles = compute_named_poles(case.model, parameters, estimate.values, covariance, names)
    assert [pole.name for pole in poles] == ["SP", "SW1B", "SW1T"]
    draws = np.random.default_rng(3).multivariate_normal(
        estimate.values, covariance, 400, method="cholesky"
    )
    scattered = [
        compute_named_poles(case.model, parameters, draw, covariance, names) for draw in draws
    ]
    for k, pole in enumerate(poles):
        values = np.array([one[k].value for one in scattered])
        assert np.std(np.real(values)) == pytest.approx(pole.real_std, rel=0.15)
        assert np.std(np.imag(values)) == pytest.approx(pole.imag_std, rel=0.15)
        assert np.std(np.abs(values)) == pytest.approx(pole.frequency_std, rel=0.15)
        assert np.std(-np.real(values) / np.abs(values)) == pytest.approx(
            pole.damping_std, rel=0.15
        )


def test_poles_follow_frequency_and_damping_that_were_estimated(make_case):
    case = make_case(2)
    extras = ("omega_7", "zeta_9")
    free = select_parameters(case.truth, ("Cm_alpha",), case.model.outputs, extras)
    theta = np.array([*free.start[:1], 1.10, 2.0])
    names = ("SW1B", "SW1T")

    def values(at: np.ndarray) -> np.ndarray:
        poles = compute_named_poles(case.model, free, at, np.zeros((3, 3)), names)
        return np.array([pole.value for pole in poles])

    for k in range(3):
        one = np.zeros((3, 3))
        one[k, k] = 1.0  # the standard error is the size of the slope
        slope = np.array(
            [
                (pole.real_std, pole.imag_std)
                for pole in compute_named_poles(case.model, free, theta, one, names)
            ]
        )
        step = 1e-5 * np.eye(3)[k]
        by_difference = (values(theta + step) - values(theta - step)) / 2e-5
        assert slope[:, 0] == pytest.approx(np.abs(np.real(by_difference)), rel=1e-4, abs=1e-5)
        assert slope[:, 1] == pytest.approx(np.abs(np.imag(by_difference)), rel=1e-4, abs=1e-5)
    stiffer = abs(values(theta)[1]) / abs(values(free.start)[1])
    assert stiffer > 1.05
