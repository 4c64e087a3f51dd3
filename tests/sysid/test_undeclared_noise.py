"""Equation error where the noise of the sensors is not declared: standard errors that hold."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from tests.sysid.conftest import Case
from tests.sysid.test_coverage import FREQUENCIES, Maneuver

from flexsid.sysid.estimation.experiment import select_parameters
from flexsid.sysid.estimation.nuisance import build_nuisance_prior
from flexsid.sysid.model.derivatives import list_derivative_names
from flexsid.sysid.regression.marginal_equation_error import marginal_equation_error
from flexsid.sysid.signals import FrequencyData

SPREAD = 0.3
IN_BAND = 2


def compute_errors(
    true: Case, fitted: Case, seed: int, uneven: float, *, is_declared: bool = False
) -> np.ndarray:
    """Errors of the derivatives of the band over their standard errors.

    The fitted model has one mode beyond the band, with a prior 30 % off the truth. Noise of the
    sensors differs by a factor exp(``uneven``) from the same share of their signals.
    """
    maneuver = Maneuver(true)
    rng = np.random.default_rng(5000 + seed)
    u, z = maneuver.noisy("white", seed)
    factors = np.exp(uneven * rng.normal(size=z.shape[1]))
    z = maneuver.y + (z - maneuver.y) * factors
    model, truth = fitted.model, fitted.truth.named()
    numbers = model.modes.numbers
    median = build_nuisance_prior(numbers, model.inputs, truth).median
    size = np.hypot(fitted.truth.values, median)
    shifted = fitted.truth.values + SPREAD * size * rng.normal(size=size.shape)
    predicted = replace(fitted.truth, values=shifted)
    own = list_derivative_names(numbers[:IN_BAND], model.inputs)
    nuisance = tuple(name for name in model.derivative_names if name not in own)
    prior = build_nuisance_prior(numbers, model.inputs, predicted.named())
    estimate, _ = marginal_equation_error(
        model,
        FrequencyData(FREQUENCIES, z, model.outputs),
        np.ones(z.shape, dtype=complex),
        FrequencyData(FREQUENCIES, u, model.inputs),
        select_parameters(predicted, (*own, *nuisance), model.outputs),
        prior.list_priors(nuisance, SPREAD),
        IN_BAND,
        maneuver.level * factors if is_declared else None,
    )
    band = estimate.select(own)
    return (band.values - [truth[name] for name in own]) / band.std_errors


@pytest.mark.parametrize("uneven", [pytest.param(0.0, marks=pytest.mark.long), 0.5])
@pytest.mark.parametrize("fits", [12, pytest.param(100, marks=pytest.mark.long)])
def test_standard_errors_hold_where_noise_is_not_declared(make_case, fits, uneven):
    case = make_case(3, n_outputs=14)
    errors = np.array([compute_errors(case, case, seed, uneven) for seed in range(fits)])
    assert 0.9 <= np.sqrt(np.mean(errors**2)) <= 1.1


@pytest.mark.parametrize("fits", [4, pytest.param(60, marks=pytest.mark.long)])
def test_an_omitted_mode_is_not_attributed_to_undeclared_noise(make_case, fits):
    """Errors are those of the estimate with the noise declared."""
    true, fitted = make_case(4, n_outputs=14), make_case(3, n_outputs=14)
    measured, declared = (
        np.array([compute_errors(true, fitted, seed, 0.0, is_declared=d) for seed in range(fits)])
        for d in (False, True)
    )
    assert np.mean(measured**2) == pytest.approx(np.mean(declared**2), rel=0.15)
