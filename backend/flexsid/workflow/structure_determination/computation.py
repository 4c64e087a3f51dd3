"""Model structure determination from a task, without a database, in any process."""

from __future__ import annotations

import time
from collections.abc import Sequence

from flexsid.records.run import Method
from flexsid.records.search import SearchResult, SearchStart
from flexsid.sysid.estimation.parameters import Parameters
from flexsid.workflow.structure_determination.by_equation_error import EquationSearch
from flexsid.workflow.structure_determination.by_likelihood import search_by_likelihood
from flexsid.workflow.structure_determination.ranking import compare_candidates
from flexsid.workflow.structure_determination.task import (
    FittedCandidate,
    Report,
    SearchTask,
    list_candidate_derivatives,
)


def compute_search(task: SearchTask, report: Report) -> SearchResult:
    """Compute one model structure determination.

    Parameters
    ----------
    task
        Task from ``prepare_search``.
    report
        Called with the progress; an exception that it raises (``Cancelled``) ends the search.
    """
    began = time.perf_counter()
    warnings = list(task.warnings)
    if task.method is Method.EE:
        equations = EquationSearch(task, report)
        candidates, groups = equations.candidates[0], equations.groups(report)
        fitted = equations.fit(warnings)
    else:
        begin = task.settings.begin is SearchStart.EQUATION_ERROR
        start = EquationSearch(task, report).found.selected if begin else None
        candidates, groups, fitted = search_by_likelihood(task, start, warnings, report)
    return SearchResult(
        sentence=_summarise(task, candidates, fitted),
        groups=groups,
        candidates=compare_candidates(task, candidates, fitted, report),
        warnings=tuple(dict.fromkeys(warnings)),
        seconds=time.perf_counter() - began,
    )


def _summarise(task: SearchTask, candidates: Parameters, fitted: Sequence[FittedCandidate]) -> str:
    best = next(one for one in fitted if one.proposed)
    derivatives = list_candidate_derivatives(candidates)
    removed = [name for name in derivatives if name not in best.selected]
    data = (
        task.maneuvers[0].maneuvers[0].label
        if len(task.maneuvers) == 1
        else f"{len(task.maneuvers)} maneuvers"
    )
    return (
        f"{task.method.value} over {data} supports {len(derivatives) - len(removed)} of "
        f"{len(derivatives)} terms; not supported: {', '.join(removed) or 'none'}."
    )
