"""Equation error with a nuisance mode that noise of the surfaces excites within the band."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from tests.sysid.conftest import Case, add_noise

from flexsid.sysid.estimation.agreement import fuse_estimates
from flexsid.sysid.estimation.estimate import Estimate, Outcome
from flexsid.sysid.estimation.experiment import select_parameters
from flexsid.sysid.estimation.nuisance import build_nuisance_prior
from flexsid.sysid.model.derivatives import list_derivative_names
from flexsid.sysid.regression import marginal_equation_error as marginal
from flexsid.sysid.regression.marginal_equation_error import marginal_equation_error
from flexsid.sysid.signals import FrequencyData

FREQUENCIES = 2.0 * np.pi * np.arange(6, 336) / 24.0  # to 14 Hz; mode 11 has 13.5 Hz
INPUT_NOISE = 0.05  # of the deflections
IN_BAND = 2


def estimate_flight(case: Case, rng: np.random.Generator) -> Estimate:
    """Estimate a flight of one input after the other, from a prediction that is 30 % wrong."""
    model, truth = case.model, case.truth.named()
    numbers = model.modes.numbers
    own = list_derivative_names(numbers[:IN_BAND], model.inputs)
    nuisance = tuple(name for name in model.derivative_names if name not in own)
    prior = build_nuisance_prior(numbers, model.inputs, truth)
    turns = np.exp(2j * np.pi * rng.uniform(size=FREQUENCIES.size))
    u = np.zeros((FREQUENCIES.size, 5), dtype=complex)
    u[np.arange(FREQUENCIES.size), np.arange(FREQUENCIES.size) % 5] = turns
    z = (model.response(case.truth, FREQUENCIES) @ u[:, :, None])[:, :, 0]
    size = np.hypot(case.truth.values, prior.median)
    wrong = 0.3 * size * rng.normal(size=size.shape)
    predicted = replace(case.truth, values=case.truth.values + wrong)
    shifted = build_nuisance_prior(numbers, model.inputs, predicted.named())
    noise = INPUT_NOISE * np.sqrt(np.mean(np.abs(u) ** 2, axis=0))
    estimate, _ = marginal_equation_error(
        model,
        FrequencyData(FREQUENCIES, add_noise(z, 0.01, rng), model.outputs),
        np.ones(z.shape, dtype=complex),
        FrequencyData(FREQUENCIES, add_noise(u, INPUT_NOISE, rng), model.inputs),
        select_parameters(predicted, (*own, *nuisance), model.outputs),
        shifted.list_priors(nuisance, 0.3),
        IN_BAND,
        input_noise=np.broadcast_to(noise**2, u.shape),
    )
    return estimate


@pytest.mark.parametrize("fits", [9, pytest.param(100, marks=pytest.mark.long)])
def test_noise_of_the_surfaces_that_a_nuisance_mode_amplifies_causes_no_bias(make_case, fits):
    case = make_case(3, airspeed_ratio=1.05)
    truth = case.truth.named()
    own = list_derivative_names(case.model.modes.numbers[:IN_BAND], case.model.inputs)
    rng = np.random.default_rng(8)
    errors = []
    for _ in range(fits):
        estimate = estimate_flight(case, rng)
        assert estimate.outcome is Outcome.CONVERGED
        band = estimate.select(own)
        errors.append((band.values - [truth[name] for name in own]) / band.std_errors)
    mean = np.abs(np.mean(errors, axis=0))
    assert mean.max() < 4.0 / np.sqrt(fits), own[mean.argmax()]
    assert 0.9 < np.mean(np.abs(errors) < 2.0) < 0.98


def test_an_estimate_that_a_further_step_would_move_did_not_converge(make_case, monkeypatch):
    monkeypatch.setattr(marginal, "_ITERATIONS", 0)
    estimate = estimate_flight(make_case(3, airspeed_ratio=1.05), np.random.default_rng(8))
    assert estimate.outcome is Outcome.ITERATION_LIMIT
    assert "would move a derivative by" in estimate.message
    settled = replace(estimate, outcome=Outcome.CONVERGED)
    assert fuse_estimates([settled, estimate], ["one", "two"]).outcome is estimate.outcome
