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
from flexsid.sysid.estimation.frequency_domain_model import expand_kept
from flexsid.sysid.estimation.linear_algebra import sum_products

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
    prior_information: Float[np.ndarray, "n_theta n_theta"],
    prior_gradient: Float[np.ndarray, " n_theta"],
    reported: np.ndarray,
    *,
    overlap: float,
    residual_df: float,
    inverse: Float[np.ndarray, "n_theta n_theta"],
) -> list[SensorInfluence]:
    """Compute the influence of every output of a fit.

    Parameters
    ----------
    fits
        Sensitivities, residuals and diagonal weights of every maneuver at the estimate.
    prior_information, prior_gradient
        Of the priors in the normal matrix, P, and P (mean - theta).
    reported
        Indices of the parameters that are results; nuisance parameters are none.
    overlap
        Frequencies per resolution 1/T of the record, at least one.
    residual_df
        Degrees of freedom of the residuals from which the noise is estimated.
    inverse
        Of the whole normal matrix.

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
    that of Hausman's test, Var(without) - Var(with). N - N_o is a downdate of N in coordinates in
    which N is one; a parameter in a direction of which only this output has information has no
    change.
    The probability of the largest |z| is that of M independent ones,
    M = (sum sqrt l)^2 / sum l with the eigenvalues l of the correlation of the changes.
    N and g are those after the elimination of each output's own nuisance parameters.
    Sources: Hausman (1978), Specification tests in econometrics; White (1980) for S; Galwey (2009),
    A new measure of the effective number of tests, Genetic Epidemiology 33.
    """
    outputs = tuple(dict.fromkeys(name for fit in fits for name in _list_outputs(fit)))
    reduced = _ReducedFit(fits, outputs, prior_information, prior_gradient, reported)
    parts, gradients = reduced.parts, reduced.gradients
    prior = prior_information[np.ix_(reduced.kept, reduced.kept)]
    reported = np.searchsorted(reduced.kept, reported)
    T = _factor_inverse(parts.sum(axis=0) + prior)
    g = T.T @ (gradients.sum(axis=0) + prior_gradient[reduced.kept])
    own_variance = np.sum(T**2, axis=1)[reported]
    noises = [
        _WeightedNoise(fit, A, inverse) for fit, A in zip(fits, reduced.weighted, strict=True)
    ]
    whole_score = np.sum([one.compute_score_covariance(reduced.columns) for one in noises], axis=0)
    whole_prior = prior + reduced.priors.sum(axis=0)
    result = []
    for o, name in enumerate(outputs):
        share = T.T @ parts[o] @ T
        downdated = _downdate(T[reported], share)
        is_known = downdated.lost <= _LEAST_INFORMATION * own_variance
        if not is_known.any():
            continue
        # (N - N_o)^-1 and its difference from N^-1, in the coordinates of T
        whole, more = downdated.rows, downdated.more
        change = more @ g - whole @ (T.T @ gradients[o])
        by_whole, by_own = more @ T.T, (-T[reported] - more) @ T.T
        noise = by_whole @ whole_score @ by_whole.T
        for one in noises:
            noise += one.compute_change_covariance(name, by_own, by_whole)
        mixed = by_own @ reduced.priors[o] @ by_whole.T
        by_priors = by_whole @ whole_prior @ by_whole.T + mixed + mixed.T
        by_priors += by_own @ reduced.priors[o] @ by_own.T
        covariance = 0.5 * (overlap * noise + by_priors)
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
        ratio = np.sqrt(downdated.variance / own_variance)
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


@dataclass(frozen=True, slots=True)
class _Downdated:
    """Rows of T times (1 - X)^-1, with the share X of one output in the information T^T N T = 1.

    ``more`` are these rows less those of T, ``variance`` the diagonal of T (1 - X)^-1 T^T and
    ``lost`` the part of that of T T^T in directions of which only the output has information; it
    is in no other value.
    """

    rows: Float[np.ndarray, "n n_kept"]
    more: Float[np.ndarray, "n n_kept"]
    variance: Float[np.ndarray, " n"]
    lost: Float[np.ndarray, " n"]


