"""How far channels or regressors say the same: correlation, variance inflation, condition."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Inexact


@dataclass(frozen=True, slots=True, eq=False)
class Collinearity:
    """Correlation matrix and what it does to a regression on these columns.

    Of spectra the real part of ``correlation`` counts for real coefficients.

    ``inflation`` is the factor by which the variance of a coefficient grows over
    that with uncorrelated columns; infinite for columns that repeat each other, NaN
    for one that never moves. ``condition`` is that of the columns at unit length.
    """

    correlation: Inexact[np.ndarray, "n n"]
    inflation: Float[np.ndarray, " n"]
    condition: float


def collinearity(
    columns: Inexact[np.ndarray, "n_rows n"], *, remove_mean: bool = True
) -> Collinearity:
    """Judge columns of samples, or of spectra (complex).

    Parameters
    ----------
    columns
        One column per channel or regressor.
    remove_mean
        True for samples; the lines of a spectrum have no mean to remove.

    Notes
    -----
    Columns of spectra are regressed on with real coefficients, so that variance
    inflation and condition are those of the stacked real and imaginary parts, and so is
    the real part of the complex correlation. Its magnitude also tells of channels that
    differ by a phase, which real coefficients keep apart.
    """
    n = columns.shape[1]
    moved = columns - columns.mean(axis=0) if remove_mean and columns.size else columns
    size = np.linalg.norm(moved, axis=0)
    # what is left of a constant after subtracting its mean is rounding
    still = size <= 1e-12 * np.linalg.norm(columns, axis=0)
    unit = np.divide(moved, size, out=np.zeros_like(moved), where=~still)
    correlation = unit.conj().T @ unit
    correlation[still, :] = np.nan
    correlation[:, still] = np.nan
    inflation = np.full(n, np.nan)
    kept = unit[:, ~still]
    if not kept.shape[1]:
        return Collinearity(correlation, inflation, float("nan"))
    real = np.concatenate([np.real(kept), np.imag(kept)])
    values, vectors = np.linalg.eigh(real.T @ real)
    least = values[-1] * np.finfo(float).eps * max(real.shape)
    with np.errstate(divide="ignore"):
        condition = float(np.sqrt(values[-1] / values[0])) if values[0] > least else float("inf")
    usable = np.where(values > least, values, least)
    grown = (vectors**2 / usable).sum(axis=1)
    inflation[~still] = np.where(grown > 1e8, np.inf, grown)
    return Collinearity(correlation, inflation, condition)


_WEAK_INDEX = 10.0  # Belsley, Kuh and Welsch: weak from 5 to 10 on, strong from 30
_LEAST_SHARE = 0.3


@dataclass(frozen=True, slots=True)
class Dependency:
    """A direction in which columns nearly cancel, and the terms that make it.

    ``index`` is the strongest direction's size over this one's; ``shares`` by term is the
    part of its variance that the direction makes, for those that owe it at least 0.3.
    """

    index: float
    shares: dict[str, float]


def near_dependencies(
    gram: Float[np.ndarray, "n n"], names: Sequence[str], least: float = _WEAK_INDEX
) -> tuple[Dependency, ...]:
    """Condition indices from ``least`` on, with the terms involved, worst first.

    Parameters
    ----------
    gram
        Products of the columns with each other: a normal or information matrix.
    names
        Of the terms, in its order.
    least
        Smallest condition index told.

    Notes
    -----
    Source: Belsley, Kuh and Welsch, Regression Diagnostics (1980): columns at unit length,
    and variance-decomposition proportions. A direction that burdens only one term is no
    dependency and is left out.
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
    kept = [name for name, moving in zip(names, moves, strict=True) if moving]
    found = []
    for direction, value in enumerate(values):
        index = float(np.sqrt(values[-1] / value))
        involved = np.flatnonzero(shares[:, direction] >= _LEAST_SHARE)
        if index >= least and involved.size > 1:
            order = involved[np.argsort(-shares[involved, direction])]
            found.append(Dependency(index, {kept[i]: float(shares[i, direction]) for i in order}))
    return tuple(found)
