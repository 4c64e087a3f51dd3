"""Candidates by what they predict: lines that were not fitted, and the flutter speed."""

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
from flexsid.sysid.stability.bands import Uncertain
from flexsid.sysid.stability.prediction import IdentifiedModes, predict_flutter, weighted_mean
from flexsid.sysid.stability.speeds import Aeroelastic
from flexsid.sysid.structure_determination.validation import cross_validate
from flexsid.workflow.runs.computation import EstimationTask, experiments_of
from flexsid.workflow.structure_determination.task import Fitted, Report, SearchTask, derivatives_of

_FLUTTER_BAND = (0.35, 2.0)  # of the fastest maneuver


def ranked(
    task: SearchTask, candidates: Parameters, fitted: Sequence[Fitted], report: Report
) -> tuple[SearchCandidate, ...]:
    """Every candidate with what it predicts, likeliest first."""
    seen, unseen = _lines(task, task.maneuvers), _lines(task, task.unseen)
    settings = FitSettings(max_iterations=task.settings.max_iterations, noise=task.settings.noise)
    found = []
    for number, one in enumerate(fitted):
        share = 0.8 + 0.2 * number / len(fitted)
        report(Progress(fraction=share, message=f"Predicting with {one.name}"))
        predicted = cross_validate(seen, one.estimates, candidates, unseen, settings)
        speed, std, sentence = _flutter(task, candidates, one)
        found.append(
            SearchCandidate(
                name=one.name,
                why=one.why,
                structure=structure_with(task.structure, candidates, one.chosen),
                n_terms=sum(name in one.chosen for name in derivatives_of(candidates)),
                proposed=one.proposed,
                converged=all(e.outcome is Outcome.CONVERGED for e in one.estimates),
                cost=one.cost,
                bic=one.bic,
                likelihood_ratio=one.likelihood_ratio,
                foretold=one.foretold,
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


def _lines(task: SearchTask, maneuvers: Sequence[EstimationTask]) -> list[Experiment]:
    """Lines to predict; those of output error for a search by equation error."""
    method = Method.OE if task.method is Method.EE else task.method
    return [
        replace(experiments_of(replace(one, method=method))[0], name=one.maneuvers[0].label)
        for one in maneuvers
    ]


def structure_with(
    structure: Structure, candidates: Parameters, chosen: Sequence[str]
) -> Structure:
    """The structure that has these of the candidates, and none of the others."""
    derivatives = derivatives_of(candidates)
    absent = tuple(name for name in derivatives if name not in chosen)
    return replace(
        structure,
        free=tuple(name for name in derivatives if name in chosen),
        absent=(*structure.absent, *absent),
    )


def _flutter(
    task: SearchTask, candidates: Parameters, one: Fitted
) -> tuple[float | None, float | None, str]:
    """Flutter speed at the loading of the first maneuver, its standard error, and in words."""
    first = task.maneuvers[0]
    names = derivatives_of(candidates)
    inside = [name for name in names if name in one.chosen]
    where = [one.estimates[0].names.index(name) for name in inside]
    try:
        values = np.stack([e.values[where] for e in one.estimates])
        covariances = [e.corrected_covariance[np.ix_(where, where)] for e in one.estimates]
        mean, covariance = weighted_mean(values, covariances)
        theta = np.zeros(len(candidates.names))
        kept = np.array([name in inside for name in names])
        theta[: len(names)][kept] = mean
        fastest = max(t.model.condition.airspeed for t in task.maneuvers)
        found = predict_flutter(
            IdentifiedModes(
                Aeroelastic(first.model.condition, first.model.modes, candidates.table(theta)),
                Uncertain(candidates.rows[kept], candidates.columns[kept], covariance),
            ),
            (_FLUTTER_BAND[0] * fastest, _FLUTTER_BAND[1] * fastest),
            called={
                str(number): name
                for number, name in zip(first.model.modes.numbers, first.mode_names, strict=True)
            },
        )
    except (FlexsidError, np.linalg.LinAlgError) as reason:
        said = reason.message if isinstance(reason, FlexsidError) else "its roots are not finite"
        return None, None, f"No flutter speed: {said}."
    if found.crossing is None:
        return None, None, found.sentence
    return found.crossing.airspeed, finite_or_none(found.airspeed_std), found.sentence
