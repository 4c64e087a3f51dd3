"""Modes from outputs alone: errors against standard errors, tones, close pairs, bad records."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pytest

from flexsid.errors import BadInput
from flexsid.sysid.modes.output_only import OutputOnlyModes, identify_output_only

_WARM_UP = 2000


class Wing(NamedTuple):
    """Modes that forces excite, which are white and held over a sample."""

    frequencies: np.ndarray  # [Hz]
    dampings: np.ndarray
    shapes: np.ndarray
    rate: float
    duration: float


def draw_wing(rng: np.random.Generator, pairs: int, outputs: int, duration: float) -> Wing:
    """Draw pairs of modes that are 1 % apart."""
    first = rng.uniform(2.0, 3.0) * np.cumprod(np.append(1.0, rng.uniform(1.3, 1.6, pairs - 1)))
    frequencies = np.sort(np.append(first, 1.01 * first))
    n = frequencies.size
    return Wing(
        frequencies,
        rng.uniform(0.008, 0.03, n),
        rng.normal(size=(n, outputs)),
        np.ceil(3.2 * frequencies[-1]),
        duration,
    )


def fly(
    rng: np.random.Generator, wing: Wing, tone: float | None = None, noise: float = 0.05
) -> np.ndarray:
    """Simulate accelerations, each mode as one complex state with exact transition."""
    omega = 2.0 * np.pi * wing.frequencies
    damped = omega * np.sqrt(1.0 - wing.dampings**2)
    pole = -wing.dampings * omega + 1j * damped
    n = int(wing.duration * wing.rate)
    mix = rng.normal(size=(max(3, omega.size // 2), omega.size))
    force = rng.normal(size=(n + _WARM_UP, mix.shape[0])) @ (mix / np.linalg.norm(mix, axis=0))
    step = np.exp(pole / wing.rate)
    gain = (step - 1.0) / pole
    state = np.zeros(omega.size, dtype=complex)
    states = np.empty((n + _WARM_UP, omega.size), dtype=complex)
    for k, one in enumerate(force):
        states[k] = state
        state = step * state + gain * one
    position, speed = np.imag(states) / damped, np.imag(pole * states) / damped
    modal = (force - 2.0 * wing.dampings * omega * speed - omega**2 * position)[_WARM_UP:]
    outputs = modal / modal.std(axis=0) @ wing.shapes
    outputs += noise * outputs.std() * rng.normal(size=outputs.shape)
    if tone is not None:
        wave = np.sin(2.0 * np.pi * tone * np.arange(n) / wing.rate)
        outputs += 0.5 * outputs.std() * np.outer(wave, rng.normal(size=outputs.shape[1]))
    return outputs


def identify(wing: Wing, outputs: np.ndarray) -> OutputOnlyModes:
    band = 2.0 * np.pi * np.array([0.75, 1.25]) * wing.frequencies[[0, -1]]
    return identify_output_only(outputs, 1.0 / wing.rate, (float(band[0]), float(band[1])))


def match(wing: Wing, found: OutputOnlyModes) -> list[tuple[int, int]]:
    """Pair true and found modes of like frequency by their shapes."""
    pairs: list[tuple[int, int]] = []
    for k, (frequency, shape) in enumerate(zip(wing.frequencies, wing.shapes, strict=True)):
        best = (0.5, -1)
        for j, other in enumerate(found.shapes):
            apart = abs(found.omega[j] / (2.0 * np.pi * frequency) - 1.0)
            allowed = max(0.006, 4.0 * found.std_omega[j] / found.omega[j])
            alike = abs(np.vdot(shape, other)) ** 2 / np.vdot(shape, shape) / np.vdot(other, other)
            if apart < allowed and j not in [one for _, one in pairs]:
                best = max(best, (float(np.real(alike)), j))
        if best[1] >= 0:
            pairs.append((k, best[1]))
    return pairs


def compute_errors(wing: Wing, found: OutputOnlyModes) -> np.ndarray:
    """Errors of frequency and damping in standard errors, by matched mode."""
    true, own = np.array(match(wing, found)).T
    omega = 2.0 * np.pi * wing.frequencies[true]
    return np.stack(
        [
            (found.omega[own] - omega) / found.std_omega[own],
            (found.damping[own] - wing.dampings[true]) / found.std_damping[own],
        ]
    )


def test_close_modes_and_an_engine_tone_are_found_with_their_errors():
    rng = np.random.default_rng(4)
    wing = draw_wing(rng, 1, 8, 150.0)
    tone = 1.13 * wing.frequencies[1]
    found = identify(wing, fly(rng, wing, tone))
    assert found.omega.size == 2
    assert found.tones / (2.0 * np.pi) == pytest.approx([tone], rel=1e-3)
    assert np.abs(compute_errors(wing, found)).max() < 4.0
    assert (found.std_damping < 0.5 * found.damping).all()
    # The model explains the measured density within chance.
    assert np.median(found.fitted / found.measured) == pytest.approx(1.0, abs=0.3)


@pytest.mark.long
def test_two_standard_errors_hold_the_truth():
    errors, missed, false, modes = [], 0, 0, 0
    for seed in range(12):
        rng = np.random.default_rng(100 + seed)
        wing = draw_wing(rng, int(rng.integers(3, 6)), int(rng.integers(8, 25)), 240.0)
        found = identify(wing, fly(rng, wing, 1.15 * wing.frequencies[0]))
        pairs = match(wing, found)
        modes += wing.frequencies.size
        missed += wing.frequencies.size - len(pairs)
        false += found.omega.size - len(pairs)
        errors.append(compute_errors(wing, found))
    inside = np.mean(np.abs(np.concatenate(errors, axis=1)) < 2.0, axis=1)
    assert (inside > 0.87).all(), inside
    assert missed <= 0.05 * modes
    assert false <= 0.05 * modes


def test_noise_has_no_modes():
    noise = np.random.default_rng(2).normal(size=(2000, 4))
    with pytest.raises(BadInput, match="do not differ from noise") as refused:
        identify_output_only(noise, 0.05, (2.0 * np.pi * 2.0, 2.0 * np.pi * 5.0))
    assert refused.value.code == "no-modes"


def test_records_that_cannot_be_used_are_refused():
    record = np.random.default_rng(3).normal(size=(200, 3))
    with pytest.raises(BadInput, match="fewer than"):
        identify_output_only(record, 0.05, (1.0, 20.0))
    with pytest.raises(BadInput, match="no output moves"):
        identify_output_only(0.0 * np.ones((4000, 3)), 0.05, (6.0, 20.0))
