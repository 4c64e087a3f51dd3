"""Covariance of a likelihood estimate, for white residuals and for the observed ones."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Complex, Float
from scipy.linalg import lapack

from flexsid.sysid.estimation import noise
from flexsid.sysid.estimation.error_components import scale_rows
from flexsid.sysid.estimation.frequency_domain_model import Sensitivity
from flexsid.sysid.estimation.kronecker import NormalForm
from flexsid.sysid.estimation.leave_one_out import compute_leave_one_out_residuals
from flexsid.sysid.estimation.real_products import sum_products

_WEAKEST = 1e-13  # of the largest eigenvalue of the scaled information: singular below
_PART = 1e-3  # least component of a parameter in a direction; smaller ones are rounding
_NAMED = 0.2  # least component of a parameter in a singular direction that is reported
_SAFE = 1e11  # condition number below which the information has no singular direction


@dataclass(frozen=True, slots=True)
class Covariance:
    """``plain`` for white residuals independent between outputs, ``corrected`` in general.

    The columns of ``lacking`` are the directions in which the information is singular.
    ``noise_components`` are the parts of every parameter's standard deviation due to the noise at
    each frequency of each maneuver; ``prior_components`` those due to the parameters with a prior.
    """

    plain: Float[np.ndarray, "n_theta n_theta"]
    corrected: Float[np.ndarray, "n_theta n_theta"]
    lacking: Float[np.ndarray, "n_theta n_lacking"]
    noise_components: tuple[Float[np.ndarray, "n_theta n_omega"], ...]
    prior_components: Float[np.ndarray, "n_theta n_prior"]

    def weak_directions(self, names: tuple[str, ...]) -> list[str]:
        """List the parameters that are not separately identifiable, by singular direction."""
        words = []
        for direction in self.lacking.T:
            leading = np.argsort(-np.abs(direction))[:3]
            share = np.abs(direction[leading]) > _NAMED
            words.append(" with ".join(names[i] for i in leading[share]))
        return words


@dataclass(frozen=True, slots=True)
class FinalSpectra:
    """Sensitivities, residuals and weights of one maneuver at the estimate.

    ``neighbours`` is the number of segments on either side in the density of the residuals;
    ``noise`` the residuals of the source data points, None: from those of this maneuver.
    ``source`` are the residuals of the source data points, whatever the density is from.
    """

    form: NormalForm
    sensitivity: Sensitivity
    residuals: np.ndarray
    weights: noise.SpectralMatrix
    neighbours: int = 2
    noise: np.ndarray | None = None
    source: np.ndarray | None = None

    @property
    def shares_noise(self) -> bool:
        """Whether these data points were computed from other ones."""
        return self.form.model.experiment.source is not None

    def with_leave_one_out_residuals(
        self, inverse: Float[np.ndarray, "n_theta n_theta"]
    ) -> FinalSpectra:
        """Return the same with leave-one-out residuals."""
        residuals = compute_leave_one_out_residuals(
            self.form.model, self.sensitivity, self.residuals, self.weights, inverse
        )
        return replace(self, residuals=residuals)


def compute_covariance(
    lines: Sequence[FinalSpectra],
    information: Float[np.ndarray, "n_theta n_theta"],
    prior_information: Float[np.ndarray, " n_theta"],
    inflation: float,
) -> Covariance:
    """Compute the Cramer-Rao covariance and the one corrected for coloured residuals.

    Parameters
    ----------
    lines
        Data of every maneuver; weights from the density corrected for fitted parameters.
    information
        Normal matrix N = Re sum J^H W J with these weights, priors included.
    prior_information
        Diagonal of the priors in N, 1/(2 sigma^2).
    inflation
        Correction of the residual variance for the fit: n_data / (n_data - n_theta).

    Notes
    -----
    The cost of ``noise.compute_residual_density`` has the expected curvature 2 N, so that
    Cov = (2 N)^-1 = 1/2 N^-1 for circular residuals. The corrected form is the sandwich
    1/2 N^-1 [Re sum J^H W S W J] N^-1 with S from neighbouring residuals. It also holds for
    coloured residuals and for noise on the inputs, which is correlated between outputs; the
    plain form is then half too small. Residuals are leave-one-out residuals. Along singular
    directions of the information its floor is the only bound. The components of the noise are
    N^-1 Re J_k^H W nu_k of every frequency, in the proportion of their squares; those of the
    priors N^-1 P sigma.
    """
    resolved, unresolved, lacking = _invert(information)
    middle = np.diag(prior_information)
    noise_components = []
    for final in lines:
        alone = final
        if final.shares_noise:
            middle = middle + inflation * score_covariance(final)
        else:
            alone = final.with_leave_one_out_residuals(resolved)
            middle = middle + score_covariance(alone)
        noise_components.append(resolved @ compute_scores(alone))
    plain = 0.5 * (resolved + unresolved)
    corrected = 0.5 * (resolved @ middle @ resolved + unresolved)
    held = np.flatnonzero(prior_information)
    prior_components = resolved[:, held] * np.sqrt(0.5 * prior_information[held])
    return Covariance(
        _symmetric(plain),
        _symmetric(corrected),
        lacking,
        _scale_components(noise_components, corrected, prior_components),
        prior_components,
    )


def compute_bound(
    information: Float[np.ndarray, "n_theta n_theta"],
) -> Float[np.ndarray, "n_theta n_theta"]:
    """Compute the Cramer-Rao covariance alone, 1/2 N^-1, as ``compute_covariance`` does."""
    resolved, unresolved, _ = _invert(information)
    return _symmetric(0.5 * (resolved + unresolved))


def _scale_components(
    found: Sequence[Float[np.ndarray, "n_theta n_omega"]],
    covariance: Float[np.ndarray, "n_theta n_theta"],
    prior: Float[np.ndarray, "n_theta n_prior"],
) -> tuple[Float[np.ndarray, "n_theta n_omega"], ...]:
    """Scale the components of the noise so that all have the variances of the covariance."""
    if not found:
        return ()
    ends = np.cumsum([one.shape[1] for one in found])[:-1]
    of_noise = np.diag(covariance) - np.sum(prior**2, axis=1)
    return tuple(np.split(scale_rows(np.concatenate(found, axis=1), of_noise), ends, axis=1))


def compute_scores(final: FinalSpectra) -> Float[np.ndarray, "n_theta n_omega"]:
    """Compute Re J^H W nu of every frequency of the record.

    Of data points that share the noise of source data points by the frequency of these; zero
    where the residuals of the source are not known.
    """
    if not final.shares_noise:
        return final.form.scores(final.sensitivity, final.residuals, final.weights)
    gain = final.form.model.experiment.gain
    if final.source is None or gain is None:
        return np.zeros((final.form.model.order.size, 0))
    return final.form.source_scores(final.sensitivity, final.source, final.weights, gain)


def invert_regular(
    scaled: Float[np.ndarray, "n_theta n_theta"],
) -> Float[np.ndarray, "n_theta n_theta"] | None:
    """Invert an information matrix of unit diagonal; None where it may be singular."""
    factor, info = lapack.dpotrf(scaled, lower=False)
    if info != 0:
        return None
    upper = lapack.dpotri(factor, lower=False, overwrite_c=True)[0]
    inverse = upper + upper.T  # LAPACK leaves the zeros below the diagonal
    np.fill_diagonal(inverse, np.diag(upper))
    condition = np.abs(scaled).sum(axis=0).max() * np.abs(inverse).sum(axis=0).max()
    return inverse if condition < _SAFE else None


def _invert(
    information: Float[np.ndarray, "n_theta n_theta"],
) -> tuple[
    Float[np.ndarray, "n_theta n_theta"],
    Float[np.ndarray, "n_theta n_theta"],
    Float[np.ndarray, "n_theta n_lacking"],
]:
    """Invert an information matrix in its resolved and singular directions.

    The second part is the inverse along the directions, returned third in parameters scaled to a
    unit diagonal, in which the information is below its floor.
    """
    own = np.diag(information)
    scale = np.sqrt(np.where(own > np.finfo(float).tiny, own, 1.0))
    outer = np.outer(scale, scale)
    scaled = information / outer
    inverse = invert_regular(scaled)
    if inverse is not None:
        return inverse / outer, np.zeros_like(inverse), np.empty((own.size, 0))
    values, vectors = np.linalg.eigh(scaled)
    floor = _WEAKEST * max(values[-1], 1.0)
    lacks = values < floor
    resolved, lacking = vectors[:, ~lacks], vectors[:, lacks]
    cleaned = np.where(np.abs(lacking) < _PART, 0.0, lacking)
    whole = (resolved / values[~lacks]) @ resolved.T
    return whole / outer, cleaned @ cleaned.T / floor / outer, lacking


def score_covariance(final: FinalSpectra) -> Float[np.ndarray, "n_theta n_theta"]:
    """Compute Re sum J^H W S W J, twice the covariance of Re sum J^H W nu, for any residuals."""
    experiment = final.form.model.experiment
    if experiment.source is not None and experiment.gain is not None:
        weighted = final.weights.times(final.form.model.jacobian(final.sensitivity))
        A, S = weight_score_noise(final, weighted)
        return sum_products(A, S.times(A))
    middle = estimate_noise(final).between(final.weights)
    return final.form.matrix(final.sensitivity, middle)


def weight_score_noise(
    final: FinalSpectra, weighted: Complex[np.ndarray, "n_omega n_y n_c"]
) -> tuple[Complex[np.ndarray, "n_source n_y n_c"], noise.SpectralMatrix]:
    """Return A and S, for which Re sum X^H nu has the covariance 1/2 Re sum A^H S A.

    Parameters
    ----------
    final
        Residuals nu, of which S is estimated.
    weighted
        X, sensitivities times weights.

    Notes
    -----
    A is X, unless data points share the noise of source data points.
    The residual of a frequency response times the deflection of its input at the same
    frequency is the residual of the outputs after subtraction of the response to all other
    inputs. Source frequencies of inputs that are not in the model take the density of
    neighbouring frequencies.
    """
    experiment = final.form.model.experiment
    source, gain = experiment.source, experiment.gain
    if source is None or gain is None:
        return weighted, estimate_noise(final)
    n_y, n_c = weighted.shape[1:]
    A = (gain.conj().T @ weighted.reshape(weighted.shape[0], -1)).reshape(-1, n_y, n_c)
    if final.noise is not None:
        one_group = np.zeros(len(final.noise), dtype=int)
        return A, noise.smooth_density(final.noise, one_group, 1, final.neighbours)
    order = np.argsort(experiment.omega, kind="stable")
    omega = experiment.omega[order]
    deflections = source.inputs[np.searchsorted(source.omega, omega)]
    own = np.sum(experiment.inputs[order] * deflections, axis=1, keepdims=True)
    found = noise.smooth_density(final.residuals[order] * own, np.zeros(omega.size, int), 1)
    nearest = np.searchsorted(0.5 * (omega[1:] + omega[:-1]), source.omega)
    return A, noise.SpectralMatrix(found.blocks, found.block[nearest])


def estimate_noise(final: FinalSpectra) -> noise.SpectralMatrix:
    """Estimate the noise covariance of the data points from neighbouring residuals."""
    experiment = final.form.model.experiment
    n_groups = len(experiment.group_names)
    return noise.smooth_density(final.residuals, experiment.group, n_groups, final.neighbours)


def _symmetric(matrix: np.ndarray) -> np.ndarray:
    return 0.5 * (matrix + matrix.T)
