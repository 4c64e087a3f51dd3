"""Fits of one linear model at several amplitudes of an excitation, with the same weights.

Of a linear aircraft spectra over amplitude differ by noise alone. Fitted with the same weights and
priors they give the same estimates but for the noise, also by a model that lacks modes: its bias is
the same at every amplitude. Estimates with weights of their own do not have this property.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Complex, Float

from flexsid.errors import BadInput, NotIdentifiable
from flexsid.sysid.estimation.covariance import FinalSpectra, compute_bound, score_covariance
from flexsid.sysid.estimation.experiment import Experiment, Parameters
from flexsid.sysid.estimation.frequency_domain_model import FrequencyDomainModel
from flexsid.sysid.estimation.kronecker import NormalForm
from flexsid.sysid.estimation.likelihood import build_prior
from flexsid.sysid.estimation.noise import SpectralMatrix

# --- Fits of all levels with the same weights and priors ------------------------------------------

_MOST_STEPS = 30  # of Gauss-Newton, from the optimum of other weights
_SMALL_STEP = 1e-3  # in standard errors
_SAME_FREQUENCY = 1e-6  # relative
_NEIGHBOURS = 4  # segments on either side in the density of the noise: a level has few degrees of
# freedom at one frequency


@dataclass(frozen=True, slots=True, eq=False)
class LevelData:
    """Output error of one maneuver, the values of its own fit, and the amplitude of its excitation.

    ``parameters`` start at these values; those that are not free may differ between levels.
    """

    experiment: Experiment
    parameters: Parameters
    amplitude: float


@dataclass(frozen=True, slots=True, eq=False)
class LevelFit:
    """Values and covariance due to noise of one level."""

    values: Float[np.ndarray, " n_theta"]
    covariance: Float[np.ndarray, "n_theta n_theta"]


@dataclass(frozen=True, slots=True)
class _Level:
    """Spectra over amplitude, with the values that fit them."""

    form: NormalForm
    theta: Float[np.ndarray, " n_theta"]

    def compute_residuals(self) -> Complex[np.ndarray, "n_omega n_y"]:
        """Compute the residuals at the values."""
        model = self.form.model
        return model.experiment.measured - model.respond(self.theta).outputs


def fit_levels(
    data: Sequence[LevelData], priors: Mapping[str, tuple[float, float]]
) -> tuple[LevelFit, ...]:
    """Fit the same linear model to every level, with the same weights and priors.

    Parameters
    ----------
    data
        Of the same frequencies, inputs, outputs and free parameters.
    priors
        Mean and standard deviation by parameter, the same for all.

    Raises
    ------
    BadInput
        If frequencies, inputs, outputs or free parameters differ.
    NotIdentifiable
        If the data do not determine the parameters with the common weights.

    Notes
    -----
    Spectra Z/a and U/a of a linear aircraft, with the amplitude a, are the same at all levels but
    for noise, and so are the estimates that solve Re sum J^H W nu + P (mean - theta) = 0 with the
    same W and P, whatever the model lacks. W is the inverse of the mean power of the residuals of
    all levels, by output. The covariance is the sandwich 1/2 N^-1 [Re sum J^H W S W J] N^-1 of the
    noise S/a^2, estimated from residuals less their mean over levels, weighted by a^2, to which a
    model error does not contribute.
    Source: Pintelon and Schoukens (2012), System Identification, 2nd ed., ch. 4,
    doi:10.1002/9781118287422.
    """
    _check_alike(data)
    amplitudes = np.array([one.amplitude for one in data])
    levels = [
        _Level(
            NormalForm(
                FrequencyDomainModel(_scale(one.experiment, 1.0 / one.amplitude), one.parameters)
            ),
            one.parameters.start,
        )
        for one in data
    ]
    power = np.mean([np.abs(one.compute_residuals()) ** 2 for one in levels], axis=(0, 1))
    weights = SpectralMatrix(
        (1.0 / power)[None], np.zeros(data[0].experiment.omega.size, dtype=int)
    )
    mean, prior = build_prior(data[0].parameters, priors)
    levels = [_maximize(one, weights, mean, prior) for one in levels]
    residuals = [one.compute_residuals() for one in levels]
    shares = amplitudes**2 / np.sum(amplitudes**2)
    common = sum(share * one for share, one in zip(shares.tolist(), residuals, strict=True))
    return tuple(
        LevelFit(one.theta, _estimate_covariance(one, weights, prior, (own - common) / left**0.5))
        for one, own, left in zip(levels, residuals, (1.0 - shares).tolist(), strict=True)
    )


def _check_alike(data: Sequence[LevelData]) -> None:
    first = data[0].experiment
    channels = [(*one.experiment.model.inputs, *one.experiment.model.outputs) for one in data]
    if any(own != channels[0] for own in channels):
        common = set(channels[0]).intersection(*channels)
        others = sorted(set().union(*channels) - common)
        raise BadInput(
            "levels are compared by the same inputs and outputs; not all of these runs have "
            f"{', '.join(others) or 'them in one order'}: estimate all maneuvers with one model "
            "structure that names inputs and outputs",
            code="different-channels",
        )
    if any(one.parameters.names != data[0].parameters.names for one in data):
        raise BadInput(
            "levels are compared by the same free parameters; these runs have others: estimate "
            "all maneuvers with one model structure",
            code="different-structures",
        )
    for other in (one.experiment for one in data[1:]):
        same = first.omega.shape == other.omega.shape
        if not same or np.any(np.abs(first.omega - other.omega) > _SAME_FREQUENCY * first.omega):
            raise BadInput(
                "levels are compared at the same frequencies; these runs have others: select "
                "maneuvers with the same multisine, and runs with the same band",
                code="different-frequencies",
            )


def _scale(experiment: Experiment, factor: float) -> Experiment:
    return replace(
        experiment,
        inputs=factor * experiment.inputs,
        measured=factor * experiment.measured,
    )


def _maximize(
    level: _Level,
    weights: SpectralMatrix,
    mean: Float[np.ndarray, " n_theta"],
    prior: Float[np.ndarray, "n_theta n_theta"],
) -> _Level:
    """Take Gauss-Newton steps with weights that are held."""
    for _ in range(_MOST_STEPS):
        N, g = _expand(level, weights, prior)
        covariance = compute_bound(N)
        step = 2.0 * covariance @ (g + prior @ (mean - level.theta))
        errors = np.sqrt(np.diag(covariance))
        if not (np.isfinite(step).all() and (errors > 0.0).all()):
            break
        level = replace(level, theta=level.theta + step)
        if np.max(np.abs(step) / errors) < _SMALL_STEP:
            return level
    raise NotIdentifiable(
        "a fit with the common weights of all levels does not converge: some parameters are not "
        "identifiable; hold them, or free fewer modes"
    )


def _expand(
    level: _Level, weights: SpectralMatrix, prior: Float[np.ndarray, "n_theta n_theta"]
) -> tuple[Float[np.ndarray, "n_theta n_theta"], Float[np.ndarray, " n_theta"]]:
    model = level.form.model
    response = model.respond(level.theta)
    residuals = model.experiment.measured - response.outputs
    N, g = level.form.equations(model.sensitivity(level.theta, response), residuals, weights)
    return N + prior, g


def _estimate_covariance(
    level: _Level,
    weights: SpectralMatrix,
    prior: Float[np.ndarray, "n_theta n_theta"],
    noise: Complex[np.ndarray, "n_omega n_y"],
) -> Float[np.ndarray, "n_theta n_theta"]:
    """Estimate the covariance due to noise: priors have the same error at all levels."""
    model = level.form.model
    sensitivity = model.sensitivity(level.theta, model.respond(level.theta))
    inverse = 2.0 * compute_bound(_expand(level, weights, prior)[0])
    final = FinalSpectra(level.form, sensitivity, noise, weights, neighbours=_NEIGHBOURS)
    middle = score_covariance(final.with_leave_one_out_residuals(inverse))
    return 0.5 * inverse @ middle @ inverse
