"""Steps of a maximisation: trial curvatures, damped steps and their size."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from jaxtyping import Float
from scipy.linalg import lapack

_CAPS = (0.97, 0.8, 0.5)  # on the share of the curvature removed by concentrating the noise
_SMALL_GRADIENT = 1e-2  # standard errors


def list_curvatures(N: np.ndarray, concentrated: np.ndarray, *, slow: bool) -> Iterator[np.ndarray]:
    """Yield the curvature with S concentrated out, with a limited reduction, and without.

    Far from the optimum the reduction can exceed the curvature in a direction; for a slow
    fit it is limited to the shares ``_CAPS`` of the curvature.
    """
    if concentrated.size:
        reduction = concentrated @ concentrated.T
        yield N - reduction
        factor, info = lapack.dpotrf(N, lower=True) if slow else (N, 1)
        if info == 0:
            half = np.linalg.solve(factor, reduction)
            shares, directions = np.linalg.eigh(np.linalg.solve(factor, half.T))
            spread = factor @ directions
            for cap in _CAPS:
                yield N - (spread * np.minimum(shares, cap)) @ spread.T
    yield N


def solve_damped_step(
    matrix: np.ndarray, diagonal: np.ndarray, gradient: np.ndarray, damping: float
) -> np.ndarray | None:
    """Solve with a share of a diagonal added, None if the matrix is not positive definite.

    The rounding of Cholesky's factorisation does not depend on the scale of the parameters.
    """
    damped = matrix.copy(order="F")
    damped.ravel("K")[:: len(damped) + 1] += damping * diagonal
    factor, info = lapack.dpotrf(damped, lower=False, overwrite_a=True, clean=False)
    return None if info != 0 else lapack.dpotrs(factor, gradient, lower=False)[0]


def compute_step_size(N: np.ndarray, delta: np.ndarray) -> float:
    """Compute the largest step in units of standard errors without correlation."""
    return float((np.abs(delta) * np.sqrt(2.0 * N.diagonal())).max())


def is_gradient_small(N: np.ndarray, g: np.ndarray) -> bool:
    """Whether every single parameter would move by less than ``_SMALL_GRADIENT``."""
    return bool(np.max(np.abs(g) / np.sqrt(np.maximum(np.diag(N), 1e-300))) < _SMALL_GRADIENT)


def compute_bounds(N: Float[np.ndarray, "n_theta n_theta"]) -> np.ndarray | None:
    """Compute the Cramer-Rao standard errors; None for a matrix that is not positive."""
    own = np.diag(N)
    if not np.all(own > 0.0):
        return None
    size = 1.0 / np.sqrt(own)
    factor, info = lapack.dpotrf(N * np.outer(size, size), lower=False)
    if info != 0:
        return None
    inverse = lapack.dpotri(factor, lower=False)[0]
    return size * np.sqrt(0.5 * np.diag(inverse))
