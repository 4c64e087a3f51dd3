"""Selection of terms by the marginal likelihood of the runs with all of them."""

from __future__ import annotations

from collections.abc import Container, Mapping, Sequence
from dataclasses import asdict, replace

import numpy as np

from flexsid.records import finite_or_none
from flexsid.records.run import Method, Progress, ReportProgress
from flexsid.records.search import (
    Algorithm,
    SearchStep,
    SearchTerm,
    TermDependency,
    TermGroup,
)
from flexsid.sysid.spectra.collinearity import find_near_dependencies
from flexsid.sysid.structure_determination.evidence import (
    Evidence,
    compute_evidence,
    estimate_subset,
)
from flexsid.sysid.structure_determination.search import search_equations
from flexsid.sysid.structure_determination.selection import (
    Selection,
    SelectionState,
    SelectionStep,
    Term,
    compute_selection_frequency,
    select_terms,
    summarise_selection,
)
from flexsid.workflow.structure_determination.fitted_models import (
    FittedModel,
    SearchTask,
    interpolate_progress,
)

HELD_SIGMAS = 4.5
"""Standard errors at which a run holds a term: it is never proposed for removal."""


class TermSearch:
    """Selection of terms by the evidence of the runs with all of them.

    By equation error the terms of each coefficient are searched together, else those of the whole
    model, from all terms or from ``start``. Terms that a run holds are never dropped.
    """

    def __init__(
        self, task: SearchTask, full: FittedModel, start: Container[str] | None = None
    ) -> None:
        self.task = task
        self.start = full.selected if start is None else start
        self.forced = set(task.held) & set(full.selected)
        for one in full.runs:
            own = one.estimate.select(full.selected)
            sigmas = np.abs(own.values / own.std_errors)
            self.forced |= {full.selected[k] for k in np.flatnonzero(sigmas > HELD_SIGMAS)}
        groups: dict[str, list[str]] = {}
        for name in full.selected:
            of_row = name.split("_", 1)[0]
            group = of_row if task.method is Method.EE else task.method.value
            groups.setdefault(group, []).append(name)
        self.evidences = {
            name: self._collect_evidence(full, name, terms) for name, terms in groups.items()
        }

    def _collect_evidence(
        self, full: FittedModel, group: str, names: Sequence[str]
    ) -> tuple[Evidence, ...]:
        found = []
        for task, run in zip(self.task.maneuvers, full.runs, strict=True):
            blocks = [
                one.measured.size
                for one in run.estimate.lines
                if self.task.method is not Method.EE or one.name == group
            ]
            n_data = 2.0 * sum(blocks) / task.maneuvers[0].measured.resolution_overlap
            found.append(compute_evidence(run.estimate, names, n_data))
        return tuple(found)

    def select(
        self,
        group: str,
        evidences: Sequence[Evidence],
        algorithm: Algorithm,
        forced: Container[str] = (),
    ) -> Selection:
        """Select the terms of a group by the evidence of every maneuver."""
        thresholds = self.task.thresholds
        if self.task.method is Method.EE:
            every = [{group: one} for one in evidences]
            found = search_equations(every, algorithm.value, thresholds, forced)
            return found.coefficients[group]
        names = evidences[0].names
        stays = np.array([name in forced for name in names])
        begin = SelectionState(np.array([name in self.start for name in names]))
        end = select_terms(evidences, begin, thresholds, forced=stays)
        return summarise_selection(evidences, end, thresholds)

    def select_all(self, algorithm: Algorithm) -> dict[str, Selection]:
        """Select the terms of every group."""
        return {
            name: self.select(name, evidences, algorithm, self.forced)
            for name, evidences in self.evidences.items()
        }

    def build_groups(
        self,
        found: Mapping[str, Selection],
        share: tuple[float, float],
        report: ReportProgress,
    ) -> tuple[TermGroup, ...]:
        """Build the terms of every group with their selection frequency."""
        settings, groups = self.task.settings, []
        modal_std = self.task.maneuvers[0].modal_std
        for number, (name, selection) in enumerate(found.items()):
            fraction = interpolate_progress(share, number, len(found))
            report(Progress(fraction=fraction, message=f"Resampling frequencies for {name}"))
            own = self.evidences[name]

            def select_again(drawn: Sequence[Evidence], name: str = name) -> Selection:
                return self.select(name, drawn, settings.algorithm)

            stability = compute_selection_frequency(own, select_again, settings.resamplings)
            groups.append(_build_term_group(name, selection, own, stability, modal_std))
        return tuple(groups)

    def predict_ratio(self, selected: Container[str]) -> float:
        """Predict twice the rise of the cost of some terms over that of all of them."""
        ratio = 0.0
        for evidences in self.evidences.values():
            for one in evidences:
                inside = np.array([name in selected for name in one.names])
                ratio += estimate_subset(one, inside).rest
                ratio -= estimate_subset(one, np.ones_like(inside)).rest
        return ratio


