"""Sensors rated by the modes they see, and places by what a further sensor adds."""

from __future__ import annotations

import numpy as np
import pytest

from flexsid.sysid.modes.assurance import compute_modal_information, rank_candidate_sensors
from flexsid.sysid.modes.shapes import connect_neighbours, contract_lines, select_spread_nodes

RNG = np.random.default_rng(4)


def test_standard_errors_are_those_of_draws():
    rows, rigid = RNG.normal(size=(12, 3)), RNG.normal(size=(12, 2))
    noise = RNG.uniform(0.5, 2.0, 12)
    information = compute_modal_information(rows, rigid, noise)
    whole = np.concatenate([rows, rigid], axis=1) / noise[:, None]
    draws = np.linalg.lstsq(whole, RNG.normal(size=(12, 4000)), rcond=None)[0][:3]
    assert np.std(draws, axis=1) == pytest.approx(
        np.sqrt(np.diag(information.covariance)), rel=0.06
    )


def test_modes_that_are_not_separately_observable_have_infinite_covariance():
    rows = np.array([[1.0, 1.0, 0.0], [2.0, 2.0, 1.0], [3.0, 3.0, 0.0]])
    information = compute_modal_information(rows, np.zeros((3, 1)), np.ones(3))
    assert np.isinf(np.diag(information.covariance)).tolist() == [True, True, False]


def test_the_best_place_is_where_the_worst_known_mode_moves():
    rows = np.array([[10.0, 0.01], [8.0, -0.01], [9.0, 0.02]])
    information = compute_modal_information(rows, np.zeros((3, 0)), np.ones(3))
    candidates = np.array([[10.0, 0.0], [0.0, 5.0], [1.0, 0.1]])
    gain, shrink = rank_candidate_sensors(information, candidates, np.zeros((3, 0)), 1.0)
    assert np.argmax(gain) == 1
    assert shrink[1, 1] < 0.05
    assert shrink[1, 0] > 0.8


def test_thinned_nodes_include_the_tips_and_are_joined():
    nodes = np.column_stack([RNG.uniform(0, 1, 3000), RNG.uniform(-5, 5, 3000), np.zeros(3000)])
    shown = select_spread_nodes(nodes, 300)
    assert shown.size == np.unique(shown).size == 300
    gap = np.linalg.norm(nodes[:, None] - nodes[shown][None], axis=2).min(axis=1)
    assert gap.max() < 0.35
    assert np.ptp(nodes[shown, 1]) > 0.98 * np.ptp(nodes[:, 1])
    lines = connect_neighbours(nodes[shown])
    assert set(lines.ravel()) == set(range(300))
    assert select_spread_nodes(nodes[:10], 300).tolist() == list(range(10))
    assert connect_neighbours(nodes[:1]).shape == (0, 2)


def test_a_mesh_is_contracted_to_the_nodes_shown():
    """A plate of 60 x 20 nodes: the coarse mesh has no gap and no line across the plate."""
    x, y = (part.ravel() for part in np.meshgrid(np.arange(20.0), np.arange(60.0)))
    nodes = np.column_stack([x, y, np.zeros(x.size)])
    row = np.arange(x.size).reshape(60, 20)
    lines = np.concatenate(
        [
            np.stack([row[:-1].ravel(), row[1:].ravel()], axis=1),
            np.stack([row[:, :-1].ravel(), row[:, 1:].ravel()], axis=1),
        ]
    )
    shown = select_spread_nodes(nodes, 150)
    coarse = contract_lines(nodes, lines, shown)
    assert set(coarse.ravel()) == set(range(150))
    one, other = nodes[shown][coarse].transpose(1, 0, 2)
    assert np.linalg.norm(one - other, axis=1).max() < 6.0
    assert contract_lines(nodes[:4], np.array([[0, 1], [1, 0]]), np.arange(4)).tolist() == [[0, 1]]
