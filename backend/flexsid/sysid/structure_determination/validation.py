"""Cross-validation: prediction of data that a model was not fitted to."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool, Float

from flexsid.errors import NotIdentifiable
from flexsid.sysid.estimation import noise
from flexsid.sysid.estimation.estimate import Estimate
from flexsid.sysid.estimation.experiment import Experiment
from flexsid.sysid.estimation.frequency_domain_model import FrequencyDomainModel
from flexsid.sysid.estimation.leakage import fit_with_leakage_correction, remove_leakage
from flexsid.sysid.estimation.likelihood import FitSettings, Report
from flexsid.sysid.estimation.parameters import Parameters
from flexsid.sysid.stability.derivative_fusion import compute_weighted_mean
from flexsid.sysid.structure_determination.equation import assign_combs
from flexsid.sysid.structure_determination.likelihood import expand_values, select_candidates


@dataclass(frozen=True, slots=True)
class ValidationResult:
    """Prediction of data by a model that was not fitted to them.

    ``cost`` is their negative log likelihood, with the noise of the prediction errors;
    ``r_squared`` the share of the outputs' power that is predicted, outputs equally
    weighted.
    """

    name: str
    cost: float
    r_squared: float


def validate_prediction(
    experiment: Experiment,
    candidates: Parameters,
    theta: Float[np.ndarray, " n_theta"],
    kind: str = "diagonal",
) -> ValidationResult:
    """Compute cost and R2 of values of all candidates on the data of a maneuver."""
    response = FrequencyDomainModel(experiment, candidates).respond(theta)
    if np.isfinite(response.outputs).all():
        experiment = remove_leakage(experiment, candidates, theta)
    residuals = experiment.measured - response.outputs
    n_groups = len(experiment.group_names)
    powers = noise.compute_group_powers(experiment.measured, experiment.group, n_groups)
    if not np.isfinite(residuals).all():
        return ValidationResult(experiment.name, np.inf, -np.inf)
    _, cost = noise.compute_residual_density(residuals, powers, experiment.group, kind)
    error = np.sum(np.abs(residuals) ** 2, axis=0)
    power = np.sum(np.abs(experiment.measured) ** 2, axis=0)
    return ValidationResult(experiment.name, cost, float(np.mean(1.0 - error / power)))


def cross_validate(
    maneuvers: Sequence[Experiment],
    estimates: Sequence[Estimate],
    candidates: Parameters,
    others: Sequence[Experiment] = (),
    settings: FitSettings | None = None,
    report: Report | None = None,
) -> tuple[ValidationResult, ...]:
    """Predict data that a model was not fitted to.

    ``others`` are validation maneuvers: other aids, other conditions. Without any, each
    maneuver is predicted by the values of the rest; a single one is fitted and predicted half
    by half, reported as by ``maximize``. Candidates without estimate are not in the model.

    Notes
    -----
    Values of several maneuvers are weighted by their information, and derivatives are
    taken as the same at the condition predicted.
    """
    settings = settings or FitSettings()
    inside = np.array([name in estimates[0].names for name in candidates.names])
    values = [expand_values(inside, estimate.values) for estimate in estimates]
    if others:
        mean = _pool_estimates(estimates, values, range(len(estimates)), inside)
        return tuple(validate_prediction(one, candidates, mean, settings.noise) for one in others)
    if len(maneuvers) == 1:
        return _validate_halves(maneuvers[0], candidates, inside, values[0], settings, report)
    found = []
    for index, experiment in enumerate(maneuvers):
        rest = [k for k in range(len(maneuvers)) if k != index]
        mean = _pool_estimates(estimates, values, rest, inside)
        found.append(validate_prediction(experiment, candidates, mean, settings.noise))
    return tuple(found)


def _validate_halves(
    experiment: Experiment,
    candidates: Parameters,
    inside: Bool[np.ndarray, " n_theta"],
    theta: Float[np.ndarray, " n_theta"],
    settings: FitSettings,
    report: Report | None,
) -> tuple[ValidationResult, ...]:
    even = assign_combs(experiment.omega.size) % 2 == 0
    found = []
    for fitted, name in (
        (even, "second half of the frequencies"),
        (~even, "first half of the frequencies"),
    ):
        parameters = select_candidates(candidates, inside, theta)
        try:
            half = [select_frequencies(experiment, fitted)]
            estimate = fit_with_leakage_correction(half, parameters, settings, report)[1]
        except NotIdentifiable:
            found.append(ValidationResult(name, np.inf, -np.inf))
            continue
        elsewhere = replace(select_frequencies(experiment, ~fitted), name=name)
        values = expand_values(inside, estimate.values)
        found.append(validate_prediction(elsewhere, candidates, values, settings.noise))
    return tuple(found)


def select_frequencies(
    experiment: Experiment, selected: Bool[np.ndarray, " n_omega"]
) -> Experiment:
    """Select some frequencies of an experiment; their correlation with others is dropped."""
    group, numbers = np.unique(experiment.group[selected], return_inverse=True)
    return replace(
        experiment,
        instruments=experiment.instruments[selected],
        omega=experiment.omega[selected],
        inputs=experiment.inputs[selected],
        measured=experiment.measured[selected],
        group=numbers,
        group_names=tuple(experiment.group_names[k] for k in group),
        source=None,
        gain=None,
    )


def _pool_estimates(
    estimates: Sequence[Estimate],
    values: Sequence[np.ndarray],
    indices: Sequence[int],
    inside: Bool[np.ndarray, " n_theta"],
) -> Float[np.ndarray, " n_theta"]:
    theta = np.zeros(inside.size)
    own = np.stack([values[k][inside] for k in indices])
    try:
        theta[inside] = compute_weighted_mean(
            own, [estimates[k].corrected_covariance for k in indices]
        )[0]
    except (NotIdentifiable, np.linalg.LinAlgError):
        theta[inside] = own.mean(axis=0)
    return theta
