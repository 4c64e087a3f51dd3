"""Exact sensitivities and the normal matrix that needs no Jacobian."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from tests.sysid.conftest import add_noise

from flexsid.sysid.estimation import covariance as jackknife
from flexsid.sysid.estimation.end_states import add_end_states, list_end_state_names
from flexsid.sysid.estimation.experiment import select_parameters
from flexsid.sysid.estimation.frequency_domain_model import FrequencyDomainModel
from flexsid.sysid.estimation.kronecker import NormalForm
from flexsid.sysid.estimation.noise import SpectralMatrix

EXTRA_VALUES = {
    **{"delay_q": 0.004, "delay_alpha": -0.002, "scale_alpha": 1.1},
    **{"omega_7": 1.05, "zeta_9": 0.9, "shape_az_cf_7": 1.2},
    **{"shape_error_az_cf_9": 0.1, "shape_error_alpha_7": -0.2, "rotation_error_alpha_7": 0.3},
}


@pytest.fixture(params=["whole maneuver", "begun and ended in motion"])
def line_model(make_case, request):
    case = make_case(2, n_outputs=8)
    u, y = case.spectra(1)
    z = add_noise(y, 0.05, np.random.default_rng(2))
    experiment = case.experiment(u, z)
    if request.param == "whole maneuver":
        parameters = case.free(tuple(EXTRA_VALUES), off=0.2)
        values = list(EXTRA_VALUES.values())
    else:
        structural = "omega_7", "zeta_9", "shape_az_cf_7"
        extras = [name for name in EXTRA_VALUES if name not in structural]
        experiment = replace(experiment, edges_s=(0.7, 31.0), first_end=1)
        parameters = add_end_states(case.free(tuple(extras), off=0.2), [experiment])
        n_ends = len(list_end_state_names(parameters))
        states = np.random.default_rng(8).uniform(-1.0, 1.0, n_ends)
        values = [*(EXTRA_VALUES[name] for name in extras), *states]
    theta = parameters.start.copy()
    theta[-len(values) :] = values
    return FrequencyDomainModel(experiment, parameters), theta


def test_sensitivities_equal_differences(line_model):
    model, theta = line_model
    J = model.jacobian(model.sensitivity(theta, model.respond(theta)))
    for index, name in enumerate(model.parameters.names):
        step = 1e-4 * max(abs(theta[index]), 1e-2)
        shift = step * np.eye(theta.size)[index]

        def at(times: float, shift: np.ndarray = shift) -> np.ndarray:
            return model.respond(theta + times * shift).outputs

        # Fourth order, so that the difference is good to 1e-8.
        difference = (8 * (at(1) - at(-1)) - (at(2) - at(-2))) / (12 * step)
        size = np.abs(difference).max()
        assert np.abs(J[:, :, index] - difference).max() < 1e-8 * size, name


@pytest.mark.parametrize("kind", ["diagonal", "full"])
def test_normal_matrix_equals_the_explicit_one(line_model, kind):
    model, theta = line_model
    response = model.respond(theta)
    sensitivity = model.sensitivity(theta, response)
    nu = model.experiment.measured - response.outputs
    n_frequencies, n_y = nu.shape
    rng = np.random.default_rng(3)
    if kind == "diagonal":
        weights = rng.uniform(0.5, 2.0, size=(n_frequencies, n_y))
        matrices = weights[:, :, None] * np.eye(n_y)
    else:
        half = rng.normal(size=(n_frequencies, n_y, n_y)) + 1j * rng.normal(
            size=(n_frequencies, n_y, n_y)
        )
        weights = matrices = half @ half.conj().transpose(0, 2, 1) + np.eye(n_y)
    N, g = NormalForm(model).equations(
        sensitivity, nu, SpectralMatrix(weights, np.arange(n_frequencies))
    )
    J = model.jacobian(sensitivity)
    N_explicit = np.real(np.einsum("kyi,kyx,kxj->ij", J.conj(), matrices, J))
    g_explicit = np.real(np.einsum("kyi,kyx,kx->i", J.conj(), matrices, nu))
    scale = np.sqrt(np.diag(N_explicit))
    assert np.abs((N - N_explicit) / np.outer(scale, scale)).max() < 1e-12
    assert np.abs((g - g_explicit) / scale).max() < 1e-12 * np.abs(g_explicit / scale).max()


def test_products_with_other_columns_and_leverages_equal_the_explicit_ones(line_model):
    model, theta = line_model
    sensitivity = model.sensitivity(theta, model.respond(theta))
    J = model.jacobian(sensitivity)
    rng = np.random.default_rng(7)
    blocks = rng.uniform(0.5, 2.0, size=(1, J.shape[1]))
    weights = SpectralMatrix(blocks, np.zeros(len(J), dtype=int))
    X = rng.normal(size=(*J.shape[:2], 3)) + 1j * rng.normal(size=(*J.shape[:2], 3))
    explicit = np.real(np.einsum("kyi,y,kyj->ij", J.conj(), blocks[0], X))
    cross = NormalForm(model).cross(sensitivity, X, weights)
    assert np.abs(cross - explicit).max() < 1e-12 * np.abs(explicit).max()

    half = rng.normal(size=(theta.size, theta.size))
    inverse = half @ half.T / np.outer(*2 * [np.linalg.norm(J, axis=(0, 1))])
    explicit = np.real(np.einsum("kyi,ij,kyj->ky", J, inverse, J.conj()))
    leverage = jackknife.compute_leverage(model, sensitivity, inverse)
    assert np.abs(leverage / explicit - 1.0).max() < 1e-10


def test_gradients_of_single_outputs_add_up(line_model):
    model, theta = line_model
    response = model.respond(theta)
    sensitivity = model.sensitivity(theta, response)
    nu = model.experiment.measured - response.outputs
    blocks = np.random.default_rng(4).uniform(0.5, 2.0, size=(2, nu.shape[1]))
    weights = SpectralMatrix(blocks, (np.arange(len(nu)) >= 20).astype(int))
    form = NormalForm(model)
    _, g = form.equations(sensitivity, nu, weights)
    parts = form.output_gradients(sensitivity, nu, weights)
    assert np.allclose(parts.sum(axis=(0, 2)), g, rtol=1e-10, atol=1e-10 * np.abs(g).max())


def test_how_a_full_density_follows_equals_differences(line_model):
    model, theta = line_model
    response = model.respond(theta)
    n_frequencies = model.experiment.omega.size
    measured, group = model.experiment.measured, (np.arange(n_frequencies) >= 20).astype(int)

    def density(at: np.ndarray) -> list[np.ndarray]:
        nu = measured - model.respond(at).outputs
        return [nu[group == g].T @ nu[group == g].conj() for g in range(2)]

    rng = np.random.default_rng(6)
    half = rng.normal(size=(2, *response.outputs.shape[1:] * 2))
    blocks = half @ half.transpose(0, 2, 1) + np.eye(half.shape[1])
    weights = SpectralMatrix(blocks.astype(complex), group)
    sensitivity = model.sensitivity(theta, response)
    nu = measured - response.outputs
    parts = NormalForm(model).matrix_gradients(sensitivity, nu, weights)
    for index in range(theta.size):
        step = 1e-5 * max(abs(theta[index]), 1e-2)
        shift = step * np.eye(theta.size)[index]
        for part, W, after, before in zip(
            parts, blocks, density(theta + shift), density(theta - shift), strict=True
        ):
            whitener = np.linalg.cholesky(W).T
            expected = -whitener @ (after - before) @ whitener.T / (4.0 * step)
            found = part[index].view(complex).reshape(expected.shape)
            assert np.abs(found - expected).max() < 1e-5 * np.abs(expected).max()


@pytest.mark.parametrize("free", [None, ("Cm_q", "CQ9_eta7", "CZ_alpha", "CQ7_etadot9")])
def test_leave_one_out_residuals_equal_those_of_fits_without_the_frequency(
    make_case, monkeypatch, free
):
    monkeypatch.setattr(jackknife, "_LARGEST_LEVERAGE", 1.0)
    case = make_case(2, airspeed_ratio=1.04, n_outputs=8)
    u, y = case.spectra(1)
    z = add_noise(y, 0.05, np.random.default_rng(2))
    parameters = select_parameters(case.truth, free, case.model.outputs, ("omega_7",))
    model = FrequencyDomainModel(case.experiment(u, z), parameters)
    response = model.respond(parameters.start)
    sensitivity = model.sensitivity(parameters.start, response)
    J, nu = model.jacobian(sensitivity).copy(), z - response.outputs
    weights = 1.0 / np.mean(np.abs(nu) ** 2, axis=0)
    own = np.real(np.einsum("kyi,y,kyj->kij", J.conj(), weights, J))
    score = np.real(np.einsum("kyi,y,ky->ki", J.conj(), weights, nu))
    N = own.sum(axis=0) + 1e-3 * np.diag(np.diag(own.sum(axis=0)))
    expected = [nu[k] + J[k] @ np.linalg.solve(N - own[k], score[k]) for k in range(len(nu))]
    W = SpectralMatrix(weights[None], np.zeros(len(nu), dtype=int))
    found = jackknife.compute_leave_one_out_residuals(model, sensitivity, nu, W, np.linalg.inv(N))
    assert np.abs(found - expected).max() < 1e-8 * np.abs(nu).max()
