"""Derivatives with a frequency shape: sensitivities, estimators, poles and flutter."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from lateral_flying_wing import condition_at, derivatives_at, modes_at, needs_records

from flexsid.errors import BadInput
from flexsid.sysid.estimation.experiment import select_parameters
from flexsid.sysid.estimation.frequency_domain_model import FrequencyDomainModel
from flexsid.sysid.estimation.kronecker import NormalForm
from flexsid.sysid.estimation.likelihood import maximize
from flexsid.sysid.estimation.noise import SpectralMatrix
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.derivatives import list_derivative_names
from flexsid.sysid.model.frequency_shape import FrequencyShape, build_frequency_shape
from flexsid.sysid.model.lateral import LATERAL
from flexsid.sysid.model.longitudinal import LONGITUDINAL
from flexsid.sysid.model.rigid_body import SensorRows
from flexsid.sysid.regression.equation_error import equation_error
from flexsid.sysid.regression.reconstruction import reconstruct_motion
from flexsid.sysid.signals import FrequencyData
from flexsid.sysid.stability.poles import Aeroelastic, compute_named_poles
from flexsid.sysid.stability.root_errors import UncertainDerivatives, estimate_crossing_error
from flexsid.sysid.stability.root_tracking import find_rational_crossing, track_roots

K = np.linspace(0.0, 2.5, 40)


def lag(
    modes: tuple[int, ...], inputs: tuple[str, ...], body=LONGITUDINAL, rates=(0.25, 0.6)
) -> FrequencyShape:
    """Forces that lag by a circulation with another time constant in every entry."""
    names = list_derivative_names(modes, inputs, body)
    every = np.linspace(rates[0], rates[1], len(names))
    p = 1j * K
    predicted = {n: 1.0 - 0.4 * p / (p + g) for n, g in zip(names, every, strict=True)}
    return build_frequency_shape(modes, inputs, K, predicted, 0.2, body)


@pytest.fixture
def shaped(make_case):
    case = make_case(2)
    model = replace(case.model, shape=lag(case.truth.modes, case.truth.inputs))
    return replace(case, model=model)


def test_factors_are_one_at_the_reference_and_refused_beyond_the_prediction(shaped):
    shape = shaped.model.shape
    assert np.allclose(shape.at(np.array([0.2])).real, 1.0)
    fewer = shape.select(shape.modes[:1], shape.inputs)
    assert np.allclose(fewer.factors[:, 2, 2], shape.factors[:, 2, 2])
    assert shape.select((*shape.modes, 99), shape.inputs).unshaped == tuple(
        name for name in list_derivative_names((*shape.modes, 99), shape.inputs) if "99" in name
    )
    with pytest.raises(BadInput, match="reduced frequency") as refused:
        shape.at(np.array([2.6]))
    assert refused.value.code == "frequency-out-of-range"


def test_derivatives_near_zero_at_the_reference_have_a_factor_of_one():
    shape = build_frequency_shape(
        (), ("bfs",), K, {"CZ_q": K - 0.2 + 0j, "CZ_alpha": 1 + 0j * K}, 0.2
    )
    assert "CZ_q" in shape.unshaped
    assert "CZ_alpha" not in shape.unshaped
    assert (shape.factors[:, 0, 1] == 1.0).all()


def test_sensitivities_are_those_of_finite_differences(shaped):
    u, z = shaped.spectra(0)
    parameters = shaped.free(("delay_q", f"omega_{shaped.truth.modes[0]}"), off=0.1)
    model = FrequencyDomainModel(shaped.experiment(u, z), parameters)
    theta = parameters.start
    response = model.respond(theta)
    assert np.allclose(
        response.motion,
        (
            shaped.model.motion(parameters.table(theta), shaped.experiment(u, z).omega)
            @ u[..., None]
        )[..., 0],
    )
    J = model.jacobian(model.sensitivity(theta, response))
    for k in range(theta.size):
        step = np.zeros(theta.size)
        step[k] = 1e-6 * max(abs(theta[k]), 1e-3)
        change = model.respond(theta + step).outputs - model.respond(theta - step).outputs
        expected = change / (2.0 * step[k])
        assert np.allclose(J[:, :, k], expected, rtol=1e-4, atol=1e-5 * np.abs(expected).max())


def test_normal_equations_are_those_of_the_jacobian(shaped):
    u, z = shaped.spectra(0)
    parameters = shaped.free(("delay_q",), off=0.1)
    model = FrequencyDomainModel(shaped.experiment(u, z), parameters)
    response = model.respond(parameters.start)
    sensitivity = model.sensitivity(parameters.start, response)
    residuals = z - response.outputs
    n_y = z.shape[1]
    rng = np.random.default_rng(1)
    half = rng.normal(size=(n_y, n_y)) + 1j * rng.normal(size=(n_y, n_y))
    W = half @ half.conj().T + n_y * np.eye(n_y)
    weights = SpectralMatrix(W[None], np.zeros(len(z), dtype=int))
    N, g = NormalForm(model).equations(sensitivity, residuals, weights)
    J = model.jacobian(sensitivity)
    assert np.allclose(N, np.real(np.einsum("kyp,yx,kxq->pq", J.conj(), W, J)), rtol=1e-9)
    assert np.allclose(g, np.real(np.einsum("kyp,yx,kx->p", J.conj(), W, residuals)), rtol=1e-9)


def test_a_shape_of_one_gives_the_estimate_of_the_quasi_steady_model(make_case):
    case = make_case(2)
    u, z = case.spectra(3)
    noisy = z + 0.01 * np.abs(z).mean(axis=0) * np.random.default_rng(4).normal(size=z.shape)
    names = list_derivative_names(case.truth.modes, case.truth.inputs)
    one = dict.fromkeys(names, np.ones(K.size, dtype=complex))
    flat = build_frequency_shape(case.truth.modes, case.truth.inputs, K, one, 0.0)
    found = [
        maximize(
            [replace(case, model=replace(case.model, shape=s)).experiment(u, noisy)], case.free()
        )
        for s in (None, flat)
    ]
    assert np.allclose(found[0].values, found[1].values, rtol=1e-8)
    assert np.allclose(found[0].std_errors, found[1].std_errors, rtol=1e-6)


def test_estimates_are_within_their_standard_errors(shaped):
    """Output error and equation error, 25 sequences of noise."""
    z_scores: dict[str, list[np.ndarray]] = {"OE": [], "EE": []}
    truth = shaped.truth.values.ravel()
    for seed in range(25):
        u, z = shaped.spectra(seed)
        rng = np.random.default_rng(1000 + seed)
        level = 0.02 * np.sqrt(np.mean(np.abs(z) ** 2, axis=0) / 2.0)
        noisy = z + level * (rng.normal(size=z.shape) + 1j * rng.normal(size=z.shape))
        experiment = shaped.experiment(u, noisy)
        parameters = shaped.free(off=0.1, seed=seed)
        likely = maximize([experiment], parameters)
        z_scores["OE"].append((likely.values - truth) / likely.std_errors)
        motion = reconstruct_motion(
            shaped.model,
            FrequencyData(experiment.omega, noisy, shaped.model.outputs),
            experiment.instruments,
        )
        inputs = FrequencyData(experiment.omega, u, shaped.model.inputs)
        regressed = equation_error(shaped.model, motion, inputs, parameters)
        z_scores["EE"].append((regressed.values - truth) / regressed.std_errors)
    for method, scores in z_scores.items():
        assert 0.92 <= np.mean(np.abs(scores) < 2.0) <= 0.99, method


def test_rational_functions_have_the_response_of_the_frequency_domain(shaped):
    omega = 2.0 * np.pi * np.linspace(0.3, 12.0, 30)
    system = shaped.model.state_space(shaped.truth)
    s = 1j * omega[:, None, None]
    inside = np.linalg.solve(s * np.eye(len(system.A)) - system.A, system.B[None] + 0j * s)
    response = system.C @ inside + system.D
    exact = shaped.model.response(shaped.truth, omega)
    error = np.linalg.norm(response - exact, axis=0) / np.linalg.norm(exact, axis=0)
    assert error.max() < 0.01


def test_poles_and_their_slopes_are_those_of_the_state_matrix(shaped):
    parameters = shaped.free()
    covariance = np.zeros((parameters.start.size,) * 2)
    place = parameters.names.index("Cm_alpha")
    covariance[place, place] = 1.0
    names = tuple(str(m) for m in shaped.truth.modes)

    def poles(theta):
        return compute_named_poles(shaped.model, parameters, theta, covariance, names)

    step = np.zeros(parameters.start.size)
    step[place] = 1e-5
    found = poles(parameters.start)
    assert [pole.name for pole in found] == ["SP", *names]
    for pole, up, down in zip(
        found, poles(parameters.start + step), poles(parameters.start - step), strict=True
    ):
        slope = (up.value - down.value) / 2e-5
        close = 2e-3 * abs(slope)
        assert pole.real_std == pytest.approx(abs(slope.real), abs=close)
        assert pole.imag_std == pytest.approx(abs(slope.imag), abs=close)


def test_flutter_agrees_with_rational_functions_and_its_error_with_differences(shaped):
    model, table = shaped.model, shaped.truth
    aircraft = Aeroelastic(model.condition, model.modes, table, model.shape)
    airspeed = np.linspace(20.0, 110.0, 46)
    locus = track_roots(aircraft, airspeed)
    crossing = locus.flutter
    assert crossing is not None
    condition = replace(model.condition, airspeed=crossing.airspeed)
    A = replace(model, condition=condition).state_space(table).A
    roots = np.linalg.eigvals(A)
    nearest = roots[np.argmin(np.abs(roots - 1j * crossing.frequency))]
    # Zero damping to the accuracy of trim, which the model takes from its own condition.
    assert abs(nearest - 1j * crossing.frequency) < 0.005 * crossing.frequency
    row, column = np.array([2]), np.array([2])
    uncertain = UncertainDerivatives(row, column, np.array([[1.0]]))
    std = estimate_crossing_error(aircraft, crossing, uncertain)

    def speed(change: float) -> float:
        values = table.values.copy()
        values[2, 2] += change
        moved = replace(aircraft, derivatives=replace(table, values=values))
        found = track_roots(moved, airspeed).flutter
        assert found is not None
        return found.airspeed

    assert std == pytest.approx(abs(speed(1e-4) - speed(-1e-4)) / 2e-4, rel=1e-3)


@needs_records
def test_lateral_motion_has_responses_and_poles():
    table, blind = derivatives_at(0.5, 2), SensorRows((), np.zeros((4, 0, 5)))
    # One of the lags of the rational functions, so that these are exact.
    shape = lag(table.modes, table.inputs, LATERAL, rates=(0.3, 0.3))
    model = AeroelasticModel(
        condition_at(126.5, 0.5, 60.0), modes_at(0.5, 2), table.inputs, blind, LATERAL, shape
    )
    omega = 2.0 * np.pi * np.linspace(0.3, 10.0, 20)
    system, motion = model.state_space(table), model.motion(table, omega)
    eye = np.eye(len(system.A))
    inside = np.linalg.solve(1j * omega[:, None, None] * eye - system.A, system.B[None] + 0j)
    states = [system.states.index(name) for name in model.motions]
    error = np.linalg.norm(inside[:, states] - motion, axis=0)
    assert (error < 0.01 * np.linalg.norm(motion, axis=0)).all()

    parameters = select_parameters(table, None, ())
    place = parameters.names.index("Cn_beta")
    covariance = np.zeros((parameters.start.size,) * 2)
    covariance[place, place] = 1.0
    step = 1e-5 * np.eye(parameters.start.size)[place]
    found, up, down = (
        compute_named_poles(model, parameters, theta, covariance, ("8", "10"))
        for theta in (parameters.start, parameters.start + step, parameters.start - step)
    )
    assert [pole.name for pole in found] == [*LATERAL.poles, "8", "10"]
    for pole, above, below in zip(found, up, down, strict=True):
        slope = (above.value - below.value) / 2e-5
        assert pole.real_std == pytest.approx(abs(slope.real), abs=2e-3 * abs(slope))

    with pytest.raises(BadInput) as refused:
        replace(model, shape=lag(table.modes, table.inputs))
    assert refused.value.code == "shape-of-other-model"


@needs_records
def test_lateral_flutter_with_unit_factors_is_quasi_steady_and_with_lags_that_of_their_states():
    table = derivatives_at(0.5, 2)
    known = Aeroelastic(condition_at(126.5, 0.5, 60.0), modes_at(0.5, 2), table)
    airspeed = 0.3048 * np.linspace(150.0, 400.0, 60)
    steady = track_roots(known, airspeed).flutter
    assert steady is not None
    # Trimmed where it flutters, which both methods then share.
    there = condition_at(steady.airspeed / 0.3048, 0.5, 60.0)
    constant = lag(table.modes, table.inputs, LATERAL)
    constant = replace(constant, factors=np.ones_like(constant.factors))
    found = track_roots(replace(known, condition=there, shape=constant), airspeed).flutter
    assert found is not None
    assert found.airspeed == pytest.approx(steady.airspeed, rel=1e-6)
    assert found.frequency == pytest.approx(steady.frequency, rel=1e-6)
    # Shares of coordinates here, of states there.
    assert found.participation == pytest.approx(steady.participation, abs=0.1)

    shaped = replace(known, shape=lag(table.modes, table.inputs, LATERAL, rates=(0.3, 0.3)))
    locus = track_roots(shaped, airspeed)
    assert "DR" in locus.names
    crossing = locus.flutter
    assert crossing is not None
    assert abs(crossing.airspeed / steady.airspeed - 1.0) > 0.01
    by_states = find_rational_crossing(shaped, crossing, known.condition.density)
    assert by_states == pytest.approx((crossing.airspeed, crossing.frequency), rel=1e-4)

    for row, column in ((3, 3), (1, 1), (2, 2)):  # CQ8_eta8, Cl_p, Cn_r
        place = np.array([row]), np.array([column])
        uncertain = UncertainDerivatives(*place, np.array([[1.0]]))
        std = estimate_crossing_error(shaped, crossing, uncertain)
        step = 1e-3 * abs(table.values[row, column])
        ends = []
        for change in (step, -step):
            values = table.values.copy()
            values[row, column] += change
            moved = replace(shaped, derivatives=replace(table, values=values))
            flutter = track_roots(moved, airspeed).flutter
            assert flutter is not None
            ends.append(flutter.airspeed)
        assert std == pytest.approx(abs(ends[0] - ends[1]) / (2.0 * step), rel=2e-3)

    other = replace(known, shape=lag(table.modes, table.inputs))
    with pytest.raises(BadInput) as refused:
        track_roots(other, airspeed)
    assert refused.value.code == "shape-of-other-model"
