"""Linear algebra of the estimators: elimination, real products, damped steps, stacked fits."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
import scipy
from jaxtyping import Complex, Float

# --- Inverses of one small matrix per frequency, by elimination at all frequencies at once --------

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


# --- Real parts of sums of complex products, by products of real matrices -------------------------


def sum_products(
    A: Complex[np.ndarray, "*rows n_a"], B: Complex[np.ndarray, "*rows n_b"]
) -> Float[np.ndarray, "n_a n_b"]:
    """Compute Re A^H B, the sum over all rows.

    Two real products are half of the complex one, and a quarter where A and B are the same.
    """
    real, imaginary = (_flatten(part) for part in (np.real(A), np.imag(A)))
    if B is A:
        return real.T @ real + imaginary.T @ imaginary
    return real.T @ _flatten(np.real(B)) + imaginary.T @ _flatten(np.imag(B))


def _flatten(part: np.ndarray) -> np.ndarray:
    """Return contiguous rows, as products of matrices need them."""
    return np.ascontiguousarray(part.reshape(math.prod(part.shape[:-1]), part.shape[-1]))


# --- Steps of a maximisation: trial curvatures, damped steps and their size -----------------------

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
        factor, info = scipy.linalg.lapack.dpotrf(N, lower=True) if slow else (N, 1)
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
    factor, info = scipy.linalg.lapack.dpotrf(damped, lower=False, overwrite_a=True, clean=False)
    return None if info != 0 else scipy.linalg.lapack.dpotrs(factor, gradient, lower=False)[0]


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
    factor, info = scipy.linalg.lapack.dpotrf(N * np.outer(size, size), lower=False)
    if info != 0:
        return None
    inverse = scipy.linalg.lapack.dpotri(factor, lower=False)[0]
    return size * np.sqrt(0.5 * np.diag(inverse))


# --- Equation-error regression of many maneuvers at once, by stacked factorisations ---------------


def regress_many(
    X: Complex[np.ndarray, "n_maneuvers n_omega p"],
    z: Complex[np.ndarray, "n_maneuvers n_omega n_coefficients"],
) -> tuple[
    Float[np.ndarray, "n_maneuvers n_coefficients p"],
    Float[np.ndarray, "n_maneuvers n_coefficients p"],
]:
    """Fit z = X theta with real theta by least squares, for all maneuvers and coefficients.

    Parameters
    ----------
    X
        Regressors, common to the coefficients of a maneuver.
    z
        Coefficients.

    Returns
    -------
    values, std_errors
        By maneuver and coefficient; for white residuals (methods as in
        ``regression.regress`` without known errors).

    Notes
    -----
    QR factorisation of the scaled columns: Cov = 1/2 s^2 R^-1 R^-T with s^2 = nu^H nu /
    (M - p/2). The condition number of the normal equations would be the square of that of R.
    """
    scale = np.sqrt(
        np.einsum("bmp,bmp->bp", np.real(X), np.real(X))
        + np.einsum("bmp,bmp->bp", np.imag(X), np.imag(X))
    )
    stacked = np.concatenate([np.real(X), np.imag(X)], axis=1) / scale[:, None, :]
    target = np.concatenate([np.real(z), np.imag(z)], axis=1)
    q, r = np.linalg.qr(stacked)
    projected = q.transpose(0, 2, 1) @ target
    inverse = np.linalg.solve(r, np.broadcast_to(np.eye(X.shape[2]), r.shape))
    theta = inverse @ projected
    freedom = X.shape[1] - 0.5 * X.shape[2]
    rest = np.sum((target - stacked @ theta) ** 2, axis=1) / freedom
    spread = np.sum(inverse**2, axis=2)
    errors = np.sqrt(0.5 * rest[:, :, None] * spread[:, None, :]) / scale[:, None, :]
    return theta.transpose(0, 2, 1) / scale[:, None, :], errors


# --- Inverse of the factor of a least-squares problem ---------------------------------------------


def invert_triangular(r: Float[np.ndarray, "p p"]) -> Float[np.ndarray, "p p"]:
    """Invert an upper triangular matrix R.

    Notes
    -----
    (A^T A)^-1 = R^-1 R^-T with A = Q R avoids the loss of digits in A^T A, whose
    condition number is the square of that of A.
    Source: Golub and Van Loan, Matrix Computations, 4th ed., sec. 5.3.
    """
    return scipy.linalg.solve_triangular(r, np.eye(len(r)))
