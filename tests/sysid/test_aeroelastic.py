"""One model for all estimators: its response, its state space, its names."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from flexsid.errors import BadInput
from flexsid.sysid.model.derivatives import list_derivative_names, parse_derivative

FOOT = 0.3048


@pytest.mark.parametrize(
    ("speed_ft_s", "published"),
    [
        (126.7, [-4.281 + 9.610j, -2.956 + 22.216j, -2.855 + 65.385j, -1.935 + 84.144j]),
        (212.4, [0.959 + 18.689j, -14.401 + 17.965j, -2.372 + 60.535j, -2.352 + 83.642j]),
    ],
)
def test_eigenvalues_are_those_of_the_design_notes(make_case, speed_ft_s, published):
    case = make_case(4, airspeed_ratio=speed_ft_s / 194.60)
    poles = np.linalg.eigvals(case.model.state_space(case.truth).A)
    for pole in published:
        assert np.min(np.abs(poles - pole)) < 0.002 * abs(pole)


@pytest.mark.parametrize("n_modes", [0, 1, 4])
def test_response_is_that_of_the_state_space_in_python_control(make_case, n_modes):
    case = make_case(n_modes, n_outputs=25)
    omega = np.array([1.5, 12.0, 20.0, 67.0, 90.0])
    system = case.model.state_space(case.truth).to_control()
    expected = np.moveaxis(system(1j * omega), -1, 0)
    response = case.model.response(case.truth, omega)
    scale = np.abs(expected).max(axis=(0, 2))[:, None] + 1e-12
    assert np.max(np.abs(response - expected) / scale) < 1e-9


@pytest.mark.parametrize("airspeed_ratio", [0.65, 1.1])
@pytest.mark.parametrize("equal", [False, True])
def test_outputs_for_inputs_are_responses_times_inputs(make_case, airspeed_ratio, equal):
    """Also above the flutter speed, and with two equal poles, which have one eigenvector."""
    case = make_case(2, airspeed_ratio=airspeed_ratio, n_outputs=25)
    truth = replace(case.truth, values=np.zeros_like(case.truth.values)) if equal else case.truth
    omega = np.linspace(0.5, 300.0, 200)
    u = np.exp(1j * np.outer(omega, np.arange(len(case.model.inputs))))
    expected = np.einsum("kyu,ku->ky", case.model.response(truth, omega), u)
    found = case.model.respond(truth, omega, u)
    assert np.max(np.abs(found - expected) / (np.abs(expected).max(axis=0) + 1e-12)) < 1e-9


def test_state_matrices_are_affine_in_the_derivatives(make_case):
    case = make_case(2)
    one, other = case.truth.values, 0.3 * case.truth.values[::-1]

    def matrices(values: np.ndarray) -> np.ndarray:
        table = type(case.truth)(case.truth.modes, case.truth.inputs, values)
        system = case.model.state_space(table)
        return np.hstack([system.A, system.B])

    middle = 0.25 * matrices(one) + 0.75 * matrices(other)
    assert np.allclose(matrices(0.25 * one + 0.75 * other), middle, atol=1e-9)


@pytest.mark.parametrize(("n", "count"), [(0, 14), (1, 27), (2, 44), (3, 65), (4, 90)])
def test_number_of_derivatives_is_the_papers(n, count):
    names = list_derivative_names(tuple(range(7, 7 + n)), ("a", "b", "c", "d", "e"))
    assert len(names) == len(set(names)) == count
    assert all("_".join(parse_derivative(name)) == name for name in names)


def test_what_is_no_derivative_is_refused_with_what_would_be():
    with pytest.raises(BadInput, match="CQ7_etadot9"):
        parse_derivative("lift")
