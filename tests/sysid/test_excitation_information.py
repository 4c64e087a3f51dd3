"""A user relies on: predicted errors decrease with amplitude, and optimised amplitudes."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import optimize

from flexsid.errors import BadInput, NotIdentifiable
from flexsid.sysid.estimation.flight_noise import RecordResiduals, split_residuals
from flexsid.sysid.excitation import input_optimisation
from flexsid.sysid.excitation.fisher_information import FisherInformation
from flexsid.sysid.excitation.input_optimisation import (
    OptimisationFailed,
    optimise_amplitudes_d_optimal,
    optimise_amplitudes_minimax,
)

TIME = np.arange(4096) / 4096


def make_information(theta: tuple[float, float] = (1.0, -1.0)) -> FisherInformation:
    """Two parameters: the first identified by input a only, the second by b, four times weaker."""
    information = np.zeros((2, 2, 2))
    information[0, 0, 0], information[1, 1, 1] = 100.0, 100.0 / 16.0
    waves = np.sin(2.0 * np.pi * np.outer([31.0, 64.0], TIME))[:, :, None]
    return FisherInformation(
        names=("p", "q"),
        inputs=("a", "b"),
        theta=np.array(theta),
        information=information,
        prior=np.zeros(2),
        limited=("load factor",),
        waves=waves,
    )


def test_errors_shrink_with_the_amplitude():
    information = make_information()
    np.testing.assert_allclose(information.std_errors(), [0.1, 0.4])
    np.testing.assert_allclose(information.std_errors(np.array([2.0, 4.0])), [0.05, 0.1])


def test_minimax_amplitudes_equalise_relative_errors_within_the_limit():
    """Errors are equal at g_b = 4 g_a, whatever the limit; peaks of two sines add."""
    information = make_information()
    gains = optimise_amplitudes_minimax(information, information.peaks())
    assert gains[1] / gains[0] == pytest.approx(4.0, rel=0.1)
    assert information.peaks(gains)[0] <= information.peaks()[0] * (1.0 + 1e-9)
    assert information.std_errors(gains).max() < 0.8 * information.std_errors().max()


def test_d_optimal_gives_every_input_the_same_power():
    information = make_information()
    gains = optimise_amplitudes_d_optimal(information, information.peaks())
    assert gains[1] == pytest.approx(gains[0], rel=0.05)
    volumes = [
        np.linalg.slogdet(information.covariance(g))[1] for g in (gains, np.array([0.6, 1.4]))
    ]
    assert volumes[0] < volumes[1]


def test_only_target_parameters_enter_the_criterion():
    information = make_information((1.0, 0.0))
    with pytest.raises(BadInput, match="zero"):
        optimise_amplitudes_minimax(information, information.peaks())
    gains = optimise_amplitudes_minimax(information, information.peaks(), np.array([True, False]))
    assert gains[0] > 10.0 * gains[1]


def test_unlimited_amplitudes_are_refused():
    with pytest.raises(BadInput, match="limit"):
        optimise_amplitudes_minimax(make_information(), np.array([np.inf]))


def test_a_failed_optimiser_is_detected(monkeypatch: pytest.MonkeyPatch):
    def stuck(criterion: object, start: np.ndarray, **options: object) -> optimize.OptimizeResult:
        found = optimize.OptimizeResult()
        found.update(x=start, success=True, nit=0, message="stuck")
        return found

    monkeypatch.setattr(input_optimisation.optimize, "minimize", stuck)
    with pytest.raises(OptimisationFailed, match="stuck"):
        optimise_amplitudes_minimax(make_information(), np.array([1.0]))


def test_a_parameter_without_information_is_not_identifiable():
    with pytest.raises(NotIdentifiable, match="not identifiable"):
        make_information().std_errors(np.array([1.0, 0.0]))


@pytest.mark.parametrize("error", [0.0, 3.0])
def test_model_error_grows_with_the_command_and_noise_does_not(error: float):
    """Noise of density 2 beside an error that is smooth in frequency, commands of changing size."""
    rng = np.random.default_rng(1)
    omega = 0.3 * np.arange(10, 210)
    assigned_input = np.arange(200) % 2
    record_s = 25.0
    size = np.sqrt(record_s)
    command = size * np.exp(2j * np.pi * rng.uniform(size=200)) * np.where(assigned_input, 1.0, 2.0)
    noise = size * (rng.normal(size=(200, 3)) + 1j * rng.normal(size=(200, 3)))
    smooth = error * np.exp(0.02j * omega)[:, None] * np.array([1.0, 2.0, 3.0])
    density, unmodelled = split_residuals(
        [
            RecordResiduals(
                omega, noise + smooth * command[:, None], record_s, assigned_input, command
            )
        ],
        ("a", "b"),
        n_theta=10,
    )
    level = np.real(np.diagonal(density(omega), axis1=1, axis2=2)).mean(axis=0)
    np.testing.assert_allclose(level, 2.0, rtol=0.3)
    for name in ("a", "b"):
        found = np.sqrt(np.mean(np.abs(unmodelled[name](omega)) ** 2, axis=0))
        np.testing.assert_allclose(found, error * np.array([1.0, 2.0, 3.0]), rtol=0.2, atol=0.6)


def test_without_commands_all_residuals_are_noise():
    omega = 0.3 * np.arange(1, 41)
    left = np.full((40, 2), 5.0 + 0.0j)
    density, unmodelled = split_residuals(
        [RecordResiduals(omega, left, 25.0, np.full(40, -1), None)], ("a",), n_theta=80
    )
    np.testing.assert_allclose(np.real(density(omega))[:, 0, 0], 2.0)
    assert unmodelled == {}
