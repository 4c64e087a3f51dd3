"""Outcomes of the maximisation and their messages."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pytest
from tests.sysid.conftest import OMEGA, add_noise

from flexsid.errors import BadInput, Cancelled, NotIdentifiable
from flexsid.sysid.estimation.estimate import IterationStep, Outcome, compute_parameter_quality
from flexsid.sysid.estimation.experiment import find_parameters_at_limits, select_parameters
from flexsid.sysid.estimation.leakage import (
    compute_leakage_responses,
    correct_leakage,
    remove_leakage,
)
from flexsid.sysid.estimation.likelihood import FitSettings, describe_outcome, maximize
from flexsid.sysid.model.derivatives import DerivativeTable
from flexsid.sysid.model.reduction import residualize
from flexsid.sysid.regression.starting_values import estimate_delays
from flexsid.sysid.signals import FrequencyData


@pytest.mark.parametrize("ratio", [0.65, 1.09])
@pytest.mark.parametrize("seed", range(5))
def test_two_modes_are_found_from_a_quarter_off(make_case, ratio, seed):
    case = make_case(2, airspeed_ratio=ratio)
    u, y = case.spectra(seed)
    z = add_noise(y, 0.02, np.random.default_rng(seed))
    estimate = maximize([case.experiment(u, z)], case.free(off=0.25, seed=seed))
    assert estimate.outcome is Outcome.CONVERGED
    assert len(estimate.steps) - 1 <= 15
    error = (estimate.values - case.truth.values.ravel()) / estimate.std_errors
    assert np.sqrt(np.mean(error**2)) < 1.5


@pytest.mark.parametrize("off", [0.25, 0.4])
@pytest.mark.parametrize("ratio", [0.5, 1.0, 1.05])
def test_two_modes_are_found_near_flutter_in_few_iterations(make_case, ratio, off):
    case = make_case(2, airspeed_ratio=ratio)
    for seed in range(100, 110):
        u, y = case.spectra(seed)
        z = add_noise(y, 0.02, np.random.default_rng(seed))
        estimate = maximize([case.experiment(u, z)], case.free(off=off, seed=seed))
        assert estimate.outcome is Outcome.CONVERGED
        assert len(estimate.steps) - 1 <= 15


@pytest.mark.parametrize(("ratio", "seed"), [(1.0, 20), (1.02, 21), (1.02, 56)])
def test_a_resonance_between_two_frequencies_does_not_stop_a_fit(make_case, ratio, seed):
    case = make_case(2, airspeed_ratio=ratio)
    u, y = case.spectra(seed)
    z = add_noise(y, 0.02, np.random.default_rng(seed))
    estimate = maximize([case.experiment(u, z)], case.free(off=0.25, seed=seed))
    assert estimate.outcome is Outcome.CONVERGED
    assert len(estimate.steps) - 1 <= 15
    error = (estimate.values - case.truth.values.ravel()) / estimate.std_errors
    assert np.sqrt(np.mean(error**2)) < 1.7


def test_a_model_gone_astray_has_no_states_at_the_edges_of_a_record(make_case):
    case = make_case(1)
    u, y = case.spectra(1)
    delays = np.linspace(0.0, 0.02, y.shape[1])
    data = replace(
        case.experiment(u, y), instruments=np.exp(-1j * np.outer(OMEGA, delays)), edges_s=(20.0,)
    )
    parameters = case.free()
    astray = parameters.start.copy()
    astray[parameters.names.index("Cm_q")] = 1e7
    assert remove_leakage(data, parameters, astray) is data


def cut_short(case, seed: int, off: float = 0.3):
    """A record that ends while the aircraft moves, and a fit that knows nothing of that."""
    u, y = case.spectra(seed)
    delays = np.zeros(y.shape[1])
    E = compute_leakage_responses(case.model, case.truth, OMEGA, (20.0,), delays)
    size = np.sqrt(np.mean(np.abs(y) ** 2)) / np.sqrt(np.mean(np.abs(E) ** 2))
    state = size * np.random.default_rng(seed).normal(size=E.shape[2])
    noisy = add_noise(y + E @ state, 0.02, np.random.default_rng(seed))
    data = replace(case.experiment(u, noisy), edges_s=(20.0,))
    parameters = case.free(off=off)
    return data, parameters, maximize([data], parameters)


def test_the_history_is_that_of_all_fits_to_a_record_that_ends_in_motion(make_case):
    data, parameters, first = cut_short(make_case(1), 4)
    reported: list[int] = []
    _, ended = correct_leakage(
        [data],
        parameters,
        first,
        FitSettings(),
        lambda iteration, cost: reported.append(iteration),
    )
    assert ended.outcome is Outcome.CONVERGED
    assert ended.steps[: len(first.steps)] == first.steps
    stages = [step.stage for step in ended.steps]
    assert stages == sorted(stages)
    assert set(stages) == set(range(stages[-1] + 1))
    assert stages[-1] > 0
    total = ended.steps[-1].iteration
    assert reported == list(range(first.steps[-1].iteration + 1, total + 1))
    later = total - first.steps[-1].iteration
    assert ended.message.startswith(f"Converged in {total} iterations ({later} of them in ")
    np.testing.assert_array_equal(ended.start, parameters.start)


def test_a_fit_can_be_cancelled_while_the_ends_of_the_record_are_corrected(make_case):
    data, parameters, first = cut_short(make_case(1), 4)

    def cancel(iteration: int, cost: float) -> None:
        raise Cancelled("enough")

    _, ended = correct_leakage([data], parameters, first, FitSettings(), cancel)
    assert ended.outcome is Outcome.CANCELLED
    assert ended.steps[-1].iteration == first.steps[-1].iteration + 1


@pytest.mark.parametrize(("count", "words"), [(1, "1 iteration."), (2, "2 iterations.")])
def test_one_iteration_is_no_iterations(count, words):
    steps = [IterationStep(k, 1.0, 0.1) for k in range(count + 1)]
    assert describe_outcome(Outcome.CONVERGED, steps) == f"Converged in {words}"


def test_nothing_has_a_standard_error_of_zero(make_case):
    case = make_case(1)
    u, y = case.spectra(3)
    found = maximize(
        [case.experiment(u, add_noise(y, 0.02, np.random.default_rng(3)))], case.free()
    )
    nothing = np.zeros_like(found.covariance)
    rounded = replace(found, covariance=nothing, corrected_covariance=-1e-20 * np.eye(len(nothing)))
    assert np.isnan(rounded.std_errors).all()
    assert np.isnan([one.cramer_rao for one in compute_parameter_quality(rounded)]).all()
    some = np.arange(len(found.names)) < 2
    quality = compute_parameter_quality(found.without_std_errors(some))
    assert np.isnan([one.std_error for one in quality[:2]]).all()
    assert np.isfinite([one.insensitivity for one in quality[2:]]).all()


def test_values_that_no_instrument_or_structure_can_have_are_at_their_limit(make_case):
    names = ("delay_q", "scale_alpha", "zeta_7", "omega_7", "shape_q_7")
    parameters = make_case(1).free(names)
    possible = np.append(parameters.start[:-5], [-0.03, 0.8, 1.5, 1.1, -2.0])
    assert not find_parameters_at_limits(parameters, possible).any()
    beyond = np.append(parameters.start[:-5], [0.2, -1.0, 0.0, np.nan, -2.0])
    assert find_parameters_at_limits(parameters, beyond)[-5:].tolist() == [
        True,
        True,
        True,
        True,
        False,
    ]


def test_cost_never_rises_and_noise_free_data_give_the_truth(make_case):
    case = make_case(2)
    u, y = case.spectra(5)
    estimate = maximize([case.experiment(u, y)], case.free(off=0.25))
    costs = [step.cost for step in estimate.steps]
    assert all(after <= before + 1e-9 * abs(before) for before, after in itertools.pairwise(costs))
    assert np.allclose(estimate.values, case.truth.values.ravel(), rtol=1e-6)


def test_full_density_with_few_frequencies_is_shrunk_and_agrees(make_case):
    case = make_case(1)
    u, y = case.spectra(6)
    experiment = case.experiment(u, add_noise(y, 0.02, np.random.default_rng(6)))
    diagonal = maximize([experiment], case.free())
    full = maximize([experiment], case.free(), FitSettings(noise="full"))
    assert full.outcome is Outcome.CONVERGED
    apart = np.abs(full.values - diagonal.values) / diagonal.std_errors
    assert np.sqrt(np.mean(apart**2)) < 1.0


@pytest.mark.parametrize("n_frequencies", [30, 45, 65, 150])
def test_a_full_density_comes_to_rest_however_few_the_frequencies(make_case, n_frequencies):
    case = make_case(1, n_outputs=8)
    omega = np.linspace(OMEGA[0], OMEGA[-1], n_frequencies)
    for seed in range(5):
        u, y = case.spectra(seed, omega)
        z = add_noise(y, 0.03, np.random.default_rng(seed))
        found = maximize(
            [case.experiment(u, z, omega)], case.free(off=0.1), FitSettings(noise="full")
        )
        assert found.outcome is Outcome.CONVERGED
        assert len(found.steps) - 1 <= 15


def test_a_full_density_bears_with_frequencies_without_noise(make_case):
    case = make_case(4)
    omega = np.linspace(OMEGA[0], OMEGA[-1], 250)
    u, y = case.spectra(5, omega)
    found = maximize([case.experiment(u, y, omega)], case.free(), FitSettings(noise="full"))
    assert np.allclose(found.values, case.truth.values.ravel(), rtol=1e-5)


@pytest.mark.parametrize("ratio", [0.65, 0.95])
def test_a_full_density_tolerates_unmodelled_modes(make_case, ratio):
    """What they do to all sensors at once counts as noise there, and hardly biases the rest."""
    case, small = make_case(8, ratio), make_case(4, ratio)
    omega = np.linspace(OMEGA[0], OMEGA[-1], 260)
    u, y = case.spectra(3, omega)
    z = add_noise(y, 0.002, np.random.default_rng(4))
    experiment = small.experiment(u, z, omega)
    modes = small.truth.modes
    expected = residualize(case.truth, case.model.modes, case.model.condition, modes).values.ravel()
    off = {}
    for kind in ("diagonal", "full"):
        found = maximize([experiment], small.free(), FitSettings(noise=kind))
        assert found.outcome is Outcome.CONVERGED
        assert len(found.steps) - 1 <= 40
        off[kind] = float(np.median(np.abs(found.values / expected - 1.0)))
    assert off["full"] < 0.5 * off["diagonal"]


def test_several_maneuvers_share_their_derivatives(make_case):
    cases = [make_case(1, airspeed_ratio=ratio) for ratio in (0.6, 0.8)]
    experiments = []
    for seed, case in enumerate(cases):
        u, y = case.spectra(seed)
        experiments.append(case.experiment(u, add_noise(y, 0.05, np.random.default_rng(seed))))
    together = maximize(experiments, cases[0].free(off=0.2))
    alone = maximize(experiments[:1], cases[0].free(off=0.2))
    assert np.median(together.std_errors / alone.std_errors) < 0.85
    error = (together.values - cases[0].truth.values.ravel()) / together.std_errors
    assert np.sqrt(np.mean(error**2)) < 1.6


def test_a_prior_acts_with_its_standard_deviation(make_case):
    case = make_case(0, n_outputs=9)
    u, y = case.spectra(7)
    experiment = case.experiment(u, add_noise(y, 0.05, np.random.default_rng(7)))
    free = maximize([experiment], case.free())
    index = free.names.index("Cm_q")
    sigma = float(np.sqrt(free.covariance[index, index]))
    away = float(free.values[index]) + 4.0 * sigma
    held = maximize([experiment], case.free(), FitSettings(priors={"Cm_q": (away, sigma)}))
    assert held.values[index] == pytest.approx(free.values[index] + 2.0 * sigma, abs=0.1 * sigma)


def test_stiffness_and_its_aerodynamic_twin_are_named_as_confounded(make_case):
    case = make_case(1)
    u, y = case.spectra(8)
    experiment = case.experiment(u, add_noise(y, 0.02, np.random.default_rng(8)))
    estimate = maximize([experiment], case.free(("omega_7",)))
    assert estimate.outcome is Outcome.SINGULAR_INFORMATION
    assert "omega_7" in estimate.message
    assert "CQ7_eta7" in estimate.message
    alone = maximize([experiment], case.free())
    errors = dict(zip(estimate.names, estimate.std_errors, strict=True))
    values = dict(zip(estimate.names, estimate.values, strict=True))
    for name, error in zip(alone.names, alone.std_errors, strict=True):
        if name not in ("CQ7_eta7", "CQ7_etadot7"):  # 2 zeta omega etadot has its twin there
            assert errors[name] == pytest.approx(error, rel=1e-2)
    assert all(errors[name] > 10.0 * abs(values[name]) for name in ("omega_7", "CQ7_eta7"))


@pytest.mark.parametrize("seed", range(20))
def test_delays_to_20_ms_are_found_jointly_from_zero(make_case, seed):
    case = make_case(2)
    u, y = case.spectra(seed)
    rng = np.random.default_rng(seed)
    delays = rng.uniform(0.0, 0.02, y.shape[1])
    z = add_noise(y * np.exp(-1j * np.outer(OMEGA, delays)), 0.02, rng)
    names = tuple(f"delay_{name}" for name in case.model.outputs)
    parameters = case.free(names, off=0.1, seed=seed)
    estimate = maximize([case.experiment(u, z)], parameters, FitSettings(max_iterations=100))
    assert np.abs(estimate.values[-delays.size :] - delays).max() < 1e-3


def test_delays_to_50_ms_are_found_from_redundancy(make_case):
    case = make_case(4)
    u, y = case.spectra(9)
    rng = np.random.default_rng(9)
    delays = rng.uniform(0.0, 0.05, y.shape[1])
    z = add_noise(y * np.exp(-1j * np.outer(OMEGA, delays)), 0.01, rng)
    found = estimate_delays(
        case.model,
        FrequencyData(OMEGA, u, case.model.inputs),
        FrequencyData(OMEGA, z, case.model.outputs),
        np.ones(z.shape, dtype=complex),
    )
    assert np.abs(found - delays).max() < 3e-3


def test_iteration_limit_and_cancellation_are_reported(make_case):
    case = make_case(1)
    u, y = case.spectra(10)
    experiment = case.experiment(u, add_noise(y, 0.02, np.random.default_rng(10)))
    stopped = maximize([experiment], case.free(off=0.3), FitSettings(max_iterations=1))
    assert stopped.outcome is Outcome.ITERATION_LIMIT
    assert "limit of 1" in stopped.message

    def cancel(iteration: int, cost: float) -> None:
        raise Cancelled("enough")

    ended = maximize([experiment], case.free(off=0.3), report=cancel)
    assert ended.outcome is Outcome.CANCELLED
    assert len(ended.steps) - 1 == 1
    assert "after 1 iteration;" in ended.message


def test_an_undamped_pole_at_a_frequency_is_reported(make_case):
    """Short period and modes without any aerodynamics: K is singular at the mode itself."""
    case = make_case(1)
    modes = replace(case.model.modes, zeta=np.zeros(1))
    model = replace(case.model, modes=modes)
    omega = np.array([5.0, float(modes.omega[0]), 40.0])
    none = DerivativeTable.from_names(modes.numbers, model.inputs, {})
    with pytest.raises(BadInput, match="undamped pole"):
        model.response(none, omega)
    other = replace(case, model=model)
    u, z = np.ones((3, 5), dtype=complex), np.ones((3, 20), dtype=complex)
    parameters = select_parameters(none, ("Cm_q",), model.outputs)
    with pytest.raises(NotIdentifiable, match="no finite response"):
        maximize([other.experiment(u, z, omega)], parameters)


def test_requests_without_a_result_are_refused(make_case):
    case = make_case(1)
    u, y = case.spectra(11)
    with pytest.raises(BadInput, match="no parameter is free"):
        select_parameters(case.truth, (), case.model.outputs)
    with pytest.raises(BadInput, match="has rows CZ, Cm, CQ7"):
        select_parameters(case.truth, ("CQ9_alpha",), case.model.outputs)
    with pytest.raises(BadInput, match="outputs are"):
        select_parameters(case.truth, None, case.model.outputs, ("delay_nose",))
    dead = y.copy()
    dead[:, 3] = 0.0
    with pytest.raises(BadInput, match=f"'{case.model.outputs[3]}' has no signal"):
        case.experiment(u, dead)
    with pytest.raises(BadInput, match="fixed at nan"):
        select_parameters(case.truth, None, case.model.outputs, fixed={"Cm_q": np.nan})
    for prior in ({"Cm_x": (0.0, 1.0)}, {"Cm_q": (0.0, 0.0)}, {"Cm_q": (np.nan, 1.0)}):
        with pytest.raises(BadInput, match="prior of"):
            maximize([case.experiment(u, y)], case.free(), FitSettings(priors=prior))
    with pytest.raises(BadInput, match="0 Hz"):
        maximize([case.experiment(u, y, OMEGA - OMEGA[0])], case.free())
    broken = y.copy()
    broken[2, 1] = np.nan
    with pytest.raises(BadInput, match="not finite"):
        case.experiment(u, broken)
    few = OMEGA[:1]
    data = make_case(1, n_outputs=4).experiment(u[:1], y[:1, :4], few)
    with pytest.raises(NotIdentifiable, match="27 parameters"):
        maximize([data], make_case(1, n_outputs=4).free())
