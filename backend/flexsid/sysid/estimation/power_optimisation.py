"""Optimal inputs: the powers of harmonics that are best for one objective within limits."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float
from scipy import linalg, optimize

from flexsid.errors import BadInput, NotIdentifiable
from flexsid.sysid.estimation.amplitude_optimisation import OptimisationFailed

_ITERATIONS = 2000
_CHECKED = 50  # iterations between two checks of the distance to the optimum
_GAP = 0.01  # distance to the optimum at which the iteration ends, in log variance
_LARGEST_GAP = 0.05  # largest accepted distance: 5 % of a variance
_LEAST_POWER = 1e-5  # of the mean: no harmonic is switched off, as another could not find it again

Criterion = Callable[
    [Float[np.ndarray, "n_theta n_theta"]], tuple[float, Float[np.ndarray, "n_theta n_directions"]]
]
"""Logarithm of what is to be small for a covariance, and directions v: its derivative with respect
to the information matrix M is -sum of v v^T."""


@dataclass(frozen=True, slots=True)
class Candidate:
    """What each harmonic contributes by one set of parameter values, and the query for them.

    ``factors`` F give the information F^T F of a harmonic of unit power.
    """

    factors: Float[np.ndarray, "n_harmonics n_rows n_theta"]
    prior: Float[np.ndarray, "n_theta n_theta"]
    criterion: Criterion


def build_variance_criterion(slopes: Float[np.ndarray, "n_theta n_values"]) -> Criterion:
    """Build the criterion of the summed variance of values with these slopes.

    Notes
    -----
    L-optimality, log tr(W^T C W): of one value, such as a flutter speed, c-optimality. The
    derivative of C with respect to the information is -C (.) C.
    """

    def evaluate(C: np.ndarray) -> tuple[float, np.ndarray]:
        through = C @ slopes
        total = float(np.sum(through * slopes))
        return float(np.log(total)), through / np.sqrt(total)

    return evaluate


def build_discrimination_criterion(
    values: Float[np.ndarray, " n_terms"], terms: Bool[np.ndarray, " n_theta"]
) -> Criterion:
    """Build the criterion of the power of the test that these terms are zero.

    Notes
    -----
    Ds-optimality for known values b: the noncentrality of the likelihood ratio is b^T C_bb^-1 b,
    with C_bb the covariance of the terms, all other parameters estimated (Atkinson, Donev, Tobias,
    Optimum Experimental Designs, 2007, Sec. 20). Its negative logarithm is minimised.
    """

    def evaluate(C: np.ndarray) -> tuple[float, np.ndarray]:
        weighted = linalg.solve(C[np.ix_(terms, terms)], values, assume_a="pos")
        size = float(values @ weighted)
        return -float(np.log(size)), (C[:, terms] @ weighted / np.sqrt(size))[:, None]

    return evaluate


def optimise_powers(
    candidates: Sequence[Candidate],
    usage: Float[np.ndarray, "n_limits n_harmonics"],
) -> Float[np.ndarray, " n_harmonics"]:
    """Compute the powers of harmonics that minimise the mean criterion of all candidates.

    Parameters
    ----------
    candidates
        One for each set of parameter values that the prior knowledge makes possible.
    usage
        Share of every limit that unit power of a harmonic uses: ``usage @ powers <= 1``.

    Raises
    ------
    BadInput
        If a harmonic is bounded by no limit.
    NotIdentifiable
        If the harmonics do not determine the parameters.
    OptimisationFailed
        If the powers remain further from the optimum than ``_LARGEST_GAP``.

    Notes
    -----
    The criteria are convex in the powers. At the optimum d_k = (multipliers @ usage)_k for every
    harmonic in use, with d_k the decrease of the criterion per power. Powers are multiplied by the
    root of the ratio of both sides, multipliers by the root of the share of their limit in use. The
    distance to the optimum is bounded by a linear program: a convex function is nowhere below its
    tangent. Source: Silvey, Titterington and Torsney 1978, Communications in Statistics A7.
    """
    if not np.all(usage.max(axis=0) > 0.0):
        raise BadInput(
            "the limits do not bound every harmonic; limit the deflection", code="no-limit"
        )
    powers = 1.0 / usage.max(axis=0)
    powers /= np.max(usage @ powers)
    multipliers = np.full(usage.shape[0], 1.0 / usage.shape[0])
    gap = np.inf
    for turn in range(_ITERATIONS):
        decrease = _compute_decrease(candidates, powers)
        if turn % _CHECKED == _CHECKED - 1:
            lowest = optimize.linprog(-decrease, A_ub=usage, b_ub=np.ones(usage.shape[0]))
            gap = float(-lowest.fun - decrease @ powers) if lowest.fun is not None else np.inf
            if gap < _GAP:
                break
        multipliers *= np.sqrt(np.maximum(usage @ powers, 1e-12))
        multipliers = np.maximum(multipliers / multipliers.sum(), 1e-12)
        powers = powers * np.sqrt(decrease / np.maximum(multipliers @ usage, 1e-300))
        powers = np.maximum(powers, _LEAST_POWER * powers.mean())
        powers /= np.max(usage @ powers)
    if not gap < _LARGEST_GAP:
        raise OptimisationFailed(
            f"the powers are not optimal: the variance may still decrease by {100.0 * gap:.2g} %"
            " of itself; free fewer derivatives, or change the limits"
        )
    return powers


def _compute_decrease(
    candidates: Sequence[Candidate], powers: Float[np.ndarray, " n_harmonics"]
) -> Float[np.ndarray, " n_harmonics"]:
    """Compute the decrease of the mean criterion with the power of every harmonic."""
    total = np.zeros(powers.size)
    for one in candidates:
        rows = (one.factors * np.sqrt(powers)[:, None, None]).reshape(-1, one.prior.shape[0])
        _, directions = one.criterion(_invert(rows.T @ rows + one.prior))
        total += np.sum((one.factors @ directions) ** 2, axis=(1, 2))
    return total / len(candidates)


def _invert(information: Float[np.ndarray, "n n"]) -> Float[np.ndarray, "n n"]:
    scale = np.sqrt(np.maximum(np.diag(information), 1e-300))
    try:
        factor = linalg.cho_factor(information / np.outer(scale, scale))
    except linalg.LinAlgError as error:
        raise NotIdentifiable(
            "the harmonics do not determine all free derivatives; excite more inputs, or free fewer"
        ) from error
    return linalg.cho_solve(factor, np.eye(scale.size)) / np.outer(scale, scale)
