"""Comparison of the models of a search: held-out data, adequacy and flutter speed."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from flexsid.errors import FlexsidError
from flexsid.records import finite_or_none
from flexsid.records.run import Method, Progress, ReportProgress
from flexsid.records.search import SearchCandidate, ValidationFit
from flexsid.sysid.stability.derivative_fusion import (
    DerivativePrior,
    IdentifiedModes,
    fuse_identified,
)
from flexsid.sysid.stability.flutter_prediction import predict_flutter
from flexsid.sysid.stability.root_errors import UncertainDerivatives
from flexsid.sysid.stability.state_family import Aeroelastic
from flexsid.sysid.structure_determination.validation import ValidationModel, cross_validate
from flexsid.workflow.fits.computation import ComputedRun
from flexsid.workflow.fits.estimation_task import (
    EstimationTask,
    get_first_start,
    select_free_parameters,
)
from flexsid.workflow.fits.likelihood_fit import build_experiments, build_fit_settings
from flexsid.workflow.structure_determination.fitted_models import (
    FittedModel,
    SearchTask,
    get_whole_estimate,
    interpolate_progress,
    restrict_terms,
)
from flexsid.workflow.structure_determination.term_search import TermSearch

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
        settings = build_fit_settings(restrict_terms(task.maneuvers[0], full.runs[0], one.selected))
        predicted = cross_validate(
            seen, one.estimates, unseen, settings, _report_iterations(at, report)
        )
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
        known = [run.retained.priors.get(name, (0.0, np.inf)) for name in names]
        mean, std = np.array(known).T
        is_nuisance = np.array([name in task.nuisance_names for name in names])
        prior = DerivativePrior(mean, std**-2.0, is_nuisance)
    return IdentifiedModes(
        Aeroelastic(task.model.condition, task.model.modes, task.model.fill_table(values)),
        UncertainDerivatives(every.rows[place], every.columns[place], own.corrected_covariance),
        prior=prior,
    )
