"""Fusion: several estimates of the same parameters to one."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from jaxtyping import Float

from flexsid.sysid.estimation.estimate import Estimate


def fuse(estimates: Sequence[Estimate], labels: Sequence[str]) -> Estimate:
    """Weight independent estimates by their information.

    Parameters
    ----------
    estimates
        Of the same parameters, e.g. one per maneuver.
    labels
        What to call each one's lines.

    Notes
    -----
    Exact for linear regressions: the same as stacking all lines, each maneuver
    weighted with its own residual variance.
    """
    if len(estimates) == 1:
        return estimates[0]
    scale = np.sqrt(np.mean([np.diag(e.corrected_covariance) for e in estimates], axis=0))
    outer = np.outer(scale, scale)
    every = np.eye(scale.size)
    values, covariance = estimates[0].values / scale, estimates[0].corrected_covariance / outer
    plain = estimates[0].covariance / outer
    for other in estimates[1:]:
        values, covariance = _weigh(
            values, covariance, every, other.values / scale, other.corrected_covariance / outer
        )
        plain = _weigh(values, plain, every, values, other.covariance / outer)[1]
    lines = tuple(
        replace(block, name=f"{label} {block.name}")
        for estimate, label in zip(estimates, labels, strict=True)
        for block in estimate.lines
    )
    return replace(
        estimates[0],
        values=values * scale,
        covariance=plain * outer,
        corrected_covariance=covariance * outer,
        lines=lines,
    )


def with_priors(estimate: Estimate, priors: Mapping[str, tuple[float, float]]) -> Estimate:
    """Weigh a linear estimate against prior values and standard deviations by name."""
    if not priors:
        return estimate
    scale = np.sqrt(np.diag(estimate.corrected_covariance))
    outer = np.outer(scale, scale)
    place = [k for k, name in enumerate(estimate.names) if name in priors]
    seen = np.eye(scale.size)[place]
    mean, std = np.array([priors[estimate.names[k]] for k in place]).T / scale[place]
    values, covariance = _weigh(
        estimate.values / scale,
        estimate.corrected_covariance / outer,
        seen,
        mean,
        np.diag(std**2),
    )
    plain = _weigh(values, estimate.covariance / outer, seen, mean, np.diag(std**2))[1]
    return replace(
        estimate,
        values=values * scale,
        covariance=plain * outer,
        corrected_covariance=covariance * outer,
    )


def _weigh(
    values: Float[np.ndarray, " n"],
    covariance: Float[np.ndarray, "n n"],
    seen: Float[np.ndarray, "n_seen n"],
    others: Float[np.ndarray, " n_seen"],
    their: Float[np.ndarray, "n_seen n_seen"],
) -> tuple[Float[np.ndarray, " n"], Float[np.ndarray, "n n"]]:
    """Mean by information of ``values`` and of ``others``, which are ``seen`` of the same.

    Notes
    -----
    In the form of covariances, which may be as ill-conditioned as they are: information would
    be their inverse, and that of an ill-conditioned one has no digit left. The symmetric
    form of the covariance stays positive.
    Source: R. S. Bucy and P. D. Joseph, Filtering for Stochastic Processes (1968).
    """
    cross = seen @ covariance
    gain = np.linalg.lstsq(cross @ seen.T + their, cross, rcond=None)[0].T
    left = np.eye(values.size) - gain @ seen
    total = left @ covariance @ left.T + gain @ their @ gain.T
    return values + gain @ (others - seen @ values), 0.5 * (total + total.T)
