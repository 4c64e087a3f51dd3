"""Closed loops against python-control, equivalent modes against what they were made of."""

from __future__ import annotations

from dataclasses import astuple, replace
from typing import Any

import control
import numpy as np
import pytest

from flexsid.demo.flex28 import load_truth
from flexsid.errors import BadInput, NotIdentifiable
from flexsid.sysid.model.aeroelastic import StateSpace
from flexsid.sysid.model.sensor_models import Instrument, SecondOrder
from flexsid.sysid.stability.closed_loop import (
    Loop,
    close_loop,
    compute_digital_margins,
    evaluate_loop_point,
    frequency_response,
)
from flexsid.sysid.stability.margins import (
    compute_broken_loops,
    compute_margins,
    estimate_margin_errors,
)
from flexsid.sysid.stability.order import compute_equivalent_modes, fit_in_vacuo_mode
from flexsid.sysid.stability.poles import Aeroelastic
from flexsid.sysid.stability.root_errors import UncertainDerivatives

OMEGA = np.geomspace(0.5, 150.0, 4000)


def controller(gain: float, *surfaces: str) -> StateSpace:
    """Pitch rate, lagged by 20 rad/s, fed back to surfaces."""
    n = len(surfaces)
    return StateSpace(
        A=np.array([[-20.0]]),
        B=np.array([[20.0]]),
        C=np.full((n, 1), gain),
        D=np.zeros((n, 1)),
        states=("lag",),
        inputs=("q",),
        outputs=surfaces,
    )


@pytest.fixture
def plant(make_case) -> StateSpace:
    case = make_case(2)
    return case.model.state_space(case.truth)


def loop_gain(plant: StateSpace, law: StateSpace, omega: np.ndarray) -> np.ndarray:
    driven = [plant.inputs.index(name) for name in law.outputs]
    G = frequency_response(plant, omega)[:, [plant.outputs.index("q")]]
    return frequency_response(law, omega) @ G[:, :, driven]


def siso(plant: StateSpace) -> control.StateSpace:
    system = plant.to_control()
    return system[plant.outputs.index("q"), plant.inputs.index("wf3s")]


def test_closed_loop_poles_are_those_of_python_control(plant):
    law = controller(0.4, "wf3s")
    ours = np.sort_complex(np.linalg.eigvals(close_loop(plant, law).A))
    around: Any = law.to_control()  # which the stubs take for a number
    theirs = control.poles(siso(plant).feedback(around, 1))
    assert np.allclose(ours, np.sort_complex(theirs), atol=1e-8)


@pytest.mark.parametrize("feedback", [0.4, -0.15])
def test_margins_are_those_of_the_transfer_function(plant, feedback):
    """Its polynomials, in python-control, need no frequencies."""
    law = controller(feedback, "wf3s")
    found = compute_margins(OMEGA, compute_broken_loops(loop_gain(plant, law, OMEGA))[:, 0])
    with np.errstate(invalid="ignore"):  # python-control compares where it found nothing
        gain, phase, modulus, *_ = control.stability_margins(-law.to_control() * siso(plant))
    assert found.gain == pytest.approx(gain, rel=1e-5)
    assert found.phase == pytest.approx(np.deg2rad(abs(phase)), rel=1e-5)
    assert found.modulus == pytest.approx(modulus, rel=1e-4)
    assert found.gain_up >= found.gain
    assert 0.0 < found.disk < 2.0


def test_a_loop_has_the_same_margins_before_flight_and_over_airspeed(make_case):
    """A digital law delays by a sample and a half."""
    case = make_case(2)
    servo = Instrument(elements=(SecondOrder(natural_frequency=62.0, damping=0.75),), delay_s=0.01)
    loop = Loop(law=controller(0.2, "wf3s", "wf4s"), actuators=(servo, servo), delay_s=0.02)
    before = compute_digital_margins(case.model.state_space(case.truth), loop, 100.0)
    late = replace(loop, delay_s=0.02 + 0.015)
    over = evaluate_loop_point(case.model, case.truth, (), late, (0.3, 150.0)).margins
    for digital, swept in zip(before, over, strict=True):
        np.testing.assert_allclose(astuple(digital), astuple(swept), rtol=5e-3)


