"""Estimates of one record share its noise: the error of their difference, against Monte Carlo."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
from tests.sysid.conftest import Case
from tests.sysid.test_coverage import ASSIGNED_INPUT, FREQUENCIES, Maneuver

from flexsid.sysid.estimation.agreement import (
    compute_difference_variance,
    compute_joint_covariance,
    compute_limit,
)
from flexsid.sysid.estimation.estimate import Estimate
from flexsid.sysid.estimation.experiment import select_parameters
from flexsid.sysid.estimation.frequency_response_error import frequency_response_error
from flexsid.sysid.estimation.likelihood import FitSettings, maximize
from flexsid.sysid.estimation.nuisance import build_nuisance_prior
from flexsid.sysid.model.derivatives import list_derivative_names
from flexsid.sysid.regression.marginal_equation_error import marginal_equation_error
from flexsid.sysid.signals import FrequencyData
from flexsid.sysid.spectra.response import estimate_bare_airframe_responses

METHODS = ("OE", "FRE", "EE")
SPREAD = 0.3


def count_disagreements(fits: list[list[Estimate]]) -> tuple[dict[str, float], float]:
    """Rates of |a - b| > 2 sigma by pair of methods, and of all three beyond their limit."""
    beyond: dict[str, list[np.ndarray]] = {}
    three: list[bool] = []
    for estimates in fits:
        covariance = compute_joint_covariance(
            [one.std_errors for one in estimates], [one.components for one in estimates], [(1,)] * 3
        )
        z = {
            (i, j): np.abs(estimates[i].values - estimates[j].values)
            / np.sqrt([compute_difference_variance(C, (i, j)) for C in covariance])
            for i, j in combinations(range(3), 2)
        }
        for (i, j), one in z.items():
            beyond.setdefault(f"{METHODS[i]}-{METHODS[j]}", []).append(one > 2.0)
        largest = np.max(list(z.values()), axis=0)
        three += [
            bool(one > compute_limit(C, list(z)))
            for one, C in zip(largest, covariance, strict=True)
        ]
    return {pair: float(np.mean(found)) for pair, found in beyond.items()}, float(np.mean(three))


@pytest.mark.parametrize(
    ("kind", "fits"),
    [
        ("white", 40),
        *(
            pytest.param(kind, 200, marks=pytest.mark.long)
            for kind in ("white", "coloured", "on the surfaces")
        ),
    ],
)
def test_methods_of_one_record_disagree_at_the_nominal_rate(make_case, kind, fits):
    maneuver = Maneuver(make_case(1, n_outputs=12))
    found = [[maneuver.estimate(m, kind, seed) for m in METHODS] for seed in range(fits)]
    pairs, three = count_disagreements(found)
    assert max(pairs.values()) < 0.075, pairs
    assert min(pairs.values()) > 0.01, pairs
    assert 0.015 < three < 0.075, f"{three:.3f}"


def estimate_with_nuisance_modes(
    true: Case, seed: int, n_modes: int, extras: tuple[str, ...] = ()
) -> list[Estimate]:
    """Fit one flight by all methods, with the modes beyond the first ones as nuisance."""
    maneuver = Maneuver(true)
    u_noisy, z_noisy = maneuver.noisy("white", seed)
    model, rng = true.model, np.random.default_rng(5000 + seed)
    numbers = model.modes.numbers
    median = build_nuisance_prior(numbers, model.inputs, true.truth.named()).median
    size = np.hypot(true.truth.values, median)
    predicted = replace(
        true.truth, values=true.truth.values + SPREAD * size * rng.normal(size=size.shape)
    )
    own = list_derivative_names(numbers[:n_modes], model.inputs)
    nuisance = tuple(name for name in model.derivative_names if name not in own)
    prior = build_nuisance_prior(numbers, model.inputs, predicted.named())
    priors = prior.list_priors(nuisance, SPREAD)
    parameters = select_parameters(predicted, (*own, *nuisance), model.outputs, extras)
    u = FrequencyData(FREQUENCIES, u_noisy, model.inputs)
    z = FrequencyData(FREQUENCIES, z_noisy, model.outputs)
    through = np.ones(z_noisy.shape, dtype=complex)
    oe = true.experiment(u_noisy, z_noisy, FREQUENCIES)
    command = FrequencyData(FREQUENCIES, maneuver.command, model.inputs)
    responses = estimate_bare_airframe_responses(u, z, command, ASSIGNED_INPUT)
    fre = frequency_response_error(model, responses, source=oe)
    settings = FitSettings(priors=priors)
    ee, _ = marginal_equation_error(
        model, z, through, u, parameters, priors, n_modes, maneuver.level
    )
    every = [maximize([oe], parameters, settings), maximize([fre], parameters, settings), ee]
    return [one.select(own) for one in every]


@pytest.mark.parametrize("fits", [6, pytest.param(60, marks=pytest.mark.long)])
def test_estimates_share_the_errors_of_their_priors(make_case, fits):
    true = make_case(3, n_outputs=14)
    found = [estimate_with_nuisance_modes(true, seed, 2) for seed in range(fits)]
    pairs, three = count_disagreements(found)
    assert max(pairs.values()) < 0.10, pairs
    assert three < 0.10, f"{three:.3f}"


def test_a_limit_is_two_standard_errors_for_two_estimates_and_more_for_three():
    assert compute_limit(np.diag([1.0, 4.0]), [(0, 1)]) == pytest.approx(2.0, abs=0.02)
    independent = compute_limit(np.eye(3), [(0, 1), (0, 2), (1, 2)])
    assert independent == pytest.approx(2.37, abs=0.04)  # studentized range, q(.0455; 3)/sqrt 2
    same = np.array([[1.0, 0.999, 0.0], [0.999, 1.0, 0.0], [0.0, 0.0, 1.0]])
    assert 2.1 < compute_limit(same, [(0, 1), (0, 2), (1, 2)]) < independent
