"""Posterior samples: against known densities, numerical integration and a linear model."""

from __future__ import annotations

import numpy as np
import pytest
from tests.sysid.conftest import Case

from flexsid.errors import NotIdentifiable
from flexsid.sysid.adequacy.posterior import (
    compute_sample_size,
    compute_scale_reduction,
    sample_density,
    sample_posterior,
)
from flexsid.sysid.estimation.experiment import Experiment, Parameters, select_parameters
from flexsid.sysid.estimation.frequency_domain_model import FrequencyDomainModel
from flexsid.sysid.estimation.likelihood import maximize


def measure(case: Case, level: float) -> Experiment:
    rng = np.random.default_rng(0)
    u, z = case.spectra(0)
    size = level * np.sqrt(np.mean(np.abs(z) ** 2, axis=0))
    return case.experiment(u, z + size * (rng.normal(size=z.shape) + 1j * rng.normal(size=z.shape)))


def free(case: Case, *names: str) -> Parameters:
    return select_parameters(case.truth, names, case.model.outputs)


def test_a_gaussian_density_has_its_standard_deviation():
    found = sample_density(lambda x: (0.5 * float(x @ x), x), 20, n_samples=250)
    assert found.acceptance == pytest.approx(1.0, abs=1e-9), "its motion is exact"
    assert found.values.std(axis=(0, 1)) == pytest.approx(np.ones(20), abs=0.1)
    assert compute_scale_reduction(found.values).max() < 1.02
    assert compute_sample_size(found.values).min() > 500.0


def test_a_skewed_density_has_the_moments_of_its_integral():
    """Two dimensions, a banana: moments against a sum over a grid."""

    def energy(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        return 0.5 * x**2 + (y + 0.5 * (x**2 - 1.0)) ** 2

    def potential(x: np.ndarray) -> tuple[float, np.ndarray]:
        bend = 2.0 * (x[1] + 0.5 * (x[0] ** 2 - 1.0))
        gradient = [x[0] * (1.0 + bend), bend]
        return float(energy(x[0], x[1])), np.array(gradient)

    found = sample_density(potential, 2, n_samples=2000).values.reshape(-1, 2)
    x, y = np.meshgrid(np.linspace(-5, 5, 801), np.linspace(-16, 6, 801), indexing="ij")
    p = np.exp(-energy(x, y))
    p /= p.sum()
    mean = np.array([(p * x).sum(), (p * y).sum()])
    std = np.sqrt([(p * x**2).sum() - mean[0] ** 2, (p * y**2).sum() - mean[1] ** 2])
    assert found.mean(axis=0) == pytest.approx(mean, abs=0.1)
    assert found.std(axis=0) == pytest.approx(std, rel=0.1)


def test_chains_that_do_not_mix_are_found():
    rng = np.random.default_rng(0)
    values = rng.normal(size=(4, 100, 1)) + np.array([0.0, 0.0, 3.0, 0.0])[:, None, None]
    walk = np.cumsum(rng.normal(size=(4, 100, 1)), axis=1)
    assert compute_scale_reduction(values)[0] > 1.2
    assert compute_sample_size(walk)[0] < 40.0


def test_a_precise_estimate_has_the_sigma_of_the_approximation(make_case):
    """With little noise the model is linear over the posterior."""
    case = make_case(1, n_outputs=10)
    experiment, parameters = measure(case, 0.01), case.free()
    estimate = maximize([experiment], parameters)
    found = sample_posterior([experiment], parameters, estimate.values, n_samples=100)
    ratio = found.values.std(axis=(0, 1)) / found.std_errors
    assert ratio.mean() == pytest.approx(1.0, abs=0.03)
    assert ratio == pytest.approx(np.ones(ratio.size), abs=0.2)
    assert compute_scale_reduction(found.values).max() < 1.1


def test_a_weak_estimate_has_the_sigma_of_the_integral(make_case):
    """Damping and stiffness of the short period from noisy data: a skewed posterior."""
    case = make_case(0, n_outputs=3)
    experiment, parameters = measure(case, 1.5), free(case, "Cm_q", "Cm_alpha")
    estimate = maximize([experiment], parameters)
    found = sample_posterior([experiment], parameters, estimate.values, n_samples=250)
    samples = found.values.reshape(-1, 2)
    model = FrequencyDomainModel(experiment, parameters)
    weights = _weights(model, estimate.values)
    axes = [
        np.linspace(value - 7.0 * std, value + 5.0 * std, 31)
        for value, std in zip(found.optimum, found.std_errors, strict=True)
    ]
    energy = [
        [
            np.sum(weights * np.abs(experiment.measured - _respond(model, a, b)) ** 2)
            for b in axes[1]
        ]
        for a in axes[0]
    ]
    p = np.exp(np.min(energy) - np.array(energy))
    p /= p.sum()
    for k, grid in enumerate(axes):
        share = p.sum(axis=1 - k)
        mean = share @ grid
        std = np.sqrt(share @ (grid - mean) ** 2)
        assert samples[:, k].std() == pytest.approx(std, rel=0.1)
        assert samples[:, k].mean() == pytest.approx(mean, abs=0.15 * std)
    assert samples[:, 0].std() > 1.1 * found.std_errors[0], "non-linear"


def _respond(model: FrequencyDomainModel, *theta: float) -> np.ndarray:
    return model.respond(np.array(theta)).outputs


def _weights(model: FrequencyDomainModel, theta: np.ndarray) -> np.ndarray:
    from flexsid.sysid.adequacy.posterior import _estimate_weights

    return _estimate_weights([model], theta, np.zeros(2))[0].expand_blocks()


def test_a_parameter_without_information_has_no_posterior(make_case):
    case = make_case(0, n_outputs=3)
    u, z = case.spectra(0)
    u[:, 1] = u[:, 0]
    parameters = free(case, *(f"Cm_{name}" for name in case.model.inputs[:2]))
    with pytest.raises(NotIdentifiable):
        sample_posterior([case.experiment(u, z)], parameters, parameters.start)
