"""Sensors rated by the modes they see, and places by what a further sensor adds."""

from __future__ import annotations

import numpy as np
import pytest

from flexsid.sysid.modes.observability import gather_information, rank_candidates
from flexsid.sysid.modes.thinning import neighbour_lines, spread_nodes

RNG = np.random.default_rng(4)


def test_standard_errors_are_those_of_draws():
    rows, rigid = RNG.normal(size=(12, 3)), RNG.normal(size=(12, 2))
    noise = RNG.uniform(0.5, 2.0, 12)
    told = gather_information(rows, rigid, noise)
    whole = np.concatenate([rows, rigid], axis=1) / noise[:, None]
    draws = np.linalg.lstsq(whole, RNG.normal(size=(12, 4000)), rcond=None)[0][:3]
    assert np.std(draws, axis=1) == pytest.approx(np.sqrt(np.diag(told.covariance)), rel=0.06)


def test_modes_that_cannot_be_told_apart_are_not_known():
    rows = np.array([[1.0, 1.0, 0.0], [2.0, 2.0, 1.0], [3.0, 3.0, 0.0]])
    told = gather_information(rows, np.zeros((3, 1)), np.ones(3))
    assert np.isinf(np.diag(told.covariance)).tolist() == [True, True, False]


def test_the_best_place_is_where_the_worst_known_mode_moves():
    rows = np.array([[10.0, 0.01], [8.0, -0.01], [9.0, 0.02]])
    told = gather_information(rows, np.zeros((3, 0)), np.ones(3))
    candidates = np.array([[10.0, 0.0], [0.0, 5.0], [1.0, 0.1]])
    gain, shrink = rank_candidates(told, candidates, np.zeros((3, 0)), 1.0)
    assert np.argmax(gain) == 1
    assert shrink[1, 1] < 0.05
    assert shrink[1, 0] > 0.8


def test_thinned_nodes_keep_the_tips_and_are_joined():
    nodes = np.column_stack([RNG.uniform(0, 1, 3000), RNG.uniform(-5, 5, 3000), np.zeros(3000)])
    shown = spread_nodes(nodes, 300)
    assert shown.size == np.unique(shown).size == 300
    gap = np.linalg.norm(nodes[:, None] - nodes[shown][None], axis=2).min(axis=1)
    assert gap.max() < 0.35
    assert np.ptp(nodes[shown, 1]) > 0.98 * np.ptp(nodes[:, 1])
    lines = neighbour_lines(nodes[shown])
    assert set(lines.ravel()) == set(range(300))
    assert spread_nodes(nodes[:10], 300).tolist() == list(range(10))
    assert neighbour_lines(nodes[:1]).shape == (0, 2)
