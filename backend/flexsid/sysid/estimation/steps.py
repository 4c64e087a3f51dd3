"""Steps of a maximisation: the curvatures that they may follow, and how large they are."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from scipy.linalg import lapack

_CAPS = (0.97, 0.8, 0.5)  # on the share of the curvature that following the noise takes off


def curvatures(N: np.ndarray, followed: np.ndarray, *, slow: bool) -> Iterator[np.ndarray]:
    """The curvature with S concentrated out, then with more and more of it kept in.

    Far from the optimum more can be lacking in a direction than there is; of a fit that is
    slow so much is taken off there that a share of the curvature stays.
    """
    if followed.size:
        lacking = followed @ followed.T
        yield N - lacking
        factor, info = lapack.dpotrf(N, lower=True) if slow else (N, 1)
        if info == 0:
            half = np.linalg.solve(factor, lacking)
            shares, directions = np.linalg.eigh(np.linalg.solve(factor, half.T))
            spread = factor @ directions
            for cap in _CAPS:
                yield N - (spread * np.minimum(shares, cap)) @ spread.T
    yield N


def damped_step(
    matrix: np.ndarray, diagonal: np.ndarray, gradient: np.ndarray, damping: float
) -> np.ndarray | None:
    """Solve with a share of a diagonal added, None where the matrix is still not positive.

    Cholesky's rounding does not depend on how the parameters are scaled.
    """
    damped = matrix.copy(order="F")
    damped.ravel("K")[:: len(damped) + 1] += damping * diagonal
    factor, info = lapack.dpotrf(damped, lower=False, overwrite_a=True, clean=False)
    return None if info != 0 else lapack.dpotrs(factor, gradient, lower=False)[0]


def size_in_std_errors(N: np.ndarray, delta: np.ndarray) -> float:
    """Largest step against a lower bound of its standard error, correlation ignored."""
    return float((np.abs(delta) * np.sqrt(2.0 * N.diagonal())).max())


def gradient_is_small(N: np.ndarray, g: np.ndarray) -> bool:
    """Whether no parameter would move by a hundredth of its standard error."""
    return bool(np.max(np.abs(g) / np.sqrt(np.maximum(np.diag(N), 1e-300))) < 1e-2)
