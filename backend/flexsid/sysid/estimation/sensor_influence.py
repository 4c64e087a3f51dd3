"""Influence of each sensor on an estimate: the estimate without its output, by one step.

Sensors of a correct model agree: what an estimate changes by when one of them is omitted has
the variance that the noise explains.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float
from scipy import linalg, special

from flexsid.sysid.estimation.covariance import FinalSpectra, score_covariance, weight_score_noise
from flexsid.sysid.estimation.frequency_domain_model import expand_sensitivity
from flexsid.sysid.estimation.real_products import sum_products

_RIDGE = 1e-10  # of unit diagonal: nearly dependent normal equations stay solvable
_LEAST_INFORMATION = 1e-8  # of a direction, left by the other outputs: not identifiable below
_LEAST_VARIANCE = 1e-9  # of a change over that of the parameter: smaller ones are rounding


@dataclass(frozen=True, slots=True)
class SensorInfluence:
    """Change of the results when an output is not used; NaN where the others do not determine one.

    ``change`` is to be added to the estimate and has the standard deviation ``change_std`` if the
    model is correct; ``std_ratio`` is the standard error without the output over that with it.
    ``largest`` is the result with the largest change over its standard deviation, ``z``, and ``p``
    the probability that any has a larger one.
    """

    output: str
    change: Float[np.ndarray, " n"]
    change_std: Float[np.ndarray, " n"]
    std_ratio: Float[np.ndarray, " n"]
    largest: int
    z: float
    p: float


def compute_sensor_influences(
    fits: Sequence[FinalSpectra],
    prior_information: Float[np.ndarray, " n_theta"],
    prior_gradient: Float[np.ndarray, " n_theta"],
    reported: np.ndarray,
    *,
    overlap: float,
    residual_df: float,
) -> list[SensorInfluence]:
    """Compute the influence of every output of a fit.

    Parameters
    ----------
    fits
        Sensitivities, residuals and diagonal weights of every maneuver at the estimate.
    prior_information, prior_gradient
        Diagonal P of the priors in the normal matrix, and P (mean - theta).
    reported
        Indices of the parameters that are results; nuisance parameters are none.
    overlap
        Frequencies per resolution 1/T of the record, at least one.
    residual_df
        Degrees of freedom of the residuals from which the noise is estimated.

    Returns
    -------
    list of SensorInfluence
        By output; none of an output without which no parameter is determined.

    Notes
    -----
    With N = Re sum J^H W J + P, its part N_o of output o and the gradients g and g_o, the
    Gauss-Newton steps with and without the output differ by
    d = (N - N_o)^-1 (g - g_o) - N^-1 g, a linear function Re sum D^H nu of the residuals with
    D = W (1 - e_o) J (N - N_o)^-1 - W J N^-1. Its covariance is 1/2 Re sum D^H S D with S from
    neighbouring leave-one-out residuals, plus that of the errors of the priors. With W = S^-1 it is
    that of Hausman's test, Var(without) - Var(with). Both inverses are in the directions that
    make N one and N_o diagonal; a parameter in a direction of which only this output has
    information has no change.
    The probability of the largest |z| is that of M independent ones,
    M = (sum sqrt l)^2 / sum l with the eigenvalues l of the correlation of the changes.
    Sources: Hausman (1978), Specification tests in econometrics; White (1980) for S; Galwey (2009),
    A new measure of the effective number of tests, Genetic Epidemiology 33.
    """
    n_theta = prior_information.size
    outputs = list(dict.fromkeys(name for fit in fits for name in _list_outputs(fit)))
    parts = np.zeros((len(outputs), n_theta, n_theta))
    gradients = np.zeros((len(outputs), n_theta))
    weighted = []
    for fit in fits:
        J = expand_sensitivity(fit.form.model, fit.sensitivity)
        root = np.sqrt(fit.weights.expand_blocks())
        J *= root[:, :, None]
        for column, name in enumerate(_list_outputs(fit)):
            own, o = J[:, column], outputs.index(name)
            parts[o] += sum_products(own, own)
            scaled = root[:, column] * fit.residuals[:, column]
            gradients[o] += sum_products(own, scaled[:, None])[:, 0]
        J *= root[:, :, None]
        weighted.append(J)
    T = _factor_inverse(parts.sum(axis=0) + np.diag(prior_information))
    g = T.T @ (gradients.sum(axis=0) + prior_gradient)
    own_variance = np.sum(T**2, axis=1)[reported]
    inverse = T @ T.T
    noises = [_WeightedNoise(fit, A, inverse) for fit, A in zip(fits, weighted, strict=True)]
    whole_score = np.sum([noise.compute_score_covariance() for noise in noises], axis=0)
    result = []
    for o, name in enumerate(outputs):
        share, V = np.linalg.eigh(T.T @ parts[o] @ T)
        lost = share > 1.0 - _LEAST_INFORMATION
        rows = T[reported] @ V
        is_known = np.sum(rows[:, lost] ** 2, axis=1) <= _LEAST_INFORMATION * own_variance
        if not is_known.any():
            continue
        left = np.where(lost, 1.0, 1.0 - share)
        growth = np.where(lost, 0.0, share / left)
        more = (rows * growth) @ V.T  # (N - N_o)^-1 - N^-1, in the coordinates of T
        whole = (rows * np.where(lost, 0.0, 1.0 / left)) @ V.T
        change = more @ g - whole @ (T.T @ gradients[o])
        by_whole, by_own = more @ T.T, (-T[reported] - more) @ T.T
        noise = by_whole @ whole_score @ by_whole.T
        for one in noises:
            noise += one.compute_change_covariance(name, by_own, by_whole)
        by_priors = by_whole * prior_information
        covariance = 0.5 * (overlap * noise + by_priors @ by_whole.T)
        variance = np.diag(covariance)
        is_known &= variance > _LEAST_VARIANCE * own_variance
        if not is_known.any():
            continue
        known = np.flatnonzero(is_known)
        deviation = np.sqrt(variance[known])
        z = np.abs(change[known]) / deviation
        correlation = covariance[np.ix_(known, known)] / np.outer(deviation, deviation)
        roots = np.sqrt(np.maximum(np.linalg.eigvalsh(correlation), 0.0))
        count = max(1.0, roots.sum() ** 2 / known.size)
        largest = int(z.argmax())
        single = 2.0 * float(special.stdtr(max(residual_df, 4.0), -z[largest]))
        ratio = np.sqrt(np.sum(rows**2 / left, axis=1) / own_variance)
        result.append(
            SensorInfluence(
                name,
                np.where(is_known, change, np.nan),
                np.where(is_known, np.sqrt(np.maximum(variance, 0.0)), np.nan),
                np.where(is_known, ratio, np.nan),
                int(known[largest]),
                float(z[largest]),
                float(-np.expm1(count * np.log1p(-min(single, 0.5)))),
            )
        )
    return result


class _WeightedNoise:
    """Weighted sensitivities A of a maneuver, and S A with the density S of the noise."""

    def __init__(
        self,
        fit: FinalSpectra,
        weighted: Complex[np.ndarray, "n_omega n_y n_theta"],
        inverse: Float[np.ndarray, "n_theta n_theta"],
    ) -> None:
        self.fit = fit if fit.shares_noise else fit.with_leave_one_out_residuals(inverse)
        self.A, S = weight_score_noise(self.fit, weighted)
        self.noise = S.times(self.A)
        self.density = np.real(np.einsum("bii->bi", S.blocks))[S.block]
        self.outputs = _list_outputs(fit)

    def compute_score_covariance(self) -> Float[np.ndarray, "n_theta n_theta"]:
        """Compute Re sum A^H S A, twice the covariance of the scores."""
        if self.fit.shares_noise:
            return sum_products(self.A, self.noise)
        return score_covariance(self.fit)

    def compute_change_covariance(
        self,
        output: str,
        own: Float[np.ndarray, "n n_theta"],
        whole: Float[np.ndarray, "n n_theta"],
    ) -> Float[np.ndarray, "n n"]:
        """Compute the part of twice the covariance of a change that one output has.

        The change is ``own`` times the score of this output plus ``whole`` times that of all.
        """
        if output not in self.outputs:
            return np.zeros((len(own), len(own)))
        column = self.outputs.index(output)
        moved, noise = self.A[:, column] @ own.T, self.noise[:, column] @ whole.T
        mixed = sum_products(moved, noise)
        return mixed + mixed.T + sum_products(moved, self.density[:, column, None] * moved)


def _list_outputs(fit: FinalSpectra) -> tuple[str, ...]:
    return fit.form.model.experiment.model.outputs


def _factor_inverse(N: Float[np.ndarray, "n n"]) -> Float[np.ndarray, "n n"]:
    """Return T with T^T N T = 1."""
    size = np.sqrt(np.maximum(np.diag(N), np.finfo(float).tiny))
    scaled = N / np.outer(size, size)
    scaled[np.diag_indices_from(scaled)] += _RIDGE
    factor = linalg.cholesky(scaled, lower=True)
    return linalg.solve_triangular(factor, np.eye(len(N)), lower=True).T / size[:, None]
