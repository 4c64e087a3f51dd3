"""Covariance of a likelihood estimate: for white residuals, and for those there are."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from flexsid.sysid.estimation import noise
from flexsid.sysid.estimation.experiment import Experiment, LineModel, Sensitivity

_WEAKEST = 1e-13  # of the strongest direction of the scaled information


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


def covariance(
    models: Sequence[LineModel],
    theta: Float[np.ndarray, " n_theta"],
    weights: Sequence[np.ndarray],
    information: Float[np.ndarray, "n_theta n_theta"],
    prior_information: Float[np.ndarray, " n_theta"],
    inflation: float,
) -> Covariance:
    """Invert the information, and weigh it against how residuals really scatter.

    Parameters
    ----------
    models
        Of every maneuver.
    theta
        The estimate.
    weights
        Inverse density of every maneuver's lines, corrected for the parameters fitted.
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
    outputs, where the plain form is too small by half.
    """
    scale = np.sqrt(np.maximum(np.diag(information), np.finfo(float).tiny))
    outer = np.outer(scale, scale)
    values, vectors = np.linalg.eigh(information / outer)
    lacking = values < _WEAKEST * values[-1]
    floored = np.maximum(values, _WEAKEST * values[-1])
    inverse = (vectors / floored) @ vectors.T / outer
    middle = np.diag(prior_information)
    for model, W in zip(models, weights, strict=True):
        middle = middle + inflation * _score_covariance(model, theta, W)
    corrected = 0.5 * inverse @ middle @ inverse
    return Covariance(0.5 * _symmetric(inverse), _symmetric(corrected), vectors[:, lacking])


def _score_covariance(
    model: LineModel, theta: Float[np.ndarray, " n_theta"], weights: np.ndarray
) -> Float[np.ndarray, "n_theta n_theta"]:
    """Twice the covariance of Re sum J^H W nu for the residuals as they are."""
    experiment = model.experiment
    response = model.respond(theta)
    sensitivity = model.sensitivity(theta, response)
    if experiment.source is not None and experiment.gain is not None:
        return _shared(model, sensitivity, weights, experiment.source, experiment.gain, theta)
    nu = experiment.measured - response.outputs
    S = _density(experiment, nu)
    if weights.ndim == 2:
        middle = weights[:, :, None] * S * weights[:, None, :]
    else:
        middle = weights @ S @ weights
    return model.normal_equations(sensitivity, nu, middle)[0]


def _shared(
    model: LineModel,
    sensitivity: Sensitivity,
    weights: np.ndarray,
    source: Experiment,
    gain: np.ndarray,
    theta: Float[np.ndarray, " n_theta"],
) -> Float[np.ndarray, "n_theta n_theta"]:
    """The same where lines share the noise of source lines."""
    J = model.jacobian(sensitivity)
    weighted = weights[:, :, None] * J if weights.ndim == 2 else weights @ J
    n_y, n_theta = J.shape[1:]
    A = (gain.conj().T @ weighted.reshape(J.shape[0], -1)).reshape(-1, n_y, n_theta)
    nu = source.measured - LineModel(source, model.parameters).respond(theta).outputs
    S = _density(source, nu)
    return np.real(A.reshape(-1, n_theta).conj().T @ (S @ A).reshape(-1, n_theta))


def _density(experiment: Experiment, residuals: np.ndarray) -> np.ndarray:
    return noise.smoothed_density(residuals, experiment.group, len(experiment.group_names))


def _symmetric(matrix: np.ndarray) -> np.ndarray:
    return 0.5 * (matrix + matrix.T)
