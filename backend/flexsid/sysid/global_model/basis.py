"""Orthogonal polynomials over the flown conditions."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations_with_replacement

import numpy as np
from jaxtyping import Bool, Float, Int

from flexsid.sysid.estimation.regression import invert_triangular

_DEGREE = 3  # largest total degree
_LEAST_INDEPENDENT = 0.05
"""Share of the rms of a term that lower terms do not explain at the flown conditions: below
it the campaign does not resolve the term. Three clusters of speeds, each within 2 %, have a
share of 0.02 for the cubic term."""


@dataclass(frozen=True, slots=True, eq=False)
class PolynomialBasis:
    """Polynomials of the conditions, orthonormal over those of the runs: mean square one.

    Conditions are scaled by ``centre`` and ``span``. ``powers`` are the exponents of the
    monomials, those of lower total degree first; ``mixing`` is upper triangular and combines
    them. ``lowest`` and ``highest`` bound the flown conditions, and so does the ellipsoid of
    ``largest_distance`` about their ``mean``, where ``whitening`` makes their spread one.
    """

    centre: Float[np.ndarray, " n_v"]
    span: Float[np.ndarray, " n_v"]
    powers: Int[np.ndarray, "n_terms n_v"]
    mixing: Float[np.ndarray, "n_terms n_terms"]
    lowest: Float[np.ndarray, " n_v"]
    highest: Float[np.ndarray, " n_v"]
    mean: Float[np.ndarray, " n_v"]
    whitening: Float[np.ndarray, "n_v n_v"]
    largest_distance: float

    @property
    def degrees(self) -> Int[np.ndarray, " n_terms"]:
        """Total degree of each term."""
        return self.powers.sum(axis=1)

    def evaluate(self, conditions: Float[np.ndarray, "n n_v"]) -> Float[np.ndarray, "n n_terms"]:
        """Evaluate all terms."""
        scaled = (conditions - self.centre) / self.span
        return np.prod(scaled[:, None, :] ** self.powers, axis=2) @ self.mixing

    def differentiate(
        self, conditions: Float[np.ndarray, "n n_v"], variable: int
    ) -> Float[np.ndarray, "n n_terms"]:
        """Differentiate all terms with respect to one variable. [per its unit]"""
        scaled = (conditions - self.centre) / self.span
        lowered = self.powers.copy()
        lowered[:, variable] = np.maximum(lowered[:, variable] - 1, 0)
        slopes = self.powers[:, variable] * np.prod(scaled[:, None, :] ** lowered, axis=2)
        return slopes @ self.mixing / self.span[variable]

    def is_extrapolated(self, conditions: Float[np.ndarray, "n n_v"]) -> Bool[np.ndarray, " n"]:
        """Whether conditions lie outside the flown ones.

        Notes
        -----
        Outside the range of a variable, or farther from the mean than any run: the second
        detects combinations that were not flown, though each variable was.
        Source: Montgomery, Peck and Vining, Introduction to Linear Regression Analysis,
        5th ed., sec. 3.8 (hidden extrapolation).
        """
        margin = 1e-9 * self.span
        outside = (conditions < self.lowest - margin) | (conditions > self.highest + margin)
        distance = np.linalg.norm((conditions - self.mean) @ self.whitening, axis=1)
        return outside.any(axis=1) | (distance > self.largest_distance * (1.0 + 1e-9))


def build_basis(
    conditions: Float[np.ndarray, "n_runs n_v"], highest_degree: int = _DEGREE
) -> PolynomialBasis:
    """Build the polynomials up to a total degree that the flown conditions resolve.

    Parameters
    ----------
    conditions
        Flight condition of every run, e.g. dynamic pressure and fuel. [any]
    highest_degree
        Largest total degree of a term.

    Notes
    -----
    Gram-Schmidt orthogonalisation of the monomials in the order of their degree; a monomial
    that lower ones explain at the flown conditions is omitted. The coefficients of
    lower terms are then nearly uncorrelated with those of higher ones.
    Source: E. A. Morelli and V. Klein, Aircraft System Identification, 2nd ed., sec. 5.4.
    """
    lowest, highest = conditions.min(axis=0), conditions.max(axis=0)
    centre, span = 0.5 * (lowest + highest), 0.5 * (highest - lowest)
    span = np.where(span > 0.0, span, 1.0)
    scaled = (conditions - centre) / span
    n_v = conditions.shape[1]
    powers: list[np.ndarray] = []
    columns: list[np.ndarray] = []
    orthonormal = np.zeros((len(conditions), 0))
    for total in range(highest_degree + 1):
        for factors in combinations_with_replacement(range(n_v), total):
            power = np.bincount(np.array(factors, dtype=int), minlength=n_v)
            column = np.prod(scaled**power, axis=1)
            rest = column - orthonormal @ (orthonormal.T @ column)
            if np.linalg.norm(rest) <= _LEAST_INDEPENDENT * np.linalg.norm(column):
                continue
            powers.append(power)
            columns.append(column)
            orthonormal = np.linalg.qr(np.stack(columns, axis=1))[0]
    r = np.linalg.qr(np.stack(columns, axis=1) / np.sqrt(len(conditions)))[1]
    mixing = invert_triangular(r * np.sign(np.diag(r))[:, None])
    mean = conditions.mean(axis=0)
    _, sizes, directions = np.linalg.svd((conditions - mean) / span)
    spread = np.zeros(n_v)
    spread[: sizes.size] = sizes
    # Along a direction that was not flown every step is large.
    spread = np.maximum(spread, _LEAST_INDEPENDENT * max(float(spread[0]), 1.0))
    whitening = directions.T / spread / span[:, None]
    distances = np.linalg.norm((conditions - mean) @ whitening, axis=1)
    return PolynomialBasis(
        centre=centre,
        span=span,
        powers=np.array(powers).reshape(-1, n_v),
        mixing=mixing,
        lowest=lowest,
        highest=highest,
        mean=mean,
        whitening=whitening,
        largest_distance=float(distances.max()),
    )
