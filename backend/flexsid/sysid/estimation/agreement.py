"""Agreement of several correlated estimates of one parameter."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from functools import lru_cache

import numpy as np
from jaxtyping import Float
from scipy import special

from flexsid.sysid.estimation.error_components import ErrorComponents, compute_shared_covariance

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
