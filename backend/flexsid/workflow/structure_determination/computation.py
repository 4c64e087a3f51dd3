"""Model structure determination from a task, without a database, in any process."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import inf

from flexsid.errors import NotIdentifiable
from flexsid.records.run import AdequacyState, Method, ReportProgress
from flexsid.records.search import InitialTerms, SearchCandidate, SearchResult, TermGroup
from flexsid.sysid.estimation.held_out_likelihood import LEAST_DIFFERENCE
from flexsid.workflow.structure_determination.candidate_comparison import compare_models
from flexsid.workflow.structure_determination.fitted_models import (
    FittedModel,
    SearchTask,
    fit_all_terms,
    fit_terms,
    interpolate_progress,
)
from flexsid.workflow.structure_determination.term_search import TermSearch, select_models

_START_FROM, _RESAMPLE_FROM, _FIT_FROM, _PREDICT_FROM = 0.25, 0.35, 0.5, 0.8  # of the progress


def compute_search(task: SearchTask, report: ReportProgress) -> SearchResult:
    """Compute one model structure determination.

    Parameters
    ----------
    task
        Task from ``prepare_search``.
    report
        Called with the progress; an exception that it raises (``Cancelled``) ends the search.

    Raises
    ------
    NotIdentifiable
        If the data do not determine all candidate terms.

    Notes
    -----
    Every model is fitted as a run of it: out-of-band modes with their priors, noise spectrum,
    leakage, and tests for remaining model error. Terms are selected by the marginal likelihood
    of the run with all of them.
    """
    began = time.perf_counter()
    full = fit_all_terms(task, report, (0.0, _START_FROM))
    search = TermSearch(task, full, _select_initial_terms(task, report))
    selections = search.select_all(task.settings.algorithm)
    groups = search.build_groups(selections, (_RESAMPLE_FROM, _FIT_FROM), report)
    warnings = [*task.warnings, *(w for run in full.runs for w in run.warnings)]
    fitted: list[FittedModel] = []
    models = select_models(task, search, selections)
    for number, (selected, (name, why)) in enumerate(models.items()):
        model = full
        if len(selected) < len(full.selected):
            share = [
                interpolate_progress((_FIT_FROM, _PREDICT_FROM), number + k, len(models))
                for k in (0, 1)
            ]
            try:
                model = fit_terms(task, full, selected, (share[0], share[1]), report)
            except NotIdentifiable as reason:
                warnings.append(f"The model of {name} has no estimate: {reason.message}.")
                continue
        also = f", {full.name}" if model is full else ""
        fitted.append(replace(model, name=name + also, why=why))
    if all(len(one.selected) < len(full.selected) for one in fitted):
        fitted.append(full)
    compared = compare_models(task, search, full, fitted, (_PREDICT_FROM, 1.0), report)
    undecided = _find_objection(task, full, fitted[0].selected, models)
    if undecided:
        sentence = f"Not decided: {undecided}"
    else:
        of_all = next(k for k, one in enumerate(fitted) if len(one.selected) == len(full.selected))
        reason = _object_to_fewer(compared[0], compared[of_all])
        proposed = of_all if reason else 0
        compared[proposed] = replace(compared[proposed], proposed=True)
        sentence = _summarise(task, full, fitted[0], reason)
    return SearchResult(
        sentence=sentence,
        groups=groups,
        candidates=tuple(
            sorted(compared, key=lambda c: inf if c.predictive_cost is None else c.predictive_cost)
        ),
        warnings=tuple(dict.fromkeys([*warnings, *_describe_held(task, groups)])),
        seconds=time.perf_counter() - began,
        undecided=undecided,
    )


def _select_initial_terms(task: SearchTask, report: ReportProgress) -> tuple[str, ...] | None:
    """Select the initial terms by equation error, where the settings ask for it."""
    if task.method is Method.EE or task.settings.initial_terms is not InitialTerms.EQUATION_ERROR:
        return None
    by_regression = replace(
        task,
        method=Method.EE,
        maneuvers=tuple(
            replace(
                one,
                method=Method.EE,
                structure=replace(one.structure, extra_parameters=()),
            )
            for one in task.maneuvers
        ),
    )
    full = fit_all_terms(by_regression, report, (_START_FROM, _RESAMPLE_FROM))
    found = TermSearch(by_regression, full).select_all(task.settings.algorithm)
    return tuple(name for one in found.values() for name in one.selected)


def _find_objection(
    task: SearchTask,
    full: FittedModel,
    selected: Sequence[str],
    models: Mapping[tuple[str, ...], tuple[str, str]],
) -> str:
    """Return why nothing can be proposed, else nothing.

    Terms that are dropped from a model that is not adequate may be those that compensate its
    error.
    """
    if full.rejection:
        suspect = full.runs.index(
            next(r for r in full.runs if r.adequacy.state is AdequacyState.SUSPECT)
        )
        label = task.maneuvers[suspect].maneuver_tasks[0].label
        of_maneuver = f" of {label}" if len(task.maneuvers) > 1 else ""
        return f"the tests of a run{of_maneuver} reject the model with all terms. {full.rejection}"
    if not models:
        return "none of the candidate terms is significant."
    if tuple(selected) != next(iter(models)):
        return "the model with the selected terms has no estimate."
    return ""


def _object_to_fewer(fewer: SearchCandidate, full: SearchCandidate) -> str:
    """Return why all terms are proposed instead of fewer, else nothing."""
    if fewer is full:
        return ""
    if fewer.adequacy is AdequacyState.SUSPECT:
        return f"the tests of a run reject the model without them: {fewer.adequacy_reason}"
    if not fewer.converged:
        return "the fit without them did not converge."
    predicted, of_all = fewer.predictive_cost, full.predictive_cost
    loss = 0.0 if predicted is None or of_all is None else predicted - of_all
    if loss > LEAST_DIFFERENCE:
        return f"without them the log likelihood of held-out data is lower by {loss:.3g}."
    return ""


def _describe_held(task: SearchTask, groups: Sequence[TermGroup]) -> list[str]:
    """Describe the terms that stay only because a stored run holds them."""
    return [
        f"{term.name} stays, since run {held.run_id} holds it at {held.sigmas:.3g} standard errors."
        for group in groups
        for term in group.terms
        if term.f < task.thresholds.f_out and (held := task.held.get(term.name)) is not None
    ]


def _summarise(task: SearchTask, full: FittedModel, selected: FittedModel, reason: str) -> str:
    removed = [name for name in full.selected if name not in selected.selected]
    data = (
        task.maneuvers[0].maneuver_tasks[0].label
        if len(task.maneuvers) == 1
        else f"{len(task.maneuvers)} maneuvers"
    )
    n_all = len(full.selected)
    sentence = (
        f"{task.method.value} over {data} supports {n_all - len(removed)} of "
        f"{n_all} terms; not supported: {', '.join(removed) or 'none'}."
    )
    return f"{sentence} All terms are proposed, since {reason}" if reason else sentence
