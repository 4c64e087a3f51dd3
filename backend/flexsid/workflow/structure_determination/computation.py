"""A search from its task, without a database, and comparison of its models."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from math import inf

import numpy as np

from flexsid.errors import FlexsidError, NotIdentifiable
from flexsid.records import finite_or_none
from flexsid.records.run import AdequacyState, Method, Progress, ReportProgress
from flexsid.records.search import (
    InitialTerms,
    SearchCandidate,
    SearchResult,
    TermGroup,
)
from flexsid.sysid.adequacy.validation import LEAST_DIFFERENCE
from flexsid.sysid.estimation.priors import build_information
from flexsid.sysid.stability.derivative_fusion import (
    DerivativePrior,
    IdentifiedModes,
    fuse_identified,
)
from flexsid.sysid.stability.flutter_prediction import predict_flutter
from flexsid.sysid.stability.poles import Aeroelastic
from flexsid.sysid.stability.root_errors import UncertainDerivatives
from flexsid.sysid.structure_determination.search import ValidationModel, cross_validate
from flexsid.sysid.structure_determination.term_search import TermSearch
from flexsid.workflow.fits.computation import ComputedRun
from flexsid.workflow.fits.estimation_task import (
    EstimationTask,
    get_first_start,
    select_free_parameters,
)
from flexsid.workflow.fits.likelihood_fit import build_experiments, build_fit_settings
from flexsid.workflow.structure_determination.term_search import (
    FittedModel,
    SearchTask,
    build_groups,
    build_search,
    fit_all_terms,
    fit_terms,
    get_whole_estimate,
    interpolate_progress,
    restrict_terms,
    select_models,
)

# --- Comparison of the models of a search: held-out data, adequacy and flutter speed --------------

_FLUTTER_BAND = (0.35, 2.0)  # of the fastest maneuver


def compare_models(
    task: SearchTask,
    search: TermSearch,
    full: FittedModel,
    fitted: Sequence[FittedModel],
    share: tuple[float, float],
    report: ReportProgress,
) -> list[SearchCandidate]:
    """Cross-validate every model; the candidates are in the order of the models."""
    method = Method.OE if task.method is Method.EE else task.method
    seen = [_build_validation_model(one, method) for one in task.maneuvers]
    unseen = [_build_validation_model(one, method) for one in task.unseen]
    n_data = [2.0 * sum(b.measured.size for b in run.estimate.lines) for run in full.runs]
    found = []
    for number, one in enumerate(fitted):
        fraction = interpolate_progress(share, number, len(fitted))
        at = Progress(fraction=fraction, message=f"Predicting with {one.name}")
        report(at)
        restricted = restrict_terms(task.maneuvers[0], full.runs[0], one.selected)
        # Halves are fitted with the shapes of the table: no run reports their errors.
        settings = build_fit_settings(replace(restricted, shape_errors={}))
        predicted = cross_validate(
            seen, one.estimates, unseen, settings, _report_iterations(at, report)
        )
        costs = [data.cost for data in predicted if data.cost is not None]
        speed, std, sentence = _predict_flutter(task, one)
        absent = tuple(name for name in full.selected if name not in one.selected)
        ratio = None
        if absent and one.cost is not None and full.cost is not None:
            ratio = 2.0 * (one.cost - full.cost)
        found.append(
            SearchCandidate(
                name=one.name,
                why=one.why,
                structure=replace(
                    task.structure,
                    free=one.selected,
                    absent=(*task.structure.absent, *absent),
                ),
                n_terms=len(one.selected),
                proposed=False,
                converged=one.converged,
                cost=one.cost,
                bic=None
                if one.cost is None
                else 2.0 * one.cost + len(one.selected) * float(np.log(n_data).sum()),
                likelihood_ratio=ratio,
                predicted_ratio=None if ratio is None else search.predict_ratio(one.selected),
                predicted=predicted,
                predictive_cost=sum(costs) if len(costs) == len(predicted) else None,
                flutter_m_s=speed,
                flutter_std_m_s=std,
                flutter=sentence,
                adequacy=one.adequacy.state,
                adequacy_reason=one.adequacy.reason,
            )
        )
    return found


def _build_validation_model(task: EstimationTask, method: Method) -> ValidationModel:
    """Build the data to predict; output error for a search by equation error."""
    experiment = build_experiments(task, method)[0]
    parameters = select_free_parameters(task, get_first_start(task), task.extras)
    return ValidationModel(replace(experiment, name=task.maneuvers[0].label), parameters)


def _report_iterations(at: Progress, report: ReportProgress) -> Callable[[int, float], None]:
    return lambda iteration, cost: report(replace(at, iteration=iteration, cost=cost))


def _predict_flutter(
    task: SearchTask, model: FittedModel
) -> tuple[float | None, float | None, str]:
    """Predict the flutter speed at the loading of the first maneuver: speed, error, sentence."""
    first = task.maneuvers[0]
    pairs = zip(task.maneuvers, model.runs, strict=True)
    try:
        parts = [_identify(one, run, model.selected) for one, run in pairs]
        fastest = max(one.model.condition.airspeed for one in task.maneuvers)
        found = predict_flutter(
            fuse_identified(parts, parts[0].aircraft) if len(parts) > 1 else parts[0],
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


def _identify(task: EstimationTask, run: ComputedRun, selected: Sequence[str]) -> IdentifiedModes:
    """Return the identified model of a run, the retained modes included."""
    estimate = get_whole_estimate(run)
    names = [name for name in estimate.names if name in {*selected, *task.nuisance_names}]
    own = estimate.select(names)
    every = select_free_parameters(task, get_first_start(task), ())
    place = [every.names.index(name) for name in names]
    values = run.held | dict(zip(names, own.values.tolist(), strict=True))
    prior = None
    if run.retained is not None:
        mean = np.array([run.retained.priors.get(name, (0.0, np.inf))[0] for name in names])
        precision = 2.0 * build_information(names, run.retained.priors)
        is_nuisance = np.array([name in task.nuisance_names for name in names])
        prior = DerivativePrior(mean, precision, is_nuisance)
    return IdentifiedModes(
        Aeroelastic(task.model.condition, task.model.modes, task.model.fill_table(values)),
        UncertainDerivatives(every.rows[place], every.columns[place], own.corrected_covariance),
        prior=prior,
    )


# --- Model structure determination from a task, without a database, in any process ----------------

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
    search = build_search(task, full, _select_initial_terms(task, report))
    selections = search.select_all(task.settings.algorithm.value)
    groups = build_groups(task, search, selections, (_RESAMPLE_FROM, _FIT_FROM), report)
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
    found = build_search(by_regression, full).select_all(task.settings.algorithm.value)
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
