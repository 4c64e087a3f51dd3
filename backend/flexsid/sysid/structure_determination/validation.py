"""Cross-validation: prediction of data that a model was not fitted to."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool

from flexsid.errors import NotIdentifiable
from flexsid.sysid.estimation import noise
from flexsid.sysid.estimation.estimate import Estimate
from flexsid.sysid.estimation.experiment import Experiment
from flexsid.sysid.estimation.frequency_domain_model import FrequencyDomainModel
from flexsid.sysid.estimation.leakage import fit_with_leakage_correction, remove_leakage
from flexsid.sysid.estimation.likelihood import FitSettings, Report
from flexsid.sysid.estimation.parameters import Parameters
from flexsid.sysid.stability.derivative_fusion import compute_weighted_mean
from flexsid.sysid.structure_determination.candidates import expand_values, select_candidates
from flexsid.sysid.structure_determination.evidence import assign_combs


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


@dataclass(frozen=True, slots=True, eq=False)
class ValidationModel:
    """Data of a maneuver, and all parameters that a model of it can have."""

    experiment: Experiment
    candidates: Parameters


def validate_prediction(
    model: ValidationModel, values: Mapping[str, float], kind: str = "diagonal"
) -> ValidationResult:
    """Compute cost and R2 of values of parameters on the data of a maneuver."""
    experiment, candidates = model.experiment, model.candidates
    theta = expand_values(candidates, values)
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
    maneuvers: Sequence[ValidationModel],
    estimates: Sequence[Estimate],
    others: Sequence[ValidationModel] = (),
    settings: FitSettings | None = None,
    report: Report | None = None,
) -> tuple[ValidationResult, ...]:
    """Predict data that a model was not fitted to.

    ``others`` are validation maneuvers: other aids, other conditions. Without any, each
    maneuver is predicted by the values of the rest; a single one is fitted and predicted half
    by half, with the priors of ``settings``, reported as by ``maximize``. Candidates without
    estimate are not in the model.

    Notes
    -----
    Values of several maneuvers are weighted by their information, and derivatives are
    taken as the same at the condition predicted.
    """
    settings = settings or FitSettings()
    if others:
        mean = _pool_estimates(estimates)
        return tuple(validate_prediction(one, mean, settings.noise) for one in others)
    if len(maneuvers) == 1:
        return _validate_halves(maneuvers[0], estimates[0], settings, report)
    found = []
    for index, model in enumerate(maneuvers):
        mean = _pool_estimates([*estimates[:index], *estimates[index + 1 :]])
        found.append(validate_prediction(model, mean, settings.noise))
    return tuple(found)


def _validate_halves(
    model: ValidationModel, estimate: Estimate, settings: FitSettings, report: Report | None
) -> tuple[ValidationResult, ...]:
    experiment, candidates = model.experiment, model.candidates
    values = dict(zip(estimate.names, estimate.values.tolist(), strict=True))
    inside = np.array([name in values for name in candidates.names])
    parameters = select_candidates(candidates, inside, expand_values(candidates, values))
    even = assign_combs(experiment.omega.size) % 2 == 0
    found = []
    for fitted, name in (
        (even, "second half of the frequencies"),
        (~even, "first half of the frequencies"),
    ):
        try:
            half = [select_frequencies(experiment, fitted)]
            own = fit_with_leakage_correction(half, parameters, settings, report)[1]
        except NotIdentifiable:
            found.append(ValidationResult(name, np.inf, -np.inf))
            continue
        elsewhere = replace(select_frequencies(experiment, ~fitted), name=name)
        refitted = dict(zip(own.names, own.values.tolist(), strict=True))
        held_out = replace(model, experiment=elsewhere)
        found.append(validate_prediction(held_out, refitted, settings.noise))
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


def _pool_estimates(estimates: Sequence[Estimate]) -> dict[str, float]:
    names = estimates[0].names
    own = np.stack([one.select(names).values for one in estimates])
    try:
        covariances = [one.select(names).corrected_covariance for one in estimates]
        mean = compute_weighted_mean(own, covariances)[0]
    except (NotIdentifiable, np.linalg.LinAlgError):
        mean = own.mean(axis=0)
    return dict(zip(names, mean.tolist(), strict=True))
