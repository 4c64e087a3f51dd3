"""Model structure determination by maximum likelihood fits of the whole model."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from flexsid.errors import NotIdentifiable
from flexsid.records.run import Progress
from flexsid.records.search import TermGroup
from flexsid.sysid.estimation.leakage import correct_leakage
from flexsid.sysid.estimation.likelihood import FitSettings
from flexsid.sysid.estimation.parameters import Parameters
from flexsid.sysid.structure_determination.candidates import (
    CandidateModel,
    CandidateSearchResult,
    search_candidates,
)
from flexsid.sysid.structure_determination.evidence import Evidence
from flexsid.sysid.structure_determination.selection import (
    Selection,
    SelectionState,
    select_terms,
    summarise_selection,
)
from flexsid.sysid.structure_determination.stability import compute_selection_frequency
from flexsid.workflow.runs.computation import build_experiments, maximize_from_starts
from flexsid.workflow.structure_determination.task import FittedCandidate, Report, SearchTask
from flexsid.workflow.structure_determination.terms import build_term_group


def search_by_likelihood(
    task: SearchTask, start: tuple[str, ...] | None, warnings: list[str], report: Report
) -> tuple[Parameters, tuple[TermGroup, ...], list[FittedCandidate]]:
    """Fit all candidates, then remove and add terms; return candidates, terms and fits.

    ``start`` names the terms to begin with, e.g. those selected by equation error.
    """
    experiments, first = [], []
    settings = FitSettings(max_iterations=task.settings.max_iterations, noise=task.settings.noise)
    for number, one in enumerate(task.maneuvers):
        message = f"Fitting all candidates to {one.maneuvers[0].label}"
        report(Progress(fraction=0.3 * number / len(task.maneuvers), message=message))
        own = build_experiments(one)
        parameters, _, estimate = maximize_from_starts(one, own, lambda progress: None)
        _, estimate = correct_leakage(own, parameters, estimate, settings)
        experiments.append(replace(own[0], name=one.maneuvers[0].label))
        first.append(replace(parameters, start=estimate.values))
    candidates = first[0]

    def report_fit(fitted: int, message: str) -> None:
        report(Progress(iteration=fitted, fraction=min(0.3 + 0.05 * fitted, 0.6), message=message))

    def search_from(begin: tuple[str, ...] | None) -> CandidateSearchResult:
        values = [one.start for one in first]
        return search_candidates(
            experiments, candidates, begin, task.thresholds, settings, report_fit, values
        )

    try:
        found = search_from(start)
    except NotIdentifiable as reason:
        if start is None:
            raise
        warnings.append(
            "The search started with all terms: those selected by equation error cannot be fitted: "
            f"{reason.message}"
        )
        found = search_from(None)
    resolution_overlap = [one.maneuvers[0].measured.resolution_overlap for one in task.maneuvers]
    evidences = [
        e.scale_by_overlap(c) for e, c in zip(found.evidences, resolution_overlap, strict=True)
    ]
    if max(resolution_overlap) > 1.0:
        warnings.append(
            "Frequencies are closer than the resolution of the record; the fits treat them as "
            "independent."
        )
    report(Progress(fraction=0.65, message="Resampling frequencies"))
    forced = np.arange(len(candidates.names)) >= candidates.rows.size
    inside = np.array([name in set(found.best.selected) for name in candidates.names]) | forced

    def select_again(drawn: Sequence[Evidence]) -> Selection:
        end = select_terms(drawn, SelectionState(inside), task.thresholds, forced=forced)
        return summarise_selection("likelihood", drawn, end, task.thresholds)

    stability = compute_selection_frequency(evidences, select_again, task.settings.draws)
    path = tuple(step for one in found.candidates for step in one.changed)
    group = build_term_group(
        task.method.value, replace(found.selection, path=path), evidences, stability
    )
    return (
        candidates,
        (group,),
        [
            _build_fitted_candidate(number, one, one is found.best)
            for number, one in enumerate(found.candidates)
        ],
    )


def _build_fitted_candidate(number: int, one: CandidateModel, proposed: bool) -> FittedCandidate:
    first = number == 0
    return FittedCandidate(
        name=f"{number + 1}: {len(one.selected)} parameters",
        why=one.why,
        selected=one.selected,
        estimates=one.estimates,
        proposed=proposed,
        cost=one.cost,
        bic=one.bic,
        likelihood_ratio=None if first else one.likelihood_ratio,
        predicted_ratio=None if first else one.predicted_ratio,
    )
