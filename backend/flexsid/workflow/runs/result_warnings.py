"""Judgement: what an analyst should know about an estimate, in words."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from flexsid.sysid.estimation.estimate import Estimate, Outcome, standard_errors
from flexsid.sysid.estimation.limits import LONGEST_DELAY_S
from flexsid.sysid.model.derivatives import is_derivative

CORRELATED = 0.9
_POOR_FIT = 0.8
_OPTIMISTIC = 2.0
_OF_PRIOR = 0.95  # of a prior's deviation is left where the data hold a tenth of what it holds


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
    ratios = estimate.std_errors / standard_errors(estimate.covariance)
    known = ratios[np.isfinite(ratios)]
    ratio = float(np.median(known)) if known.size else 1.0
    if ratio > _OPTIMISTIC:
        found.append(
            f"Residuals are coloured or correlated between outputs; standard errors are "
            f"{ratio:.1f} times what white residuals would give. A mode may be missing."
        )
    return tuple(found)


def warning_of_limits(estimate: Estimate, beyond: np.ndarray) -> tuple[str, ...]:
    """A sentence on parameters that ended at a limit; empty where there is none."""
    if not beyond.any():
        return ()
    named = [
        f"{name} = {value:.3g}"
        for name, value, out in zip(estimate.names, estimate.values, beyond, strict=True)
        if out
    ]
    one = len(named) == 1
    return (
        f"{_some(named)} {'is' if one else 'are'} at or beyond what an instrument or a structure "
        f"can have (delays within ±{LONGEST_DELAY_S:g} s, factors above zero): "
        f"{'it is' if one else 'they are'} no estimate and {'has' if one else 'have'} no standard "
        f"error, and the other values rest on {'it' if one else 'them'}. "
        f"Hold {'it' if one else 'them'}, or correct the channel.",
    )


def warning_of_priors(
    estimate: Estimate, priors: Mapping[str, tuple[float, float]]
) -> tuple[str, ...]:
    """A sentence on estimates that are little more than their priors; empty where none is."""
    held = [
        name
        for name, sigma in zip(estimate.names, estimate.std_errors, strict=True)
        if name in priors and sigma > _OF_PRIOR * priors[name][1]
    ]
    if not held:
        return ()
    return (
        f"The data say little of {_some(held)}: "
        f"{'its value and standard error are' if len(held) == 1 else 'values and errors are'} "
        "those of the prior.",
    )


def _some(names: np.ndarray | list[str], most: int = 6) -> str:
    listed = ", ".join(map(str, names[:most]))
    return listed if len(names) <= most else f"{listed} and {len(names) - most} more"
