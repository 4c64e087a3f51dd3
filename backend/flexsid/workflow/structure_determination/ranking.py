"""Ranking of candidate model structures by cross-validation, with their flutter speeds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from flexsid.errors import FlexsidError
from flexsid.records.finite import finite_or_none
from flexsid.records.model_structure import Structure
from flexsid.records.run import Method, Progress
from flexsid.records.search import PredictedLines, SearchCandidate
from flexsid.sysid.estimation.estimate import Outcome
from flexsid.sysid.estimation.experiment import Experiment
from flexsid.sysid.estimation.likelihood import FitSettings
from flexsid.sysid.estimation.parameters import Parameters
from flexsid.sysid.stability.bands import UncertainDerivatives
from flexsid.sysid.stability.prediction import (
    IdentifiedModes,
    compute_weighted_mean,
    predict_flutter,
)
from flexsid.sysid.stability.speeds import Aeroelastic
from flexsid.sysid.structure_determination.validation import cross_validate
from flexsid.workflow.runs.computation import EstimationTask, build_experiments
from flexsid.workflow.structure_determination.task import (
    FittedCandidate,
    Report,
    SearchTask,
    list_candidate_derivatives,
)

_FLUTTER_BAND = (0.35, 2.0)  # of the fastest maneuver


def compare_candidates(
    task: SearchTask, candidates: Parameters, fitted: Sequence[FittedCandidate], report: Report
) -> tuple[SearchCandidate, ...]:
    """Cross-validate every candidate; smallest predictive cost first."""
    seen, unseen = _build_experiments(task, task.maneuvers), _build_experiments(task, task.unseen)
    settings = FitSettings(max_iterations=task.settings.max_iterations, noise=task.settings.noise)
    found = []
    for number, one in enumerate(fitted):
        share = 0.8 + 0.2 * number / len(fitted)
        report(Progress(fraction=share, message=f"Predicting with {one.name}"))
        predicted = cross_validate(seen, one.estimates, candidates, unseen, settings)
        speed, std, sentence = _predict_flutter(task, candidates, one)
        found.append(
            SearchCandidate(
                name=one.name,
                why=one.why,
                structure=build_structure(task.structure, candidates, one.selected),
                n_terms=sum(
                    name in one.selected for name in list_candidate_derivatives(candidates)
                ),
                proposed=one.proposed,
                converged=all(e.outcome is Outcome.CONVERGED for e in one.estimates),
                cost=one.cost,
                bic=one.bic,
                likelihood_ratio=one.likelihood_ratio,
                predicted_ratio=one.predicted_ratio,
                predicted=tuple(
                    PredictedLines(
                        name=p.name,
                        cost=finite_or_none(p.cost),
                        r_squared=finite_or_none(p.r_squared),
                    )
                    for p in predicted
                ),
                predictive_cost=finite_or_none(sum(p.cost for p in predicted)),
                flutter_m_s=speed,
                flutter_std_m_s=std,
                flutter=sentence,
            )
        )
    return tuple(
        sorted(found, key=lambda c: np.inf if c.predictive_cost is None else c.predictive_cost)
    )


def _build_experiments(task: SearchTask, maneuvers: Sequence[EstimationTask]) -> list[Experiment]:
    """Build the experiments to predict; output error for a search by equation error."""
    method = Method.OE if task.method is Method.EE else task.method
    return [
        replace(build_experiments(replace(one, method=method))[0], name=one.maneuvers[0].label)
        for one in maneuvers
    ]


def build_structure(
    structure: Structure, candidates: Parameters, selected: Sequence[str]
) -> Structure:
    """Build the model structure with the selected candidates free and the others absent."""
    derivatives = list_candidate_derivatives(candidates)
    absent = tuple(name for name in derivatives if name not in selected)
    return replace(
        structure,
        free=tuple(name for name in derivatives if name in selected),
        absent=(*structure.absent, *absent),
    )


def _predict_flutter(
    task: SearchTask, candidates: Parameters, one: FittedCandidate
) -> tuple[float | None, float | None, str]:
    """Predict the flutter speed at the loading of the first maneuver: speed, error, sentence."""
    first = task.maneuvers[0]
    names = list_candidate_derivatives(candidates)
    terms = [name for name in names if name in one.selected]
    columns = [one.estimates[0].names.index(name) for name in terms]
    try:
        values = np.stack([e.values[columns] for e in one.estimates])
        covariances = [e.corrected_covariance[np.ix_(columns, columns)] for e in one.estimates]
        mean, covariance = compute_weighted_mean(values, covariances)
        theta = np.zeros(len(candidates.names))
        is_selected = np.array([name in terms for name in names])
        theta[: len(names)][is_selected] = mean
        fastest = max(t.model.condition.airspeed for t in task.maneuvers)
        found = predict_flutter(
            IdentifiedModes(
                Aeroelastic(first.model.condition, first.model.modes, candidates.table(theta)),
                UncertainDerivatives(
                    candidates.rows[is_selected], candidates.columns[is_selected], covariance
                ),
            ),
            (_FLUTTER_BAND[0] * fastest, _FLUTTER_BAND[1] * fastest),
            called={
                str(number): name
                for number, name in zip(first.model.modes.numbers, first.mode_names, strict=True)
            },
        )
    except (FlexsidError, np.linalg.LinAlgError) as reason:
        message = reason.message if isinstance(reason, FlexsidError) else "its roots are not finite"
        return None, None, f"No flutter speed: {message}."
    if found.crossing is None:
        return None, None, found.sentence
    return found.crossing.airspeed, finite_or_none(found.airspeed_std), found.sentence
