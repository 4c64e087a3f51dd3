"""Inverses of one small matrix per line, by elimination at all lines at once."""

from __future__ import annotations

import numpy as np
from jaxtyping import Complex, Float

_LARGEST = 6  # rows, and
_FEWEST = 150  # lines: beyond these LAPACK is as fast, one line after the other
_LOST = 1e6  # change of a squared pivot that costs three digits which pivoting would keep


class Elimination:
    """Gauss and Jordan's elimination without pivoting, in memory that it keeps.

    Each step is a few operations on the rows of all lines, up to three times as fast as a
    call of LAPACK for every line. A pivot that elimination has shrunk or blown up betrays
    lost digits; such lines are inverted again with pivoting.
    """

    def __init__(self, n_omega: int, n_r: int) -> None:
        self._worth = n_r <= _LARGEST and n_omega >= _FEWEST
        self._rows = np.empty((n_r, n_r, n_omega), dtype=complex)
        self._taken = np.empty_like(self._rows)

    def inverse(
        self, K: Complex[np.ndarray, "n_omega n_r n_r"]
    ) -> Complex[np.ndarray, "n_omega n_r n_r"]:
        """Invert the matrix of every line."""
        if not self._worth:
            return _pivoted(K)
        rows, taken = self._rows, self._taken
        rows[:] = K.transpose(1, 2, 0)
        kept = np.ones(len(K), dtype=bool)
        original = [_squared(rows[p, p]) for p in range(len(rows))]
        with np.errstate(all="ignore"):
            for p, before in enumerate(original):
                change = _squared(rows[p, p]) / before
                kept &= (change > 1.0 / _LOST) & (change < _LOST)
                column = rows[:, p].copy()
                rows[p, p] = 1.0
                row = rows[p] * (1.0 / column[p])
                column[p] = -1.0
                rows[p] = 0.0
                rows[:, p] = 0.0
                np.multiply(column[:, None], row, out=taken)
                np.subtract(rows, taken, out=rows)
        inverse = np.ascontiguousarray(rows.transpose(2, 0, 1))
        if not kept.all():
            inverse[~kept] = _pivoted(K[~kept])
        return inverse


def _pivoted(
    K: Complex[np.ndarray, "n_omega n_r n_r"],
) -> Complex[np.ndarray, "n_omega n_r n_r"]:
    """Inverses; not a number where a pole without damping lies on a line."""
    try:
        return np.linalg.inv(K)
    except np.linalg.LinAlgError:
        regular = np.linalg.matrix_rank(K) == K.shape[1]
        inverse = np.full_like(K, np.nan)
        inverse[regular] = np.linalg.inv(K[regular])
        return inverse


def _squared(values: Complex[np.ndarray, " n_omega"]) -> Float[np.ndarray, " n_omega"]:
    return np.real(values) ** 2 + np.imag(values) ** 2
