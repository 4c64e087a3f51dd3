"""Derivatives of out-of-band modes as nuisance parameters: their prior and its spread.

An aircraft has more modes than a maneuver excites. Omitted, they bias the derivatives of the
modes in the band by more than the standard errors; estimated freely, they are not identifiable.
With a prior they are marginalised: their uncertainty is part of every standard error.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from flexsid.sysid.estimation.estimate import Estimate
from flexsid.sysid.model.derivatives import DerivativeTable, list_derivative_names
from flexsid.sysid.model.longitudinal import LONGITUDINAL
from flexsid.sysid.model.rigid_body import RigidBody

PRIOR_SPREAD = 0.3
"""Standard deviation of a predicted derivative over its size where nothing else is known.

Panel codes and flight differ by 10 to 30 % (design notes of the project; DLM priors there are
0.15 to 0.25 per entry)."""

_MEDIAN_OF_NORMAL = 0.6745  # of its absolute value, in standard deviations
_SPREADS = np.geomspace(0.05, 1.0, 60)  # searched
_QUANTILE = 0.84  # of the posterior of a spread, which few derivatives leave uncertain
_SPREAD_PRIOR = 0.5  # standard deviation of the logarithm of a spread about PRIOR_SPREAD


@dataclass(frozen=True, slots=True)
class NuisancePrior:
    """Prior of the derivatives of a table: mean, and size that the spread multiplies.

    ``covered`` are those with a prediction; the others have mean zero and a standard deviation
    of their size, which is that of similar predicted derivatives. ``modal_std`` are the standard
    deviations due to the modal table, which estimates and predictions do not share.
    """

    mean: DerivativeTable
    size: Float[np.ndarray, "n_rows n_w"]
    covered: np.ndarray
    modal_std: Float[np.ndarray, "n_rows n_w"]

    def list_priors(self, names: tuple[str, ...], spread: float) -> dict[str, tuple[float, float]]:
        """Return mean and standard deviation by name."""
        std = np.hypot(np.where(self.covered, spread * self.size, self.size), self.modal_std)
        means = self.mean.named()
        stds = replace(self.mean, values=std).named()
        return {name: (means[name], stds[name]) for name in names}


def build_nuisance_prior(
    modes: tuple[int, ...],
    inputs: tuple[str, ...],
    predicted: Mapping[str, float],
    body: RigidBody = LONGITUDINAL,
) -> NuisancePrior:
    """Build the prior of all derivatives of a model.

    Parameters
    ----------
    modes, inputs, body
        Of the model.
    predicted
        Predicted derivatives by name; those that are missing have mean zero.

    Notes
    -----
    The size of a derivative is at least the median of its row: one that is predicted near
    zero is not certain to be. The size of a derivative without prediction is the product of the
    medians of its row and its column, relative to that of the table, over 0.67, which is the
    median of the absolute value of a normal variable of unit deviation. Rows and columns without
    prediction, or predicted as zero for the most part, take the medians of those of the same
    kind: a size of zero would be a prior without standard deviation.
    """
    missing = dict.fromkeys(list_derivative_names(modes, inputs, body), np.nan)
    table = DerivativeTable.from_names(modes, inputs, missing | dict(predicted), body)
    covered = np.isfinite(table.values)
    absolute = np.abs(table.values)
    row, column = _complete_medians(absolute, len(modes), body.size)
    overall = float(np.nanmedian(absolute)) if covered.any() else 0.0
    similar = np.outer(row, column) / (overall or np.median(row)) / _MEDIAN_OF_NORMAL
    size = np.where(covered, np.maximum(np.nan_to_num(absolute), row[:, None]), similar)
    mean = replace(table, values=np.nan_to_num(table.values))
    return NuisancePrior(mean, size, covered, np.zeros(size.shape))


def _complete_medians(
    absolute: Float[np.ndarray, "n_rows n_w"], n_modes: int, n_rigid: int
) -> tuple[Float[np.ndarray, " n_rows"], Float[np.ndarray, " n_w"]]:
    """Return the median of every row and column; unknown and zero ones from the same kind."""
    masked = np.ma.masked_invalid(absolute)
    row = np.ma.median(masked, axis=1).filled(np.nan)
    column = np.ma.median(masked, axis=0).filled(np.nan)
    single = [slice(k, k + 1) for k in range(n_rigid)]
    n_r, n_x = n_rigid + n_modes, n_rigid + 2 * n_modes
    kinds = [
        (row, [*single, slice(n_rigid, None)]),
        (column, [*single, slice(n_rigid, n_r), slice(n_r, n_x), slice(n_x, None)]),
    ]
    for values, slices in kinds:
        known = values[values > 0.0]
        rest = float(np.median(known)) if known.size else 1.0
        for part in slices:
            own = values[part]
            found = own[own > 0.0]
            own[~(own > 0.0)] = np.median(found) if found.size else rest
    return row, column


def estimate_spread(estimate: Estimate, prior: NuisancePrior) -> float:
    """Estimate how far predicted derivatives are from the truth, relative to their size.

    Parameters
    ----------
    estimate
        Fit with the nuisance parameters; the others have no prior.
    prior
        Of all derivatives of the model.

    Notes
    -----
    The derivatives of the modes in the band show the error of the prediction: the distance of
    those above the median of their row from it, over their size, is d ~ N(0, s^2 I + C), with
    the covariance C of the estimates and of the modal table over the sizes. The posterior of s
    from this marginal likelihood and a log-normal prior about 0.3 is computed on a grid; its
    upper standard deviation is returned, since standard errors from an average spread are too
    small half of the time.
    Source: MacKay (1992), Bayesian interpolation, Neural Computation 4 (evidence framework).
    """
    place = {name: k for k, name in enumerate(prior.mean.named())}
    leading = (prior.covered & (np.abs(prior.mean.values) >= prior.size)).ravel()
    own = [
        k
        for k, name in enumerate(estimate.names)
        if name not in estimate.nuisance and name in place and leading[place[name]]
    ]
    where = [place[estimate.names[k]] for k in own]
    size = prior.size.ravel()[where]
    covariance = estimate.corrected_covariance[np.ix_(own, own)] / np.outer(size, size)
    covariance += np.diag((prior.modal_std.ravel()[where] / size) ** 2)
    if not own or not np.isfinite(covariance).all():
        return PRIOR_SPREAD
    variances, axes = np.linalg.eigh(covariance)
    distance = (estimate.values[own] - prior.mean.values.ravel()[where]) / size
    total = _SPREADS[:, None] ** 2 + np.maximum(variances, 0.0)
    log_likelihood = -0.5 * np.sum(np.log(total) + (axes.T @ distance) ** 2 / total, axis=1)
    log_likelihood -= 0.5 * (np.log(_SPREADS / PRIOR_SPREAD) / _SPREAD_PRIOR) ** 2
    posterior = np.cumsum(np.exp(log_likelihood - log_likelihood.max()))
    return float(np.interp(_QUANTILE, posterior / posterior[-1], _SPREADS))


def compute_noise_share(
    estimate: Estimate, priors: Mapping[str, tuple[float, float]], overlap: float = 1.0
) -> dict[str, float]:
    """Compute the share of the variance of each parameter that noise causes.

    Parameters
    ----------
    estimate, priors
        Estimate, and mean and standard deviation of every nuisance parameter.
    overlap
        Factor of the variances, for frequencies closer than 1/T.

    Notes
    -----
    Cov = N^-1 (noise + prior) N^-1 with N = data + prior information P: the prior's part is
    Cov P Cov for Cov = N^-1, the rest is due to noise. With the corrected covariance, of
    coloured residuals, it is an approximation and limited to one.
    """
    if not np.isfinite(estimate.corrected_covariance).all():
        return {}
    own = [k for k, name in enumerate(estimate.names) if name not in estimate.nuisance]
    held = [k for k, name in enumerate(estimate.names) if name in estimate.nuisance]
    std = np.array([priors[estimate.names[k]][1] for k in held])
    through = estimate.covariance[np.ix_(own, held)] / std
    variance = np.diag(estimate.corrected_covariance)[own]
    share = 1.0 - np.sum(through**2, axis=1) / overlap / np.where(variance > 0.0, variance, np.inf)
    return {estimate.names[k]: float(np.clip(s, 0.0, 1.0)) for k, s in zip(own, share, strict=True)}
