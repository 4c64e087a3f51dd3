"""Model structure determination from a task, without a database, in any process."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from flexsid.errors import Cancelled, FlexsidError, NotIdentifiable
from flexsid.records import finite_or_none
from flexsid.records.model_structure import Structure
from flexsid.records.run import AdequacyState, Method, Progress, ReportProgress
from flexsid.records.search import (
    Algorithm,
    InitialTerms,
    SearchCandidate,
    SearchResult,
    SearchSettings,
    SearchStep,
    SearchTerm,
    TermDependency,
    TermGroup,
    ValidationFit,
)
from flexsid.sysid.estimation.equation_error import equation_error
from flexsid.sysid.estimation.estimate import Estimate, Outcome
from flexsid.sysid.estimation.experiment import Experiment
from flexsid.sysid.estimation.leakage import correct_leakage
from flexsid.sysid.estimation.likelihood import FitSettings
from flexsid.sysid.estimation.parameters import Parameters
from flexsid.sysid.estimation.reconstruction import ReconstructedMotion
from flexsid.sysid.spectra.collinearity import find_near_dependencies
from flexsid.sysid.stability.derivative_fusion import IdentifiedModes, compute_weighted_mean
from flexsid.sysid.stability.flutter_prediction import predict_flutter
from flexsid.sysid.stability.root_errors import UncertainDerivatives
from flexsid.sysid.stability.state_family import Aeroelastic
from flexsid.sysid.structure_determination.candidates import (
    CandidateSearchResult,
    search_candidates,
)
from flexsid.sysid.structure_determination.equation import compute_equation_evidence
from flexsid.sysid.structure_determination.evidence import Evidence
from flexsid.sysid.structure_determination.likelihood import select_candidates
from flexsid.sysid.structure_determination.search import StructureSelection, search_equations
from flexsid.sysid.structure_determination.selection import (
    Selection,
    SelectionState,
    Thresholds,
    compute_selection_frequency,
    select_terms,
    summarise_selection,
)
from flexsid.sysid.structure_determination.validation import cross_validate
from flexsid.workflow.fits.computation import compute_run
from flexsid.workflow.fits.equation_error_fit import (
    reconstruct_with_out_of_band_modes,
    warn_of_sensor_noise,
)
from flexsid.workflow.fits.estimation_task import (
    EstimationTask,
    get_first_start,
    select_free_parameters,
)
from flexsid.workflow.fits.feedback_correction import fit_without_feedback_noise
from flexsid.workflow.fits.likelihood_fit import build_experiments, maximize_from_starts

_FLUTTER_BAND = (0.35, 2.0)  # of the fastest maneuver


@dataclass(frozen=True, slots=True)
class SearchTask:
    """Input of a worker: one task for each fitted and for each validation maneuver.

    ``default_run`` is the run of all fitted maneuvers by the same method with all candidates.
    """

    method: Method
    settings: SearchSettings
    thresholds: Thresholds
    fit: FitSettings
    structure: Structure
    maneuvers: tuple[EstimationTask, ...]
    unseen: tuple[EstimationTask, ...]
    default_run: EstimationTask
    warnings: tuple[str, ...]


@dataclass(frozen=True, slots=True, eq=False)
class FittedCandidate:
    """A candidate model structure with its estimates in every maneuver and its origin."""

    name: str
    why: str
    selected: tuple[str, ...]
    estimates: tuple[Estimate, ...]
    proposed: bool
    cost: float | None = None
    bic: float | None = None
    likelihood_ratio: float | None = None
    predicted_ratio: float | None = None


def list_candidate_derivatives(candidates: Parameters) -> tuple[str, ...]:
    """Return the names of the derivatives among the candidates; the others are delays."""
    return candidates.names[: candidates.rows.size]


def build_term_group(
    name: str, selection: Selection, evidences: Sequence[Evidence], stability: np.ndarray
) -> TermGroup:
    """Build the statistics of a selection; ``stability`` is the selection frequency by term."""
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
                name=term.name,
                selected=term.selected,
                value=term.value if np.isfinite(term.std_error) else None,
                std_error=finite_or_none(term.std_error),
                f=term.f,
                support=term.share,
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


class EquationSearch:
    """Model structure determination by equation error over all maneuvers."""

    def __init__(self, task: SearchTask, report: ReportProgress) -> None:
        self.task = task
        self.candidates: list[Parameters] = []
        self.motions: list[ReconstructedMotion] = []
        self.evidences: list[dict[str, Evidence]] = []
        self.warnings: list[str] = []
        for number, one in enumerate(task.maneuvers):
            data = one.maneuvers[0]
            share = 0.4 * number / len(task.maneuvers)
            report(Progress(fraction=share, message=f"Reconstructing motion in {data.label}"))
            candidates = select_free_parameters(one, get_first_start(one), ())
            motion, _ = reconstruct_with_out_of_band_modes(data)
            self.warnings += warn_of_sensor_noise(data, motion)
            found = compute_equation_evidence(data.model, motion, data.measured.inputs, candidates)
            resolution_overlap = data.measured.resolution_overlap
            self.candidates.append(candidates)
            self.motions.append(motion)
            self.evidences.append(
                {name: e.scale_by_overlap(resolution_overlap) for name, e in found.items()}
            )
        report(Progress(fraction=0.4, message="Selecting terms"))
        self.found = self._search(task.settings.algorithm)

    def _search(self, algorithm: Algorithm) -> StructureSelection:
        return search_equations(self.evidences, algorithm.value, self.task.thresholds)

    def groups(self, report: ReportProgress) -> tuple[TermGroup, ...]:
        """Build the terms of every coefficient with their selection frequency."""
        groups, algorithm = [], self.task.settings.algorithm.value
        for number, (name, selection) in enumerate(self.found.coefficients.items()):
            share = 0.45 + 0.35 * number / len(self.found.coefficients)
            report(Progress(fraction=share, message=f"Resampling frequencies for {name}"))
            own = [one[name] for one in self.evidences]

            def select_again(drawn: Sequence[Evidence], name: str = name) -> Selection:
                one = [{name: each} for each in drawn]
                return search_equations(one, algorithm, self.task.thresholds).coefficients[name]

            stability = compute_selection_frequency(
                own, select_again, self.task.settings.resamplings
            )
            groups.append(build_term_group(name, selection, own, stability))
        return tuple(groups)

    def fit(self, warnings: list[str]) -> list[FittedCandidate]:
        """Estimate all terms and the selection of either algorithm by equation error."""
        other = next(one for one in Algorithm if one is not self.task.settings.algorithm)
        selections = {
            self.task.settings.algorithm.value: self.found.selected,
            other.value: self._search(other).selected,
            "all terms": self.candidates[0].names,
        }
        fitted: list[FittedCandidate] = []
        warnings += self.warnings
        for name, selected in selections.items():
            same = next((one for one in fitted if set(one.selected) == set(selected)), None)
            if same is not None:
                fitted[fitted.index(same)] = replace(same, name=f"{same.name}, {name}")
                continue
            try:
                estimates = tuple(
                    self._estimate(one, selected) for one in range(len(self.evidences))
                )
            except NotIdentifiable as reason:
                warnings.append(f"The model structure of {name} has no estimate: {reason.message}.")
                continue
            why = "all candidates" if name == "all terms" else f"selected by {name}"
            fitted.append(FittedCandidate(name, why, selected, estimates, proposed=not fitted))
        if not fitted:
            raise NotIdentifiable(
                "no model structure can be estimated from these maneuvers; free fewer candidates",
                code="empty",
            )
        return fitted

    def _estimate(self, number: int, selected: tuple[str, ...]) -> Estimate:
        data = self.task.maneuvers[number].maneuvers[0]
        candidates = self.candidates[number]
        selected_terms = np.array([name in selected for name in candidates.names])
        if not selected_terms.any():
            raise NotIdentifiable("no candidate term is supported by the data")
        parameters = select_candidates(candidates, selected_terms, candidates.start)
        found = equation_error(data.model, self.motions[number], data.measured.inputs, parameters)
        return found.scale_covariance(data.measured.resolution_overlap)


def _report_at(at: Progress, report: ReportProgress) -> ReportProgress:
    """Report the iterations of a fit at a fixed fraction of the search."""
    return lambda own: report(replace(at, iteration=own.iteration, cost=own.cost))


def _report_iterations(at: Progress, report: ReportProgress) -> Callable[[int, float], None]:
    return lambda iteration, cost: report(replace(at, iteration=iteration, cost=cost))


def search_by_likelihood(
    task: SearchTask, start: tuple[str, ...] | None, warnings: list[str], report: ReportProgress
) -> tuple[Parameters, tuple[TermGroup, ...], list[FittedCandidate]]:
    """Fit all candidates, then remove and add terms; return candidates, terms and fits.

    ``start`` names the terms to begin with, e.g. those selected by equation error.
    """
    experiments, first = [], []
    for number, one in enumerate(task.maneuvers):
        message = f"Fitting all candidates to {one.maneuvers[0].label}"
        share = 0.3 * number / len(task.maneuvers)
        own = build_experiments(one)
        at = Progress(fraction=share, message=message)
        parameters, _, estimate = maximize_from_starts(one, own, _report_at(at, report))
        _, estimate = correct_leakage(
            own, parameters, estimate, task.fit, _report_iterations(at, report)
        )
        if estimate.outcome is Outcome.CANCELLED:
            raise Cancelled(estimate.message)
        experiments.append(replace(own[0], name=one.maneuvers[0].label))
        first.append(replace(parameters, start=estimate.values))
    candidates = first[0]

    def report_candidate(fitted: int, message: str) -> None:
        report(Progress(iteration=fitted, fraction=min(0.3 + 0.05 * fitted, 0.6), message=message))

    def search_from(begin: tuple[str, ...] | None) -> CandidateSearchResult:
        values = [one.start for one in first]
        return search_candidates(
            experiments, candidates, begin, task.thresholds, task.fit, report_candidate, values
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
        return summarise_selection(drawn, end, task.thresholds)

    stability = compute_selection_frequency(evidences, select_again, task.settings.resamplings)
    path = tuple(step for one in found.candidates for step in one.changed)
    group = build_term_group(
        task.method.value, replace(found.selection, path=path), evidences, stability
    )
    fitted = [
        FittedCandidate(
            name=f"{number}: {len(one.selected)} parameters",
            why=one.why,
            selected=one.selected,
            estimates=one.estimates,
            proposed=one is found.best,
            cost=one.cost,
            bic=one.bic,
            likelihood_ratio=None if number == 1 else one.likelihood_ratio,
            predicted_ratio=None if number == 1 else one.predicted_ratio,
        )
        for number, one in enumerate(found.candidates, start=1)
    ]
    return candidates, (group,), fitted


def compare_candidates(
    task: SearchTask,
    candidates: Parameters,
    fitted: Sequence[FittedCandidate],
    report: ReportProgress,
) -> tuple[SearchCandidate, ...]:
    """Cross-validate every candidate; smallest predictive cost first."""
    seen, unseen = _build_experiments(task, task.maneuvers), _build_experiments(task, task.unseen)
    derivatives = list_candidate_derivatives(candidates)
    found = []
    for number, one in enumerate(fitted):
        share = 0.8 + 0.2 * number / len(fitted)
        at = Progress(fraction=share, message=f"Predicting with {one.name}")
        report(at)
        predicted = cross_validate(
            seen, one.estimates, candidates, unseen, task.fit, _report_iterations(at, report)
        )
        speed, std, sentence = _predict_flutter(task, candidates, one)
        free = tuple(name for name in derivatives if name in one.selected)
        absent = tuple(name for name in derivatives if name not in free)
        found.append(
            SearchCandidate(
                name=one.name,
                why=one.why,
                structure=replace(
                    task.structure, free=free, absent=(*task.structure.absent, *absent)
                ),
                n_terms=len(free),
                proposed=one.proposed,
                converged=all(e.outcome is Outcome.CONVERGED for e in one.estimates),
                cost=one.cost,
                bic=one.bic,
                likelihood_ratio=one.likelihood_ratio,
                predicted_ratio=one.predicted_ratio,
                predicted=tuple(
                    ValidationFit(
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
        replace(
            build_experiments(one if one.method is method else replace(one, method=method))[0],
            name=one.maneuvers[0].label,
        )
        for one in maneuvers
    ]


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


def compute_search(task: SearchTask, report: ReportProgress) -> SearchResult:
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
        task = _remove_feedback_noise(task, report)
        begin = task.settings.initial_terms is InitialTerms.EQUATION_ERROR
        start = EquationSearch(task, report).found.selected if begin else None
        candidates, groups, fitted = search_by_likelihood(task, start, warnings, report)
    compared = compare_candidates(task, candidates, fitted, report)
    undecided = _find_objection(task, report)
    if undecided:
        compared = tuple(replace(one, proposed=False) for one in compared)
    return SearchResult(
        sentence=f"Not decided: {undecided}" if undecided else _summarise(task, candidates, fitted),
        groups=groups,
        candidates=compared,
        warnings=tuple(dict.fromkeys(warnings)),
        seconds=time.perf_counter() - began,
        undecided=undecided,
    )


def _find_objection(task: SearchTask, report: ReportProgress) -> str:
    """Return why the model that was searched is not that of runs or not adequate, else nothing.

    Terms that are dropped from such a model may be those that compensate its error.
    """
    run = task.default_run
    if run.nuisance is not None:
        modes = ", ".join(map(str, run.retained))
        return (
            f"runs of these maneuvers retain out-of-band modes ({modes}), which the model of this "
            "search omits. Open a candidate as a run to see what the data support."
        )
    at = Progress(fraction=0.95, message="Testing the model with all terms")
    report(at)
    try:
        found = compute_run(run, _report_at(at, report))
    except NotIdentifiable:  # what is not identifiable with all terms may be so with fewer
        return ""
    if found.adequacy.state is not AdequacyState.SUSPECT:
        return ""
    return f"the tests of a run reject the model with all terms. {found.adequacy.reason}"


def _remove_feedback_noise(task: SearchTask, report: ReportProgress) -> SearchTask:
    """Replace the data of each maneuver by those without noise by feedback, if it has any.

    All candidates fit the same data, from a fit with all terms.
    """

    def remove(one: EstimationTask) -> EstimationTask:
        at = Progress(message=f"Errors in variables of {one.maneuvers[0].label}")
        fit = fit_without_feedback_noise(one, _report_at(at, report))
        return one if fit is None else fit.task

    return replace(
        task,
        maneuvers=tuple(remove(one) for one in task.maneuvers),
        unseen=tuple(remove(one) for one in task.unseen),
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
