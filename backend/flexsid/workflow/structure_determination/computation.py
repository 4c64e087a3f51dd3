"""The pure middle of a search for structure, fit for any process or machine."""

from __future__ import annotations

import time
from collections.abc import Sequence

from flexsid.records.run import Method
from flexsid.records.search import SearchResult, SearchStart
from flexsid.sysid.estimation.parameters import Parameters
from flexsid.workflow.structure_determination.by_equation_error import EquationSearch
from flexsid.workflow.structure_determination.by_likelihood import search_by_likelihood
from flexsid.workflow.structure_determination.ranking import ranked
from flexsid.workflow.structure_determination.task import Fitted, Report, SearchTask, derivatives_of


def search(task: SearchTask, report: Report) -> SearchResult:
    """Carry out one search.

    Parameters
    ----------
    task
        As prepared.
    report
        Told how far it is; what it raises (``Cancelled``) ends the search.
    """
    began = time.perf_counter()
    warnings = list(task.warnings)
    if task.method is Method.EE:
        equations = EquationSearch(task, report)
        candidates, groups = equations.candidates[0], equations.groups(report)
        fitted = equations.fitted(warnings)
    else:
        begin = task.settings.begin is SearchStart.EQUATION_ERROR
        start = EquationSearch(task, report).found.chosen if begin else None
        candidates, groups, fitted = search_by_likelihood(task, start, warnings, report)
    return SearchResult(
        sentence=_sentence(task, candidates, fitted),
        groups=groups,
        candidates=ranked(task, candidates, fitted, report),
        warnings=tuple(dict.fromkeys(warnings)),
        seconds=time.perf_counter() - began,
    )


def _sentence(task: SearchTask, candidates: Parameters, fitted: Sequence[Fitted]) -> str:
    best = next(one for one in fitted if one.proposed)
    derivatives = derivatives_of(candidates)
    gone = [name for name in derivatives if name not in best.chosen]
    where = (
        task.maneuvers[0].maneuvers[0].label
        if len(task.maneuvers) == 1
        else f"{len(task.maneuvers)} maneuvers"
    )
    return (
        f"{task.method.value} over {where} asks for {len(derivatives) - len(gone)} of "
        f"{len(derivatives)} terms; without support: {', '.join(gone) or 'none'}."
    )
