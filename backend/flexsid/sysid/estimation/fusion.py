"""Fusion of several estimates of the same parameters."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from jaxtyping import Float

from flexsid.sysid.estimation.error_components import add_components, name_priors
from flexsid.sysid.estimation.estimate import Estimate


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
