"""Models of a search, fitted as runs, and selection of their terms by the marginal likelihood."""

from __future__ import annotations

from collections.abc import Container, Mapping, Sequence
from dataclasses import asdict, dataclass, replace

import numpy as np

from flexsid.records import finite_or_none
from flexsid.records.decision import Structure
from flexsid.records.run import AdequacyState, Method, ModelAdequacy, Progress, ReportProgress
from flexsid.records.search import (
    Algorithm,
    SearchSettings,
    SearchStep,
    SearchTerm,
    TermDependency,
    TermGroup,
)
from flexsid.sysid.estimation.estimate import Estimate, Outcome
from flexsid.sysid.spectra.collinearity import compute_variance_inflation, find_near_dependencies
from flexsid.sysid.structure_determination.evidence import Evidence
from flexsid.sysid.structure_determination.selection import (
    Selection,
    SelectionStep,
    Term,
    Thresholds,
    compute_selection_frequency,
)
from flexsid.sysid.structure_determination.term_search import (
    TermSearch,
    collect_evidence,
    find_held_terms,
    group_by_coefficient,
)
from flexsid.workflow.fits.computation import ComputedRun, compute_run
from flexsid.workflow.fits.estimation_task import (
    EstimationTask,
    get_first_start,
    select_free_parameters,
)

# --- Models of a search, fitted as runs: with all candidate terms, and with some of them ----------


@dataclass(frozen=True, slots=True)
class HoldingRun:
    """A stored run of a maneuver that holds a term, and its value over its standard error."""

    run_id: int
    sigmas: float


@dataclass(frozen=True, slots=True)
class SearchTask:
    """Input of a worker: the run of each fitted and each validation maneuver with all candidates.

    ``held`` are the terms that a stored run of a maneuver holds.
    """

    method: Method
    settings: SearchSettings
    thresholds: Thresholds
    structure: Structure
    maneuvers: tuple[EstimationTask, ...]
    unseen: tuple[EstimationTask, ...]
    held: Mapping[str, HoldingRun]
    warnings: tuple[str, ...]


@dataclass(frozen=True, slots=True, eq=False)
class FittedModel:
    """A candidate model structure: its terms, and its run of every maneuver."""

    name: str
    why: str
    selected: tuple[str, ...]
    runs: tuple[ComputedRun, ...]

    @property
    def estimates(self) -> tuple[Estimate, ...]:
        """Estimates of all parameters of the runs, the nuisance parameters included."""
        return tuple(get_whole_estimate(one) for one in self.runs)

    @property
    def converged(self) -> bool:
        """Whether every run ended at an optimum."""
        return all(one.estimate.outcome is Outcome.CONVERGED for one in self.runs)

    @property
    def cost(self) -> float | None:
        """Negative log likelihood of all maneuvers; None of a method without one."""
        steps = [one.estimate.steps for one in self.runs]
        return float(sum(one[-1].cost for one in steps)) if all(steps) else None

    @property
    def adequacy(self) -> ModelAdequacy:
        """The tests for remaining model error of the run that they reject, else of the first."""
        every = [one.adequacy for one in self.runs]
        return next((a for a in every if a.state is AdequacyState.SUSPECT), every[0])

    @property
    def rejection(self) -> str:
        """The failed tests for remaining model error; empty where no run is suspect."""
        found = self.adequacy
        return found.reason if found.state is AdequacyState.SUSPECT else ""


def get_whole_estimate(run: ComputedRun) -> Estimate:
    """Return the estimate of all parameters, the nuisance parameters included."""
    return run.estimate if run.retained is None else run.retained.estimate


def list_candidates(task: EstimationTask) -> tuple[str, ...]:
    """List the candidate terms: free derivatives of the model structure."""
    names = select_free_parameters(task, get_first_start(task), ()).names
    return tuple(name for name in names if name not in task.nuisance_names)


def fit_all_terms(
    task: SearchTask, report: ReportProgress, share: tuple[float, float]
) -> FittedModel:
    """Compute the run of every maneuver with all candidates."""
    name = "all terms"
    runs = _compute_runs(task.maneuvers, name, share, report)
    return FittedModel(name, "all candidates", list_candidates(task.maneuvers[0]), runs)


