"""Computation of a run from its task, without a database, in any process."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from flexsid.records.run import AdequacyState, Method, ModelAdequacy, Progress, Provenance
from flexsid.sysid.estimation.estimate import Estimate
from flexsid.sysid.estimation.experiment import Experiment
from flexsid.sysid.estimation.fusion import apply_priors
from flexsid.sysid.estimation.input_noise import compute_input_noise_errors
from flexsid.sysid.estimation.leakage import remove_leakage
from flexsid.sysid.estimation.limits import find_parameters_at_limits
from flexsid.sysid.estimation.parameters import Parameters
from flexsid.sysid.estimation.weighted_fit import (
    compute_weighting_change,
    describe_common_noise,
    weight_by_noise_spectrum,
    widen_by_change,
)
from flexsid.sysid.stability.poles import NamedPole
from flexsid.workflow.runs.equation_error_fit import fit_equation_error
from flexsid.workflow.runs.estimation_task import (
    EstimationTask,
    Report,
    compute_poles,
    get_first_start,
    select_free_parameters,
    select_moved_poles,
)
from flexsid.workflow.runs.likelihood_fit import (
    PROGRESS_BEFORE_WEIGHTING,
    build_experiments,
    build_fit_settings,
    compute_interpolation_bias,
    maximize_from_starts,
    refit_with_leakage_correction,
    refit_with_spread,
)
from flexsid.workflow.runs.model_adequacy import assess_model_adequacy
from flexsid.workflow.runs.nuisance_parameters import (
    ComputedRetainedModes,
    marginalise,
    refit_until_consistent,
)
from flexsid.workflow.runs.run_warnings import (
    list_result_warnings,
    warn_of_interpolation,
    warn_of_lag,
    warn_of_limits,
    warn_of_moved_poles,
    warn_of_poor_prediction,
    warn_of_priors,
    warn_of_reversed_surfaces,
)
from flexsid.workflow.runs.software_versions import read_versions

_INPUT_NOISE_SHARE = 0.1  # of the variance of the median parameter, that raises a warning
_MOST_CHANGE = 1.8  # by the weights, in standard errors; in Monte Carlo of still air up to 1.1
_BIASED = (
    "The fit weighted with the noise spectrum of the record {change}, so that values can be "
    "biased: {cause}. The standard errors include the change by the weights. {remedy}"
)
_TURBULENCE = {
    "cause": "feedback in turbulence correlates the inputs with the noise",
    "remedy": "Repeat the maneuver in still air or at a lower airspeed, or with a larger "
    "amplitude.",
}
_MODEL_ERROR = {
    "cause": "the residuals contain the model error that the tests of the run show, or feedback in "
    "turbulence correlates the inputs with the noise",
    "remedy": "Correct first what the tests indicate.",
}


@dataclass(frozen=True, slots=True)
class ComputedRun:
    """Result of an estimation.

    ``held`` are the derivatives that were not free, ``at_limit`` the parameters that converged
    to a physical limit, ``versions`` is the software of the worker. ``modal_std`` are the
    standard deviations due to the modal table, which the covariance does not include.
    """

    estimate: Estimate
    poles: tuple[NamedPole, ...]
    start: str
    warnings: tuple[str, ...]
    residualized: dict[str, float] | None
    prediction_id: int | None
    held: dict[str, float]
    seconds: float
    versions: dict[str, str]
    provenance: Provenance
    adequacy: ModelAdequacy
    symmetry: ModelAdequacy | None
    modal_std: dict[str, float]
    at_limit: tuple[str, ...] = ()
    retained: ComputedRetainedModes | None = None


@dataclass(frozen=True, slots=True)
class MethodFit:
    """Estimate of all parameters by one method, with the spread of the nuisance prior."""

    parameters: Parameters
    estimate: Estimate
    spread: float
    start: str
    warnings: tuple[str, ...]
    adequacy: ModelAdequacy
    symmetry: ModelAdequacy | None = None


def compute_run(task: EstimationTask, report: Report) -> ComputedRun:
    """Compute one estimation.

    Parameters
    ----------
    task
        Task from ``prepare``.
    report
        Called at every iteration; an exception that it raises (``Cancelled``) ends the run.
    """
    began = time.perf_counter()
    fit = (_fit_regressions if task.method is Method.EE else _fit_likelihood)(task, report)
    parameters, estimate, spread = fit.parameters, fit.estimate, fit.spread
    overlap = max(maneuver.measured.resolution_overlap for maneuver in task.maneuvers)
    estimate = estimate.scale_covariance(overlap)
    at_limit = find_parameters_at_limits(parameters, estimate.values)
    estimate = estimate.without_std_errors(None if not estimate.outcome.is_optimum else at_limit)
    poles = compute_poles(task, parameters, estimate)
    warnings = [
        *task.warnings,
        *fit.warnings,
        *warn_of_lag(fit.adequacy, task.settings),
        *warn_of_limits(estimate, at_limit),
        *warn_of_priors(estimate, task.priors),
        *warn_of_moved_poles(select_moved_poles(task, poles), task.max_omega),
    ]
    table = parameters.table(estimate.values).named()
    retained = marginalise(task, estimate, spread, overlap)
    limited = {name for name, out in zip(estimate.names, at_limit, strict=True) if out}
    if retained is not None:
        warnings += warn_of_poor_prediction(spread)
        estimate = estimate.select([n for n in estimate.names if n not in estimate.nuisance])
        of_retained = set(task.mode_names[len(task.structure.modes) :])
        poles = tuple(pole for pole in poles if pole.name not in of_retained)
    return ComputedRun(
        estimate=estimate,
        poles=poles,
        start=fit.start,
        warnings=(
            *warnings,
            *warn_of_reversed_surfaces(estimate, task.predicted),
            *list_result_warnings(estimate),
        ),
        residualized=task.residualized,
        prediction_id=task.prediction_id,
        held={
            name: value
            for name, value in table.items()
            if name not in estimate.names and name not in task.nuisance_names
        },
        retained=retained,
        at_limit=tuple(name for name in estimate.names if name in limited),
        seconds=time.perf_counter() - began,
        versions=read_versions(),
        provenance=task.provenance,
        adequacy=fit.adequacy,
        symmetry=fit.symmetry,
        modal_std=task.modal_std,
    )


def _fit_regressions(task: EstimationTask, report: Report) -> MethodFit:
    """Estimate by equation error."""
    report(Progress(message="Reconstructing motion from the sensors"))
    parameters = select_free_parameters(task, get_first_start(task), task.extras)
    fit = fit_equation_error(task, parameters)

    def refit(estimate: Estimate, spread: float) -> Estimate:
        nonlocal fit
        message = f"Reconstructing motion with a prior spread of {spread:.2g}"
        report(Progress(message=message))
        fit = fit_equation_error(task, replace(parameters, start=estimate.values), spread)
        return replace(fit.estimate, start=parameters.start)

    spread, estimate = refit_until_consistent(task, fit.estimate, refit)
    start = "none needed"
    if fit.out_of_band:
        start += f"; modes {', '.join(map(str, fit.out_of_band))} reconstructed in addition"
    estimate = apply_priors(estimate, task.priors)
    # The tests remove the errors of the estimate to first order, whatever the estimator.
    experiments = [
        remove_leakage(experiment, parameters, estimate.values)
        for experiment in build_experiments(task, Method.OE)
    ]
    adequacy, symmetry = assess_model_adequacy(task, experiments, parameters, estimate, spread)
    return MethodFit(parameters, estimate, spread, start, fit.warnings, adequacy, symmetry)


def _fit_likelihood(task: EstimationTask, report: Report) -> MethodFit:
    """Estimate by output error or frequency-response error."""
    experiments = build_experiments(task)
    parameters, start, estimate = maximize_from_starts(task, experiments, report)
    return complete_likelihood_fit(task, experiments, parameters, estimate, start, report)


def complete_likelihood_fit(
    task: EstimationTask,
    experiments: list[Experiment],
    parameters: Parameters,
    estimate: Estimate,
    start: str,
    report: Report,
) -> MethodFit:
    """Complete a fit of output error or frequency-response error from its optimum.

    The spread of the nuisance prior, leakage, weights from the noise spectrum, and the tests for
    remaining model error.
    """

    def refit(estimate: Estimate, spread: float) -> Estimate:
        return refit_with_spread(task, experiments, parameters, estimate, spread, report)

    spread, estimate = refit_until_consistent(task, estimate, refit)
    corrected, estimate = refit_with_leakage_correction(
        task, experiments, parameters, estimate, report, spread
    )
    warnings = ()
    if task.method is Method.OE:
        priors = task.list_priors(spread)
        warnings = tuple(_warn_of_input_noise(task, corrected, parameters, estimate, priors))
    elif task.method is Method.FRE:
        measured = task.maneuvers[0].measured
        warnings = warn_of_interpolation(
            compute_interpolation_bias(task, corrected, parameters, estimate.values),
            compute_poles(task, parameters, estimate),
            measured.omega,
            measured.assigned_input,
        )
    settings = build_fit_settings(task, spread)
    n_iterations = estimate.steps[-1].iteration

    def report_noise_spectrum(number: int) -> None:
        message = f"Weighting with noise spectrum {number}"
        report(
            Progress(iteration=n_iterations, fraction=PROGRESS_BEFORE_WEIGHTING, message=message)
        )

    weighted = weight_by_noise_spectrum(
        corrected, parameters, estimate, settings, report_noise_spectrum
    )
    adequacy, symmetry = assess_model_adequacy(task, corrected, parameters, weighted, spread)
    noise, values = weighted.noise, weighted.values
    change = compute_weighting_change(estimate, weighted) if values is not estimate.values else 0.0
    is_suspect = adequacy.state is AdequacyState.SUSPECT
    if is_suspect and values is not estimate.values:
        # Residuals that are model error are no noise: weighted with them, a fit follows the
        # frequencies and outputs where the model is least wrong.
        weighted = replace(estimate, noise=describe_common_noise(corrected, settings))
    converged = noise is None or noise.converged
    if change > _MOST_CHANGE or not converged:
        found = f"moved the results by {change:.2g} standard errors"
        found = found if converged else f"did not converge and {found}"
        reason = _BIASED.format(change=found, **(_MODEL_ERROR if is_suspect else _TURBULENCE))
        weighted = widen_by_change(weighted, values - estimate.values)
        warnings = (*warnings, reason)
        if not is_suspect:
            adequacy = replace(adequacy, state=AdequacyState.SUSPECT, reason=reason)
    return MethodFit(parameters, weighted, spread, start, warnings, adequacy, symmetry)


def _warn_of_input_noise(
    task: EstimationTask,
    experiments: list[Experiment],
    parameters: Parameters,
    estimate: Estimate,
    priors: Mapping[str, tuple[float, float]],
) -> list[str]:
    noise = task.maneuvers[0].measured.input_noise
    if noise is None or len(experiments) > 1:
        return []
    errors = compute_input_noise_errors(experiments[0], parameters, estimate, noise, priors)
    reported = [name not in estimate.nuisance for name in estimate.names]
    share = float(np.median((errors / estimate.std_errors)[reported] ** 2))
    if not share >= _INPUT_NOISE_SHARE:  # or no number, where there are no standard errors
        return []
    return [
        f"Noise on the measured surfaces contributes {min(share, 1.0):.0%} of the variance of the "
        "median parameter; the standard errors include it."
    ]
