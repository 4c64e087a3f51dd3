"""A user relies on: what noise does between amplitudes is not called nonlinear, a change is."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from tests.sysid.conftest import Case

from flexsid.errors import BadInput
from flexsid.sysid.adequacy.amplitude_dependence import LevelData, fit_levels
from flexsid.sysid.adequacy.equal_levels import (
    LevelEstimates,
    Pattern,
    average_repeats,
    classify_frequency,
    compare_levels,
    estimate_change,
    estimate_effectiveness,
)
from flexsid.sysid.adequacy.several_tests import adjust_by_holm
from flexsid.sysid.estimation.experiment import Experiment, select_parameters

AMPLITUDES = np.array([1.0, 2.0, 4.0])


def join(values: np.ndarray, std: float, amplitudes: np.ndarray = AMPLITUDES) -> LevelEstimates:
    """Levels with independent errors, smaller at larger amplitudes."""
    values = np.asarray(values, dtype=float).reshape(amplitudes.size, -1)
    n_levels, n = values.shape
    covariance = np.zeros((n_levels, n_levels, n, n))
    for k, amplitude in enumerate(amplitudes):
        covariance[k, k] = np.eye(n) * (std / amplitude) ** 2
    return LevelEstimates(amplitudes, values, covariance)


def test_equal_values_are_rejected_as_often_as_the_p_value_states():
    rng = np.random.default_rng(0)
    noise = rng.normal(size=(4000, 3, 2)) / AMPLITUDES[:, None]
    p = np.array([compare_levels(join(5.0 + own, 1.0)).p for own in noise])
    assert np.mean(p < 0.05) == pytest.approx(0.05, abs=0.01)
    assert np.mean(p < 0.5) == pytest.approx(0.5, abs=0.03)


def test_the_change_is_from_the_weighted_mean_of_the_smaller_levels():
    change = estimate_change(join(np.array([10.0, 11.0, 9.0]), 1.0))
    assert change.reference == pytest.approx((10.0 + 4.0 * 11.0) / 5.0)
    assert change.value == pytest.approx(9.0 - 10.8)
    assert change.std_error == pytest.approx((1.0 / 5.0 + 1.0 / 16.0) ** 0.5)


def test_repeats_of_a_level_are_averaged():
    estimates = join(np.array([10.0, 12.0, 9.0]), 1.0, np.array([1.0, 1.05, 4.0]))
    levels = average_repeats(estimates)
    assert levels.values.shape == (2, 1)
    assert 10.0 < levels.values[0, 0] < 12.0
    assert levels.covariance[0, 0, 0, 0] < estimates.covariance[1, 1, 0, 0]
    assert compare_levels(levels).degrees_of_freedom == 1


def test_holm_multiplies_by_the_tests_not_yet_rejected():
    assert adjust_by_holm([0.03, 0.001, 0.5]) == pytest.approx([0.06, 0.003, 0.5])


@pytest.mark.parametrize(
    ("frequencies", "pattern"),
    [
        ([3.00, 2.98, 2.90], Pattern.SOFTENING),
        ([1.876, 2.483, 2.752], Pattern.FREEPLAY),  # a gap of 0.5 of the smallest amplitude
        ([3.015, 3.059, 3.231], Pattern.HARDENING),  # a stiffness that rises with A^2
        ([3.000, 3.001, 2.9995], None),
    ],
)
def test_a_frequency_is_named_by_how_it_changes(frequencies: list[float], pattern: Pattern | None):
    assert classify_frequency(join(np.array(frequencies), 0.002)) is pattern


def test_two_levels_do_not_separate_freeplay_from_hardening():
    levels = join(np.array([2.0, 2.1]), 0.002, np.array([1.0, 2.0]))
    assert classify_frequency(levels) is Pattern.STIFFENING


def test_a_surface_that_saturates_loses_the_same_share_in_all_equations():
    own = np.array([-0.5, 0.3, 0.8])
    found = estimate_effectiveness(join(np.array([own, own, 0.9 * own]), 0.01))
    assert found.factor == pytest.approx(0.9)
    assert found.p < 1e-6
    assert found.p_common > 0.99
    other = estimate_effectiveness(join(np.array([own, own, own * [0.8, 1.0, 1.1]]), 0.01))
    assert other.p_common < 1e-6


@pytest.fixture(scope="module")
def case(make_case: Callable[..., Case]) -> Case:
    return make_case(1, n_outputs=10)


def measure(case: Case, level: float, rng: np.random.Generator) -> Experiment:
    u, z = case.spectra(0)
    size = 0.01 * np.sqrt(np.mean(np.abs(z) ** 2, axis=0))
    noise = size * (rng.normal(size=z.shape) + 1j * rng.normal(size=z.shape))
    return case.experiment(level * u, level * z + noise)


def test_a_wrong_linear_model_has_the_same_estimates_at_all_amplitudes(case: Case):
    """Cm_q is held at half its value: estimates are biased, and equal within their noise."""
    rng = np.random.default_rng(3)
    named = case.truth.named()
    wrong = case.model.fill_table(named | {"Cm_q": 0.5 * named["Cm_q"]})
    parameters = select_parameters(wrong, ("Cm_alpha", "CZ_alpha"), case.model.outputs)
    data = [
        LevelData(measure(case, amplitude, rng), parameters, amplitude)
        for amplitude in AMPLITUDES.tolist()
    ]
    fits = fit_levels(data, {})
    covariance = np.zeros((3, 3, 2, 2))
    for k, fit in enumerate(fits):
        covariance[k, k] = fit.covariance
    levels = LevelEstimates(AMPLITUDES, np.array([fit.values for fit in fits]), covariance)
    assert compare_levels(levels).p > 0.01
    bias = np.abs(fits[-1].values - [named["Cm_alpha"], named["CZ_alpha"]])
    assert (bias > 3.0 * np.sqrt(np.diag(fits[-1].covariance))).any()


def test_levels_at_other_frequencies_are_refused(case: Case):
    rng = np.random.default_rng(3)
    parameters = select_parameters(case.truth, ("Cm_alpha",), case.model.outputs)
    first, second = (measure(case, level, rng) for level in (1.0, 2.0))
    moved = replace(second, omega=1.01 * second.omega)
    data = [LevelData(first, parameters, 1.0), LevelData(moved, parameters, 2.0)]
    with pytest.raises(BadInput, match="same frequencies"):
        fit_levels(data, {})