def fit_terms(
    task: SearchTask,
    full: FittedModel,
    selected: tuple[str, ...],
    share: tuple[float, float],
    report: ReportProgress,
) -> FittedModel:
    """Compute the runs of a model with some terms, started at the estimates of all of them."""
    pairs = zip(task.maneuvers, full.runs, strict=True)
    tasks = [restrict_terms(one, run, selected) for one, run in pairs]
    name = f"{len(selected)} terms"
    return FittedModel(name, "", selected, _compute_runs(tasks, name, share, report))


def _compute_runs(
    tasks: Sequence[EstimationTask],
    name: str,
    share: tuple[float, float],
    report: ReportProgress,
) -> tuple[ComputedRun, ...]:
    runs = []
    for number, one in enumerate(tasks):
        fraction = interpolate_progress(share, number, len(tasks))
        at = Progress(fraction=fraction, message=f"{one.maneuver_tasks[0].label} with {name}")
        report(at)
        runs.append(compute_run(one, report_at(at, report)))
    return tuple(runs)


def interpolate_progress(share: tuple[float, float], number: int, count: int) -> float:
    """Return the progress before one of several parts."""
    return share[0] + (share[1] - share[0]) * number / count


def restrict_terms(
    task: EstimationTask, full: ComputedRun, selected: Container[str]
) -> EstimationTask:
    """Return the run of a model with some of the candidates."""
    absent = [name for name in list_candidates(task) if name not in selected]
    kept = tuple(name for name in list_candidates(task) if name in selected)
    structure = replace(
        task.structure, free=kept, fixed=task.structure.fixed | dict.fromkeys(absent, 0.0)
    )
    estimate = get_whole_estimate(full)
    found = dict(zip(estimate.names, estimate.values.tolist(), strict=True))
    start = task.model.fill_table(get_first_start(task).named() | full.held | found)
    task = task.with_spreads(full.retained, full.shape_spread)
    return replace(
        task,
        structure=structure,
        starts={"the estimate of all terms": start},
        try_equation_error=False,
        priors={name: prior for name, prior in task.priors.items() if name not in absent},
    )


def report_at(at: Progress, report: ReportProgress) -> ReportProgress:
    """Report the iterations of a fit at a fixed fraction of the search."""
    return lambda own: report(replace(at, iteration=own.iteration, cost=own.cost))


# --- Selection of terms by the marginal likelihood of the runs with all of them -------------------


def build_search(
    task: SearchTask, full: FittedModel, start: Container[str] | None = None
) -> TermSearch:
    """Build the search of the terms of the runs with all of them.

    By equation error the terms of each coefficient are searched together, else those of the whole
    model, from all terms or from ``start``. Terms that a run holds are never dropped.
    """
    names, estimates = full.selected, [one.estimate for one in full.runs]
    overlaps = [one.maneuvers[0].measured.resolution_overlap for one in task.maneuvers]
    by_equation = task.method is Method.EE
    groups = group_by_coefficient(names) if by_equation else {task.method.value: names}
    return TermSearch(
        evidences={
            name: collect_evidence(estimates, terms, overlaps, name if by_equation else None)
            for name, terms in groups.items()
        },
        thresholds=task.thresholds,
        by_equation=by_equation,
        start=frozenset(n for n in names if start is None or n in start),
        forced=find_held_terms(estimates, names).union(set(task.held) & set(names)),
    )


def build_groups(
    task: SearchTask,
    search: TermSearch,
    found: Mapping[str, Selection],
    share: tuple[float, float],
    report: ReportProgress,
) -> tuple[TermGroup, ...]:
    """Build the terms of every group with their selection frequency."""
    settings, groups = task.settings, []
    modal_std = task.maneuvers[0].modal_std
    for number, (name, selection) in enumerate(found.items()):
        fraction = interpolate_progress(share, number, len(found))
        report(Progress(fraction=fraction, message=f"Resampling frequencies for {name}"))
        own = search.evidences[name]

        def select_again(drawn: Sequence[Evidence], name: str = name) -> Selection:
            return search.select(name, drawn, settings.algorithm.value)

        stability = compute_selection_frequency(own, select_again, settings.resamplings)
        groups.append(_build_term_group(name, selection, own, stability, modal_std))
    return tuple(groups)


def select_models(
    task: SearchTask, search: TermSearch, found: Mapping[str, Selection]
) -> dict[tuple[str, ...], tuple[str, str]]:
    """Select the models to fit, by their terms: name and reason; the first is the selected one."""
    own = task.settings.algorithm
    selections = {own: found}
    if task.method is Method.EE:
        other = next(one for one in Algorithm if one is not own)
        selections[other] = search.select_all(other.value)
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
    inflation = compute_variance_inflation(total)
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
