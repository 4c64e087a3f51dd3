"""A user relies on: power goes where it serves the objective, and the limits hold."""

from __future__ import annotations

import numpy as np
import pytest

from flexsid.errors import BadInput, NotIdentifiable
from flexsid.sysid.excitation.input_optimisation import (
    Candidate,
    Criterion,
    build_discrimination_criterion,
    build_variance_criterion,
    optimise_powers,
)

NO_PRIOR = np.zeros((2, 2))


def build_candidate(rows: list[list[float]], criterion: Criterion) -> Candidate:
    return Candidate(np.array(rows)[:, None, :], NO_PRIOR, criterion)


def test_powers_of_a_sum_of_two_parameters():
    """1/p1 + 9/p2 within p1 + p2 = 1 is smallest at p2 = 3 p1 (Elfving)."""
    criterion = build_variance_criterion(np.array([[1.0], [3.0]]))
    powers = optimise_powers(
        [build_candidate([[1.0, 0.0], [0.0, 1.0]], criterion)], np.ones((1, 2))
    )
    np.testing.assert_allclose(powers, [0.25, 0.75], atol=0.03)


def test_every_limit_holds_and_one_is_used_up():
    rng = np.random.default_rng(4)
    one = Candidate(
        rng.normal(size=(60, 3, 5)), np.zeros((5, 5)), build_variance_criterion(np.eye(5)[:, :2])
    )
    usage = rng.uniform(0.1, 1.0, (4, 60))
    powers = optimise_powers([one], usage)
    assert (usage @ powers).max() == pytest.approx(1.0)
    best = one.criterion(compute_covariance(one, powers))[0]
    for _ in range(100):
        other = powers * rng.uniform(0.5, 2.0, 60)
        other /= (usage @ other).max()
        assert one.criterion(compute_covariance(one, other))[0] > best - 0.01


def compute_covariance(one: Candidate, powers: np.ndarray) -> np.ndarray:
    rows = (one.factors * np.sqrt(powers)[:, None, None]).reshape(-1, one.prior.shape[0])
    return np.linalg.inv(rows.T @ rows + one.prior)


def test_discrimination_leaves_the_common_parameter_only_the_power_that_it_needs():
    """b^2 / C_bb with rows (1, 1) and (1, 0): C_bb = 1/p1 + 1/p2, smallest at p1 = p2."""
    criterion = build_discrimination_criterion(np.array([0.3]), np.array([False, True]))
    powers = optimise_powers(
        [build_candidate([[1.0, 1.0], [1.0, 0.0]], criterion)], np.ones((1, 2))
    )
    np.testing.assert_allclose(powers, [0.5, 0.5], atol=0.03)


def test_knowledge_before_the_flight_moves_power_to_what_is_unknown():
    criterion = build_variance_criterion(np.array([[1.0], [1.0]]))
    known = Candidate(np.eye(2)[:, None, :], np.diag([0.5, 0.0]), criterion)
    powers = optimise_powers([known], np.ones((1, 2)))
    # (p1 + 1/2) = p2 with p1 + p2 = 1
    np.testing.assert_allclose(powers, [0.25, 0.75], atol=0.03)


def test_what_cannot_be_optimised_is_refused():
    criterion = build_variance_criterion(np.array([[1.0], [1.0]]))
    with pytest.raises(NotIdentifiable, match="do not determine"):
        optimise_powers([build_candidate([[1.0, 0.0], [2.0, 0.0]], criterion)], np.ones((1, 2)))
    with pytest.raises(BadInput, match="limit the deflection"):
        optimise_powers(
            [build_candidate([[1.0, 0.0], [0.0, 1.0]], criterion)], np.array([[1.0, 0.0]])
        )
