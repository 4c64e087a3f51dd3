"""The pure middle of a search for structure, fit for any process or machine."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from flexsid.errors import BadInput, FlexsidError, NotIdentifiable
from flexsid.records.model_structure import Structure
from flexsid.records.run import Method, Progress
from flexsid.records.search import (
    Algorithm,
    PredictedLines,
    SearchCandidate,
    SearchResult,
    SearchSettings,
    SearchStart,
    SearchStep,
    SearchTerm,
    TermDependency,
    TermGroup,
)
from flexsid.sysid.estimation.equation_error import equation_error
from flexsid.sysid.estimation.estimate import Estimate, Outcome
from flexsid.sysid.estimation.experiment import Experiment
from flexsid.sysid.estimation.likelihood import FitSettings
from flexsid.sysid.estimation.parameters import Parameters
from flexsid.sysid.estimation.record_edges import settle_edges
from flexsid.sysid.spectra.collinearity import near_dependencies
from flexsid.sysid.stability.bands import Uncertain
from flexsid.sysid.stability.prediction import Identified, predict_flutter, weighted_mean
from flexsid.sysid.stability.speeds import Aeroelastic
from flexsid.sysid.structure.candidates import Candidate, CandidatesFound, search_candidates
from flexsid.sysid.structure.equation import equation_evidence
from flexsid.sysid.structure.evidence import Evidence
from flexsid.sysid.structure.likelihood import reduced
from flexsid.sysid.structure.search import StructureFound, search_equations
from flexsid.sysid.structure.selection import (
    Selection,
    Step,
    Thresholds,
    Walk,
    selection_at,
    walk,
)
from flexsid.sysid.structure.stability import selection_frequency
from flexsid.sysid.structure.validation import cross_validate
from flexsid.workflow.computation import (
    Task,
    any_start,
    experiments_of,
    likeliest,
    motion_of,
    parameters_of,
)

Report = Callable[[Progress], None]
_FLUTTER_BAND = (0.35, 2.0)  # of the fastest maneuver


@dataclass(frozen=True, slots=True)
class SearchTask:
    """All that a worker needs: one task for each maneuver, and for each that is only predicted."""

    method: Method
    settings: SearchSettings
    structure: Structure
    maneuvers: tuple[Task, ...]
    unseen: tuple[Task, ...]
    warnings: tuple[str, ...]

    @property
    def thresholds(self) -> Thresholds:
        """What a term must show."""
        return thresholds_of(self.settings)


def thresholds_of(asked: SearchSettings) -> Thresholds:
    """What a term must show; refused where that makes no sense."""
    return Thresholds(f_in=asked.f_in, f_out=asked.f_out, pse_noise=asked.pse_noise)


@dataclass(frozen=True, slots=True, eq=False)
class _Fitted:
    """A structure with its values in every maneuver, and why it is there."""

    name: str
    why: str
    chosen: tuple[str, ...]
    estimates: tuple[Estimate, ...]
    proposed: bool
    cost: float | None = None
    bic: float | None = None
    likelihood_ratio: float | None = None
    foretold: float | None = None


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
    by_equations = task.method is Method.EE
    begin = task.settings.begin is SearchStart.EQUATION_ERROR
    equations: _Equations | None = None
    if by_equations or begin:
        equations = _Equations(task, report)
    if by_equations:
        assert equations is not None
        candidates, groups = equations.candidates[0], equations.groups(report)
        fitted = equations.fitted(warnings)
    else:
        start = None if equations is None else equations.found.chosen
        candidates, groups, fitted = _by_likelihood(task, start, warnings, report)
    ranked = _ranked(task, candidates, fitted, report)
    return SearchResult(
        sentence=_sentence(task, candidates, fitted),
        groups=groups,
        candidates=ranked,
        warnings=tuple(dict.fromkeys(warnings)),
        seconds=time.perf_counter() - began,
    )


class _Equations:
    """The search by equation error over all maneuvers."""

    def __init__(self, task: SearchTask, report: Report) -> None:
        self.task = task
        self.candidates: list[Parameters] = []
        self.evidences: list[dict[str, Evidence]] = []
        for number, one in enumerate(task.maneuvers):
            data = one.maneuvers[0]
            share = 0.4 * number / len(task.maneuvers)
            report(Progress(fraction=share, message=f"Reconstructing motion in {data.label}"))
            candidates = parameters_of(one, any_start(one), ())
            motion, _ = motion_of(data)
            found = equation_evidence(data.model, motion, data.measured.inputs, candidates)
            crowding = data.measured.crowding
            self.candidates.append(candidates)
            self.evidences.append({name: e.thinned(crowding) for name, e in found.items()})
        report(Progress(fraction=0.4, message="Choosing terms"))
        self.found = self._search(task.settings.algorithm)

    def _search(self, algorithm: Algorithm) -> StructureFound:
        return search_equations(self.evidences, algorithm.value, self.task.thresholds)

    def groups(self, report: Report) -> tuple[TermGroup, ...]:
        """What was found of every coefficient, and how stable the choice is."""
        groups, algorithm = [], self.task.settings.algorithm.value
        for number, (name, selection) in enumerate(self.found.coefficients.items()):
            share = 0.45 + 0.35 * number / len(self.found.coefficients)
            report(Progress(fraction=share, message=f"Drawing lines anew for {name}"))
            own = [one[name] for one in self.evidences]

            def again(drawn: Sequence[Evidence], name: str = name) -> Selection:
                one = [{name: each} for each in drawn]
                return search_equations(one, algorithm, self.task.thresholds).coefficients[name]

            often = selection_frequency(own, again, self.task.settings.draws)
            groups.append(_group(name, selection, own, often))
        return tuple(groups)

    def fitted(self, warnings: list[str]) -> list[_Fitted]:
        """All terms, and what either algorithm chose, each estimated by equation error."""
        other = next(one for one in Algorithm if one is not self.task.settings.algorithm)
        wanted = {
            self.task.settings.algorithm.value: self.found.chosen,
            other.value: self._search(other).chosen,
            "all terms": self.candidates[0].names,
        }
        kept: list[_Fitted] = []
        for name, chosen in wanted.items():
            same = next((one for one in kept if set(one.chosen) == set(chosen)), None)
            if same is not None:
                kept[kept.index(same)] = replace(same, name=f"{same.name}, {name}")
                continue
            try:
                estimates = tuple(self._estimate(one, chosen) for one in range(len(self.evidences)))
            except NotIdentifiable as reason:
                warnings.append(f"The structure of {name} has no estimate: {reason.message}.")
                continue
            why = "all candidates" if name == "all terms" else f"chosen by {name}"
            kept.append(_Fitted(name, why, chosen, estimates, proposed=not kept))
        if not kept:
            raise NotIdentifiable(
                "no structure can be estimated from these maneuvers; free fewer candidates",
                code="empty",
            )
        return kept

    def _estimate(self, number: int, chosen: tuple[str, ...]) -> Estimate:
        data = self.task.maneuvers[number].maneuvers[0]
        candidates = self.candidates[number]
        kept = np.array([name in chosen for name in candidates.names])
        if not kept.any():
            raise NotIdentifiable("nothing in the data asks for any of the candidates")
        parameters = reduced(candidates, kept, candidates.start)
        motion, _ = motion_of(data)
        found = equation_error(data.model, motion, data.measured.inputs, parameters)
        return found.widened(data.measured.crowding)


def _by_likelihood(
    task: SearchTask, start: tuple[str, ...] | None, warnings: list[str], report: Report
) -> tuple[Parameters, tuple[TermGroup, ...], list[_Fitted]]:
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
    group = _group(task.method.value, replace(found.selection, path=path), evidences, often)
    return (
        candidates,
        (group,),
        [
            _of_candidate(number, one, one is found.best)
            for number, one in enumerate(found.candidates)
        ],
    )


def _of_candidate(number: int, one: Candidate, proposed: bool) -> _Fitted:
    first = number == 0
    return _Fitted(
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


def _group(
    name: str, selection: Selection, evidences: Sequence[Evidence], often: np.ndarray
) -> TermGroup:
    total = np.sum([one.information for one in evidences], axis=0)
    size = np.sqrt(np.maximum(np.diag(total), np.finfo(float).tiny))
    unit = total / np.outer(size, size)
    inflation = np.diag(np.linalg.pinv(unit, rcond=1e-12, hermitian=True))
    inside = np.array([term.chosen for term in selection.terms])
    names = [term.name for term in selection.terms]
    chosen = [term.name for term in selection.terms if term.chosen]
    among = near_dependencies(total[np.ix_(inside, inside)], chosen) if inside.any() else ()
    before = near_dependencies(total, names)
    criteria = selection.criteria
    return TermGroup(
        name=name,
        path=tuple(_step(step) for step in selection.path),
        terms=tuple(
            SearchTerm(
                name=term.name,
                chosen=term.chosen,
                value=term.value if np.isfinite(term.std_error) else None,
                std_error=_finite(term.std_error),
                f=term.f,
                support=term.share,
                stability=_finite(share),
                inflation=float(grown) if 0.0 < grown < 1e8 else None,
            )
            for term, share, grown in zip(selection.terms, often, inflation, strict=True)
        ),
        dependencies=tuple(
            TermDependency(condition_index=one.index, shares=one.shares)
            for one in (*among, *(b for b in before if b not in among))
        ),
        r_squared=_finite(criteria.r_squared),
        pse=_finite(criteria.pse),
        bic=_finite(criteria.bic),
    )


def _step(step: Step) -> SearchStep:
    return SearchStep(
        action=step.action,
        term=step.term,
        f=step.f,
        n_terms=step.criteria.n_terms,
        r_squared=_finite(step.criteria.r_squared),
        pse=_finite(step.criteria.pse),
        bic=_finite(step.criteria.bic),
    )


def _ranked(
    task: SearchTask, candidates: Parameters, fitted: Sequence[_Fitted], report: Report
) -> tuple[SearchCandidate, ...]:
    """Every candidate with what it predicts, likeliest first."""
    seen, unseen = _lines(task, task.maneuvers), _lines(task, task.unseen)
    settings = FitSettings(max_iterations=task.settings.max_iterations, noise=task.settings.noise)
    ranked = []
    for number, one in enumerate(fitted):
        share = 0.8 + 0.2 * number / len(fitted)
        report(Progress(fraction=share, message=f"Predicting with {one.name}"))
        predicted = cross_validate(seen, one.estimates, candidates, unseen, settings)
        speed, std, sentence = _flutter(task, candidates, one)
        ranked.append(
            SearchCandidate(
                name=one.name,
                why=one.why,
                structure=structure_with(task.structure, candidates, one.chosen),
                n_terms=sum(name in one.chosen for name in candidates.names[: _n(candidates)]),
                proposed=one.proposed,
                converged=all(e.outcome is Outcome.CONVERGED for e in one.estimates),
                cost=one.cost,
                bic=one.bic,
                likelihood_ratio=one.likelihood_ratio,
                foretold=one.foretold,
                predicted=tuple(
                    PredictedLines(
                        name=p.name, cost=_finite(p.cost), r_squared=_finite(p.r_squared)
                    )
                    for p in predicted
                ),
                predictive_cost=_finite(sum(p.cost for p in predicted)),
                flutter_m_s=speed,
                flutter_std_m_s=std,
                flutter=sentence,
            )
        )
    return tuple(
        sorted(ranked, key=lambda c: np.inf if c.predictive_cost is None else c.predictive_cost)
    )


def _lines(task: SearchTask, maneuvers: Sequence[Task]) -> list[Experiment]:
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
    derivatives = candidates.names[: _n(candidates)]
    absent = tuple(name for name in derivatives if name not in chosen)
    return replace(
        structure,
        free=tuple(name for name in derivatives if name in chosen),
        absent=(*structure.absent, *absent),
    )


def _n(candidates: Parameters) -> int:
    return candidates.rows.size


def _flutter(
    task: SearchTask, candidates: Parameters, one: _Fitted
) -> tuple[float | None, float | None, str]:
    """Flutter speed at the loading of the first maneuver, its standard error, and in words."""
    first = task.maneuvers[0]
    n = _n(candidates)
    names = candidates.names[:n]
    inside = [name for name in names if name in one.chosen]
    where = [one.estimates[0].names.index(name) for name in inside]
    try:
        values = np.stack([e.values[where] for e in one.estimates])
        covariances = [e.corrected_covariance[np.ix_(where, where)] for e in one.estimates]
        mean, covariance = weighted_mean(values, covariances)
        theta = np.zeros(len(candidates.names))
        kept = np.array([name in inside for name in names])
        theta[:n][kept] = mean
        fastest = max(t.model.condition.airspeed for t in task.maneuvers)
        found = predict_flutter(
            Identified(
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
    return found.crossing.airspeed, _finite(found.airspeed_std), found.sentence


def _sentence(task: SearchTask, candidates: Parameters, fitted: Sequence[_Fitted]) -> str:
    best = next(one for one in fitted if one.proposed)
    derivatives = candidates.names[: _n(candidates)]
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


def _finite(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None


def check_same_candidates(tasks: Sequence[Task]) -> None:
    """Refuse maneuvers that cannot share one structure.

    Raises
    ------
    BadInput
        Naming the maneuver whose inputs or modes differ.
    """
    first = tasks[0].model
    for other in tasks[1:]:
        same = (other.model.inputs, other.model.modes.numbers) == (
            first.inputs,
            first.modes.numbers,
        )
        if not same:
            raise BadInput(
                f"{other.maneuvers[0].label} has inputs {', '.join(other.model.inputs)}, "
                f"{tasks[0].maneuvers[0].label} has {', '.join(first.inputs)}; name the inputs "
                "of the structure, or search over maneuvers with the same ones",
                code="other-candidates",
            )
