"""A user relies on: no bias where the controller moves the surfaces with turbulence."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from flexsid.errors import Cancelled
from flexsid.sysid.estimation.estimate import Outcome
from flexsid.sysid.estimation.experiment import Experiment, Parameters
from flexsid.sysid.estimation.feedback_noise import (
    CorrectedInputs,
    ErrorsInVariablesModel,
    has_feedback_noise,
    remove_feedback_noise,
)
from flexsid.sysid.estimation.flight_noise import (
    AssignedCommands,
    estimate_joint_noise,
    estimate_joint_noise_of_part,
    has_input_noise,
)
from flexsid.sysid.estimation.frequency_domain_model import FrequencyDomainModel
from flexsid.sysid.estimation.kronecker import NormalForm
from flexsid.sysid.estimation.likelihood import FitSettings, maximize
from flexsid.sysid.estimation.noise import NoiseSpectrum
from flexsid.sysid.estimation.output_error import output_error
from flexsid.sysid.estimation.weighted_fit import weight_by_noise_spectrum
from flexsid.sysid.signals import FrequencyData

OMEGA = 2.0 * np.pi * np.arange(6, 256) / 24.0  # five inputs, fifty harmonics each
FITS = 30


class Flight:
    """Spectra of a maneuver in turbulence, with feedback of all outputs to all surfaces."""

    def __init__(self, case, gust: float, gain: float) -> None:
        rng = np.random.default_rng(1)
        self.case, self.gust = case, gust
        assigned = np.arange(OMEGA.size) % 5
        command = np.exp(2j * np.pi * rng.uniform(size=OMEGA.size))
        self.commands = AssignedCommands(assigned, command)
        self.excitation = command[:, None] * np.eye(5)[assigned]
        self.H = case.model.response(case.truth, OMEGA)
        table = case.truth.values.copy()
        table[:, -1] = table[:, 0]  # a gust acts like the angle of attack
        as_surface = type(case.truth)(case.truth.modes, case.truth.inputs, table)
        self.G = case.model.response(as_surface, OMEGA)[:, :, -1]
        power = np.sqrt(np.mean(np.abs(self.H) ** 2, axis=(0, 2)))
        self.level = 0.01 * power
        n_y = power.size
        K = gain * rng.normal(size=(5, n_y)) / power / n_y
        self.K = K
        self.loop = np.linalg.inv(np.eye(5) + K @ self.H)

    def record(self, seed: int):
        rng = np.random.default_rng(100 + seed)

        def white(*shape: int) -> np.ndarray:
            return (rng.normal(size=shape) + 1j * rng.normal(size=shape)) / np.sqrt(2.0)

        model, n_y = self.case.model, self.level.size
        disturbed = self.gust * white(OMEGA.size, 1) * self.G
        noise = self.level * white(OMEGA.size, n_y)
        # u = r - K (H u + gust + noise)
        driven = self.excitation - (disturbed + noise) @ self.K.T
        u = np.matmul(self.loop, driven[:, :, None])[:, :, 0]
        z = np.matmul(self.H, u[:, :, None])[:, :, 0] + disturbed + noise
        inputs = FrequencyData(OMEGA, u, model.inputs)
        outputs = FrequencyData(OMEGA, z, model.outputs)
        return output_error(model, inputs, outputs, np.ones(z.shape, dtype=complex))


def estimate_noise(record: Experiment, commands: AssignedCommands) -> NoiseSpectrum | None:
    signals = np.concatenate([record.measured, record.inputs], axis=1)
    return estimate_joint_noise(record.omega, signals, commands)


def remove_noise(
    record: Experiment, commands: AssignedCommands, free: Parameters
) -> CorrectedInputs:
    noise = estimate_noise(record, commands)
    assert noise is not None
    found = remove_feedback_noise([record], [noise], free, FitSettings())
    assert found is not None
    return found


def test_errors_in_variables_hold_the_truth_where_output_error_is_biased(make_case):
    flight = Flight(make_case(1), gust=0.1, gain=1.0)
    truth, free = flight.case.truth.values.ravel(), flight.case.free()
    errors, sigmas, biased = [], [], []
    for seed in range(FITS):
        record = flight.record(seed)
        assert has_input_noise(record.inputs, flight.commands)
        found = remove_noise(record, flight.commands, free)
        assert found.is_significant
        first = maximize([record], free)
        biased.append(first.values - truth)
        corrected = list(found.experiments)
        base = maximize(corrected, free, FitSettings(max_iterations=0))
        base = replace(base, outcome=Outcome.CONVERGED)
        final = weight_by_noise_spectrum(
            corrected, free, base, FitSettings(), start=found.theta, known=found.noise
        )
        # With its noise spectrum, output error of the corrected data has the same optimum.
        assert np.max(np.abs(final.values - found.theta) / final.std_errors) < 0.2
        errors.append(final.values - truth)
        sigmas.append(final.std_errors)
    inside = np.mean(np.abs(errors) <= 2.0 * np.array(sigmas))
    assert 0.92 <= inside <= 0.985, f"{inside:.3f}"
    spread = np.std(errors, axis=0)
    bias = np.abs(np.mean(errors, axis=0)) / spread
    before = np.abs(np.mean(biased, axis=0)) / spread
    assert np.max(before) > 2.5, np.max(before)
    assert np.max(bias) < 4.0 / np.sqrt(FITS), np.max(bias)


def test_gradient_of_errors_in_variables_is_that_of_differences(make_case):
    flight = Flight(make_case(1), gust=0.1, gain=1.0)
    record, free = flight.record(0), flight.case.free()
    noise = estimate_noise(record, flight.commands)
    assert noise is not None
    model = FrequencyDomainModel(record, free)
    one = ErrorsInVariablesModel(model, NormalForm(model), noise)
    theta = free.start * 1.01 + 1e-3
    N, g = one.expand(theta, one.evaluate(theta))
    gradient, size = -2.0 * g, np.sqrt(np.diag(N))
    for k in range(theta.size):
        step = np.zeros(theta.size)
        step[k] = 1e-6 * max(abs(theta[k]), 1e-2)
        change = one.evaluate(theta + step).cost - one.evaluate(theta - step).cost
        # In standard errors: differences of a cost of many terms have rounding.
        expected = change / (2.0 * step[k])
        assert gradient[k] == pytest.approx(expected, rel=1e-4, abs=1e-3 * size[k])


def test_corrected_data_have_the_residuals_of_the_measured_ones(make_case):
    flight = Flight(make_case(1), gust=0.1, gain=1.0)
    record, free = flight.record(0), flight.case.free()
    found = remove_noise(record, flight.commands, free)
    corrected = found.experiments[0]
    residuals = [
        one.measured - FrequencyDomainModel(one, free).respond(found.theta).outputs
        for one in (record, corrected)
    ]
    assert residuals[1] == pytest.approx(residuals[0], abs=1e-9 * np.abs(record.measured).max())
    # Nearer to the deflections that the commands alone cause.
    exact = np.matmul(flight.loop, flight.excitation[:, :, None])[:, :, 0]
    errors = [np.mean(np.abs(one.inputs - exact) ** 2) for one in (record, corrected)]
    assert errors[1] < 0.2 * errors[0]


def test_the_noise_of_unequally_spaced_harmonics_is_that_of_equally_spaced_ones():
    """A response that is a straight line over frequency is no noise, whatever its harmonics."""
    rng = np.random.default_rng(0)
    omega = np.sort(rng.choice(np.arange(20, 700), 300, replace=False)) / 4.0
    command = np.exp(2j * np.pi * rng.uniform(size=300))
    commands = AssignedCommands(np.arange(300) % 3, command)
    line = (1.0 + 0.5 * omega)[:, None] * np.array([1.0, -2.0j])
    noise = rng.normal(size=(300, 4)) @ np.array([[1, 0], [1j, 0], [0, 3], [0, 3j]])
    found = estimate_joint_noise(omega, line * command[:, None] + noise, commands)
    assert found is not None
    power = np.mean(np.real(np.einsum("bii->bi", found.density.blocks)), axis=0)
    assert power == pytest.approx([2.0, 18.0], rel=0.2)


def test_the_noise_of_a_part_of_a_maneuver_has_no_part_of_the_response_to_commands():
    """All commands excite every frequency, and the ends of the record add free motions."""
    rng = np.random.default_rng(0)

    def white(*shape: int) -> np.ndarray:
        return rng.normal(size=(*shape, 2)) @ [1.0, 1.0j]

    omega, edges_s = 2.0 * np.pi * np.arange(5, 205) / 10.0, (0.7, 10.7)
    commands = white(200, 5)
    free = np.exp(-1j * np.outer(omega, edges_s))
    motion = 50.0 * (commands @ white(5, 3) + free @ white(2, 3))
    noise = white(200, 3) @ np.diag([1.0, 2.0, 3.0]) + 8.0 * white(200, 1)
    found = estimate_joint_noise_of_part(omega, motion + noise, commands, edges_s)
    assert found is not None
    density = np.mean(found.density.expand_blocks(), axis=0)
    exact = 128.0 + np.diag([2.0, 8.0, 18.0])
    assert np.linalg.norm(density - exact) < 0.2 * np.linalg.norm(exact)
    assert np.diag(np.linalg.inv(density)) == pytest.approx(np.diag(np.linalg.inv(exact)), rel=0.3)
    assert estimate_joint_noise_of_part(omega[:12], motion[:12], commands[:12], edges_s) is None


def test_without_feedback_there_is_nothing_to_remove(make_case):
    flight = Flight(make_case(1), gust=0.03, gain=0.0)
    record = flight.record(0)
    assert not has_input_noise(record.inputs, flight.commands)
    found = remove_noise(record, flight.commands, flight.case.free())
    assert not found.is_significant
    noise = estimate_noise(record, flight.commands)
    assert noise is not None
    exact = replace(flight.case.free(), start=flight.case.truth.values.ravel())
    assert not has_feedback_noise(record, noise, exact)


def test_harmonics_without_a_command_or_too_few_of_them_are_left(make_case):
    flight = Flight(make_case(1), gust=0.1, gain=1.0)
    record, commands = flight.record(0), flight.commands
    silent = AssignedCommands(commands.assigned_input, commands.values.copy())
    silent.values[3] = 0.0
    unknown = AssignedCommands(commands.assigned_input.copy(), commands.values)
    unknown.assigned_input[3] = -1
    few = AssignedCommands(np.arange(OMEGA.size) // 3, commands.values)
    for one in (silent, unknown, few):
        assert not has_input_noise(record.inputs, one)
        assert estimate_noise(record, one) is None


def test_errors_in_variables_are_cancelled_between_iterations(make_case):
    flight = Flight(make_case(1), gust=0.1, gain=1.0)
    numbers: list[int] = []

    def report(number: int) -> None:
        numbers.append(number)
        if number == 4:
            raise Cancelled("cancelled")

    record = flight.record(0)
    noise = estimate_noise(record, flight.commands)
    assert noise is not None
    with pytest.raises(Cancelled):
        remove_feedback_noise([record], [noise], flight.case.free(), FitSettings(), report)
    assert numbers == [1, 2, 3, 4]
