"""Judgement: what an analyst should know about an estimate, in words."""

from __future__ import annotations

import numpy as np

from flexsid.sysid.estimation.estimate import Estimate, Outcome
from flexsid.sysid.model.derivatives import is_derivative

CORRELATED = 0.9
_POOR_FIT = 0.8
_OPTIMISTIC = 2.0


def warnings_of(estimate: Estimate) -> tuple[str, ...]:
    """Sentences on identifiability, fit and error bars; empty where nothing is wrong."""
    found = []
    if estimate.outcome is not Outcome.CONVERGED:
        found.append(estimate.message)
    names = np.array(estimate.names)
    derivative = np.array([is_derivative(name) for name in estimate.names])
    weak = np.flatnonzero(derivative & (np.abs(estimate.values) < 2.0 * estimate.std_errors))
    if weak.size:
        found.append(
            f"{weak.size} of {derivative.sum()} derivatives {'is' if weak.size == 1 else 'are'} "
            "within two standard errors "
            f"of zero: {_some(names[weak])}."
        )
    correlation = np.abs(np.triu(estimate.correlation, 1))
    pairs = np.argwhere(correlation > CORRELATED)
    if pairs.size:
        worst = pairs[np.argsort(-correlation[pairs[:, 0], pairs[:, 1]])]
        found.append(
            f"{len(pairs)} {'pair' if len(pairs) == 1 else 'pairs'} of parameters "
            f"{'is' if len(pairs) == 1 else 'are'} correlated above {CORRELATED}: "
            + _some(np.array([f"{names[i]} with {names[j]}" for i, j in worst]))
            + "."
        )
    poor = {
        output
        for block in estimate.lines
        for output, r2 in zip(block.outputs, block.r_squared(), strict=True)
        if r2 < _POOR_FIT
    }
    if poor:
        found.append(f"The model explains less than {_POOR_FIT:.0%} of {_some(sorted(poor))}.")
    plain = np.sqrt(np.diag(estimate.covariance))
    ratio = float(np.median(estimate.std_errors / np.where(plain > 0, plain, np.inf)))
    if ratio > _OPTIMISTIC:
        found.append(
            f"Residuals are coloured or correlated between outputs; standard errors are "
            f"{ratio:.1f} times what white residuals would give. A mode may be missing."
        )
    return tuple(found)


def _some(names: np.ndarray | list[str], most: int = 6) -> str:
    listed = ", ".join(map(str, names[:most]))
    return listed if len(names) <= most else f"{listed} and {len(names) - most} more"
