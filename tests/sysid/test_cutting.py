"""Maneuvers are found in a flight from what was commanded, or from a marker."""

from __future__ import annotations

import numpy as np
import pytest

from flexsid.demo.flights import design_fta
from flexsid.sysid.preparation.cutting import find_excitations, find_marked_intervals

RATE = 200.0


def flight(parts: list[tuple[float, np.ndarray]], seconds: float, inputs: int = 5) -> np.ndarray:
    x = np.zeros((round(seconds * RATE), inputs))
    for at, part in parts:
        first = round(at * RATE)
        x[first : first + len(part), : part.shape[1]] = part
    return x


def multisine(periods: int, fta: int = 506) -> np.ndarray:
    designed = design_fta(fta, 2.0)
    n = round(periods * designed.period_s * RATE)
    return designed.sample(np.arange(n) / RATE)


@pytest.mark.parametrize("noise", [0.0, 1e-8])
def test_multisines_are_found_with_their_periods_and_harmonics(noise: float):
    expected = tuple(design_fta(506, 2.0).harmonics().values())
    x = flight([(31.0, multisine(1)), (77.0, multisine(3)), (170.0, multisine(1, 503))], 210.0)
    x += noise * np.random.default_rng(0).standard_normal(x.shape)
    found = find_excitations(x, RATE)
    assert [one.n_periods for one in found] == [1, 3, 1]
    for one, at in zip(found, (31.0, 77.0, 170.0), strict=True):
        assert one.period == 24 * RATE
        assert abs(one.first - at * RATE) <= 1
    assert tuple(map(tuple, found[0].harmonics)) == expected
    assert found[1].harmonics == found[0].harmonics
    assert found[2].harmonics == tuple(design_fta(503, 2.0).harmonics().values())


def test_a_doublet_and_a_sweep_are_found_without_harmonics():
    time = np.arange(round(10 * RATE)) / RATE
    doublet = np.repeat([0.03, -0.03], round(RATE))[:, None]
    sweep = 0.02 * np.sin(2 * np.pi * (0.2 + 0.15 * time) * time)[:, None]
    found = find_excitations(flight([(10.0, doublet), (30.0, sweep)], 60.0), RATE)
    assert [one.n_periods for one in found] == [1, 1]
    assert [one.harmonics for one in found] == [(), ()]
    assert found[0].first == 2000
    assert abs(found[0].stop - 2400) <= 1


def test_a_command_that_never_rests_exactly_is_found_by_its_size():
    rng = np.random.default_rng(1)
    x = flight([(40.0, multisine(1))], 120.0) + 2e-4 * rng.standard_normal((24000, 5))
    (found,) = find_excitations(x, RATE)
    assert abs(found.first - 8000) < 100
    assert abs(found.stop - 12800) < 100


def test_nothing_is_found_where_nothing_moves():
    assert find_excitations(np.zeros((1000, 2)), RATE) == ()
    assert find_marked_intervals(np.zeros(1000), RATE) == ()


def test_markers_give_numbers_and_ignore_blips():
    marker = np.zeros(20_000)
    marker[2000:7000] = 506
    marker[7000:12000] = 503
    marker[15000:15020] = 7
    found = find_marked_intervals(marker, RATE)
    assert [(one.first, one.stop, one.marker) for one in found] == [
        (2000, 7000, 506),
        (7000, 12000, 503),
    ]