def select_models(
    task: SearchTask, search: TermSearch, found: Mapping[str, Selection]
) -> dict[tuple[str, ...], tuple[str, str]]:
    """Select the models to fit, by their terms: name and reason; the first is the selected one."""
    own = task.settings.algorithm
    selections = {own: found}
    if task.method is Method.EE:
        other = next(one for one in Algorithm if one is not own)
        selections[other] = search.select_all(other)
    models: dict[tuple[str, ...], tuple[str, str]] = {}
    for algorithm, selection in selections.items():
        terms = tuple(name for one in selection.values() for name in one.selected)
        if not terms:
            continue
        name, why = algorithm.value, f"selected by {algorithm.value}"
        if task.method is not Method.EE:
            path = [step for one in selection.values() for step in one.path]
            name, why = f"{len(terms)} terms", _describe_path(path)
        before = models.get(terms)
        models[terms] = (name, why) if before is None else (f"{before[0]}, {name}", before[1])
    return models


def _describe_path(path: Sequence[SelectionStep]) -> str:
    words = []
    for action, verb in (("drop", "dropped"), ("enter", "entered")):
        terms = [step.term for step in path if step.action == action]
        if terms:
            words.append(f"{', '.join(terms)} {verb} by partial F")
    return "; ".join(words) or "no term dropped"


def _build_term_group(
    name: str,
    selection: Selection,
    evidences: Sequence[Evidence],
    stability: np.ndarray,
    modal_std: Mapping[str, float],
) -> TermGroup:
    """Build the statistics of a selection; ``stability`` is the selection frequency by term.

    Standard errors include ``modal_std``, those due to the modal table. The partial F does not:
    with the frequencies of the table, the data need the term.
    """
    total = np.sum([one.information for one in evidences], axis=0)
    size = np.sqrt(np.maximum(np.diag(total), np.finfo(float).tiny))
    unit = total / np.outer(size, size)
    inflation = np.diag(np.linalg.pinv(unit, rcond=1e-12, hermitian=True))
    inside = np.array([term.selected for term in selection.terms])
    names = [term.name for term in selection.terms]
    selected = [term.name for term in selection.terms if term.selected]
    among = find_near_dependencies(total[np.ix_(inside, inside)], selected) if inside.any() else ()
    before = find_near_dependencies(total, names)
    criteria = selection.criteria
    return TermGroup(
        name=name,
        path=tuple(
            SearchStep(
                action=step.action,
                term=step.term,
                f=step.f,
                n_terms=step.criteria.n_terms,
                r_squared=finite_or_none(step.criteria.r_squared),
                pse=finite_or_none(step.criteria.pse),
                bic=finite_or_none(step.criteria.bic),
            )
            for step in selection.path
        ),
        terms=tuple(
            SearchTerm(
                **asdict(_add_modal_error(term, modal_std.get(term.name, 0.0))),
                stability=finite_or_none(share),
                inflation=float(grown) if 0.0 < grown < 1e8 else None,
            )
            for term, share, grown in zip(selection.terms, stability, inflation, strict=True)
        ),
        dependencies=tuple(
            TermDependency(condition_index=one.index, shares=one.shares)
            for one in (*among, *(b for b in before if b not in among))
        ),
        r_squared=finite_or_none(criteria.r_squared),
        pse=finite_or_none(criteria.pse),
        bic=finite_or_none(criteria.bic),
    )


def _add_modal_error(term: Term, std: float) -> Term:
    if term.std_error is None:
        return term
    return replace(term, std_error=finite_or_none(float(np.hypot(term.std_error, std))))