def _downdate(
    rows: Float[np.ndarray, "n n_kept"], share: Float[np.ndarray, "n_kept n_kept"]
) -> _Downdated:
    """Subtract the share of one output from the information.

    Notes
    -----
    With 1 - X = L L^T the least information that is left in any direction is at least
    1 / ||L^-1||_F^2: where that suffices no direction is lost, and a Cholesky factorisation takes a
    tenth of the time of the eigenvalues.
    """
    left = np.eye(len(share)) - share
    factor, info = linalg.lapack.dpotrf(left, lower=True)
    if info == 0:
        inverse, _ = linalg.lapack.dtrtri(factor, lower=True)
        if _LEAST_INFORMATION * np.sum(inverse**2) < 1.0:
            half = rows @ inverse.T
            whole = half @ inverse
            return _Downdated(whole, whole - rows, np.sum(half**2, axis=1), np.zeros(len(rows)))
    shares, V = np.linalg.eigh(share)
    is_lost = shares > 1.0 - _LEAST_INFORMATION
    turned = rows @ V
    growth = np.where(is_lost, 0.0, 1.0 / np.where(is_lost, 1.0, 1.0 - shares))
    return _Downdated(
        (turned * growth) @ V.T,
        (turned * np.where(is_lost, 0.0, shares * growth)) @ V.T,
        np.sum(turned**2 * np.where(is_lost, 1.0, growth), axis=1),
        np.sum(turned[:, is_lost] ** 2, axis=1),
    )


class _ReducedFit:
    """Normal equations of each output after elimination of its own nuisance parameters.

    With the sensitivities E of an output to parameters with independent priors P_e that no other
    output has,
    the others have the sensitivities J - E L, L = (Re E^H W E + P_e)^-1 Re E^H W J, and the errors
    of these priors the covariance 1/2 L^T P_e L of its score. The size of every matrix is then
    that of the parameters which outputs share.

    Attributes
    ----------
    kept
        Indices in theta of the parameters that are left.
    parts, gradients, priors
        Of every output.
    columns
        Of the sensitivities that are left, in those to theta.
    weighted
        These sensitivities times the weights, of every fit.
    """

    def __init__(
        self,
        fits: Sequence[FinalSpectra],
        outputs: tuple[str, ...],
        prior_information: Float[np.ndarray, "n_theta n_theta"],
        prior_gradient: Float[np.ndarray, " n_theta"],
        reported: np.ndarray,
    ) -> None:
        strength = np.diag(prior_information)
        is_held = (strength > 0.0) & (np.count_nonzero(prior_information, axis=1) == 1)
        is_held[reported] = False
        own_parameters = fits[0].form.model.list_own_parameters()
        eliminated = [k for k in own_parameters if is_held[k]]
        self.kept = np.setdiff1d(np.arange(is_held.size), eliminated)
        size = len(outputs), self.kept.size, self.kept.size
        self.parts, self.priors = np.zeros(size), np.zeros(size)
        self.gradients = np.zeros(size[:2])
        self.columns = np.zeros((is_held.size, self.kept.size))
        self.columns[self.kept, np.arange(self.kept.size)] = 1.0
        self.weighted = [expand_kept(fit.form.model, fit.sensitivity, self.kept) for fit in fits]
        roots = [np.sqrt(fit.weights.expand_blocks()) for fit in fits]
        for o, name in enumerate(outputs):
            places = [
                (fit, J, root, _list_outputs(fit).index(name))
                for fit, J, root in zip(fits, self.weighted, roots, strict=True)
                if name in _list_outputs(fit)
            ]
            J = np.concatenate([root[:, at, None] * J[:, at] for _, J, root, at in places])
            nu = np.concatenate([root[:, at] * fit.residuals[:, at] for fit, _, root, at in places])
            self.parts[o] = sum_products(J, J)
            self.gradients[o] = sum_products(J, nu[:, None])[:, 0]
            fit, _, _, at = places[0]
            rows = fit.form.model.own_outputs == at
            single = own_parameters[rows]
            rows[rows], single = is_held[single], single[is_held[single]]
            if single.size:
                E = np.concatenate(
                    [root[:, at, None] * fit.sensitivity.own[rows].T for fit, _, root, at in places]
                )
                held = strength[single]
                cross = sum_products(E, J)
                L = linalg.solve(sum_products(E, E) + np.diag(held), cross, assume_a="pos")
                own_gradient = sum_products(E, nu[:, None])[:, 0] + prior_gradient[single]
                self.parts[o] -= cross.T @ L
                self.gradients[o] -= L.T @ own_gradient
                self.priors[o] = L.T @ (held[:, None] * L)
                self.columns[single] = -L
                for fit, left, _, at in places:
                    left[:, at] -= fit.sensitivity.own[rows].T @ L
        for J, root in zip(self.weighted, roots, strict=True):
            J *= (root**2)[:, :, None]


