"""A search by fits of the whole model, from all candidates or from equation error's choice."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from flexsid.errors import NotIdentifiable
from flexsid.records.run import Progress
from flexsid.records.search import TermGroup
from flexsid.sysid.estimation.likelihood import FitSettings
from flexsid.sysid.estimation.parameters import Parameters
from flexsid.sysid.estimation.record_edges import settle_edges
from flexsid.sysid.structure_determination.candidates import (
    CandidatesFound,
    CandidateTerm,
    search_candidates,
)
from flexsid.sysid.structure_determination.evidence import Evidence
from flexsid.sysid.structure_determination.selection import Selection, Walk, selection_at, walk
from flexsid.sysid.structure_determination.stability import selection_frequency
from flexsid.workflow.runs.computation import experiments_of, likeliest
from flexsid.workflow.structure_determination.task import Fitted, Report, SearchTask
from flexsid.workflow.structure_determination.terms import term_group


def search_by_likelihood(
    task: SearchTask, start: tuple[str, ...] | None, warnings: list[str], report: Report
) -> tuple[Parameters, tuple[TermGroup, ...], list[Fitted]]:
    """Fit all candidates, then leave out and take in; candidates, their terms, and the fits.

    ``start`` names the terms to begin with, where equation error chose some.
    """
    experiments, first = [], []
    settings = FitSettings(max_iterations=task.settings.max_iterations, noise=task.settings.noise)
    for number, one in enumerate(task.maneuvers):
        message = f"Fitting all candidates to {one.maneuvers[0].label}"
        report(Progress(fraction=0.3 * number / len(task.maneuvers), message=message))
        own = experiments_of(one)
        parameters, _, estimate = likeliest(one, own, lambda progress: None)
        _, estimate = settle_edges(own, parameters, estimate, settings)
        experiments.append(replace(own[0], name=one.maneuvers[0].label))
        first.append(replace(parameters, start=estimate.values))
    candidates = first[0]

    def tell(fitted: int, message: str) -> None:
        report(Progress(iteration=fitted, fraction=min(0.3 + 0.05 * fitted, 0.6), message=message))

    def search_from(begin: tuple[str, ...] | None) -> CandidatesFound:
        values = [one.start for one in first]
        return search_candidates(
            experiments, candidates, begin, task.thresholds, settings, tell, values
        )

    try:
        found = search_from(start)
    except NotIdentifiable as reason:
        if start is None:
            raise
        warnings.append(
            "Began with all terms, for those that equation error chose cannot be fitted: "
            f"{reason.message}"
        )
        found = search_from(None)
    crowding = [one.maneuvers[0].measured.crowding for one in task.maneuvers]
    evidences = [e.thinned(c) for e, c in zip(found.evidences, crowding, strict=True)]
    if max(crowding) > 1.0:
        warnings.append(
            "Lines are closer than the resolution of the record; the fits take them as independent."
        )
    report(Progress(fraction=0.65, message="Drawing lines anew"))
    forced = np.arange(len(candidates.names)) >= candidates.rows.size
    inside = np.array([name in set(found.best.chosen) for name in candidates.names]) | forced

    def again(drawn: Sequence[Evidence]) -> Selection:
        end = walk(drawn, Walk(inside), task.thresholds, forced=forced)
        return selection_at("likelihood", drawn, end, task.thresholds)

    often = selection_frequency(evidences, again, task.settings.draws)
    path = tuple(step for one in found.candidates for step in one.changed)
    group = term_group(task.method.value, replace(found.selection, path=path), evidences, often)
    return (
        candidates,
        (group,),
        [
            _of_candidate(number, one, one is found.best)
            for number, one in enumerate(found.candidates)
        ],
    )


def _of_candidate(number: int, one: CandidateTerm, proposed: bool) -> Fitted:
    first = number == 0
    return Fitted(
        name=f"{number + 1}: {len(one.chosen)} parameters",
        why=one.why,
        chosen=one.chosen,
        estimates=one.estimates,
        proposed=proposed,
        cost=one.cost,
        bic=one.bic,
        likelihood_ratio=None if first else one.likelihood_ratio,
        foretold=None if first else one.foretold,
    )
