"""Quasi-steady against shaped derivatives: held-out frequencies, score tests and flutter."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool, Float

from flexsid.allowed import Id
from flexsid.records import finite_or_none
from flexsid.records.run import (
    AdequacyTest,
    Aerodynamics,
    EstimationRun,
    Method,
    ModelAdequacy,
    Progress,
    ReportProgress,
    Start,
)
from flexsid.records.validation import AerodynamicsComparison, AerodynamicsFit, AerodynamicsVerdict
from flexsid.storage.store import Store
from flexsid.sysid.adequacy.model_tests import Hypothesis
from flexsid.sysid.adequacy.validation import (
    LEAST_DIFFERENCE,
    LikelihoodDifference,
    assign_folds,
    compare_likelihoods,
    compute_held_out_likelihoods,
    predict_outputs,
)
from flexsid.sysid.estimation.estimate import Estimate
from flexsid.sysid.estimation.experiment import Parameters
from flexsid.sysid.estimation.feedback_noise import compute_costs
from flexsid.sysid.estimation.maneuver_data import estimate_maneuver_noise
from flexsid.sysid.stability.flutter_prediction import FlutterPrediction
from flexsid.workflow.aircraft.axes import find_body
from flexsid.workflow.aircraft.derivative_predictions import select_shaped_prediction
from flexsid.workflow.fits.computation import fit_likelihood
from flexsid.workflow.fits.equation_error_fit import collect_starting_points
from flexsid.workflow.fits.estimation_task import EstimationTask, build_experiments
from flexsid.workflow.fits.likelihood_fit import (
    fit_without_feedback_noise,
    maximize_task,
    refit_with_leakage_correction,
)
from flexsid.workflow.model_structures.model_structures import get_result
from flexsid.workflow.runs.estimation import prepare
from flexsid.workflow.runs.run_identity import list_run_contents
from flexsid.workflow.validation.cross_prediction import predict_flutter_of_fit
from flexsid.workflow.validation.cross_validation import select_frequencies

_FOLDS = 3  # every third frequency of each input is held out
_LEAST_HIGHEST_K = 0.2
"""Of the data. Flexible aircraft flutter at k = 0.15 to 0.3 (design notes of the project): a band
that ends below does not contain the lag that matters, however well it is resolved."""

_MODELS = (Aerodynamics.QUASI_STEADY, Aerodynamics.SHAPED)


@dataclass(frozen=True, slots=True, kw_only=True)
class AerodynamicsQuery:
    """A run whose data are fitted with both aerodynamic models."""

    run_id: Id


@dataclass(frozen=True, slots=True)
class _Fitted:
    """Fits of one aerodynamic model: log likelihoods held out, and the fit to all data."""

    held_out: np.ndarray
    estimate: Estimate
    adequacy: ModelAdequacy
    flutter: FlutterPrediction

    @property
    def lag(self) -> AdequacyTest | None:
        """The score test for a lag of the forces that the model does not have."""
        tests = self.adequacy.tests
        return next((t for t in tests if t.hypothesis == Hypothesis.AERODYNAMIC_LAG), None)

    @property
    def flutter_std(self) -> float | None:
        """Standard error of the flutter speed; None where the fit is no optimum. [m/s]"""
        if self.flutter.crossing is None or not self.estimate.outcome.is_optimum:
            return None
        return finite_or_none(self.flutter.airspeed_std)

    @property
    def passes(self) -> bool:
        """Whether the fit is an optimum that leaves no lag of the forces."""
        return self.estimate.outcome.is_optimum and not (self.lag and self.lag.rejects)


def identify_aerodynamics(store: Store, query: AerodynamicsQuery) -> tuple[object, ...]:
    """Check a query, and return all records on which its result depends.

    Raises
    ------
    BadInput
        If the aircraft has no prediction with a frequency shape for the run.
    UnknownRecord
        If the run does not exist.
    Conflict
        If the run has no result, or it was altered.
    """
    run = store.runs.get(query.run_id)
    get_result(run)
    structure, body = run.structure, find_body(run.structure.axis)
    aircraft_id = store.maneuvers.get(run.maneuver_id).aircraft_id
    shaped = _request(store, run, Aerodynamics.SHAPED).prediction_id
    select_shaped_prediction(
        store, aircraft_id, shaped, structure.modes, structure.inputs or (), body
    )
    return list_run_contents(store, (query.run_id,))


def compare_aerodynamics(
    store: Store, query: AerodynamicsQuery, report: ReportProgress
) -> AerodynamicsComparison:
    """Compare both aerodynamic models on the data of a run, see ``compare_tasks``.

    Raises
    ------
    BadInput
        If an input has fewer than three frequencies, or there is no frequency shape.
    """
    run = store.runs.get(query.run_id)
    quasi_steady, shaped = (prepare(store, _request(store, run, one)) for one in _MODELS)
    prediction = store.predictions.get(shaped.prediction_id or 0)
    found = compare_tasks(quasi_steady, shaped, prediction.source, report)
    return replace(found, run_id=query.run_id, prediction_id=prediction.id or 0)


def compare_tasks(
    quasi_steady_task: EstimationTask,
    shaped_task: EstimationTask,
    source: str,
    report: ReportProgress,
) -> AerodynamicsComparison:
    """Fit data with both aerodynamic models, and decide between them.

    Both are fitted by output error to two of three frequencies of each input; the likelihood
    of the others decides, since a shape has no more parameters than its absence.

    Parameters
    ----------
    quasi_steady_task, shaped_task
        Output-error tasks that differ in their aerodynamics only.
    source
        Of the frequency shape.
    report
        Called at every iteration; may raise to stop.

    Raises
    ------
    BadInput
        If an input has fewer than three frequencies.
    """
    tasks = dict(zip(_MODELS, (quasi_steady_task, shaped_task), strict=True))
    fits = {}
    for number, (aerodynamics, task) in enumerate(tasks.items()):

        def report_fit(progress: Progress, name: str = aerodynamics, done: int = number) -> None:
            share = (done + progress.fraction) / len(_MODELS)
            report(replace(progress, fraction=share, message=f"{name}: {progress.message}"))

        fits[aerodynamics] = _fit(task, report_fit)
    quasi_steady, shaped = (fits[one] for one in _MODELS)
    difference = compare_likelihoods(shaped.held_out, quasi_steady.held_out)
    highest_k = shaped_task.max_omega * shaped_task.model.condition.rate_factor
    verdict = _decide(difference, shaped, quasi_steady, highest_k)
    return AerodynamicsComparison(
        run_id=0,
        verdict=verdict,
        sentence=_describe(verdict, difference, shaped, quasi_steady, source, highest_k),
        source=source,
        prediction_id=0,
        n_frequencies=sum(block.omega.size for block in shaped.estimate.lines),
        n_held_out=difference.n_frequencies,
        highest_k=highest_k,
        difference=difference.value,
        difference_std=difference.std_error,
        fits=tuple(_summarise(one, fit) for one, fit in fits.items()),
    )


def _request(store: Store, run: EstimationRun, aerodynamics: Aerodynamics) -> EstimationRun:
    """Return the request of the run by output error with an aerodynamic model."""
    settings = replace(run.settings, aerodynamics=aerodynamics, start=Start.BEST, start_run_id=None)
    prediction_id = run.prediction_id
    if prediction_id is not None and store.predictions.get(prediction_id).unsteady is None:
        prediction_id = None if aerodynamics is Aerodynamics.SHAPED else prediction_id
    return replace(run, method=Method.OE, settings=settings, prediction_id=prediction_id)


def _fit(task: EstimationTask, report: ReportProgress) -> _Fitted:
    """Fit two of three frequencies, then all of them from there."""
    masks = [
        assign_folds(one.measurement.excited.assigned_input, _FOLDS) == 0
        for one in task.maneuver_tasks
    ]
    some = replace(
        task,
        maneuver_tasks=tuple(
            select_frequencies(one, ~mask)
            for one, mask in zip(task.maneuver_tasks, masks, strict=True)
        ),
    )
    report(Progress(message="fitting two of three frequencies"))
    parameters, values = _maximize(some, report)
    held_out = np.concatenate(_compute_held_out(task, masks, parameters, values))
    report(Progress(fraction=0.7, message="fitting all frequencies"))
    start = replace(parameters, start=values)
    fit = fit_likelihood(task, report, {"the fit to two of three frequencies": start})
    flutter = predict_flutter_of_fit(
        task, parameters, fit.estimate.values, fit.estimate.corrected_covariance
    )
    return _Fitted(held_out, fit.estimate, fit.adequacy, flutter)


def _maximize(
    task: EstimationTask, report: ReportProgress
) -> tuple[Parameters, Float[np.ndarray, " n_theta"]]:
    """Return the optimum without noise that feedback correlates, where the task has any."""
    candidates = collect_starting_points(task, report)
    corrected = fit_without_feedback_noise(task, report, candidates)
    if corrected is not None:
        return corrected.parameters, corrected.estimate.values
    experiments = build_experiments(task)
    # A model that does not fit the data often converges from no start: perturbed ones add little.
    best = maximize_task(task, experiments, report, n_perturbed=0, candidates=candidates)
    parameters = best.parameters
    _, estimate = refit_with_leakage_correction(
        task, experiments, parameters, best.estimate, report
    )
    return parameters, estimate.values


def _compute_held_out(
    task: EstimationTask,
    masks: Sequence[Bool[np.ndarray, " n_omega"]],
    parameters: Parameters,
    values: Float[np.ndarray, " n_theta"],
) -> list[Float[np.ndarray, " n_held_out"]]:
    """Compute the log likelihood of each held-out frequency of each maneuver.

    Where feedback correlates the noise of inputs and outputs, that of errors in variables: the
    residuals of output error near a sharp resonance are mostly response to noise of the inputs.
    """
    experiments = build_experiments(task)
    noise = estimate_maneuver_noise(task.maneuvers, experiments)
    if noise is not None:
        return [
            -compute_costs(one, own, parameters, values)[mask]
            for one, own, mask in zip(experiments, noise, masks, strict=True)
        ]
    spectra = [
        predict_outputs(one, parameters, values, mask)
        for one, mask in zip(experiments, masks, strict=True)
    ]
    return [
        compute_held_out_likelihoods(part.omega, part.measured - part.fitted, mask)
        for part, mask in zip(spectra, masks, strict=True)
    ]


def _decide(
    difference: LikelihoodDifference, shaped: _Fitted, quasi_steady: _Fitted, highest_k: float
) -> AerodynamicsVerdict:
    """Return the model of larger likelihood, if its fit passes and the band is sufficient."""
    likelier, verdict = quasi_steady, AerodynamicsVerdict.QUASI_STEADY
    if difference.value > 0.0:
        likelier, verdict = shaped, AerodynamicsVerdict.SHAPED
    is_sufficient = highest_k >= _LEAST_HIGHEST_K and likelier.passes
    return verdict if difference.is_decided and is_sufficient else AerodynamicsVerdict.NOT_DECIDED


def _summarise(aerodynamics: Aerodynamics, fit: _Fitted) -> AerodynamicsFit:
    lag, crossing = fit.lag, fit.flutter.crossing
    return AerodynamicsFit(
        aerodynamics=aerodynamics,
        outcome=fit.estimate.outcome.value,
        cost=fit.estimate.steps[-1].cost,
        held_out=float(fit.held_out.mean()),
        lag_p=None if lag is None else lag.p,
        lag_rejects=lag is not None and lag.rejects,
        smallest_r_squared=float(min(part.r_squared().min() for part in fit.estimate.lines)),
        flutter_m_s=None if crossing is None else crossing.airspeed,
        flutter_std_m_s=fit.flutter_std,
        flutter=fit.flutter.sentence,
    )


def _describe(
    verdict: AerodynamicsVerdict,
    difference: LikelihoodDifference,
    shaped: _Fitted,
    quasi_steady: _Fitted,
    source: str,
    highest_k: float,
) -> str:
    size = f"{abs(difference.value):.0f} ± {difference.std_error:.0f}"
    flutter = (
        f" Flutter: {_describe_speed(quasi_steady)} quasi-steady, {_describe_speed(shaped)} with "
        "the frequency shape."
    )
    for fit, name in ((quasi_steady, "quasi-steady"), (shaped, "shaped")):
        if not fit.estimate.outcome.is_optimum:
            flutter += f" The {name} fit did not converge: {fit.estimate.outcome}."
    if verdict is AerodynamicsVerdict.SHAPED:
        return (
            f"The forces lag the motion: with the frequency shape of {source} the log likelihood "
            f"of held-out frequencies is larger by {size}. Estimate a shaped model; quasi-steady "
            f"derivatives of these data are biased.{flutter}"
        )
    if verdict is AerodynamicsVerdict.QUASI_STEADY:
        return (
            f"No lag of the forces: quasi-steady derivatives have a log likelihood of held-out "
            f"frequencies that is larger by {size} than with the frequency shape of {source}."
            f"{flutter}"
        )
    if highest_k < _LEAST_HIGHEST_K:
        return (
            f"Not decided: the data reach k = {highest_k:.2f}, and the lag of flutter needs "
            f"{_LEAST_HIGHEST_K:g}. Excite higher frequencies, or fit a wider band.{flutter}"
        )
    if difference.is_decided:
        return (
            f"Not decided: log likelihoods of held-out frequencies differ by {size}, but the fit "
            "of the likelier model is no optimum, or leaves a lag of the forces that it does not "
            f"contain.{flutter}"
        )
    return (
        f"Not decided: log likelihoods of held-out frequencies differ by {size}, and a decision "
        f"needs {LEAST_DIFFERENCE:g} and three standard errors. Excite higher frequencies, or fit "
        f"a wider band.{flutter}"
    )


def _describe_speed(fit: _Fitted) -> str:
    crossing, std = fit.flutter.crossing, fit.flutter_std
    if crossing is None:
        return f"none up to {fit.flutter.locus.airspeed[-1]:.1f} m/s"
    interval = "" if std is None else f" ± {2.0 * std:.2f}"
    return f"{crossing.airspeed:.2f}{interval} m/s"
