"""A user relies on: predicted errors that shrink as physics says, and a better allotment."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import optimize

from flexsid.errors import BadInput, NotIdentifiable
from flexsid.sysid.estimation import allocation
from flexsid.sysid.estimation.allocation import (
    NotAllocated,
    allocate_d_optimal,
    allocate_minimax,
)
from flexsid.sysid.estimation.as_flown import RecordResiduals, split_residuals
from flexsid.sysid.estimation.expectation import Expectation

TIME = np.arange(4096) / 4096


def expectation(theta: tuple[float, float] = (1.0, -1.0)) -> Expectation:
    """Two parameters: the first seen by input a alone, the second by b, four times weaker."""
    information = np.zeros((2, 2, 2))
    information[0, 0, 0], information[1, 1, 1] = 100.0, 100.0 / 16.0
    waves = np.sin(2.0 * np.pi * np.outer([31.0, 64.0], TIME))[:, :, None]
    return Expectation(
        names=("p", "q"),
        inputs=("a", "b"),
        theta=np.array(theta),
        information=information,
        scatter=information,
        prior=np.zeros(2),
        limited=("load factor",),
        waves=waves,
    )


def test_errors_shrink_with_the_amplitude():
    told = expectation()
    np.testing.assert_allclose(told.std_errors(), [0.1, 0.4])
    np.testing.assert_allclose(told.std_errors(np.array([2.0, 4.0])), [0.05, 0.1])


def test_amplitude_goes_where_the_worst_error_is_within_the_limit():
    """Errors are equal at g_b = 4 g_a, whatever the limit; peaks of two sines add."""
    told = expectation()
    gains = allocate_minimax(told, told.peaks())
    assert gains[1] / gains[0] == pytest.approx(4.0, rel=0.1)
    assert told.peaks(gains)[0] <= told.peaks()[0] * (1.0 + 1e-9)
    assert told.std_errors(gains).max() < 0.8 * told.std_errors().max()


def test_d_optimal_gives_every_input_the_same_power():
    told = expectation()
    gains = allocate_d_optimal(told, told.peaks())
    assert gains[1] == pytest.approx(gains[0], rel=0.05)
    volumes = [np.linalg.slogdet(told.covariance(g))[1] for g in (gains, np.array([0.6, 1.4]))]
    assert volumes[0] < volumes[1]


def test_only_parameters_that_count_decide():
    told = expectation((1.0, 0.0))
    with pytest.raises(BadInput, match="zero"):
        allocate_minimax(told, told.peaks())
    gains = allocate_minimax(told, told.peaks(), np.array([True, False]))
    assert gains[0] > 10.0 * gains[1]


def test_amplitudes_that_nothing_limits_are_refused():
    with pytest.raises(BadInput, match="limit"):
        allocate_minimax(expectation(), np.array([np.inf]))


def test_an_optimiser_that_fails_is_not_believed(monkeypatch: pytest.MonkeyPatch):
    def stuck(criterion: object, start: np.ndarray, **options: object) -> optimize.OptimizeResult:
        found = optimize.OptimizeResult()
        found.update(x=start, success=True, nit=0, message="stuck")
        return found

    monkeypatch.setattr(allocation.optimize, "minimize", stuck)
    with pytest.raises(NotAllocated, match="stuck"):
        allocate_minimax(expectation(), np.array([1.0]))


def test_what_no_input_shows_is_not_identifiable():
    with pytest.raises(NotIdentifiable, match="not told apart"):
        expectation().std_errors(np.array([1.0, 0.0]))


@pytest.mark.parametrize("error", [0.0, 3.0])
def test_model_error_grows_with_the_command_and_noise_does_not(error: float):
    """Noise of density 2 beside an error that is smooth in frequency, commands of changing size."""
    rng = np.random.default_rng(1)
    omega = 0.3 * np.arange(10, 210)
    owner = np.arange(200) % 2
    record_s = 25.0
    size = np.sqrt(record_s)
    command = size * np.exp(2j * np.pi * rng.uniform(size=200)) * np.where(owner, 1.0, 2.0)
    noise = size * (rng.normal(size=(200, 3)) + 1j * rng.normal(size=(200, 3)))
    smooth = error * np.exp(0.02j * omega)[:, None] * np.array([1.0, 2.0, 3.0])
    told, missed = split_residuals(
        [RecordResiduals(omega, noise + smooth * command[:, None], record_s, owner, command)],
        ("a", "b"),
        n_theta=10,
    )
    level = np.real(np.diagonal(told(omega), axis1=1, axis2=2)).mean(axis=0)
    np.testing.assert_allclose(level, 2.0, rtol=0.3)
    for name in ("a", "b"):
        found = np.sqrt(np.mean(np.abs(missed[name](omega)) ** 2, axis=0))
        np.testing.assert_allclose(found, error * np.array([1.0, 2.0, 3.0]), rtol=0.2, atol=0.6)


def test_without_commands_all_that_is_left_is_noise():
    omega = 0.3 * np.arange(1, 41)
    left = np.full((40, 2), 5.0 + 0.0j)
    told, missed = split_residuals(
        [RecordResiduals(omega, left, 25.0, np.full(40, -1), None)], ("a",), n_theta=80
    )
    np.testing.assert_allclose(np.real(told(omega))[:, 0, 0], 2.0)
    assert missed == {}
