"""Tests of a fit for remaining model error: false alarms and power against Monte Carlo."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
import pytest
from tests.sysid.conftest import Case

from flexsid.sysid.adequacy.model_tests import Hypothesis, ModelTest, compute_model_tests
from flexsid.sysid.estimation.experiment import Experiment, Parameters, select_parameters
from flexsid.sysid.estimation.likelihood import FitSettings, maximize
from flexsid.sysid.regression.equation_error import equation_error
from flexsid.sysid.regression.reconstruction import reconstruct_motion
from flexsid.sysid.signals import FrequencyData

FREQUENCIES = 2.0 * np.pi * np.arange(6, 206) / 24.0  # five inputs, forty harmonics each
LEVEL = 0.03


def excite() -> np.ndarray:
    """Multisine of five inputs, whose surfaces also move at the harmonics of the others."""
    rng = np.random.default_rng(1)
    u = np.zeros((FREQUENCIES.size, 5), dtype=complex)
    turns = np.exp(2j * np.pi * rng.uniform(size=FREQUENCIES.size))
    u[np.arange(FREQUENCIES.size), np.arange(FREQUENCIES.size) % 5] = turns
    return u @ (np.eye(5) + 0.1 * rng.normal(size=(5, 5)))


def measure(
    case: Case,
    seed: int,
    fitted: Case,
    change: Callable[[np.ndarray], None] | None = None,
    colour: float | np.ndarray = 1.0,
) -> Experiment:
    """Record the response of one aircraft with noise, to fit the model of another."""
    rng = np.random.default_rng(1000 + seed)
    u = excite()
    z = (case.model.response(case.truth, FREQUENCIES) @ u[:, :, None])[:, :, 0]
    level = LEVEL * np.sqrt(np.mean(np.abs(z) ** 2, axis=0))
    if change is not None:
        change(z)
    noise = (rng.normal(size=z.shape) + 1j * rng.normal(size=z.shape)) / np.sqrt(2.0)
    return fitted.experiment(u, z + colour * level * noise, FREQUENCIES)


def fit_and_test(
    experiment: Experiment,
    parameters: Parameters,
    priors: Mapping[str, tuple[float, float]] | None = None,
) -> tuple[ModelTest, ...]:
    estimate = maximize([experiment], parameters, FitSettings(priors=priors))
    return compute_model_tests([experiment], parameters, estimate.values, priors)


@pytest.mark.parametrize(
    ("fits", "low", "high"),
    [(80, 0.0, 0.1), pytest.param(400, 0.03, 0.07, marks=pytest.mark.long)],
)
def test_a_correct_model_is_rejected_in_five_percent_of_fits(make_case, fits, low, high):
    case = make_case(1, n_outputs=10)
    rejected = [
        fit_and_test(measure(case, seed, case), case.free())[0].rejects for seed in range(fits)
    ]
    assert low <= np.mean(rejected) <= high, f"{np.mean(rejected):.3f}"


@pytest.mark.long
@pytest.mark.parametrize("method", ["OE", "EE"])
def test_a_correct_model_is_rejected_as_rarely_with_coloured_noise(make_case, method):
    case = make_case(1, n_outputs=12)
    colour = (0.3 + 3.0 * np.linspace(0.0, 1.0, FREQUENCIES.size) ** 2)[:, None]
    rejected = []
    for seed in range(400):
        experiment = measure(case, seed, case, colour=colour)
        if method == "OE":
            tests = fit_and_test(experiment, case.free())
        else:
            tests = fit_equation_error_and_test(case, experiment)
        rejected.append(tests[0].rejects)
    assert 0.03 <= np.mean(rejected) <= 0.07, f"{np.mean(rejected):.3f}"


def fit_equation_error_and_test(fitted: Case, experiment: Experiment) -> tuple[ModelTest, ...]:
    """Tests at the estimate of equation error, with the noise of the sensors declared."""
    level = LEVEL * np.sqrt(np.mean(np.abs(experiment.measured) ** 2, axis=0))
    outputs = FrequencyData(FREQUENCIES, experiment.measured, fitted.model.outputs)
    motion = reconstruct_motion(fitted.model, outputs, experiment.instruments, guess=level)
    inputs = FrequencyData(FREQUENCIES, experiment.inputs, fitted.model.inputs)
    estimate = equation_error(fitted.model, motion, inputs, fitted.free())
    return compute_model_tests([experiment], fitted.free(), estimate.values)


@pytest.mark.parametrize(
    ("fits", "low", "high"),
    [(60, 0.0, 0.1), pytest.param(400, 0.03, 0.07, marks=pytest.mark.long)],
)
def test_equation_error_of_a_correct_model_is_rejected_as_rarely(make_case, fits, low, high):
    case = make_case(1, n_outputs=12)
    rejected = [
        fit_equation_error_and_test(case, measure(case, seed, case))[0].rejects
        for seed in range(fits)
    ]
    assert low <= np.mean(rejected) <= high, f"{np.mean(rejected):.3f}"


def test_model_error_of_equation_error_is_found(make_case):
    """A delay of 10 ms, a scale factor of 1.03, and a fourth mode."""
    case, true = make_case(3), make_case(4)
    for seed in range(3):

        def delay(z: np.ndarray, output: int = seed) -> None:
            z[:, output] *= np.exp(-0.01j * FREQUENCIES)

        def scale(z: np.ndarray, output: int = seed) -> None:
            z[:, output] *= 1.03

        for experiment in (
            measure(case, seed, case, delay),
            measure(case, seed, case, scale),
            measure(true, seed, case),
        ):
            assert fit_equation_error_and_test(case, experiment)[0].rejects


def test_priors_are_no_model_error(make_case):
    """Priors about means that miss the truth by their standard deviation."""
    case = make_case(1, n_outputs=10)
    truth = case.truth.named()
    rejected = []
    for seed in range(40):
        rng = np.random.default_rng(seed)
        spread = {name: 0.1 * abs(value) for name, value in truth.items() if "eta7" in name}
        priors = {n: (truth[n] + std * rng.normal(), std) for n, std in spread.items()}
        tests = fit_and_test(measure(case, seed, case), case.free(), priors)
        rejected.append(tests[0].rejects)
    assert np.mean(rejected) <= 0.125, f"{np.mean(rejected):.3f}"


@pytest.mark.parametrize(
    ("fits", "low", "high"),
    [(30, 0.03, 0.07), pytest.param(200, 0.04, 0.06, marks=pytest.mark.long)],
)
def test_residual_power_in_a_band_exceeds_the_noise_in_five_percent(make_case, fits, low, high):
    case = make_case(1, n_outputs=12)
    p = [
        test.p
        for seed in range(fits)
        for test in fit_and_test(measure(case, seed, case), case.free())
        if test.hypothesis is Hypothesis.RESIDUAL_POWER
    ]
    assert len(p) == 4 * 12 * fits  # four bands
    assert low <= np.mean(np.array(p) < 0.05) <= high, f"{np.mean(np.array(p) < 0.05):.3f}"


def test_residual_power_names_the_band_of_an_omitted_mode(make_case):
    true, fitted = make_case(4), make_case(3)
    tests = fit_and_test(measure(true, 0, fitted), fitted.free())
    powers = [test for test in tests if test.hypothesis is Hypothesis.RESIDUAL_POWER]
    assert powers[0].rejects
    assert (powers[0].estimate or 0.0) > 2.0, "times the noise"
    assert powers[0].subject.endswith("Hz")


def test_a_delay_of_10_ms_in_one_sensor_is_found(make_case):
    case = make_case(3, n_outputs=12)
    for seed in range(12):
        output = seed % 12

        def delay(z: np.ndarray, output: int = output) -> None:
            z[:, output] *= np.exp(-0.01j * FREQUENCIES)

        found = fit_and_test(measure(case, seed, case, delay), case.free())
        name = case.model.outputs[output]
        one = next(t for t in found if (t.hypothesis, t.subject) == (Hypothesis.OUTPUT_DELAY, name))
        assert one.rejects
        assert one.estimate == pytest.approx(0.01, rel=0.3)
        sensor = next(t for t in found if t.hypothesis is Hypothesis.SENSOR_CONSISTENCY)
        assert sensor.rejects, "the estimate changes without it"


def test_a_sensor_scale_of_3_percent_is_found(make_case):
    case = make_case(3, n_outputs=12)
    found, changed = [], []
    for seed in range(12):
        output = seed % 12

        def scale(z: np.ndarray, output: int = output) -> None:
            z[:, output] *= 1.03

        tests = fit_and_test(measure(case, seed, case, scale), case.free())
        found.append(tests[0].rejects)
        one = next(t for t in tests if t.hypothesis is Hypothesis.SENSOR_CONSISTENCY)
        changed.append(one.rejects)
    assert np.mean(found) >= 0.95
    assert np.mean(changed) >= 0.9


def test_an_omitted_mode_is_found(make_case):
    true, fitted = make_case(4), make_case(3)
    u = measure(true, 0, fitted)
    for seed in range(3):
        found = fit_and_test(measure(true, seed, fitted), fitted.free())
        assert found[0].rejects
        assert found[0].hypothesis is Hypothesis.RESIDUAL_RESPONSE
    estimate = maximize([u], fitted.free())
    tests = compute_model_tests([u], fitted.free(), estimate.values, extended_models=[true.model])
    mode = next(t for t in tests if t.hypothesis is Hypothesis.FURTHER_MODE)
    assert mode.rejects
    assert mode.subject == f"mode {true.model.modes.numbers[-1]}"


def test_a_wrongly_held_derivative_is_found_with_its_size(make_case):
    case = make_case(1, n_outputs=10)
    truth = case.truth.named()["Cm_q"]
    parameters = select_parameters(
        case.truth, None, case.model.outputs, fixed={"Cm_q": 1.3 * truth}
    )
    held = next(
        t
        for t in fit_and_test(measure(case, 0, case), parameters)
        if t.hypothesis is Hypothesis.DERIVATIVE
    )
    assert held.subject == "Cm_q"
    assert held.rejects
    assert held.estimate == pytest.approx(-0.3 * truth, rel=0.2)


def test_a_lag_of_the_forces_and_a_delay_of_an_input_are_found(make_case):
    """Surfaces that act late, alone and together with all other forces."""
    case = make_case(1, n_outputs=10)
    u = excite()
    late = u.copy()
    late[:, 1] *= np.exp(-0.005j * FREQUENCIES)
    z = (case.model.response(case.truth, FREQUENCIES) @ late[:, :, None])[:, :, 0]
    rng = np.random.default_rng(0)
    level = 0.01 * np.sqrt(np.mean(np.abs(z) ** 2, axis=0))
    z += level * (rng.normal(size=z.shape) + 1j * rng.normal(size=z.shape))
    tests = fit_and_test(case.experiment(u, z, FREQUENCIES), case.free())
    found = {(t.hypothesis, t.subject): t for t in tests}
    one = found[Hypothesis.INPUT_DELAY, case.model.inputs[1]]
    assert one.rejects
    assert one.estimate == pytest.approx(0.005, rel=0.3)


def test_free_quantities_and_too_few_frequencies_are_not_tested(make_case):
    case = make_case(1, n_outputs=10)
    name = case.model.outputs[0]
    parameters = case.free((f"delay_{name}",))
    tests = fit_and_test(measure(case, 0, case), parameters)
    assert (Hypothesis.OUTPUT_DELAY, name) not in {(t.hypothesis, t.subject) for t in tests}
    u, z = case.spectra(0, FREQUENCIES[:15])
    few = case.experiment(u, z, FREQUENCIES[:15])
    assert compute_model_tests([few], case.free(), case.truth.values.ravel()) == ()


def measure_with_wrong_az(case: Case, seed: int, factor: float) -> Experiment:
    """A rigid aircraft: noise of 20 % on all outputs but az, which has a wrong scale and a lag."""
    rng = np.random.default_rng(seed)

    def change(z: np.ndarray) -> None:
        z[:, 4] *= factor * np.exp(-0.03j * FREQUENCIES)
        level = 0.2 * np.sqrt(np.mean(np.abs(z[:, :4]) ** 2, axis=0))
        z[:, :4] += level * (rng.normal(size=(len(z), 4)) + 1j * rng.normal(size=(len(z), 4)))

    whole = measure(case, seed, case, change)
    low = slice(60)  # of the short period
    return case.experiment(whole.inputs[low], whole.measured[low], FREQUENCIES[low])


def test_the_estimate_without_a_wrong_sensor_is_that_of_a_fit_without_it(make_case):
    """The one step from the optimum is close to the fit, and the sensor is named."""
    case, without = make_case(0, n_outputs=5), make_case(0, n_outputs=4)
    parameters = case.free()
    k = parameters.names.index("CZ_alpha")
    experiment = measure_with_wrong_az(case, 0, factor=2.0)
    estimate = maximize([experiment], parameters)
    tests = compute_model_tests([experiment], parameters, estimate.values)
    found = [t for t in tests if t.hypothesis is Hypothesis.SENSOR_CONSISTENCY]
    az = found[0].influence
    assert found[0].rejects
    assert found[0].subject == "az_egi"
    assert az is not None
    u, z = experiment.inputs, experiment.measured[:, :4]
    refit = maximize([without.experiment(u, z, experiment.omega)], parameters)
    change, std = refit.values[k] - estimate.values[k], refit.std_errors[k]
    assert abs(az.change[k]) > 4.0 * az.change_std[k], "the sensor matters"
    assert az.change[k] == pytest.approx(change, abs=float(0.3 * std))
    assert az.std_ratio[k] * estimate.std_errors[k] == pytest.approx(std, rel=0.3)


def test_changes_without_a_sensor_have_their_standard_deviations(make_case):
    case = make_case(1, n_outputs=10)
    z = []
    for seed in range(12):
        for test in fit_and_test(measure(case, seed, case), case.free()):
            if test.influence is not None:
                z += (test.influence.change / test.influence.change_std).tolist()
    assert float(np.nanstd(np.array(z))) == pytest.approx(1.0, abs=0.1)


def test_a_parameter_that_only_one_sensor_determines_has_no_change(make_case):
    """The delay of an output is not determined without it."""
    case = make_case(1, n_outputs=10)
    name = case.model.outputs[3]
    parameters = case.free((f"delay_{name}",))
    for test in fit_and_test(measure(case, 0, case), parameters):
        if test.influence is not None:
            is_known = np.isfinite(test.influence.change[parameters.names.index(f"delay_{name}")])
            assert is_known == (test.subject != name)


def test_the_elimination_of_nuisance_parameters_of_one_output_changes_no_influence(make_case):
    """Errors of mode shapes as nuisance parameters, and as results that nothing eliminates."""
    case = make_case(1, n_outputs=10)
    errors = tuple(f"shape_error_{name}_7" for name in case.model.outputs if name != "alpha")
    parameters, priors = case.free(errors), dict.fromkeys(errors, (0.0, 0.05))
    experiment = measure(case, 0, case)
    estimate = maximize([experiment], parameters, FitSettings(priors=priors))
    common = [k for k, name in enumerate(parameters.names) if name not in errors]
    both = []
    for nuisance in (frozenset(errors), frozenset[str]()):
        tests = compute_model_tests(
            [experiment], parameters, estimate.values, priors, nuisance=nuisance
        )
        both.append({one.subject: one.influence for one in tests if one.influence is not None})
    assert both[0].keys() == both[1].keys() == set(case.model.outputs)
    for name, eliminated in both[0].items():
        whole = both[1][name]
        for field in ("change", "change_std", "std_ratio"):
            found, expected = getattr(eliminated, field)[common], getattr(whole, field)[common]
            assert found == pytest.approx(expected, rel=1e-3, nan_ok=True)
