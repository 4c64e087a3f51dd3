"""Search of the terms of every coefficient, and cross-validation of the models."""

from __future__ import annotations

from collections.abc import Container, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from jaxtyping import Bool

from flexsid.errors import BadInput, NotIdentifiable
from flexsid.sysid.estimation import noise
from flexsid.sysid.estimation.estimate import Estimate
from flexsid.sysid.estimation.experiment import Experiment, Parameters
from flexsid.sysid.estimation.frequency_domain_model import FrequencyDomainModel
from flexsid.sysid.estimation.leakage import fit_with_leakage_correction, remove_leakage
from flexsid.sysid.estimation.likelihood import FitSettings, Report
from flexsid.sysid.stability.derivative_fusion import compute_weighted_mean
from flexsid.sysid.structure_determination.evidence import Evidence, assign_combs, pool_evidence
from flexsid.sysid.structure_determination.selection import (
    DEFAULT_THRESHOLDS,
    Selection,
    SelectionState,
    SelectionStep,
    Thresholds,
    ValidationFit,
    compute_criteria,
    expand_values,
    select_candidates,
    select_terms,
    summarise_selection,
)

# --- Search of the terms of every coefficient, over one maneuver or a campaign --------------------

SearchMethod = Literal["stepwise", "orthogonal functions"]


@dataclass(frozen=True, slots=True)
class StructureSelection:
    """The selection of every coefficient, in the order of the candidates."""

    coefficients: dict[str, Selection]

    @property
    def selected(self) -> tuple[str, ...]:
        """Names of all selected derivatives."""
        return tuple(name for one in self.coefficients.values() for name in one.selected)


def search_equations(
    maneuvers: Sequence[Mapping[str, Evidence]],
    method: SearchMethod = "stepwise",
    thresholds: Thresholds = DEFAULT_THRESHOLDS,
    forced: Container[str] = (),
) -> StructureSelection:
    """Select the terms of every coefficient by equation error.

    ``maneuvers`` is the evidence of each by coefficient, ``forced`` are terms that stay.

    Raises
    ------
    BadInput
        If there is no maneuver, or they have different candidates.
    """
    if not maneuvers:
        raise BadInput("a search needs at least one maneuver", code="no-maneuver")
    first = maneuvers[0]
    for other in maneuvers[1:]:
        if {k: e.names for k, e in other.items()} != {k: e.names for k, e in first.items()}:
            raise BadInput(
                "the maneuvers have different candidates; search over maneuvers with the same "
                "inputs and modes",
                code="other-candidates",
            )
    select = select_stepwise if method == "stepwise" else select_by_orthogonal_functions
    return StructureSelection(
        {name: select([one[name] for one in maneuvers], thresholds, forced) for name in first}
    )


def select_stepwise(
    evidences: Sequence[Evidence],
    thresholds: Thresholds = DEFAULT_THRESHOLDS,
    forced: Container[str] = (),
) -> Selection:
    """Select the terms of one coefficient over one maneuver or many by stepwise regression.

    Notes
    -----
    Source: Klein and Morelli, stepwise regression with partial F. Departures: the scatter
    of a term is that of the residuals as they are, coloured or not, with all candidates;
    and when no further term enters, all candidates enter and the weak ones are dropped
    again. The result with the lower predicted squared error is taken: a term that replaces
    another one early can exclude it permanently.
    """
    stays = np.array([name in forced for name in evidences[0].names])
    forward = select_terms(evidences, SelectionState(np.zeros_like(stays)), thresholds)
    forward = _enter_terms(evidences, forward, thresholds, stays)
    forward = select_terms(evidences, forward, thresholds, forced=stays)
    backward = _enter_terms(evidences, forward, thresholds)
    backward = select_terms(evidences, backward, thresholds, forced=stays)
    ends = [summarise_selection(evidences, end, thresholds) for end in (forward, backward)]
    return min(ends, key=lambda end: end.criteria.pse)


def select_by_orthogonal_functions(
    evidences: Sequence[Evidence],
    thresholds: Thresholds = DEFAULT_THRESHOLDS,
    forced: Container[str] = (),
) -> Selection:
    """Select the terms of one coefficient over one maneuver or many by orthogonal functions.

    Notes
    -----
    Source: Morelli, multivariate orthogonal functions, J. Aircraft 32 (1995), doi:10.2514/3.46712.
    The next function is the candidate that, made orthogonal to those before it, reduces the
    residuals most; their number has the least predicted squared error. In the plain terms that they
    are mapped back to, those whose partial F is below ``f_out`` are dropped.
    """
    names = evidences[0].names
    stays = np.array([name in forced for name in names])
    nothing = np.zeros(len(names), dtype=bool)
    rest = pool_evidence(evidences, nothing).rest
    path = _enter_terms(evidences, SelectionState(nothing), thresholds).path
    criteria = [compute_criteria(evidences, nothing, rest, thresholds)]
    criteria += [step.criteria for step in path]
    path = path[: int(np.argmin([one.pse for one in criteria]))]
    entered = {step.term for step in path}
    best = SelectionState(np.array([name in entered for name in names]), path)
    best = _enter_terms(evidences, best, thresholds, stays)
    end = select_terms(evidences, best, thresholds, forced=stays, enter=False)
    return summarise_selection(evidences, end, thresholds)


def _enter_terms(
    evidences: Sequence[Evidence],
    at: SelectionState,
    thresholds: Thresholds,
    which: Bool[np.ndarray, " p"] | None = None,
) -> SelectionState:
    """Enter terms, by default all that the data resolve, the one of the largest gain first."""
    selected, path = at.selected.copy(), list(at.path)
    now = pool_evidence(evidences, selected)
    while True:
        missing = ~selected if which is None else which & ~selected
        gain = np.where(missing, now.gain, -1.0)
        entering = int(np.argmax(gain))
        if gain[entering] <= 0.0:
            return SelectionState(selected, tuple(path))
        f = float(now.f[entering])
        selected[entering] = True
        now = pool_evidence(evidences, selected)
        criteria = compute_criteria(evidences, selected, now.rest, thresholds)
        path.append(SelectionStep("enter", evidences[0].names[entering], f, criteria))


# --- Cross-validation: prediction of data that a model was not fitted to --------------------------


@dataclass(frozen=True, slots=True, eq=False)
class ValidationModel:
    """Data of a maneuver, and all parameters that a model of it can have."""

    experiment: Experiment
    candidates: Parameters


def validate_prediction(
    model: ValidationModel, values: Mapping[str, float], kind: str = "diagonal"
) -> ValidationFit:
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
        return ValidationFit(name=experiment.name, cost=None, r_squared=None)
    _, cost = noise.compute_residual_density(residuals, powers, experiment.group, kind)
    error = np.sum(np.abs(residuals) ** 2, axis=0)
    power = np.sum(np.abs(experiment.measured) ** 2, axis=0)
    r_squared = float(np.mean(1.0 - error / power))
    return ValidationFit(
        name=experiment.name,
        cost=float(cost) if np.isfinite(cost) else None,
        r_squared=r_squared if np.isfinite(r_squared) else None,
    )


def cross_validate(
    maneuvers: Sequence[ValidationModel],
    estimates: Sequence[Estimate],
    others: Sequence[ValidationModel] = (),
    settings: FitSettings | None = None,
    report: Report | None = None,
) -> tuple[ValidationFit, ...]:
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
) -> tuple[ValidationFit, ...]:
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
            found.append(ValidationFit(name=name, cost=None, r_squared=None))
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
