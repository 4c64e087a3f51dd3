"""Free motion: the response to the states at the ends of a record, subtracted from its spectra.

What remains is the response to the inputs alone, as of a maneuver that begins and ends at rest:
equation error and tests of the model, which have no end states of their own, apply to it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Complex, Float

from flexsid.sysid.estimation.end_states import add_end_states, list_end_state_names
from flexsid.sysid.estimation.estimate import Estimate, standard_errors
from flexsid.sysid.estimation.experiment import Experiment
from flexsid.sysid.estimation.frequency_domain_model import FrequencyDomainModel
from flexsid.sysid.estimation.likelihood import FitSettings, maximize
from flexsid.sysid.estimation.parameters import Parameters
from flexsid.sysid.estimation.real_products import sum_products

_LEAST_SHARE = 1e-12  # of the largest variance of an independent error of a fit
_LEAST_ERROR = 0.2  # of free motion, over the noise of all data: smaller ones are left out


@dataclass(frozen=True, slots=True)
class FreeMotionFit:
    """Free motion of several records by output error.

    ``outputs`` are those of each record; ``errors`` their changes by one standard deviation of
    each independent error of the fit, record by record. ``noise`` are these errors by the
    frequencies of all records, orthonormal. ``converged`` is whether the fit has, with errors.
    """

    outputs: tuple[Complex[np.ndarray, "n_omega n_y"], ...]
    errors: tuple[tuple[Complex[np.ndarray, "n_omega n_y"], ...], ...]
    noise: Float[np.ndarray, "n_errors n_all"]
    converged: bool


def fit_free_motion(
    experiments: Sequence[Experiment], parameters: Parameters, settings: FitSettings
) -> FreeMotionFit:
    """Fit the states at the ends of records together with the derivatives.

    Parameters
    ----------
    experiments
        Output error with the times of the ends, numbered by ``number_ends``.
    parameters
        Derivatives with their starting values.
    settings
        Of the maximisation of the likelihood.

    Returns
    -------
    FreeMotionFit
        The free motion. Errors of derivatives change it as those of the states do.
    """
    whole = add_end_states(parameters, experiments)
    found = maximize(experiments, whole, settings)
    directions, noise = _find_independent_errors(found)
    outputs, changes, relative = [], [], []
    for one, fitted in zip(experiments, found.lines, strict=True):
        free, sensitivity = _expand_free_motion(FrequencyDomainModel(one, whole), found.values)
        outputs.append(free)
        changes.append(sensitivity @ directions)
        power = np.mean(np.abs(fitted.measured - fitted.fitted) ** 2, axis=0)
        relative.append((changes[-1] / np.sqrt(power)[:, None]).reshape(-1, len(noise)))
    flat = np.concatenate(relative)
    size, axes = np.linalg.eigh(sum_products(flat, flat))
    axes = axes[:, size > _LEAST_ERROR**2]
    return FreeMotionFit(
        tuple(outputs),
        tuple(tuple(np.moveaxis(change @ axes, 2, 0)) for change in changes),
        axes.T @ noise,
        found.outcome.is_optimum and len(noise) > 0,
    )


def subtract_free_motion(
    experiment: Experiment, parameters: Parameters, theta: Float[np.ndarray, " n_theta"]
) -> Experiment:
    """Subtract the free motion from the end states among the parameters."""
    model = FrequencyDomainModel(experiment, parameters)
    moved = model.respond(theta).outputs - model.respond(_come_to_rest(parameters, theta)).outputs
    return replace(experiment, measured=experiment.measured - moved, edges_s=())


def add_errors(
    estimate: Estimate,
    changes: Float[np.ndarray, "n_errors n_theta"],
    noise: Float[np.ndarray, "n_errors n_all"],
    records: Sequence[int],
) -> Estimate:
    """Add the errors of the free motion to those of an estimate from what remains.

    Parameters
    ----------
    estimate
        From spectra without the free motion.
    changes
        Of the values, by each error of ``FreeMotionFit``.
    noise
        As of ``FreeMotionFit``: the same noise is part of the errors of the estimate.
    records
        Positions of its records among those of the estimate.
    """
    total = estimate.corrected_covariance + changes.T @ changes
    if estimate.components is None or not changes.size:
        return replace(estimate, corrected_covariance=total)
    own = np.concatenate([estimate.components.noise[k] for k in records], axis=1)
    variance = np.diag(total)
    shared = 2.0 * np.sum(own * (changes.T @ noise), axis=1)
    growth = np.sqrt(np.maximum(1.0 + shared / variance, 0.0))
    return replace(estimate, corrected_covariance=total * np.outer(growth, growth))


def _expand_free_motion(
    model: FrequencyDomainModel, theta: Float[np.ndarray, " n_theta"]
) -> tuple[Complex[np.ndarray, "n_omega n_y"], Complex[np.ndarray, "n_omega n_y n_theta"]]:
    """Compute the free motion and its sensitivity to all parameters."""
    at_rest = _come_to_rest(model.parameters, theta)
    moving, resting = model.respond(theta), model.respond(at_rest)
    sensitivity = model.jacobian(model.sensitivity(theta, moving))
    of_inputs = model.jacobian(model.sensitivity(at_rest, resting))
    last = len(theta) - len(list_end_state_names(model.parameters))
    sensitivity[:, :, :last] -= of_inputs[:, :, :last]
    return moving.outputs - resting.outputs, sensitivity


def _come_to_rest(
    parameters: Parameters, theta: Float[np.ndarray, " n_theta"]
) -> Float[np.ndarray, " n_theta"]:
    """Return the parameters with end states of zero."""
    at_rest = theta.copy()
    at_rest[len(theta) - len(list_end_state_names(parameters)) :] = 0.0
    return at_rest


def _find_independent_errors(
    estimate: Estimate,
) -> tuple[Float[np.ndarray, "n_theta n_errors"], Float[np.ndarray, "n_errors n_all"]]:
    """Find the independent errors of an estimate, and each by the frequencies of all records."""
    covariance, components = estimate.corrected_covariance, estimate.components
    if components is None or not np.isfinite(standard_errors(covariance)).all():
        return np.zeros((len(estimate.names), 0)), np.zeros((0, 0))
    size = standard_errors(covariance)
    values, axes = np.linalg.eigh(covariance / np.outer(size, size))
    resolved = values > _LEAST_SHARE * values[-1]
    axes, root = axes[:, resolved], np.sqrt(values[resolved])
    by_frequency = np.concatenate(components.noise, axis=1) / size[:, None]
    left, _, right = np.linalg.svd((axes / root).T @ by_frequency, full_matrices=False)
    return size[:, None] * axes * root, left @ right
