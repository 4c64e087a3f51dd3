"""Trends: weighted polynomials through estimates, with a chi-square test of their scatter."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy import special

from flexsid.sysid.estimation.regression import invert_triangular


@dataclass(frozen=True, slots=True, eq=False)
class Trend:
    """A polynomial in (x - centre) / span, lowest power first.

    ``probability`` is the p-value of ``chi_square`` for independent estimates with the given
    standard errors; None without degrees of freedom.
    """

    centre: float
    span: float
    coefficients: np.ndarray
    covariance: np.ndarray
    chi_square: float
    freedom: int
    probability: float | None

    @property
    def inflation(self) -> float:
        """Birge ratio: factor on the standard errors due to the scatter; at least one."""
        return max(1.0, float(np.sqrt(self.chi_square / self.freedom))) if self.freedom else 1.0

    def at(self, x: Float[np.ndarray, " n"]) -> tuple[np.ndarray, np.ndarray]:
        """Compute value and standard error at x, the error inflated by the Birge ratio."""
        powers = self._powers(x)
        spread = np.einsum("ij,jk,ik->i", powers, self.covariance, powers)
        return powers @ self.coefficients, self.inflation * np.sqrt(spread)

    @property
    def slope(self) -> tuple[float, float]:
        """Derivative at the centre and its standard error; zero for a constant."""
        if self.coefficients.size < 2:
            return 0.0, 0.0
        error = self.inflation * float(np.sqrt(self.covariance[1, 1]))
        return float(self.coefficients[1]) / self.span, error / self.span

    def _powers(self, x: np.ndarray) -> np.ndarray:
        scaled = (np.asarray(x, dtype=float) - self.centre) / self.span
        return np.vander(scaled, self.coefficients.size, increasing=True)


def fit_trend(
    x: Float[np.ndarray, " n"],
    values: Float[np.ndarray, " n"],
    std_errors: Float[np.ndarray, " n"],
    degree: int,
) -> Trend:
    """Fit a polynomial to estimates, each weighted by its standard error.

    Parameters
    ----------
    x
        Condition of each estimate, e.g. dynamic pressure. [any]
    values
        Estimates. [any]
    std_errors
        Their standard errors, all positive. [as ``values``]
    degree
        0 for a constant (the weighted mean), 1 for a straight line, and so on.

    Raises
    ------
    ValueError
        If there are fewer distinct x than coefficients.

    Notes
    -----
    Weighted least squares with known variances; the sum of squares left over is
    chi-square distributed with n - degree - 1 degrees of freedom if the errors are
    independent with the given standard errors. Where it is larger, errors are inflated by
    its square root over the degrees of freedom (the Birge ratio).
    Source: R. T. Birge, Phys. Rev. 40, 207 (1932).
    """
    x = np.asarray(x, dtype=float)
    if np.unique(x).size <= degree:
        raise ValueError(
            f"{degree + 1} coefficients need {degree + 1} distinct x; found {np.unique(x).size}"
        )
    centre = float(np.average(x, weights=std_errors**-2.0))
    span = float(np.ptp(x)) or 1.0
    powers = np.vander((x - centre) / span, degree + 1, increasing=True) / std_errors[:, None]
    whitened = values / std_errors
    q, r = np.linalg.qr(powers)
    inverse = invert_triangular(r)
    coefficients = inverse @ (q.T @ whitened)
    chi_square = float(np.sum((whitened - powers @ coefficients) ** 2))
    freedom = x.size - degree - 1
    probability = float(special.chdtrc(freedom, chi_square)) if freedom else None
    return Trend(centre, span, coefficients, inverse @ inverse.T, chi_square, freedom, probability)
