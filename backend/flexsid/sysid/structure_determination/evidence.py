"""Evidence: what data say about every candidate term, whatever the estimator.

Around the estimate with all candidates, the weighted squared residuals are quadratic
in the terms. The information, its moment and how the moment really scatters are then
all that a search needs: what any subset of the terms would estimate, and how surely,
costs one small solve and no further look at the data.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool, Float

_COLLINEAR = 1e-9  # share of a term's information that the chosen ones leave
_RIDGE = 1e-12  # of a term's information: keeps terms that say the same from being singular
_SUREST = 1e-20  # of a term's variance for white residuals: keeps noise-free data finite
_COMMON = 0.5  # standard errors of one maneuver that all may be wrong alike


@dataclass(frozen=True, slots=True)
class Parts:
    """The sums of the evidence over combs of lines, to draw lines anew."""

    information: Float[np.ndarray, "n_parts p p"]
    moment: Float[np.ndarray, "n_parts p"]
    total: Float[np.ndarray, " n_parts"]


@dataclass(frozen=True, slots=True)
class Evidence:
    """What one maneuver says about candidate terms, in units of the residuals' variance.

    Terms of a subset are estimated by solving ``information`` for ``moment``; ``total`` is
    the squared sum without any term, over ``n_data`` real numbers. ``scatter`` is the
    covariance of the moment for the residuals as they are, for white ones the same as the
    information: once from neighbouring lines together, once line by line, which also sees
    residuals that stand out at a lightly damped mode alone. The larger one counts.
    """

    names: tuple[str, ...]
    information: Float[np.ndarray, "p p"]
    moment: Float[np.ndarray, " p"]
    scatter: Float[np.ndarray, "2 p p"]
    total: float
    n_data: float
    parts: Parts | None = None

    def thinned(self, crowding: float) -> Evidence:
        """The same evidence where so many lines share the resolution of the record."""
        share = 1.0 / crowding
        parts = self.parts
        thin = None
        if parts is not None:
            thin = Parts(share * parts.information, share * parts.moment, share * parts.total)
        return replace(
            self,
            information=share * self.information,
            moment=share * self.moment,
            scatter=share * self.scatter,
            total=share * self.total,
            n_data=share * self.n_data,
            parts=thin,
        )

    def drawn(self, counts: Float[np.ndarray, " n_parts"]) -> Evidence:
        """The evidence of a record in which every comb of lines stands so many times."""
        parts = self.parts
        assert parts is not None, "evidence was gathered without its parts"
        return replace(
            self,
            information=np.tensordot(counts, parts.information, axes=1),
            moment=counts @ parts.moment,
            total=float(counts @ parts.total),
        )


@dataclass(frozen=True, slots=True)
class EvidenceAtStep:
    """Every term with a subset chosen: its value, or the one it would take as the next.

    ``variance`` is infinite for a term that the chosen ones already say; ``change`` is what
    dropping a chosen term adds to the squared residuals, or entering another takes off;
    ``rest`` is the squared sum of residuals that the subset leaves.
    """

    values: Float[np.ndarray, " p"]
    variance: Float[np.ndarray, " p"]
    change: Float[np.ndarray, " p"]
    rest: float


def look(evidence: Evidence, chosen: Bool[np.ndarray, " p"]) -> EvidenceAtStep:
    """Estimate the chosen terms, and each other one as if it were the next to enter."""
    own = np.diag(evidence.information)
    moves = own > 0.0
    scale = np.sqrt(np.where(moves, own, 1.0))
    outer = np.outer(scale, scale)
    N, S, m = evidence.information / outer, evidence.scatter / outer, evidence.moment / scale
    # Rows of A read a term's value from the moment, so that A S A^T is how it scatters.
    A = np.eye(scale.size)
    inside, outside = np.flatnonzero(chosen), np.flatnonzero(~chosen)
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
    free = left > _COLLINEAR
    A[outside] /= np.where(free, left, 1.0)[outside, None]
    spread = np.sum((A @ S) * A, axis=2).max(axis=0)
    variance = np.where(free, np.maximum(spread, _SUREST), np.inf)
    values = np.where(free, A @ m, 0.0)
    return EvidenceAtStep(values / scale, variance / scale**2, values**2 * left, rest)


@dataclass(frozen=True, slots=True)
class Support:
    """What several maneuvers together say of every term with a subset chosen.

    ``values`` is the mean over the maneuvers and ``std_errors`` its uncertainty, which
    counts that the term may differ between them; ``f`` is the partial F of the mean,
    ``each_f`` that in every maneuver. ``gain`` is what the term takes off the residuals
    in units of its scatter, summed over the maneuvers.
    """

    values: Float[np.ndarray, " p"]
    std_errors: Float[np.ndarray, " p"]
    f: Float[np.ndarray, " p"]
    each_f: Float[np.ndarray, "n_maneuvers p"]
    gain: Float[np.ndarray, " p"]
    rest: Float[np.ndarray, " n_maneuvers"]

    def held_by(self, threshold: float) -> Bool[np.ndarray, " p"]:
        """Terms that the mean supports, or more than half of the maneuvers one by one."""
        return (self.f > threshold) | (np.mean(self.each_f > threshold, axis=0) > 0.5)


def support(evidences: Sequence[Evidence], chosen: Bool[np.ndarray, " p"]) -> Support:
    """Pool what maneuvers say; every one keeps its own values of the terms.

    Notes
    -----
    Derivatives drift with fuel and airspeed. Pooling them as equal would let the drift of
    one term appear as another, so only the structure is shared: the mean of a term is
    weighed by random effects (DerSimonian and Laird 1986), whose spread between
    maneuvers is read from the values themselves. Beyond that, half a standard error
    of one maneuver stays however many are flown: mode shapes, noise levels and the
    reconstruction are wrong in the same way in all of them, and must not become terms.
    """
    looks = [look(evidence, chosen) for evidence in evidences]
    values = np.stack([one.values for one in looks])
    variance = np.stack([one.variance for one in looks])
    each = values**2 / variance
    mean, spread = _random_effects(values, variance)
    return Support(
        values=mean,
        std_errors=np.sqrt(spread),
        f=mean**2 / spread,
        each_f=each,
        gain=each.sum(axis=0),
        rest=np.array([one.rest for one in looks]),
    )


def _random_effects(
    values: Float[np.ndarray, "n_maneuvers p"], variance: Float[np.ndarray, "n_maneuvers p"]
) -> tuple[Float[np.ndarray, " p"], Float[np.ndarray, " p"]]:
    """Mean and its variance, the spread between maneuvers included."""
    weight = 1.0 / variance
    known = weight.sum(axis=0) > 0.0
    total = np.where(known, weight.sum(axis=0), 1.0)
    seen = np.maximum(np.count_nonzero(weight, axis=0), 1)
    common = _COMMON**2 * (seen - 1) / total
    mean = (weight * values).sum(axis=0) / total
    unrest = (weight * (values - mean) ** 2).sum(axis=0)
    freedom = seen - 1
    bound = total - (weight**2).sum(axis=0) / total
    between = np.maximum(unrest - freedom, 0.0) / np.where(bound > 0.0, bound, np.inf)
    weight = 1.0 / (variance + between)
    total = np.where(known, weight.sum(axis=0), 1.0)
    return (weight * values).sum(axis=0) / total, np.where(known, 1.0 / total + common, np.inf)