def test_margins_of_samples_scatter_by_what_their_loops_do(plant):
    """A factor on a loop is one on its gain margin, and a rotation one of its phase margin."""
    L = compute_broken_loops(loop_gain(plant, controller(0.4, "wf3s"), OMEGA))
    rng = np.random.default_rng(0)
    gains, turns = rng.normal(0.0, 0.01, 40), rng.normal(0.0, 0.01, 40)
    scaled = estimate_margin_errors(np.exp(gains)[:, None, None] * L)
    turned = estimate_margin_errors(np.exp(1j * turns)[:, None, None] * L)
    assert scaled[0, 0] == pytest.approx(gains.std(), rel=1e-2)
    assert turned[1, 0] == pytest.approx(turns.std(), rel=1e-2)


def test_a_loop_broken_at_one_surface_leaves_the_others_closed(plant):
    law = controller(0.2, "wf3s", "wf4s")
    omega = np.array([2.0, 15.0, 60.0])
    both = compute_broken_loops(loop_gain(plant, law, omega))
    inner = close_loop(plant, controller(0.2, "wf4s"))
    lone = compute_broken_loops(loop_gain(inner, controller(0.2, "wf3s"), omega))
    assert np.allclose(both[:, 0], lone[:, 0], rtol=1e-8)


def test_a_controller_of_another_aircraft_is_refused(plant):
    with pytest.raises(BadInput, match="drives 'elevator'"):
        close_loop(plant, controller(0.1, "elevator"))


def test_lines_over_dynamic_pressure_return_the_structure_and_its_derivatives():
    truth = load_truth()
    rng = np.random.default_rng(4)
    n = 4
    rows, columns = (x.ravel() for x in np.indices((2 + n, 2 + 2 * n)))
    table = truth.derivatives_at(0.5, n)
    sigma = 0.01 * np.maximum(np.abs(table.values[rows, columns]), 0.02)
    modes = truth.modes_at(0.5, n)
    points: list[list] = [[] for _ in range(n)]
    for ratio in (0.56, 0.65, 0.72, 0.80, 0.95):
        values = table.values.copy()
        values[rows, columns] += sigma * rng.normal(size=sigma.size)
        aircraft = Aeroelastic(
            truth.condition_at(ratio * 59.3, 0.5), modes, replace(table, values=values)
        )
        for k, found in enumerate(
            compute_equivalent_modes(
                aircraft, UncertainDerivatives(rows, columns, np.diag(sigma**2))
            )
        ):
            points[k].append(found)
    for k, number in enumerate(modes.numbers):
        line = fit_in_vacuo_mode(points[k], truth.area, truth.chord, float(modes.mass[k]))
        assert line.mode == number
        for value, std, true in (
            (line.omega, line.omega_std, modes.omega[k]),
            (line.zeta, line.zeta_std, modes.zeta[k]),
            (line.stiffness_derivative, line.stiffness_derivative_std, table.values[2 + k, 2 + k]),
            (
                line.damping_derivative,
                line.damping_derivative_std,
                table.values[2 + k, 2 + n + k],
            ),
        ):
            assert abs(value - true) < 4.0 * std
    assert points[0][0].omega == pytest.approx(np.sqrt(points[0][0].stiffness))
    with pytest.raises(NotIdentifiable, match="three"):
        fit_in_vacuo_mode(points[0][:2], truth.area, truth.chord, 1.0)
    with pytest.raises(NotIdentifiable, match="one condition"):
        fit_in_vacuo_mode([points[0][0]] * 3, truth.area, truth.chord, 1.0)
