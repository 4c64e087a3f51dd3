"""A user relies on: no shared harmonics, exact orthogonality, gentle start, low peaks."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flexsid.errors import BadInput
from flexsid.sysid.excitation.catalogue import CATALOGUE
from flexsid.sysid.excitation.multisine import Multisine, assign_harmonics, design_multisine
from flexsid.sysid.excitation.peak_factor import lower_peak, relative_peak_factor, schroeder_phases

ORDER = ("bfs", "wf3s", "wf1s", "wf4s", "wf2s")
PEAKS = {"bfs": 1.0, "wf1s": 0.95, "wf2s": 0.90, "wf3s": 0.85, "wf4s": 0.80}


def design(number: int) -> Multisine:
    assigned = assign_harmonics(ORDER, CATALOGUE[number].harmonics_per_input, 6)
    peaks = {name: float(np.radians(2.0)) * relative for name, relative in PEAKS.items()}
    return design_multisine({name: assigned[name] for name in peaks}, 24.0, peaks)


def test_harmonics_are_dealt_in_turn():
    dealt = assign_harmonics(ORDER, 65, 6)
    assert [list(dealt[name][:2]) for name in ORDER] == [
        [6, 11],
        [7, 12],
        [8, 13],
        [9, 14],
        [10, 15],
    ]
    assert sorted(np.concatenate(list(dealt.values()))) == list(range(6, 331))


@pytest.mark.parametrize(("order", "first"), [(["a", "b", "a"], 1), (["a"], 0), (["a"], -4)])
def test_harmonics_that_nobody_could_fly_are_not_dealt(order: list[str], first: int):
    with pytest.raises(BadInput, match="cannot be assigned"):
        assign_harmonics(order, 3, first)


@pytest.mark.parametrize(("number", "count"), [(503, 25), (506, 65)])
def test_table_1_counts_are_per_input(number: int, count: int):
    assert CATALOGUE[number].harmonics_per_input == count
    harmonics = design(number).harmonics()
    assert {len(own) for own in harmonics.values()} == {count}


@pytest.mark.parametrize("number", [503, 506])
def test_design_is_orthogonal_gentle_and_of_the_size_asked(number: int):
    multisine = design(number)
    samples = multisine.sample(np.arange(24 * 1000) / 1000.0)
    gram = samples.T @ samples
    size = np.sqrt(np.diag(gram))
    assert np.abs(gram / np.outer(size, size) - np.eye(5)).max() < 1e-12
    assert np.abs(samples[0]).max() < 1e-12
    np.testing.assert_allclose(
        np.abs(samples).max(axis=0), np.radians(2.0) * np.array(list(PEAKS.values())), rtol=2e-3
    )
    assert multisine.inputs == tuple(PEAKS)
    assert max(relative_peak_factor(column) for column in samples.T) < 1.2


@settings(max_examples=25)
@given(
    per_input=st.integers(1, 20),
    first=st.integers(1, 12),
    n_inputs=st.integers(1, 6),
    rate=st.sampled_from([40, 50, 100]),
)
def test_any_layout_is_orthogonal_over_its_period(
    per_input: int, first: int, n_inputs: int, rate: int
):
    names = tuple(f"u{index}" for index in range(n_inputs))
    harmonics = assign_harmonics(names, per_input, first)
    multisine = design_multisine(harmonics, 10.0, dict.fromkeys(names, 1.0))
    samples = multisine.sample(np.arange(10 * rate) / rate)
    gram = samples.T @ samples
    size = np.sqrt(np.diag(gram))
    assert np.abs(gram / np.outer(size, size) - np.eye(n_inputs)).max() < 1e-12
    assert np.abs(samples[0]).max() < 1e-10


@pytest.mark.parametrize("number", [503, 506])
def test_running_integral_starts_at_its_mean(number: int):
    """Else the attitude, which follows it, would be left displaced when the excitation ends."""
    integral = np.cumsum(design(number).sample(np.arange(24_000) / 1000.0), axis=0)
    assert np.abs(integral.mean(axis=0)).max() < 0.02 * np.ptp(integral, axis=0).max()


def test_every_input_excites_its_own_harmonics_only():
    multisine = design(503)
    spectrum = np.abs(np.fft.rfft(multisine.sample(np.arange(4800) / 200.0), axis=0)) / 2400.0
    for column, (name, own) in enumerate(multisine.harmonics().items()):
        elsewhere = np.delete(spectrum[:, column], list(own))
        assert elsewhere.max() < 1e-12, name
        assert np.ptp(spectrum[list(own), column]) < 1e-12, name


def test_shared_harmonics_are_refused():
    shared = {"a": np.array([3, 4]), "b": np.array([4, 5])}
    with pytest.raises(ValueError, match="share a harmonic"):
        design_multisine(shared, 10.0, {"a": 1.0, "b": 1.0})


def test_single_sine_has_peak_factor_one():
    assert relative_peak_factor(np.sin(2.0 * np.pi * np.arange(1000) / 1000.0)) == pytest.approx(
        1.0
    )


def test_clipping_lowers_the_peak_of_schroeder_phases():
    harmonics = np.arange(6, 71)
    amplitudes = np.ones(65)
    start = schroeder_phases(amplitudes)
    time = np.arange(8192) / 8192.0

    def factor(phases: np.ndarray) -> float:
        return relative_peak_factor(
            np.sin(2.0 * np.pi * np.outer(time, harmonics) + phases) @ amplitudes
        )

    assert factor(lower_peak(harmonics, amplitudes, start)) < factor(start) - 0.05


def test_parts_of_independent_sides_have_the_harmonics_of_both():
    assigned = assign_harmonics(("wf1l", "wf1r"), 20, 6)
    sides = design_multisine(assigned, 24.0, {"wf1l": 0.02, "wf1r": 0.03})
    parts = sides.combine({"wf1s": {"wf1l": 0.5, "wf1r": 0.5}, "wf1a": {"wf1l": -0.5, "wf1r": 0.5}})
    time_s = np.arange(0.0, 24.0, 0.01)
    left, right = sides.sample(time_s).T
    np.testing.assert_allclose(
        parts.sample(time_s),
        np.column_stack([0.5 * (left + right), 0.5 * (right - left)]),
        atol=1e-15,
    )
    for tones in parts.tones.values():
        assert tones.harmonics.tolist() == sorted((*assigned["wf1l"], *assigned["wf1r"]))
