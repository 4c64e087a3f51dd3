"""Evidence of an estimate on every candidate term, for any estimator.

Around the estimate with all candidates, the weighted squared residuals are quadratic
in the terms. The information, its moment and the scatter of the moment are then
sufficient for a search: the estimates of any subset of the terms and their variances
need one small solve and no further access to the data.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool, Float

from flexsid.errors import NotIdentifiable
from flexsid.sysid.estimation.estimate import Estimate

N_PARTS = 20  # combs of frequencies for the bootstrap
_RUN_LENGTH = 5  # neighbouring frequencies that stay together in a bootstrap
_COLLINEAR_SHARE = 1e-9  # of a term's information: collinear with the selected ones below
_RIDGE = 1e-12  # of a term's information: regularises collinear terms
_LEAST_VARIANCE = 1e-20  # of a term's variance for white residuals, for noise-free data
_COMMON_STD = 0.5  # standard errors of one maneuver: systematic error common to all

_MAJORITY = 0.5  # of the maneuvers: more must support a term that the mean does not


@dataclass(frozen=True, slots=True)
class Evidence:
    """Evidence of one maneuver on candidate terms, in units of the residuals' variance.

    Terms of a subset are estimated by solving ``information`` for ``moment``; ``total`` is
    the squared sum without any term, over ``n_data`` real numbers. ``scatter`` is the
    covariance of the moment for the residuals as they are, for white ones the same as the
    information. ``parts`` are the errors of the moment by combs of frequencies.
    """

    names: tuple[str, ...]
    information: Float[np.ndarray, "p p"]
    moment: Float[np.ndarray, " p"]
    scatter: Float[np.ndarray, "p p"]
    total: float
    n_data: float
    parts: Float[np.ndarray, "n_parts p"]

    def resample(self, counts: Float[np.ndarray, " n_parts"]) -> Evidence:
        """Resample: evidence of a record with every comb of frequencies repeated so many times.

        Notes
        -----
        To first order: the information is that of the record.
        """
        return replace(self, moment=self.moment + (counts - 1.0) @ self.parts)


def compute_evidence(estimate: Estimate, names: Sequence[str], n_data: float) -> Evidence:
    """Compute the evidence of one maneuver on some terms from its estimate with all of them.

    Parameters
    ----------
    estimate
        By any estimator. Its other parameters are marginalised: nuisance parameters with their
        priors, and delays.
    names
        Candidate terms.
    n_data
        Real numbers that were fitted.

    Raises
    ------
    NotIdentifiable
        If a term has no standard error.

    Notes
    -----
    With the information [[A, B], [B^T, D]] of terms and other parameters, priors included, that
    of the marginal likelihood is the Schur complement A - B D^-1 B^T: the inverse of the terms'
    part of the covariance. The sandwich covariance C gives the scatter A' C A'. With all terms the
    weighted residuals have the mean square one.
    """
    own = estimate.select(names)
    if not np.isfinite(own.std_errors).all():
        lacking = [n for n, s in zip(names, own.std_errors, strict=True) if not np.isfinite(s)]
        raise NotIdentifiable(
            f"{', '.join(lacking[:4])} have no standard error with all candidates in the model; "
            "fix some candidates, or use more maneuvers",
            code="no-evidence",
        )
    size = np.sqrt(np.diag(own.covariance))
    outer = np.outer(size, size)
    information = np.linalg.pinv(own.covariance / outer, rcond=1e-14, hermitian=True) / outer
    scatter = information @ own.corrected_covariance @ information
    moment = information @ own.values
    parts = np.zeros((0, len(names)))
    if own.components is not None and own.components.noise:
        changes = np.concatenate(own.components.noise, axis=1)
        comb = assign_combs(changes.shape[1])
        by_comb = [changes[:, comb == number].sum(axis=1) for number in range(comb.max() + 1)]
        parts = np.stack(by_comb) @ information
    left = max(n_data - len(names), 1.0)
    return Evidence(
        names=tuple(names),
        information=information,
        moment=moment,
        scatter=0.5 * (scatter + scatter.T),
        total=float(left + moment @ own.values),
        n_data=float(n_data),
        parts=parts,
    )


def assign_combs(n_frequencies: int) -> np.ndarray:
    """Assign each frequency to a comb; runs of neighbours stay together."""
    run = np.arange(n_frequencies) // max(1, min(_RUN_LENGTH, n_frequencies // N_PARTS))
    return run % N_PARTS


@dataclass(frozen=True, slots=True)
class SubsetEstimate:
    """Every term with a subset selected: its value, or its value if entered next.

    ``variance`` is infinite for a term collinear with the selected ones; ``change`` is the rise
    of the squared residuals if a selected term is dropped, or their fall if another enters;
    ``rest`` is the squared sum of the residuals of the subset.
    """

    values: Float[np.ndarray, " p"]
    variance: Float[np.ndarray, " p"]
    change: Float[np.ndarray, " p"]
    rest: float


def estimate_subset(evidence: Evidence, selected: Bool[np.ndarray, " p"]) -> SubsetEstimate:
    """Estimate the selected terms, and each other one as if it were the next to enter."""
    own = np.diag(evidence.information)
    moves = own > 0.0
    scale = np.sqrt(np.where(moves, own, 1.0))
    outer = np.outer(scale, scale)
    N, S, m = evidence.information / outer, evidence.scatter / outer, evidence.moment / scale
    # Rows of A give a term's value from the moment, so that A S A^T is its covariance.
    A = np.eye(scale.size)
    inside, outside = np.flatnonzero(selected), np.flatnonzero(~selected)
    left = np.where(moves, 1.0, 0.0)
    rest = evidence.total
    if inside.size:
        among = N[np.ix_(inside, inside)] + _RIDGE * np.eye(inside.size)
        solved = np.linalg.solve(among, np.column_stack([np.eye(inside.size), N[inside]]))
        inverse, others = solved[:, : inside.size], solved[:, inside.size :][:, outside]
        A[np.ix_(inside, inside)] = inverse
        A[np.ix_(outside, inside)] = -others.T
        left[outside] -= np.sum(N[np.ix_(inside, outside)] * others, axis=0)
        rest -= float(m[inside] @ inverse @ m[inside])
    left[inside] = 1.0 / np.diag(A)[inside]
    free = left > _COLLINEAR_SHARE
    A[outside] /= np.where(free, left, 1.0)[outside, None]
    spread = np.sum((A @ S) * A, axis=1)
    variance = np.where(free, np.maximum(spread, _LEAST_VARIANCE), np.inf)
    values = np.where(free, A @ m, 0.0)
    return SubsetEstimate(values / scale, variance / scale**2, values**2 * left, rest)


@dataclass(frozen=True, slots=True)
class PooledEvidence:
    """Evidence of several maneuvers together on every term with a subset selected.

    ``values`` is the mean over the maneuvers and ``std_errors`` its uncertainty, which
    includes that the term may differ between them; ``f`` is the partial F of the mean,
    ``each_f`` that in every maneuver. ``gain`` is the fall of the squared residuals
    in units of the term's variance, summed over the maneuvers.
    """

    values: Float[np.ndarray, " p"]
    std_errors: Float[np.ndarray, " p"]
    f: Float[np.ndarray, " p"]
    each_f: Float[np.ndarray, "n_maneuvers p"]
    gain: Float[np.ndarray, " p"]
    rest: Float[np.ndarray, " n_maneuvers"]

    def find_supported(self, threshold: float) -> Bool[np.ndarray, " p"]:
        """Find terms supported by the mean, or by more than half of the maneuvers alone."""
        return (self.f > threshold) | (np.mean(self.each_f > threshold, axis=0) > _MAJORITY)


def pool_evidence(
    evidences: Sequence[Evidence], selected: Bool[np.ndarray, " p"]
) -> PooledEvidence:
    """Pool the evidence of maneuvers; each has its own values of the terms.

    Notes
    -----
    Derivatives drift with fuel and airspeed. Pooling them as equal would let the drift of
    one term appear as another, so only the structure is shared: the mean of a term is
    weighted by random effects (DerSimonian and Laird 1986, doi:10.1016/0197-2456(86)90046-2), whose
    spread between maneuvers is read from the values themselves. In addition, half a standard error
    of one maneuver remains for any number of maneuvers: errors of mode shapes, noise levels and
    reconstruction are common to all of them, and must not become terms.
    """
    looks = [estimate_subset(evidence, selected) for evidence in evidences]
    values = np.stack([one.values for one in looks])
    variance = np.stack([one.variance for one in looks])
    each = values**2 / variance
    mean, spread = _compute_random_effects(values, variance)
    return PooledEvidence(
        values=mean,
        std_errors=np.sqrt(spread),
        f=mean**2 / spread,
        each_f=each,
        gain=each.sum(axis=0),
        rest=np.array([one.rest for one in looks]),
    )


def _compute_random_effects(
    values: Float[np.ndarray, "n_maneuvers p"], variance: Float[np.ndarray, "n_maneuvers p"]
) -> tuple[Float[np.ndarray, " p"], Float[np.ndarray, " p"]]:
    """Mean and its variance, the spread between maneuvers included."""
    weight = 1.0 / variance
    known = weight.sum(axis=0) > 0.0
    total = np.where(known, weight.sum(axis=0), 1.0)
    seen = np.maximum(np.count_nonzero(weight, axis=0), 1)
    common = _COMMON_STD**2 * (seen - 1) / total
    mean = (weight * values).sum(axis=0) / total
    unrest = (weight * (values - mean) ** 2).sum(axis=0)
    freedom = seen - 1
    bound = total - (weight**2).sum(axis=0) / total
    between = np.maximum(unrest - freedom, 0.0) / np.where(bound > 0.0, bound, np.inf)
    weight = 1.0 / (variance + between)
    total = np.where(known, weight.sum(axis=0), 1.0)
    return (weight * values).sum(axis=0) / total, np.where(known, 1.0 / total + common, np.inf)
