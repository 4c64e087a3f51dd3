"""Several estimates of the same parameters: agreement, fusion and trends."""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from jaxtyping import Float
from scipy import special

from flexsid.sysid.estimation.estimate import (
    ErrorComponents,
    Estimate,
    add_components,
    compute_shared_covariance,
)
from flexsid.sysid.estimation.linear_algebra import invert_triangular
from flexsid.sysid.estimation.priors import name_priors

# --- Agreement of several correlated estimates of one parameter -----------------------------------

AGREEMENT_SIGMA = 2.0
"""Two estimates agree when they differ by at most this many standard errors of the difference."""

FALSE_ALARM_RATE = float(special.erfc(AGREEMENT_SIGMA / np.sqrt(2.0)))
"""Probability that correct estimates do not agree: that of two beyond two standard errors."""

_LEAST_VARIANCE = 1e-4  # of the sum of both variances: a smaller difference is numerical
_SAMPLES = 2**16  # of all pairs together,
_FEWEST, _MOST = 2**9, 2**12  # and of one


def compute_difference_variance(
    covariance: Float[np.ndarray, "n n"], pair: tuple[int, int]
) -> float:
    """Compute the variance of the difference of two estimates."""
    i, j = pair
    total = covariance[i, i] + covariance[j, j]
    return float(max(total - 2.0 * covariance[i, j], _LEAST_VARIANCE * total))


