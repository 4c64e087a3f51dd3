"""A user relies on: low peak factors, computed accurately and reproducible from the seed."""

from __future__ import annotations

import numpy as np
import pytest

from flexsid.errors import Cancelled
from flexsid.sysid.excitation.catalogue import CATALOGUE
from flexsid.sysid.excitation.peak_factor import (
    QUICK,
    THOROUGH,
    FoundPhases,
    HarmonicSpectrum,
    evaluate_peak_factor,
    evaluate_peak_factors,
    lower_norms,
    refine_peaks,
    relative_peak_factor,
    schroeder_phases,
    search_phases,
    start_at_zero,
)


def flat(n: int, first: int = 6, spacing: int = 5) -> HarmonicSpectrum:
    return HarmonicSpectrum(first + spacing * np.arange(n), np.full(n, np.sqrt(2.0 / n)))


def test_table_1_has_24_designs_with_177_inputs():
    assert len(CATALOGUE) == 24
    assert sum(len(aid.harmonics()) for aid in CATALOGUE.values()) == 177
    assert CATALOGUE[524].harmonics()["throttle"].tolist() == [1, 2]
    numbers = sorted(number for aid in CATALOGUE.values() for number in aid.numbers)
    assert (numbers[0], numbers[-1], len(numbers)) == (500, 576, 72)


@pytest.mark.parametrize("number", CATALOGUE)
def test_no_design_of_table_1_shares_a_harmonic_and_all_are_orthogonal(number: int):
    dealt = CATALOGUE[number].harmonics(6)
    highest = max(int(own.max()) for own in dealt.values())
    time = np.arange(4 * highest)[:, None] / (4 * highest)
    generator = np.random.default_rng(number)
    columns = []
    for own in dealt.values():
        spectrum = HarmonicSpectrum(own, np.full(own.size, np.sqrt(2.0 / own.size)))
        phases = generator.uniform(-np.pi, np.pi, own.size)
        columns.append(np.sin(2.0 * np.pi * time * own + phases) @ spectrum.amplitudes)
    samples = np.stack(columns, axis=1)
    gram = samples.T @ samples / len(samples)
    assert np.abs(gram - np.eye(len(dealt))).max() < 1e-12


@pytest.mark.parametrize(("n", "bar"), [(7, 1.19), (13, 1.13), (25, 1.11), (65, 1.085)])
def test_peaks_are_close_to_the_lowest_known(n: int, bar: float):
    assert search_phases(flat(n), THOROUGH, seed=0).peak_factor < bar


def test_harmonics_of_a_common_base_go_below_one():
    assert search_phases(flat(20, first=1, spacing=1), THOROUGH, seed=0).peak_factor < 1.0


def test_same_seed_finds_the_same():
    one, other = (search_phases(flat(13), QUICK, seed=3) for _ in range(2))
    np.testing.assert_array_equal(one.phases, other.phases)


def test_peak_factor_agrees_with_a_very_fine_grid_and_coarse_grids_are_optimistic():
    spectrum = flat(25)
    phases = np.random.default_rng(2).uniform(-np.pi, np.pi, (40, 25))
    fine = [
        relative_peak_factor(wave) for wave in spectrum.on_grid(phases, spectrum.grid_size(512))
    ]
    np.testing.assert_allclose(evaluate_peak_factors(spectrum, phases), fine, rtol=2e-4)
    coarse = [
        relative_peak_factor(wave) for wave in spectrum.on_grid(phases, spectrum.grid_size(4))
    ]
    assert np.mean(coarse) < np.mean(fine) - 0.01


def test_norms_and_refinement_each_lower_the_peak():
    spectrum = flat(33)
    start = schroeder_phases(spectrum.amplitudes)
    normed = lower_norms(spectrum, start[None])[0]
    refined = refine_peaks(spectrum, normed)
    factors = [evaluate_peak_factor(spectrum, phases) for phases in (start, normed, refined)]
    assert factors[0] > factors[1] + 0.1 > factors[2] + 0.1


def test_shift_in_time_starts_at_zero_and_preserves_the_peak_factor():
    spectrum = flat(25)
    found = search_phases(spectrum, QUICK)
    shifted = start_at_zero(spectrum.harmonics, spectrum.amplitudes, found.phases)
    assert abs(np.sum(spectrum.amplitudes * np.sin(shifted))) < 1e-12
    assert evaluate_peak_factor(spectrum, shifted) == pytest.approx(found.peak_factor, abs=2e-4)


def test_one_tone_is_a_sine():
    assert search_phases(flat(1)).peak_factor == pytest.approx(1.0)


@pytest.mark.parametrize("harmonics", [(1, 2), (1, 3), (6, 7), (2, 4)])
def test_two_low_harmonics_of_a_throttle(harmonics: tuple[int, int]):
    spectrum = HarmonicSpectrum(np.array(harmonics), np.ones(2))
    assert search_phases(spectrum, THOROUGH).peak_factor <= np.sqrt(2.0) + 1e-9


def test_search_reports_its_best_and_can_be_stopped():
    reports: list[tuple[float, float]] = []

    def report(best: FoundPhases, fraction: float) -> None:
        reports.append((best.peak_factor, fraction))
        if fraction > 0.5:
            raise Cancelled("enough")

    with pytest.raises(Cancelled):
        search_phases(flat(13), THOROUGH, report=report)
    factors = [factor for factor, _ in reports]
    assert factors == sorted(factors, reverse=True)
    assert reports[0][1] < 0.5 < reports[-1][1]
