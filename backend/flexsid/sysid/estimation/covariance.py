"""Covariance of a likelihood estimate: for white residuals, and for those there are."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float
from scipy.linalg import lapack

from flexsid.sysid.estimation import noise
from flexsid.sysid.estimation.experiment import Experiment
from flexsid.sysid.estimation.kronecker import NormalForm
from flexsid.sysid.estimation.left_out import left_out
from flexsid.sysid.estimation.line_model import Sensitivity

_WEAKEST = 1e-13  # of the strongest direction of the scaled information
_PART = 1e-3  # least share of a parameter in a direction; rounding leaves less
_SAFE = 1e11  # condition number up to which no direction is weak


@dataclass(frozen=True, slots=True)
class Covariance:
    """``plain`` for white residuals independent between outputs, ``corrected`` in general.

    ``lacking`` holds, in columns, the directions in which the information is singular.
    """

    plain: Float[np.ndarray, "n_theta n_theta"]
    corrected: Float[np.ndarray, "n_theta n_theta"]
    lacking: Float[np.ndarray, "n_theta n_lacking"]

    def weak_directions(self, names: tuple[str, ...]) -> list[str]:
        """The parameters that each singular direction trades against each other."""
        words = []
        for direction in self.lacking.T:
            leading = np.argsort(-np.abs(direction))[:3]
            share = np.abs(direction[leading]) > 0.2
            words.append(" with ".join(names[i] for i in leading[share]))
        return words


@dataclass(frozen=True, slots=True)
class FinalLines:
    """The lines of one maneuver at the estimate."""

    form: NormalForm
    sensitivity: Sensitivity
    residuals: np.ndarray
    weights: noise.LineMatrix

    @property
    def shares_noise(self) -> bool:
        """Whether lines were computed from others."""
        return self.form.model.experiment.source is not None

    def left_out(self, inverse: Float[np.ndarray, "n_theta n_theta"]) -> FinalLines:
        """The same with what residuals would be if their line had taken no part."""
        residuals = left_out(
            self.form.model, self.sensitivity, self.residuals, self.weights, inverse
        )
        return replace(self, residuals=residuals)


def covariance(
    lines: Sequence[FinalLines],
    information: Float[np.ndarray, "n_theta n_theta"],
    prior_information: Float[np.ndarray, " n_theta"],
    inflation: float,
) -> Covariance:
    """Invert the information, and weigh it against how residuals really scatter.

    Parameters
    ----------
    lines
        Of every maneuver, weighted with the density corrected for the parameters fitted.
    information
        Normal matrix with these weights, priors included.
    prior_information
        Share of the priors on its diagonal.
    inflation
        What fitting took off the residuals' variance: data over data less parameters.

    Notes
    -----
    For circular residuals Cov = 1/2 N^-1. The corrected form is the sandwich
    1/2 N^-1 [Re sum J^H W S W J] N^-1 with S from neighbouring residuals: it stays right
    for coloured residuals and for those that noise on the inputs makes alike on all
    outputs, where the plain form is too small by half. Each line's residuals are those
    against the fit to the other lines. Where the information is singular residuals tell
    nothing: there the floor of the information is the only bound.
    """
    own = np.diag(information)
    scale = np.sqrt(np.where(own > np.finfo(float).tiny, own, 1.0))
    outer = np.outer(scale, scale)
    known, unknown, lacking = _invert(information / outer)
    known, unknown = known / outer, unknown / outer
    middle = np.diag(prior_information)
    for final in lines:
        if final.shares_noise:
            middle = middle + inflation * score_covariance(final)
        else:
            middle = middle + score_covariance(final.left_out(known))
    plain = 0.5 * (known + unknown)
    corrected = 0.5 * (known @ middle @ known + unknown)
    return Covariance(_symmetric(plain), _symmetric(corrected), lacking)


def _invert(
    scaled: Float[np.ndarray, "n_theta n_theta"],
) -> tuple[
    Float[np.ndarray, "n_theta n_theta"],
    Float[np.ndarray, "n_theta n_theta"],
    Float[np.ndarray, "n_theta n_lacking"],
]:
    """Inverse of an information matrix of unit diagonal: what is told, and what it lacks.

    The second part is the inverse in the directions, given third, where the information is
    below its floor.
    """
    factor, info = lapack.dpotrf(scaled, lower=False)
    if info == 0:
        upper = lapack.dpotri(factor, lower=False, overwrite_c=True)[0]
        inverse = upper + upper.T  # below the diagonal LAPACK leaves the zeros that it found
        np.fill_diagonal(inverse, np.diag(upper))
        if np.abs(scaled).sum(axis=0).max() * np.abs(inverse).sum(axis=0).max() < _SAFE:
            return inverse, np.zeros_like(inverse), np.empty((scaled.shape[0], 0))
    values, vectors = np.linalg.eigh(scaled)
    floor = _WEAKEST * max(values[-1], 1.0)
    lacks = values < floor
    told, lacking = vectors[:, ~lacks], vectors[:, lacks]
    lost = np.where(np.abs(lacking) < _PART, 0.0, lacking)
    return (told / values[~lacks]) @ told.T, lost @ lost.T / floor, lacking


def score_covariance(final: FinalLines) -> Float[np.ndarray, "n_theta n_theta"]:
    """Twice the covariance of Re sum J^H W nu for the residuals as they are."""
    experiment = final.form.model.experiment
    if experiment.source is not None and experiment.gain is not None:
        return _shared(final, experiment.source, experiment.gain)
    middle = _density(experiment, final.residuals).between(final.weights)
    return final.form.matrix(final.sensitivity, middle)


def _shared(
    final: FinalLines, source: Experiment, gain: np.ndarray
) -> Float[np.ndarray, "n_theta n_theta"]:
    """The same where lines share the noise of source lines.

    Notes
    -----
    A residual of a response, times the deflection of its input at the same line, is what
    the outputs there depart from the model when the motion due to all other inputs has
    been taken off. Source lines of inputs that the model does not have take the density
    of the lines about them.
    """
    experiment = final.form.model.experiment
    weighted = final.weights.times(final.form.model.jacobian(final.sensitivity))
    n_y, n_theta = weighted.shape[1:]
    A = (gain.conj().T @ weighted.reshape(weighted.shape[0], -1)).reshape(-1, n_y, n_theta)
    order = np.argsort(experiment.omega, kind="stable")
    omega = experiment.omega[order]
    deflections = source.inputs[np.searchsorted(source.omega, omega)]
    own = np.sum(experiment.inputs[order] * deflections, axis=1, keepdims=True)
    found = noise.smoothed_density(final.residuals[order] * own, np.zeros(omega.size, int), 1)
    nearest = np.searchsorted(0.5 * (omega[1:] + omega[:-1]), source.omega)
    S = noise.LineMatrix(found.blocks, found.block[nearest])
    return np.real(A.reshape(-1, n_theta).conj().T @ S.times(A).reshape(-1, n_theta))


def _density(experiment: Experiment, residuals: np.ndarray) -> noise.LineMatrix:
    return noise.smoothed_density(residuals, experiment.group, len(experiment.group_names))


def _symmetric(matrix: np.ndarray) -> np.ndarray:
    return 0.5 * (matrix + matrix.T)
