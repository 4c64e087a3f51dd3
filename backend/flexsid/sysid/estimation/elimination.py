"""Inverses of one small matrix per frequency, by elimination at all frequencies at once."""

from __future__ import annotations

import numpy as np
from jaxtyping import Complex, Float

_LARGEST = 6  # rows, and
_FEWEST = 150  # frequencies: outside these limits LAPACK is as fast
_LARGEST_CHANGE = 1e6  # of a squared pivot: a loss of three digits without pivoting


class Elimination:
    """Gauss-Jordan elimination without pivoting, in memory that is reserved once.

    Each step is a few operations on the rows of all frequencies, up to three times as fast
    as a call of LAPACK for every frequency. A large change of a pivot indicates a loss of
    digits; such frequencies are inverted again with pivoting.
    """

    def __init__(self, n_omega: int, n_r: int) -> None:
        self._is_faster = n_r <= _LARGEST and n_omega >= _FEWEST
        self._rows = np.empty((n_r, n_r, n_omega), dtype=complex)
        self._taken = np.empty_like(self._rows)
        self._pivots = np.empty((n_r, n_omega), dtype=complex)

    def inverse(
        self, K: Complex[np.ndarray, "n_omega n_r n_r"]
    ) -> Complex[np.ndarray, "n_omega n_r n_r"]:
        """Invert the matrix of every frequency."""
        if not self._is_faster:
            return _invert_with_pivoting(K)
        rows, taken = self._rows, self._taken
        rows[:] = K.transpose(1, 2, 0)
        original, pivots = rows.diagonal().T.copy(), self._pivots
        with np.errstate(all="ignore"):
            for p in range(len(rows)):
                pivots[p] = rows[p, p]
                column = rows[:, p].copy()
                rows[p, p] = 1.0
                row = rows[p] * (1.0 / column[p])
                column[p] = -1.0
                rows[p] = 0.0
                rows[:, p] = 0.0
                np.multiply(column[:, None], row, out=taken)
                np.subtract(rows, taken, out=rows)
            change = _square(pivots) / _square(original)
        accurate = np.all((change > 1.0 / _LARGEST_CHANGE) & (change < _LARGEST_CHANGE), axis=0)
        inverse = np.ascontiguousarray(rows.transpose(2, 0, 1))
        if not accurate.all():
            inverse[~accurate] = _invert_with_pivoting(K[~accurate])
        return inverse


def _invert_with_pivoting(
    K: Complex[np.ndarray, "n_omega n_r n_r"],
) -> Complex[np.ndarray, "n_omega n_r n_r"]:
    """Invert with LAPACK; not a number where an undamped pole is at a frequency."""
    try:
        return np.linalg.inv(K)
    except np.linalg.LinAlgError:
        regular = np.linalg.matrix_rank(K) == K.shape[1]
        inverse = np.full_like(K, np.nan)
        inverse[regular] = np.linalg.inv(K[regular])
        return inverse


def _square(
    values: Complex[np.ndarray, "n_r n_omega"],
) -> Float[np.ndarray, "n_r n_omega"]:
    return np.real(values) ** 2 + np.imag(values) ** 2
