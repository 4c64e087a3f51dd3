"""A user relies on: predicted errors that shrink as physics says, and a better allotment."""

from __future__ import annotations

import numpy as np
import pytest

from flexsid.errors import NotIdentifiable
from flexsid.sysid.estimation.expectation import Expectation, allocate_minimax


def expectation() -> Expectation:
    """Two parameters: the first seen by input a alone, the second by b, four times weaker."""
    information = np.zeros((2, 2, 2))
    information[0, 0, 0], information[1, 1, 1] = 100.0, 100.0 / 16.0
    return Expectation(
        names=("p", "q"),
        inputs=("a", "b"),
        outputs=("y",),
        theta=np.array([1.0, -1.0]),
        information=information,
        powers=np.ones((2, 1)),
    )


def test_errors_shrink_with_the_amplitude():
    told = expectation()
    np.testing.assert_allclose(told.std_errors(), [0.1, 0.4])
    np.testing.assert_allclose(told.std_errors(np.array([2.0, 4.0])), [0.05, 0.1])


def test_amplitude_goes_where_the_worst_error_is_within_the_limit():
    """With x_a + x_b = 2 the errors are equal at x_b = 16 x_a."""
    told = expectation()
    gains = allocate_minimax(told, np.array([4.0, 4.0]), np.array([2.0]))
    np.testing.assert_allclose(gains**2, [2.0 / 17.0, 32.0 / 17.0], rtol=0.05)
    assert told.std_errors(gains).max() < 0.75 * told.std_errors().max()
    assert gains**2 @ told.powers[:, 0] <= 2.0 + 1e-6


def test_without_a_limit_every_input_is_as_large_as_it_may_be():
    gains = allocate_minimax(expectation(), np.array([1.5, 2.0]), np.array([np.inf]))
    assert gains[1] == pytest.approx(2.0, rel=1e-3)


def test_what_no_input_shows_is_not_identifiable():
    with pytest.raises(NotIdentifiable, match="not told apart"):
        expectation().std_errors(np.array([1.0, 0.0]))