class _WeightedNoise:
    """Weighted sensitivities A of a maneuver, and S A with the density S of the noise."""

    def __init__(
        self,
        fit: FinalSpectra,
        weighted: Complex[np.ndarray, "n_omega n_y n"],
        inverse: Float[np.ndarray, "n_theta n_theta"],
    ) -> None:
        self.fit = fit if fit.shares_noise else fit.with_leave_one_out_residuals(inverse)
        self.A, S = weight_score_noise(self.fit, weighted)
        self.noise = S.times(self.A)
        self.density = np.real(np.einsum("bii->bi", S.blocks))[S.block]
        self.outputs = _list_outputs(fit)

    def compute_score_covariance(
        self, columns: Float[np.ndarray, "n_theta n"]
    ) -> Float[np.ndarray, "n n"]:
        """Compute Re sum A^H S A, twice the covariance of the scores.

        ``columns`` are those of A in the sensitivities to all parameters.
        """
        if self.fit.shares_noise:
            return sum_products(self.A, self.noise)
        return columns.T @ score_covariance(self.fit) @ columns

    def compute_change_covariance(
        self,
        output: str,
        own: Float[np.ndarray, "n n_kept"],
        whole: Float[np.ndarray, "n n_kept"],
    ) -> Float[np.ndarray, "n n"]:
        """Compute the part of twice the covariance of a change that one output has.

        The change is ``own`` times the score of this output plus ``whole`` times that of all.
        """
        if output not in self.outputs:
            return np.zeros((len(own), len(own)))
        column = self.outputs.index(output)
        # Interleaved real and imaginary parts: real products take half the time of complex ones.
        moved = own @ np.ascontiguousarray(self.A[:, column].T).view(float)
        noise = whole @ np.ascontiguousarray(self.noise[:, column].T).view(float)
        mixed = moved @ noise.T
        scaled = np.repeat(np.sqrt(self.density[:, column]), 2) * moved
        return mixed + mixed.T + scaled @ scaled.T


def _list_outputs(fit: FinalSpectra) -> tuple[str, ...]:
    return fit.form.model.experiment.model.outputs


def _factor_inverse(N: Float[np.ndarray, "n n"]) -> Float[np.ndarray, "n n"]:
    """Return T with T^T N T = 1."""
    size = np.sqrt(np.maximum(np.diag(N), np.finfo(float).tiny))
    scaled = N / np.outer(size, size)
    scaled[np.diag_indices_from(scaled)] += _RIDGE
    factor = linalg.cholesky(scaled, lower=True)
    return linalg.solve_triangular(factor, np.eye(len(N)), lower=True).T / size[:, None]
