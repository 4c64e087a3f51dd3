"""Cross-validation: how well a model predicts lines that it was not fitted to."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool, Float

from flexsid.errors import NotIdentifiable
from flexsid.sysid.estimation import noise
from flexsid.sysid.estimation.estimate import Estimate
from flexsid.sysid.estimation.experiment import Experiment
from flexsid.sysid.estimation.likelihood import FitSettings, maximize
from flexsid.sysid.estimation.line_model import LineModel
from flexsid.sysid.estimation.parameters import Parameters
from flexsid.sysid.estimation.record_edges import settle_edges, without_edges
from flexsid.sysid.stability.prediction import weighted_mean
from flexsid.sysid.structure_determination.equation import comb_of_lines
from flexsid.sysid.structure_determination.likelihood import reduced


@dataclass(frozen=True, slots=True)
class Predicted:
    """Lines predicted by a model that did not see them.

    ``cost`` is their negative log likelihood, the noise taken from what the prediction
    leaves; ``r_squared`` the share of the outputs' power that is predicted, each output
    counting alike.
    """

    name: str
    cost: float
    r_squared: float


def predict_lines(
    experiment: Experiment,
    candidates: Parameters,
    theta: Float[np.ndarray, " n_theta"],
    kind: str = "diagonal",
) -> Predicted:
    """Judge values of all candidates on the lines of a maneuver."""
    response = LineModel(experiment, candidates).respond(theta)
    if np.isfinite(response.outputs).all():
        experiment = without_edges(experiment, candidates, theta)
    residuals = experiment.measured - response.outputs
    n_groups = len(experiment.group_names)
    powers = noise.group_powers(experiment.measured, experiment.group, n_groups)
    if not np.isfinite(residuals).all():
        return Predicted(experiment.name, np.inf, -np.inf)
    _, cost = noise.residual_density(residuals, powers, experiment.group, kind)
    error = np.sum(np.abs(residuals) ** 2, axis=0)
    power = np.sum(np.abs(experiment.measured) ** 2, axis=0)
    return Predicted(experiment.name, cost, float(np.mean(1.0 - error / power)))


def cross_validate(
    maneuvers: Sequence[Experiment],
    estimates: Sequence[Estimate],
    candidates: Parameters,
    others: Sequence[Experiment] = (),
    settings: FitSettings | None = None,
) -> tuple[Predicted, ...]:
    """Predict what a fitted model did not see.

    Parameters
    ----------
    maneuvers, estimates
        What the model was fitted to, and its values in each.
    candidates
        All terms; those without estimate are not in the model.
    others
        Maneuvers that were kept out: other aids, other conditions. Without any, each
        maneuver is predicted by the values of the rest; a single one is fitted and
        predicted half by half.
    settings
        Of the fits to halves.

    Notes
    -----
    Values of several maneuvers are weighed by their information, and derivatives are
    taken as the same at the condition predicted.
    """
    settings = settings or FitSettings()
    kept = np.array([name in estimates[0].names for name in candidates.names])
    values = [_spread(candidates, kept, estimate.values) for estimate in estimates]
    if others:
        mean = _pooled(estimates, values, range(len(estimates)), kept)
        return tuple(predict_lines(one, candidates, mean, settings.noise) for one in others)
    if len(maneuvers) == 1:
        return _half_by_half(maneuvers[0], candidates, kept, values[0], settings)
    found = []
    for left_out, experiment in enumerate(maneuvers):
        rest = [k for k in range(len(maneuvers)) if k != left_out]
        mean = _pooled(estimates, values, rest, kept)
        found.append(predict_lines(experiment, candidates, mean, settings.noise))
    return tuple(found)


def _half_by_half(
    experiment: Experiment,
    candidates: Parameters,
    kept: Bool[np.ndarray, " n_theta"],
    theta: Float[np.ndarray, " n_theta"],
    settings: FitSettings,
) -> tuple[Predicted, ...]:
    even = comb_of_lines(experiment.omega.size) % 2 == 0
    found = []
    for fitted, name in ((even, "second half of the lines"), (~even, "first half of the lines")):
        parameters = reduced(candidates, kept, theta)
        try:
            half = [lines_of(experiment, fitted)]
            estimate = maximize(half, parameters, settings)
            estimate = settle_edges(half, parameters, estimate, settings)[1]
        except NotIdentifiable:
            found.append(Predicted(name, np.inf, -np.inf))
            continue
        elsewhere = replace(lines_of(experiment, ~fitted), name=name)
        values = _spread(candidates, kept, estimate.values)
        found.append(predict_lines(elsewhere, candidates, values, settings.noise))
    return tuple(found)


def lines_of(experiment: Experiment, lines: Bool[np.ndarray, " n_omega"]) -> Experiment:
    """A part of the lines of an experiment; what they share with others is forgotten."""
    group, numbers = np.unique(experiment.group[lines], return_inverse=True)
    return replace(
        experiment,
        instruments=experiment.instruments[lines],
        omega=experiment.omega[lines],
        inputs=experiment.inputs[lines],
        measured=experiment.measured[lines],
        group=numbers,
        group_names=tuple(experiment.group_names[k] for k in group),
        source=None,
        gain=None,
    )


def _spread(
    candidates: Parameters, kept: Bool[np.ndarray, " n_theta"], values: np.ndarray
) -> Float[np.ndarray, " n_theta"]:
    """Values at their place among all candidates, zero elsewhere."""
    theta = np.zeros(len(candidates.names))
    theta[kept] = values
    return theta


def _pooled(
    estimates: Sequence[Estimate],
    values: Sequence[np.ndarray],
    chosen: Sequence[int],
    kept: Bool[np.ndarray, " n_theta"],
) -> Float[np.ndarray, " n_theta"]:
    theta = np.zeros(kept.size)
    own = np.stack([values[k][kept] for k in chosen])
    try:
        theta[kept] = weighted_mean(own, [estimates[k].corrected_covariance for k in chosen])[0]
    except (NotIdentifiable, np.linalg.LinAlgError):
        theta[kept] = own.mean(axis=0)
    return theta
