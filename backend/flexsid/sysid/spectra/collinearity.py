"""Collinearity of channels or regressors: correlation, variance inflation, condition."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Inexact

_LARGEST_INFLATION = 1e8  # of a variance: above it, columns are linearly dependent


@dataclass(frozen=True, slots=True, eq=False)
class Collinearity:
    """Correlation matrix of columns, and its effect on a regression on them.

    Of spectra the real part of ``correlation`` counts for real coefficients.

    ``inflation`` is the factor by which the variance of a coefficient grows over
    that with uncorrelated columns; infinite for linearly dependent columns, NaN
    for a constant one. ``condition`` is that of the columns at unit length.
    """

    correlation: Inexact[np.ndarray, "n n"]
    inflation: Float[np.ndarray, " n"]
    condition: float


def assess_collinearity(
    columns: Inexact[np.ndarray, "n_rows n"], *, remove_mean: bool = True
) -> Collinearity:
    """Assess the collinearity of columns of samples, or of spectra (complex).

    The mean is removed of samples; a spectrum has none.

    Notes
    -----
    Columns of spectra are regressed on with real coefficients, so that variance
    inflation and condition are those of the stacked real and imaginary parts, and so is
    the real part of the complex correlation. Its magnitude is also large for channels that
    differ by a phase, which real coefficients resolve.
    """
    n = columns.shape[1]
    moved = columns - columns.mean(axis=0) if remove_mean and columns.size else columns
    size = np.linalg.norm(moved, axis=0)
    # a constant minus its mean is rounding
    still = size <= 1e-12 * np.linalg.norm(columns, axis=0)
    unit = np.divide(moved, size, out=np.zeros_like(moved), where=~still)
    correlation = unit.conj().T @ unit
    correlation[still, :] = np.nan
    correlation[:, still] = np.nan
    inflation = np.full(n, np.nan)
    active = unit[:, ~still]
    if not active.shape[1]:
        return Collinearity(correlation, inflation, float("nan"))
    real = np.concatenate([np.real(active), np.imag(active)])
    values, vectors = np.linalg.eigh(real.T @ real)
    least = values[-1] * np.finfo(float).eps * max(real.shape)
    with np.errstate(divide="ignore"):
        condition = float(np.sqrt(values[-1] / values[0])) if values[0] > least else float("inf")
    usable = np.where(values > least, values, least)
    grown = (vectors**2 / usable).sum(axis=1)
    inflation[~still] = np.where(grown > _LARGEST_INFLATION, np.inf, grown)
    return Collinearity(correlation, inflation, condition)


def compute_variance_inflation(gram: Float[np.ndarray, "n n"]) -> Float[np.ndarray, " n"]:
    """Compute the factors by which collinearity increases the variances of all columns. [1]

    ``gram`` has the products of the columns with each other, as a normal or information matrix.

    Notes
    -----
    The diagonal of the pseudo-inverse of the matrix with unit diagonal.
    """
    size = np.sqrt(np.maximum(np.diag(gram), np.finfo(float).tiny))
    unit = gram / np.outer(size, size)
    return np.diag(np.linalg.pinv(unit, rcond=1e-12, hermitian=True))


WEAK_CONDITION_INDEX = 10.0  # Belsley, Kuh and Welsch: weak from 5 to 10 on, strong from 30
_LEAST_VARIANCE_SHARE = 0.3  # of a term's variance in a direction, to be part of the dependency


@dataclass(frozen=True, slots=True)
class Dependency:
    """A direction in which columns nearly cancel, and the terms that make it.

    ``index`` is the largest singular value over this direction's; ``shares`` by term is the
    part of its variance due to the direction, for those of at least 0.3.
    """

    index: float
    shares: dict[str, float]


def find_near_dependencies(
    gram: Float[np.ndarray, "n n"], names: Sequence[str]
) -> tuple[Dependency, ...]:
    """Condition indices that are not weak, with the terms involved, worst first.

    ``gram`` has the products of the columns with each other, as a normal or information matrix.

    Notes
    -----
    Source: Belsley, Kuh and Welsch, Regression Diagnostics (1980), doi:10.1002/0471725153: columns
    at unit length, and variance-decomposition proportions. A direction that affects only one term
    is not a dependency and is omitted.
    """
    size = np.sqrt(np.maximum(np.diag(gram), 0.0))
    moves = size > 0.0
    if not moves.any():
        return ()
    unit = gram[np.ix_(moves, moves)] / np.outer(size[moves], size[moves])
    values, vectors = np.linalg.eigh(0.5 * (unit + unit.T))
    values = np.maximum(values, np.finfo(float).eps * values[-1])
    burden = vectors**2 / values
    shares = burden / burden.sum(axis=1, keepdims=True)
    active = [name for name, moving in zip(names, moves, strict=True) if moving]
    found = []
    for direction, value in enumerate(values):
        index = float(np.sqrt(values[-1] / value))
        involved = np.flatnonzero(shares[:, direction] >= _LEAST_VARIANCE_SHARE)
        if index >= WEAK_CONDITION_INDEX and involved.size > 1:
            order = involved[np.argsort(-shares[involved, direction])]
            found.append(Dependency(index, {active[i]: float(shares[i, direction]) for i in order}))
    return tuple(found)
