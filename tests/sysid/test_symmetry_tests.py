"""Tests for an asymmetry in maneuvers of both axes: false alarms and power by Monte Carlo."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
import pytest
from tests.sysid.conftest import Case, add_noise

from flexsid.sysid.adequacy.model_tests import (
    SYMMETRY_HYPOTHESES,
    Hypothesis,
    ModelTest,
    OpposedMotion,
    compute_model_tests,
)
from flexsid.sysid.estimation.estimate import Estimate
from flexsid.sysid.estimation.experiment import Experiment
from flexsid.sysid.estimation.frequency_response_error import frequency_response_error
from flexsid.sysid.estimation.likelihood import FitSettings, maximize
from flexsid.sysid.regression.equation_error import equation_error
from flexsid.sysid.regression.reconstruction import reconstruct_motion
from flexsid.sysid.signals import FrequencyData
from flexsid.sysid.spectra.response import estimate_bare_airframe_responses

FREQUENCIES = 2.0 * np.pi * np.arange(6, 336) / 24.0  # ten inputs, 33 harmonics each
LATERAL_INPUTS = ("bfa", "wf1a", "wf2a", "wf3a", "wf4a")
LEVEL = 0.03


def excite(rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Half sums and half differences of ten surfaces, each with harmonics of its own."""
    turns = np.exp(2j * np.pi * rng.uniform(size=FREQUENCIES.size))
    line = np.arange(FREQUENCIES.size)
    left, right = (np.zeros((FREQUENCIES.size, 5), dtype=complex) for _ in range(2))
    for side, first in ((left, 0), (right, 5)):
        own = line % 10 - first
        mine = (own >= 0) & (own < 5)
        side[line[mine], own[mine]] = turns[mine]
    return 0.5 * (right + left), 0.5 * (right - left)


def oppose(u: np.ndarray, rng: np.random.Generator) -> OpposedMotion:
    """Surfaces of the other axis, and motions that they cause through lags, with noise."""
    s = 1j * FREQUENCIES[:, None]
    lags = np.array([1.0, 4.0, 9.0, 25.0])
    motion = (u @ rng.normal(size=(5, lags.size))) / (1.0 + s / lags)
    variables = np.concatenate([add_noise(motion, 0.02, rng), u], axis=1)
    names = ("beta", "p", "r", "eta8", *LATERAL_INPUTS)
    pairs = {name.replace("a", "s"): name for name in LATERAL_INPUTS}
    return OpposedMotion(FrequencyData(FREQUENCIES, variables, names), pairs)


def fit(case: Case, experiment: Experiment, method: str) -> Estimate:
    if method == "OE":
        return maximize([experiment], case.free(), FitSettings())
    u = FrequencyData(FREQUENCIES, experiment.inputs, case.model.inputs)
    z = FrequencyData(FREQUENCIES, experiment.measured, case.model.outputs)
    if method == "EE":
        motion = reconstruct_motion(case.model, z, experiment.instruments)
        return equation_error(case.model, motion, u, case.free())
    assigned = np.arange(FREQUENCIES.size) % 5
    responses = estimate_bare_airframe_responses(u, z, u, assigned)
    of_responses = frequency_response_error(case.model, responses, source=experiment)
    return maximize([of_responses], case.free(), FitSettings())


def fit_and_test(
    case: Case, seed: int, loss: float = 0.0, method: str = "OE"
) -> Iterator[ModelTest]:
    """Fit one flight, in which the left outer flap lost a share of its effectiveness."""
    rng = np.random.default_rng(seed)
    u, opposed = excite(rng)
    # C_l = (1 - loss) C_r: with the sum C as the derivative, C_r - C_l = C loss / (2 - loss).
    moved = u.copy()
    moved[:, 4] += loss / (2.0 - loss) * opposed[:, 4]
    z = (case.model.response(case.truth, FREQUENCIES) @ moved[:, :, None])[:, :, 0]
    experiment = case.experiment(u, add_noise(z, LEVEL, rng), FREQUENCIES)
    parameters = case.free()
    estimate = fit(case, experiment, method)
    tests = compute_model_tests(
        [experiment], parameters, estimate.values, opposed_motions=[oppose(opposed, rng)]
    )
    return (test for test in tests if test.hypothesis in SYMMETRY_HYPOTHESES)


@pytest.mark.parametrize(
    ("method", "fits", "low", "high"),
    [
        ("FRE", 30, 0.0, 0.14),
        *(
            pytest.param(method, 600, 0.03, 0.07, marks=pytest.mark.long)
            for method in ("OE", "FRE", "EE")
        ),
    ],
)
def test_a_symmetric_aircraft_is_called_asymmetric_in_five_percent_of_flights(
    make_case: Callable[..., Case], method: str, fits: int, low: float, high: float
):
    case = make_case(1, n_outputs=10)
    alarms = [
        any(t.rejects for t in fit_and_test(case, seed, method=method)) for seed in range(fits)
    ]
    assert low <= np.mean(alarms) <= high, f"{np.mean(alarms):.3f}"


@pytest.mark.parametrize(
    "method", ["OE", *(pytest.param(m, marks=pytest.mark.long) for m in ("FRE", "EE"))]
)
def test_a_flap_that_lost_5_percent_is_found_and_named(make_case: Callable[..., Case], method: str):
    case = make_case(1, n_outputs=10)
    found, estimates = [], []
    for seed in range(40):
        tests = list(fit_and_test(case, seed, 0.05, method))
        (flap,) = (
            t
            for t in tests
            if (t.hypothesis, t.subject) == (Hypothesis.SURFACE_EFFECTIVENESS, "wf4s")
        )
        found.append(flap.rejects)
        estimates.append(flap.estimate)
    assert np.mean(found) >= 0.95
    assert np.mean(estimates) == pytest.approx(0.05 / 1.95, rel=0.05)