def compute_limit(covariance: Float[np.ndarray, "n n"], pairs: Sequence[tuple[int, int]]) -> float:
    """Compute the largest difference of correct estimates, in standard errors.

    Parameters
    ----------
    covariance
        Of the estimates.
    pairs
        Whose differences count.

    Returns
    -------
    float
        Limit that the largest of these differences exceeds with ``FALSE_ALARM_RATE``, each in its
        own standard error: 2 for one pair.

    Notes
    -----
    The quantile of max |x_i - x_j| / sigma_ij for x ~ N(0, covariance), from quasi-random numbers
    that are the same in every call. For equal independent estimates it is Tukey's studentized
    range over the root of two.
    Source: Tukey (1953), The problem of multiple comparisons.
    """
    if len(pairs) == 1:
        return AGREEMENT_SIGMA
    values, vectors = np.linalg.eigh(covariance)
    root = vectors * np.sqrt(np.maximum(values, 0.0))
    i, j = np.array(pairs).T
    sigma = np.sqrt([compute_difference_variance(covariance, pair) for pair in pairs])
    count = int(np.clip(_SAMPLES // len(pairs), _FEWEST, _MOST))
    z = ((root[i] - root[j]) / sigma[:, None]) @ _sample_normal(len(covariance), count)
    largest = np.sort(np.abs(z, out=z).max(axis=0))
    return float(largest[round((1.0 - FALSE_ALARM_RATE) * (count - 1))])


@lru_cache(maxsize=32)
def _sample_normal(n: int, count: int) -> Float[np.ndarray, "n n_samples"]:
    """Return quasi-random normal numbers, the first ones of a scrambled Sobol sequence."""
    from scipy.stats import qmc  # takes a second to import, of the start of a server

    return np.ascontiguousarray(special.ndtri(qmc.Sobol(n, rng=1).random(_MOST)[:count]).T)


def compute_joint_covariance(
    std_errors: Sequence[Float[np.ndarray, " n_theta"]],
    components: Sequence[ErrorComponents | None],
    maneuvers: Sequence[Sequence[Hashable]],
) -> Float[np.ndarray, "n_theta n n"]:
    """Compute the covariance between several estimates of every parameter.

    Parameters
    ----------
    std_errors
        Of the parameters, by estimate; NaN where there is none.
    components
        Errors by their causes, by estimate; None: independent of all others.
    maneuvers
        Names of the maneuvers of each estimate, in the order of its components.

    Notes
    -----
    Variances are those of the standard errors. What the components lack of them is independent
    of other estimates, so that the matrices are positive semidefinite.
    """
    n = len(std_errors)
    result = np.zeros((std_errors[0].size, n, n))
    shares: list[np.ndarray] = []
    for i, (own, found) in enumerate(zip(std_errors, components, strict=True)):
        result[:, i, i] = own**2
        whole = np.zeros(own.size) if found is None else found.compute_variances()
        excess = np.divide(own**2, whole, out=np.ones(own.size), where=whole > own**2)
        shares.append(np.sqrt(excess))
        for j, other in enumerate(components[:i]):
            if found is None or other is None:
                continue
            common = [
                (maneuvers[i].index(name), maneuvers[j].index(name))
                for name in maneuvers[i]
                if name in maneuvers[j]
            ]
            shared = compute_shared_covariance(found, other, common) * shares[i] * shares[j]
            result[:, i, j] = result[:, j, i] = shared
    return result


def normalise_deviation(
    difference: float, covariance: Float[np.ndarray, "n n"], pair: tuple[int, int]
) -> float | None:
    """Divide a difference of two estimates by its standard error; None where one has none."""
    i, j = pair
    if not (covariance[i, i] > 0.0 and covariance[j, j] > 0.0):
        return None
    return float(difference / np.sqrt(compute_difference_variance(covariance, pair)))


def compute_correlation(covariance: Float[np.ndarray, "n n"]) -> Float[np.ndarray, "n n"]:
    """Compute the correlation of estimates; NaN where a variance is not positive."""
    std = np.sqrt(np.where(np.diag(covariance) > 0.0, np.diag(covariance), np.nan))
    return covariance / np.outer(std, std)


def find_correlated_pairs(
    correlation: Float[np.ndarray, "n n"], count: int
) -> list[tuple[int, int, float]]:
    """Find the most correlated pairs of estimates.

    Parameters
    ----------
    correlation
        Of the estimates; NaN where it is unknown.
    count
        Largest number of pairs.

    Returns
    -------
    list of tuple
        Both estimates and their correlation, largest magnitude first.
    """
    i, j = np.triu_indices(len(correlation), 1)
    found = np.nan_to_num(correlation[i, j])
    order = np.argsort(-np.abs(found), kind="stable")[:count]
    return [(int(i[k]), int(j[k]), float(found[k])) for k in order]


# --- Fusion of several estimates of the same parameters -------------------------------------------


def fuse_estimates(estimates: Sequence[Estimate], labels: Sequence[str]) -> Estimate:
    """Combine independent estimates, weighted by their information.

    Parameters
    ----------
    estimates
        Of the same parameters, e.g. one per maneuver.
    labels
        Names of the estimates, for their spectra.

    Notes
    -----
    Exact for linear regressions: equal to the regression over all maneuvers, each
    weighted with its own residual variance.
    """
    if len(estimates) == 1:
        return estimates[0]
    scale = np.sqrt(np.mean([np.diag(e.corrected_covariance) for e in estimates], axis=0))
    outer = np.outer(scale, scale)
    every = np.eye(scale.size)
    values, covariance = estimates[0].values / scale, estimates[0].corrected_covariance / outer
    plain = estimates[0].covariance / outer
    components = estimates[0].components
    for other in estimates[1:]:
        values, covariance, gain = _combine(
            values, covariance, every, other.values / scale, other.corrected_covariance / outer
        )
        own, new = components, other.components
        if own is not None and new is not None:
            components = add_components(
                own.transform(scale[:, None] * (every - gain) / scale),
                new.transform(scale[:, None] * gain / scale),
            )
        plain = _combine(values, plain, every, values, other.covariance / outer)[1]
    if components is not None:
        # Every estimate has a share of the priors' information: all have the same error.
        components = replace(components, prior=components.prior / np.sqrt(len(estimates)))
    lines = tuple(
        replace(block, name=f"{label} {block.name}")
        for estimate, label in zip(estimates, labels, strict=True)
        for block in estimate.lines
    )
    worst = next((one for one in estimates if not one.outcome.is_optimum), estimates[0])
    return replace(
        estimates[0],
        outcome=worst.outcome,
        message=worst.message,
        values=values * scale,
        covariance=plain * outer,
        corrected_covariance=covariance * outer,
        components=components,
        lines=lines,
    )


def apply_priors(estimate: Estimate, priors: Mapping[str, tuple[float, float]]) -> Estimate:
    """Combine a linear estimate with prior values and standard deviations by name."""
    if not priors:
        return estimate
    scale = np.sqrt(np.diag(estimate.corrected_covariance))
    outer = np.outer(scale, scale)
    own = [k for k, name in enumerate(estimate.names) if name in priors]
    seen = np.eye(scale.size)[own]
    mean, std = np.array([priors[estimate.names[k]] for k in own]).T / scale[own]
    values, covariance, gain = _combine(
        estimate.values / scale,
        estimate.corrected_covariance / outer,
        seen,
        mean,
        np.diag(std**2),
    )
    plain = _combine(values, estimate.covariance / outer, seen, mean, np.diag(std**2))[1]
    components = estimate.components
    if components is not None:
        left = np.eye(scale.size) - gain @ seen
        components = components.transform(scale[:, None] * left / scale).append_priors(
            name_priors(estimate.names, priors), scale[:, None] * gain * std
        )
    return replace(
        estimate,
        values=values * scale,
        covariance=plain * outer,
        corrected_covariance=covariance * outer,
        components=components,
    )


def _combine(
    values: Float[np.ndarray, " n"],
    covariance: Float[np.ndarray, "n n"],
    seen: Float[np.ndarray, "n_seen n"],
    others: Float[np.ndarray, " n_seen"],
    their: Float[np.ndarray, "n_seen n_seen"],
) -> tuple[Float[np.ndarray, " n"], Float[np.ndarray, "n n"], Float[np.ndarray, "n n_seen"]]:
    """Compute the mean of ``values`` and ``others = seen @ values``, weighted by information.

    The third result is the weight of ``others`` in it.

    Notes
    -----
    The form with covariances avoids the inverse of an ill-conditioned covariance. The
    symmetric (Joseph) form of the result stays positive definite.
    Source: R. S. Bucy and P. D. Joseph, Filtering for Stochastic Processes (1968).
    """
    cross = seen @ covariance
    gain = np.linalg.lstsq(cross @ seen.T + their, cross, rcond=None)[0].T
    left = np.eye(values.size) - gain @ seen
    total = left @ covariance @ left.T + gain @ their @ gain.T
    return values + gain @ (others - seen @ values), 0.5 * (total + total.T), gain


# --- Trends: weighted polynomials through estimates, with a chi-square test of their scatter ------


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
