"""A user relies on: turbulence is recognised from the motion that no command excites."""

from __future__ import annotations

import numpy as np
import pytest

from flexsid.sysid.estimation.flight_noise import AssignedCommands, estimate_process_noise

N, INPUTS = 200, 4
OMEGA = 2.0 * np.pi * np.arange(6, 6 + N) / 24.0
ASSIGNED = np.arange(N) % INPUTS
SENSORS = np.diag([1e-4, 4e-4]) + 0j
"""Covariance of the reconstructed motion."""


def simulate(gust: float) -> tuple[np.ndarray, np.ndarray, AssignedCommands]:
    """Two motions and one surface, which feeds back half of the first motion of gusts."""
    rng = np.random.default_rng(3)

    def draw(size: int) -> np.ndarray:
        return rng.standard_normal((N, size, 2)) @ np.array([1.0, 1j]) / np.sqrt(2.0)

    command = np.exp(2j * np.pi * rng.random(N)) * (1.0 + ASSIGNED)
    response = 1.0 / (1j * OMEGA[:, None] + np.array([20.0, 40.0]))
    moved = gust * draw(2)
    motion = response * command[:, None] * 20.0 + moved + draw(2) * np.sqrt(np.diag(SENSORS).real)
    inputs = command[:, None] + 0.5 * moved[:, :1]
    return motion, inputs, AssignedCommands(ASSIGNED, command)


def test_the_accuracy_of_the_reconstruction_is_no_turbulence():
    motion, inputs, commands = simulate(0.0)
    known = np.tile(SENSORS, (N, 1, 1))
    assert estimate_process_noise(OMEGA, motion, known, inputs, commands) is None


def test_covariance_of_the_motion_by_gusts_and_of_the_surfaces_that_follow_it():
    motion, inputs, commands = simulate(0.1)
    known = np.tile(SENSORS, (N, 1, 1))
    found = estimate_process_noise(OMEGA, motion, known, inputs, commands)
    assert found is not None
    mean = found.covariance.mean(axis=0)
    assert np.real(np.diag(mean)) == pytest.approx([0.0101, 0.0104, 0.0025], rel=0.35)
    assert mean[0, 2].real == pytest.approx(0.005, rel=0.35)
    assert found.relative_std == pytest.approx(0.19, abs=0.01)


def test_without_a_command_at_a_harmonic_or_with_few_harmonics_nothing_is_estimated():
    motion, inputs, commands = simulate(0.1)
    known = np.tile(SENSORS, (N, 1, 1))
    silent = AssignedCommands(ASSIGNED, np.where(np.arange(N) == 7, 0.0, commands.values))
    assert estimate_process_noise(OMEGA, motion, known, inputs, silent) is None
    few = AssignedCommands(ASSIGNED[:20], commands.values[:20])
    assert estimate_process_noise(OMEGA[:20], motion[:20], known[:20], inputs[:20], few) is None
