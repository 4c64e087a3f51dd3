"""Grey-box models: derivatives, standard errors over draws, priors, tests, python-control."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import control
import numpy as np
import pytest
from own_model_flight import HOVER, RATE_HZ, ROLL, simulate_hover, simulate_roll

from flexsid.errors import BadInput, NotIdentifiable
from flexsid.sysid import (
    GreyBox,
    GreyBoxData,
    GreyBoxEstimate,
    fit_frequency_response_data,
    fit_grey_box,
)
from flexsid.sysid import GreyBoxParameter as Parameter
from flexsid.sysid.grey_box.model import Matrices, differentiate, is_analytic
from flexsid.sysid.grey_box.residual_tests import compute_poles, run_residual_tests
from flexsid.sysid.spectra.fourier import integrate_between

_GRAVITY = 9.81


def _roll(p: Mapping[str, Any], condition: Any) -> Matrices:
    A = [[p["L_p"], p["L_da"]], [0.0, -p["servo"]]]
    return A, [[0.0], [p["servo"]]], [[1.0, 0.0]], [[0.0]]


def _hover(p: Mapping[str, Any], condition: Any) -> Matrices:
    A = [
        [p["X_u"], 0, -_GRAVITY, 0, 0, 0, 0, 0],
        [p["M_u"], p["M_q"], 0, 0, p["M_p"], 0, p["M_lon"], 0],
        [0, 1, 0, 0, 0, 0, 0, 0],
        [0, 0, 0, p["Y_v"], 0, _GRAVITY, 0, 0],
        [0, p["L_q"], 0, p["L_v"], p["L_p"], 0, 0, p["L_lat"]],
        [0, 0, 0, 0, 1, 0, 0, 0],
        [0, 0, 0, 0, 0, 0, -p["servo_lon"], 0],
        [0, 0, 0, 0, 0, 0, 0, -p["servo_lat"]],
    ]
    B = [[0, 0]] * 6 + [[p["servo_lon"], 0], [0, p["servo_lat"]]]
    return A, B, np.eye(8)[:6], np.zeros((6, 2))


ROLL_MODEL = GreyBox(
    title="Roll mode with actuator",
    matrices=_roll,
    parameters=[Parameter("L_p", -2.0), Parameter("L_da", 8.0), Parameter("servo", 12.0)],
    inputs={"aileron": "rad"},
    outputs={"p": "rad/s"},
)
HOVER_MODEL = GreyBox(
    title="Hover cubics",
    matrices=_hover,
    parameters=[
        Parameter(name, value * (1.3 if k % 2 else 0.7))
        for k, (name, value) in enumerate(HOVER.items())
    ],
    inputs={"longitudinal": "rad", "lateral": "rad"},
    outputs={"u": "m/s", "q": "rad/s", "theta": "rad", "v": "m/s", "p": "rad/s", "phi": "rad"},
)


def transform(model: GreyBox, columns: dict[str, np.ndarray], top_hz: float) -> GreyBoxData:
    """Transform a record at the multiples of 1/T up to a frequency."""
    duration_s = float(columns["t"][-1])
    omega = 2.0 * np.pi * np.arange(1, int(top_hz * duration_s)) / duration_s
    samples = np.stack([columns[name] for name in (*model.inputs, *model.outputs)], axis=1)
    window = (0.0, duration_s)
    spectra = integrate_between(samples - samples.mean(axis=0), RATE_HZ, omega, 0.0, window)
    n_u = len(model.inputs)
    return GreyBoxData(
        omega=omega,
        inputs=spectra[:, :n_u],
        outputs=spectra[:, n_u:],
        ends_s=(duration_s,),
        duration_s=duration_s,
    )


def deviate(estimate: GreyBoxEstimate, truth: Mapping[str, float]) -> np.ndarray:
    """Return the errors of the parameters in standard errors."""
    errors = estimate.values - [truth[name] for name in estimate.model.names]
    return errors / estimate.std_errors


@pytest.mark.parametrize("draws", [8, pytest.param(200, marks=pytest.mark.long)])
def test_standard_errors_of_a_roll_mode_hold(draws: int) -> None:
    found = [
        deviate(fit_grey_box(ROLL_MODEL, [transform(ROLL_MODEL, simulate_roll(k), 5.0)]), ROLL)
        for k in range(draws)
    ]
    _check_coverage(np.array(found))


@pytest.mark.parametrize("draws", [2, pytest.param(200, marks=pytest.mark.long)])
def test_standard_errors_of_unstable_hover_cubics_hold(draws: int) -> None:
    found = []
    for k in range(draws):
        data = [transform(HOVER_MODEL, simulate_hover(k), 3.0)]
        estimate = fit_grey_box(HOVER_MODEL, data)
        assert estimate.matrices.A.shape == (8, 8)
        assert estimate.by_complex_step
        found.append(deviate(estimate, HOVER))
        unstable = [one for one in compute_poles(estimate) if one.real_rad_s > 0.0]
        assert len(unstable) == 2
    _check_coverage(np.array(found))


def _check_coverage(deviations: np.ndarray) -> None:
    """Check that as many errors are inside 1.96 standard errors as normal ones, to 3 sigma."""
    share = np.mean(np.abs(deviations) < 1.96)
    assert abs(share - 0.95) < 3.0 * np.sqrt(0.95 * 0.05 / len(deviations) / 2.0), share
    if len(deviations) >= 100:
        assert 0.93 <= share <= 0.97


def test_derivatives_by_complex_step_are_those_of_differences() -> None:
    theta = HOVER_MODEL.starts
    exact = differentiate(HOVER_MODEL, theta, None, analytic=True)
    compared = differentiate(HOVER_MODEL, theta, None, analytic=False)
    for one, other in zip(exact, compared, strict=True):
        for a, b in zip(one, other, strict=True):
            np.testing.assert_allclose(a, b, rtol=1e-7, atol=1e-9)


@pytest.mark.parametrize("make", [abs, np.real, float, lambda x: x if x > 0.0 else -x])
def test_functions_that_are_not_analytic_are_found(make: Any) -> None:
    def matrices(p: Mapping[str, Any], condition: Any) -> Matrices:
        return _roll({**p, "servo": make(p["servo"])}, condition)

    model = GreyBox(
        title="Not analytic",
        matrices=matrices,
        parameters=ROLL_MODEL.parameters,
        inputs=ROLL_MODEL.inputs,
        outputs=ROLL_MODEL.outputs,
    )
    assert is_analytic(ROLL_MODEL, ROLL_MODEL.starts, None)
    assert not is_analytic(model, model.starts, None)
    data = [transform(model, simulate_roll(1), 5.0)]
    estimate, exact = (fit_grey_box(one, data) for one in (model, ROLL_MODEL))
    np.testing.assert_allclose(estimate.values, exact.values, rtol=1e-4)
    np.testing.assert_allclose(estimate.std_errors, exact.std_errors, rtol=1e-3)


def test_a_prior_is_combined_with_the_data() -> None:
    data = [transform(ROLL_MODEL, simulate_roll(1), 5.0)]
    free = fit_grey_box(ROLL_MODEL, data)
    spread = float(free.std_errors[2])
    prior = (float(free.values[2]) + spread, spread)
    model = GreyBox(
        title="With prior",
        matrices=_roll,
        parameters=[*ROLL_MODEL.parameters[:2], Parameter("servo", 12.0, prior=prior)],
        inputs=ROLL_MODEL.inputs,
        outputs=ROLL_MODEL.outputs,
    )
    found = fit_grey_box(model, data)
    assert found.values[2] == pytest.approx(free.values[2] + 0.5 * spread, abs=0.1 * spread)
    assert found.std_errors[2] == pytest.approx(spread / np.sqrt(2.0), rel=0.1)


def test_missing_dynamics_are_rejected() -> None:
    smaller = GreyBox(
        title="Roll mode",
        matrices=lambda p, condition: ([[p["L_p"]]], [[p["L_da"]]], [[1.0]], [[0.0]]),
        parameters=ROLL_MODEL.parameters[:2],
        inputs=ROLL_MODEL.inputs,
        outputs=ROLL_MODEL.outputs,
    )
    data = [transform(ROLL_MODEL, simulate_roll(1), 5.0)]
    whole, part = (fit_grey_box(one, data) for one in (ROLL_MODEL, smaller))
    assert not any(one.rejects for one in run_residual_tests(whole, data))
    assert any(one.rejects for one in run_residual_tests(part, data))
    assert whole.bic < part.bic


def test_parameters_that_data_do_not_separate_are_named() -> None:
    def matrices(p: Mapping[str, Any], condition: Any) -> Matrices:
        return [[p["L_p"]]], [[p["gain"] * p["L_da"]]], [[1.0]], [[0.0]]

    model = GreyBox(
        title="Gain twice",
        matrices=matrices,
        parameters=[*ROLL_MODEL.parameters[:2], Parameter("gain", 1.0)],
        inputs=ROLL_MODEL.inputs,
        outputs=ROLL_MODEL.outputs,
    )
    with pytest.raises(NotIdentifiable, match="L_da and gain"):
        fit_grey_box(model, [transform(ROLL_MODEL, simulate_roll(1), 5.0)])


def test_frequency_responses_of_python_control_are_fitted() -> None:
    omega = np.geomspace(0.3, 40.0, 80)
    truth = control.StateSpace(*_roll(ROLL, None))
    rng = np.random.default_rng(5)
    std = 0.01 + 0.02 * omega / omega[-1]
    deviations = []
    for _ in range(20):
        noise = rng.normal(size=(2, omega.size)) * std / np.sqrt(2.0)
        measured = np.reshape(truth(1j * omega) + noise[0] + 1j * noise[1], (1, 1, -1))
        data = control.FrequencyResponseData(measured, omega)
        system, estimate = fit_frequency_response_data(
            ROLL_MODEL, data, np.reshape(std, (1, 1, -1))
        )
        deviations.append(deviate(estimate, ROLL))
    _check_coverage(np.array(deviations))
    assert isinstance(system, control.StateSpace)
    assert (system.input_labels, system.output_labels) == (["aileron"], ["p"])
    np.testing.assert_allclose(system.A, truth.A, atol=1.0)
    np.testing.assert_allclose(system.A, estimate.matrices.A)


def test_data_of_other_channels_are_refused() -> None:
    data = control.FrequencyResponseData(np.ones((2, 1, 5), dtype=complex), np.arange(1.0, 6.0))
    with pytest.raises(BadInput, match="2 outputs and 1 inputs"):
        fit_frequency_response_data(ROLL_MODEL, data)


@pytest.mark.parametrize(
    ("returned", "message"),
    [
        (([[1.0]], [[1.0]], [[1.0]]), "must return A, B, C, D"),
        (([[1.0, 2.0]], [[1.0]], [[1.0]], [[0.0]]), "A of 'Bad' is 1 x 2; expected 1 x 1"),
        (([[1.0], [1.0, 2.0]], [[1.0]], [[1.0]], [[0.0]]), "rows of different lengths"),
        (([[1j]], [[1.0]], [[1.0]], [[0.0]]), "complex A"),
        (([["a"]], [[1.0]], [[1.0]], [[0.0]]), "no number"),
    ],
)
def test_matrices_that_are_none_are_refused(returned: Any, message: str) -> None:
    model = GreyBox(
        title="Bad",
        matrices=lambda p, condition: returned,
        parameters=[Parameter("a", 1.0)],
        inputs={"u": ""},
        outputs={"y": ""},
    )
    with pytest.raises(BadInput, match=message):
        model.evaluate(model.starts, None)
