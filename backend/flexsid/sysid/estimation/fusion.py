"""Fusion: several estimates of the same parameters to one."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

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
    identity = np.eye(scale.size)
    information = np.zeros_like(outer)
    moment = np.zeros_like(scale)
    plain = np.zeros_like(outer)
    for estimate in estimates:
        weight = np.linalg.solve(estimate.corrected_covariance / outer, identity)
        information += weight
        moment += weight @ (estimate.values / scale)
        plain += np.linalg.solve(estimate.covariance / outer, identity)
    lines = tuple(
        replace(block, name=f"{label} {block.name}")
        for estimate, label in zip(estimates, labels, strict=True)
        for block in estimate.lines
    )
    return replace(
        estimates[0],
        values=np.linalg.solve(information, moment) * scale,
        covariance=np.linalg.solve(plain, identity) * outer,
        corrected_covariance=np.linalg.solve(information, identity) * outer,
        lines=lines,
    )


def with_priors(estimate: Estimate, priors: Mapping[str, tuple[float, float]]) -> Estimate:
    """Weigh a linear estimate against prior values and standard deviations by name."""
    if not priors:
        return estimate
    scale = np.sqrt(np.diag(estimate.corrected_covariance))
    outer = np.outer(scale, scale)
    identity = np.eye(scale.size)
    mean = np.array(
        [
            priors[n][0] if n in priors else v
            for n, v in zip(estimate.names, estimate.values, strict=True)
        ]
    )
    weight = np.array(
        [
            scale[k] ** 2 / priors[n][1] ** 2 if n in priors else 0.0
            for k, n in enumerate(estimate.names)
        ]
    )
    information = np.linalg.solve(estimate.corrected_covariance / outer, identity)
    total = information + np.diag(weight)
    moment = information @ (estimate.values / scale) + weight * mean / scale
    plain = np.linalg.solve(estimate.covariance / outer, identity) + np.diag(weight)
    return replace(
        estimate,
        values=np.linalg.solve(total, moment) * scale,
        covariance=np.linalg.solve(plain, identity) * outer,
        corrected_covariance=np.linalg.solve(total, identity) * outer,
    )
