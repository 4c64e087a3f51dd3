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
"""Standard deviation of relative errors of predicted derivatives where nothing else is known.

Panel codes and flight differ by 10 to 30 % (design notes of the project; DLM priors there are
0.15 to 0.25 per entry)."""

_MEDIAN_OF_NORMAL = 0.6745  # of its absolute value, in standard deviations
_DEGREES_OF_FREEDOM = 4.0
"""Of Student's t for true derivatives over the size of similar ones: their kurtosis is 6 to 26 on
three aircraft with eight modes, that of a normal variable 3. [1]"""

_LEADING = 0.5  # of the median of the row: least size of derivatives that determine the spread
_NEAR = 8.0 * np.sinh(np.linspace(-4.0, 4.0, 121)) / np.sinh(4.0)  # deviations about a prediction
_FAR = 12.0 * np.sinh(np.linspace(-6.0, 6.0, 161)) / np.sinh(6.0)  # sizes about zero
_SPREADS = np.geomspace(0.05, 1.0, 60)  # searched
_QUANTILE = 0.84  # of the posterior of a spread, which few derivatives leave uncertain
_SPREAD_PRIOR = 0.5  # standard deviation of the logarithm of a spread about PRIOR_SPREAD


@dataclass(frozen=True, slots=True)
class NuisancePrior:
    """Prior of the derivatives of a table: their predictions, and the sizes of true derivatives.

    ``covered`` are those with a prediction; the others have mean zero and a standard deviation of
    ``similar``, the size of similar predicted derivatives. ``median`` is that of each row, to
    which a part of the errors is relative. ``modal_std`` are the standard deviations due to the
    modal table, which estimates and predictions do not share.
    """

    mean: DerivativeTable
    median: Float[np.ndarray, "n_rows 1"]
    similar: Float[np.ndarray, "n_rows n_w"]
    covered: np.ndarray
    modal_std: Float[np.ndarray, "n_rows n_w"]

    def list_priors(self, names: tuple[str, ...], spread: float) -> dict[str, tuple[float, float]]:
        """Return mean and standard deviation by name; ``spread`` is that of relative errors."""
        predicted = compute_prior_std(self.mean.values, self.median, self.similar, spread)
        std = np.hypot(np.where(self.covered, predicted, self.similar), self.modal_std)
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
    Errors are relative to the median of the row, too: a derivative that is predicted near zero is
    not certain to be. The size of similar derivatives is the product of the medians of row
    and column, relative to that of the table, over 0.67, which is the median of the absolute value
    of a normal variable of unit deviation. Rows and columns without prediction, or predicted as
    zero for the most part, take the medians of those of the same kind: a size of zero would be a
    prior without standard deviation.
    """
    missing = dict.fromkeys(list_derivative_names(modes, inputs, body), np.nan)
    table = DerivativeTable.from_names(modes, inputs, missing | dict(predicted), body)
    covered = np.isfinite(table.values)
    absolute = np.abs(table.values)
    row, column = _complete_medians(absolute, len(modes), body.size)
    overall = float(np.nanmedian(absolute)) if covered.any() else 0.0
    similar = np.outer(row, column) / (overall or np.median(row)) / _MEDIAN_OF_NORMAL
    mean = replace(table, values=np.nan_to_num(table.values))
    return NuisancePrior(mean, row[:, None], similar, covered, np.zeros(similar.shape))


def compute_prior_std(
    predicted: Float[np.ndarray, "*shape"],
    median: Float[np.ndarray, "*#shape"],
    similar: Float[np.ndarray, "*#shape"],
    spread: float,
) -> Float[np.ndarray, "*shape"]:
    """Compute the root mean square deviation of true derivatives from their predictions.

    Parameters
    ----------
    predicted
        Predictions p.
    median
        Median a of the absolute derivatives of the row.
    similar
        Size S of similar derivatives.
    spread
        Standard deviation s of relative errors. [1]

    Notes
    -----
    p ~ N(theta, s^2 (theta^2 + a^2)), theta / S ~ Student's t of four degrees of freedom: errors
    are relative to the truth, not to the prediction. Returned is E[(theta - p)^2 | p]^(1/2), by
    quadrature over theta, and s (p^2 + a^2)^(1/2) at least. Where |p| is far below S it is larger:
    a large derivative is predicted near zero, or with the opposite sign, by chance.
    """
    p, a, S = np.broadcast_arrays(np.abs(predicted), median, similar)
    direct = spread * np.hypot(p, a)
    near = p[..., None] + direct[..., None] * _NEAR
    theta = np.sort(np.concatenate([near, np.maximum(S, p)[..., None] * _FAR], axis=-1), axis=-1)
    std = spread * np.hypot(theta, a[..., None])
    deviation = theta - p[..., None]
    log_density = -0.5 * (deviation / std) ** 2 - np.log(std)
    tail = np.log1p((theta / S[..., None]) ** 2 / _DEGREES_OF_FREEDOM)
    log_density -= 0.5 * (_DEGREES_OF_FREEDOM + 1.0) * tail
    density = np.exp(log_density - log_density.max(axis=-1, keepdims=True))
    total = np.trapezoid(density, theta, axis=-1)
    variance = np.trapezoid(density * deviation**2, theta, axis=-1) / total
    return np.maximum(np.sqrt(variance), direct)


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
    """Estimate how far predicted derivatives are from the truth, relative to it.

    Parameters
    ----------
    estimate
        Fit with the nuisance parameters; the others have no prior.
    prior
        Of all derivatives of the model.

    Notes
    -----
    The derivatives of the modes in the band show the error of the prediction: the distance of
    those above half of the median of their row from it, over their estimates, is
    d ~ N(0, s^2 I + C), with the covariance C of the estimates and of the modal table over the
    estimates. Errors are relative to estimates, not to predictions: predictions that are small by
    chance would be omitted, or have excessive errors. The posterior of s
    from this marginal likelihood and a log-normal prior about 0.3 is computed on a grid; its
    upper standard deviation is returned, since standard errors from an average spread are too
    small half of the time.
    Source: MacKay (1992), Bayesian interpolation, Neural Computation 4 (evidence framework).
    """
    place = {name: k for k, name in enumerate(prior.mean.named())}
    covered = prior.covered.ravel()
    least = np.broadcast_to(_LEADING * prior.median, prior.covered.shape).ravel()
    own = [
        k
        for k, name in enumerate(estimate.names)
        if name not in estimate.nuisance
        and name in place
        and covered[place[name]]
        and abs(estimate.values[k]) >= least[place[name]]
    ]
    where = [place[estimate.names[k]] for k in own]
    size = np.abs(estimate.values[own])
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


def compute_prior_shares(
    estimate: Estimate, priors: Mapping[str, tuple[float, float]], overlap: float = 1.0
) -> Float[np.ndarray, "n_own n_prior"]:
    """Compute the share of the variance of each result that the error of each prior causes.

    Parameters
    ----------
    estimate, priors
        Estimate of results and nuisance parameters, and mean and standard deviation by parameter.
    overlap
        Factor of the variances, for frequencies closer than 1/T.

    Returns
    -------
    Array
        The priors in the order of the parameters; the shares of a result are one in sum at most.

    Notes
    -----
    Cov = N^-1 (noise + prior) N^-1 with N = data + prior information P: the prior's part is
    Cov P Cov for Cov = N^-1, the rest is due to noise. With the corrected covariance, of
    coloured residuals, it is an approximation and limited to one.
    """
    own = [k for k, name in enumerate(estimate.names) if name not in estimate.nuisance]
    held = [k for k, name in enumerate(estimate.names) if name in priors]
    std = np.array([priors[estimate.names[k]][1] for k in held])
    through = estimate.covariance[np.ix_(own, held)] / std
    variance = np.diag(estimate.corrected_covariance)[own, None]
    shares = through**2 / overlap / np.where(variance > 0.0, variance, np.inf)
    return shares / np.maximum(shares.sum(axis=1, keepdims=True), 1.0)
