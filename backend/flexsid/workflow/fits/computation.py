"""Estimators, one entry of a table for each method, and the computation of a run in any process.

A further one is a member of ``Method`` and an entry here, or a value that an installed package
declares in the entry points ``flexsid.estimators``, under the name of the method.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from flexsid.errors import BadInput
from flexsid.extensions import ESTIMATORS, ExtensionFailed, load_extensions, report_errors
from flexsid.records.run import (
    AdequacyState,
    Method,
    ModelAdequacy,
    Progress,
    Provenance,
    ReportProgress,
    Start,
    VarianceShares,
)
from flexsid.sysid.estimation.agreement import apply_priors
from flexsid.sysid.estimation.covariance import compute_input_noise_errors
from flexsid.sysid.estimation.end_states import (
    add_end_states,
    drop_end_states,
    has_end_states,
)
from flexsid.sysid.estimation.estimate import Estimate
from flexsid.sysid.estimation.experiment import Experiment, Parameters, find_parameters_at_limits
from flexsid.sysid.estimation.interpolation import compute_interpolation_bias
from flexsid.sysid.estimation.likelihood import maximize
from flexsid.sysid.estimation.multistart import PERTURBED_STARTS, SAME_COST, Optimum
from flexsid.sysid.estimation.weighted_fit import (
    compute_weighting_change,
    describe_common_noise,
    weight_by_noise_spectrum,
    widen_by_change,
)
from flexsid.sysid.model.longitudinal import LONGITUDINAL
from flexsid.sysid.stability.poles import NamedPole
from flexsid.workflow.fits.equation_error_fit import (
    collect_starting_points,
    fit_consistent_equation_error,
    list_sensor_warnings,
)
from flexsid.workflow.fits.estimation_task import (
    ComputedRetainedModes,
    EstimationTask,
    build_experiments,
    build_fit_settings,
    compute_poles,
    marginalise,
    read_versions,
    refit_until_consistent,
    select_free_parameters,
    select_moved_poles,
)
from flexsid.workflow.fits.likelihood_fit import (
    PROGRESS_BEFORE_WEIGHTING,
    CorrectedFit,
    fit_without_feedback_noise,
    maximize_task,
    refit,
    refit_with_interpolation_correction,
    refit_with_leakage_correction,
)
from flexsid.workflow.fits.model_adequacy import assess_model_adequacy, build_record_experiments
from flexsid.workflow.fits.named_cause import TestedFit, name_cause
from flexsid.workflow.fits.run_warnings import (
    list_result_warnings,
    warn_of_implausible_surfaces,
    warn_of_interpolation,
    warn_of_lag,
    warn_of_limits,
    warn_of_moved_poles,
    warn_of_poor_prediction,
    warn_of_priors,
    warn_of_reversed_surfaces,
)
from flexsid.workflow.fits.variance_budget import compute_variance_budget

# --- Estimators: one entry of a table for each method ---------------------------------------------

_INPUT_NOISE_SHARE = 0.1  # of the variance of the median parameter, that raises a warning
_PROGRESS_BEFORE_CAUSE = 0.98  # progress when a rejected model is fitted to corrected data
_STEP_ROUNDS = 2  # the second moves derivatives by the square of what the first does
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
class EstimatorFit:
    """Estimate of all parameters by one estimator.

    Attributes
    ----------
    task
        The task, with the spreads of its priors as they were estimated.
    parameters, estimate
        Free parameters of the model, and their estimate.
    start
        Description of the starting values.
    warnings
        Warnings for the analyst.
    adequacy, symmetry
        Tests for remaining model error and for asymmetry.
    """

    task: EstimationTask
    parameters: Parameters
    estimate: Estimate
    start: str
    warnings: tuple[str, ...]
    adequacy: ModelAdequacy
    symmetry: ModelAdequacy | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Estimator:
    """An estimator: its title, and the function that fits a task and reports progress.

    ``package`` is the package that adds it; empty for those of flexsid.
    """

    title: str
    fit: Callable[[EstimationTask, ReportProgress], EstimatorFit]
    package: str = ""


def find_estimator(method: Method) -> Estimator:
    """Find the estimator of a method.

    Raises
    ------
    BadInput
        If the package that adds it is not installed.
    ExtensionFailed
        If the package cannot be imported.
    """
    estimators = load_estimators()
    if method not in estimators:
        raise BadInput(
            f"there is no estimator '{method}'; estimators are {', '.join(estimators)}",
            code="unknown-method",
        )
    return estimators[method]


def get_title(method: Method) -> str:
    """Return the title of a method; its name if its package is no longer installed."""
    known = load_estimators().get(method)
    return method.value if known is None else known.title


@cache
def load_estimators() -> Mapping[str, Estimator]:
    """Load all estimators by method, first those of flexsid.

    Raises
    ------
    ExtensionFailed
        If a package cannot be imported, or its method exists already.
    """
    estimators = _BUILT_IN.copy()
    for name, package, added in load_extensions(ESTIMATORS, Estimator):
        if name in estimators:
            raise ExtensionFailed(
                f"the package {package} adds the method '{name}', which "
                f"{estimators[name].package or 'flexsid'} has already; rename it",
                package=package,
            )
        estimators[name] = replace(added, package=package)
    return estimators


def fit_regressions(task: EstimationTask, report: ReportProgress) -> EstimatorFit:
    """Estimate by equation error."""
    task, parameters, fit = fit_consistent_equation_error(task, report)
    start = "none needed"
    if fit.out_of_band:
        start += f"; modes {', '.join(map(str, fit.out_of_band))} reconstructed in addition"
    priors = task.list_priors()
    estimate = apply_priors(fit.estimate, {name: priors[name] for name in task.priors})
    task, parameters, estimate = _include_shape_errors(task, parameters, estimate, report)
    first = replace(parameters, start=estimate.values)
    adequacy, symmetry = assess_model_adequacy(task, (), parameters, estimate, first)
    warnings = list_sensor_warnings(task, fit)
    return EstimatorFit(task, parameters, estimate, start, warnings, adequacy, symmetry)


def _include_shape_errors(
    task: EstimationTask, parameters: Parameters, estimate: Estimate, report: ReportProgress
) -> tuple[EstimationTask, Parameters, Estimate]:
    """Include the errors of mode shapes, which equation error holds at zero, in its estimate.

    Their spread is that of output error with free shapes, from the estimate. Held, errors e change
    the other parameters by -N_tt^-1 N_te e = C_te C_ee^-1 e to first order, with its information N
    and covariance C = N^-1 at the estimate, where weights are from residuals that e adds to: so are
    those of equation error.
    """
    without = task.without_shape_errors()
    if not (task.shape_errors and estimate.outcome.is_optimum):
        return without, parameters, estimate
    names = tuple(task.shape_errors)
    free = select_free_parameters(task, parameters.table(estimate.values), names)
    experiments = build_record_experiments(task, parameters, estimate)
    begun = maximize(experiments, free, replace(build_fit_settings(task), max_iterations=0))
    held, found = begun.covariance, refit(task, experiments, free, begun, report)
    if not found.outcome.is_optimum:
        return without, parameters, estimate
    spread = task.estimate_spreads(found, task.shape_spread).shape_spread
    task = task.with_spreads(None, spread)
    std = np.array([task.list_priors()[name][1] for name in names])
    first = len(estimate.names)
    changes = np.linalg.solve(held[first:, first:], held[first:, :first]).T * std
    return task, free, estimate.append_held(names, std, changes)


def fit_likelihood(
    task: EstimationTask, report: ReportProgress, candidates: Mapping[str, Parameters] | None = None
) -> EstimatorFit:
    """Estimate by output error or frequency-response error.

    ``candidates`` are the start parameters by name, by default those of the task. Equation error,
    which takes several times as long as a maximisation, is a further start where the optimum from
    the prediction is rejected, not tested or has a pole that moved into the band.
    """
    waits = candidates is None and task.try_equation_error and bool(task.starts)
    waits = waits and task.settings.start is Start.BEST
    if candidates is None:
        candidates = collect_starting_points(task, report, with_equation_error=not waits)
    optimum = _find_optimum(task, report, candidates, 0 if waits else PERTURBED_STARTS)
    if not waits:
        return _complete_fit(task, optimum, candidates, report)
    fit, estimate = None, optimum.estimate
    if estimate.outcome.is_optimum:
        poles = compute_poles(task, optimum.parameters, estimate)
        fit = _complete_fit(task, optimum, candidates, report)
        is_consistent = fit.adequacy.state is AdequacyState.CONSISTENT
        if is_consistent and not select_moved_poles(task, poles):
            return fit
    candidates = collect_starting_points(task, report)
    further = _find_optimum(task, report, candidates, PERTURBED_STARTS, optimum)
    if fit is not None and fit.adequacy.state is not AdequacyState.NOT_TESTED:
        change = further.estimate.steps[-1].cost - estimate.steps[-1].cost
        if type(further) is type(optimum) and abs(change) < SAME_COST:
            return fit
    return _complete_fit(task, further, candidates, report)


@dataclass(frozen=True, slots=True)
class _LikelihoodOptimum(Optimum):
    """Optimum of the likelihood of one noise covariance, and the data that it is of."""

    experiments: list[Experiment]


def _find_optimum(
    task: EstimationTask,
    report: ReportProgress,
    candidates: Mapping[str, Parameters],
    n_perturbed: int,
    known: CorrectedFit | _LikelihoodOptimum | None = None,
) -> CorrectedFit | _LikelihoodOptimum:
    """Find the optimum from all starts, without the noise that feedback correlates if it can.

    ``known`` is the optimum from one of them.
    """
    fit = fit_without_feedback_noise(task, report, candidates)
    if fit is not None:
        return fit
    known = known if isinstance(known, _LikelihoodOptimum) else None
    experiments = build_experiments(task)
    candidates = {name: _add_ends(one, experiments) for name, one in candidates.items()}
    best = maximize_task(task, experiments, report, n_perturbed, candidates, known)
    return _LikelihoodOptimum(best.parameters, best.start, best.estimate, experiments)


def _complete_fit(
    task: EstimationTask,
    optimum: CorrectedFit | _LikelihoodOptimum,
    candidates: Mapping[str, Parameters],
    report: ReportProgress,
) -> EstimatorFit:
    """Complete a fit from its optimum; causes are named at the first start where there is none."""
    first = next(iter(candidates.values()))
    if isinstance(optimum, CorrectedFit):
        return _complete_corrected_fit(optimum, first)
    return complete_likelihood_fit(
        task,
        optimum.experiments,
        optimum.parameters,
        optimum.estimate,
        optimum.start,
        report,
        _add_ends(first, optimum.experiments),
    )


def _add_ends(parameters: Parameters, experiments: list[Experiment]) -> Parameters:
    """Free the states at the ends of records, where nothing else was assumed of them."""
    free = [one for one in experiments if one.free_ends]
    return add_end_states(parameters, free) if has_end_states(parameters, free) else parameters


def _complete_corrected_fit(fit: CorrectedFit, first: Parameters) -> EstimatorFit:
    task, parameters, estimate = fit.task, fit.parameters, fit.estimate
    warnings = _list_method_warnings(task, fit.experiments, parameters, estimate)
    adequacy, symmetry = assess_model_adequacy(task, fit.experiments, parameters, estimate, first)
    if estimate.noise is not None and not estimate.noise.converged:
        reason = _BIASED.format(change="did not converge", **_TURBULENCE)
        warnings = (*warnings, reason)
        if adequacy.state is not AdequacyState.SUSPECT:
            adequacy = replace(adequacy, state=AdequacyState.SUSPECT, reason=reason)
    return EstimatorFit(task, parameters, estimate, fit.start, warnings, adequacy, symmetry)


def complete_likelihood_fit(
    task: EstimationTask,
    experiments: list[Experiment],
    parameters: Parameters,
    estimate: Estimate,
    start: str,
    report: ReportProgress,
    first: Parameters,
) -> EstimatorFit:
    """Complete a fit of output error or frequency-response error from its optimum.

    The spreads of the priors, leakage, weights from the noise spectrum, and the tests for
    remaining model error, at the start ``first`` where there is no optimum.
    """

    def fit_again(task: EstimationTask, estimate: Estimate) -> Estimate:
        return refit(task, experiments, parameters, estimate, report)

    task, estimate = refit_until_consistent(task, estimate, fit_again)
    correct = refit_with_leakage_correction
    if task.method is Method.FRE:
        correct = refit_with_interpolation_correction
    corrected, estimate = correct(task, experiments, parameters, estimate, report)
    warnings = _list_method_warnings(task, corrected, parameters, estimate)
    settings = build_fit_settings(task)
    n_iterations = estimate.steps[-1].iteration

    def report_noise_spectrum(number: int) -> None:
        message = f"Weighting with noise spectrum {number}"
        report(
            Progress(iteration=n_iterations, fraction=PROGRESS_BEFORE_WEIGHTING, message=message)
        )

    weighted = weight_by_noise_spectrum(
        corrected, parameters, estimate, settings, report_noise_spectrum
    )
    adequacy, symmetry = assess_model_adequacy(task, corrected, parameters, weighted, first)
    noise, values = weighted.noise, weighted.values
    change = compute_weighting_change(estimate, weighted) if values is not estimate.values else 0.0
    is_suspect = adequacy.state is AdequacyState.SUSPECT
    if is_suspect and values is not estimate.values:
        # Residuals that are model error are no noise: weighted with them, a fit follows the
        # frequencies and outputs where the model is least wrong.
        weighted = replace(estimate, noise=describe_common_noise(corrected, settings))
        again, of_symmetry = assess_model_adequacy(task, corrected, parameters, weighted, first)
        if again.state is AdequacyState.SUSPECT:  # the sizes stated are about these values
            adequacy, symmetry = again, of_symmetry
    converged = noise is None or noise.converged
    if change > _MOST_CHANGE or not converged:
        found = f"moved the results by {change:.2g} standard errors"
        found = found if converged else f"did not converge and {found}"
        reason = _BIASED.format(change=found, **(_MODEL_ERROR if is_suspect else _TURBULENCE))
        weighted = widen_by_change(weighted, values - estimate.values)
        warnings = (*warnings, reason)
        if not is_suspect:
            adequacy = replace(adequacy, state=AdequacyState.SUSPECT, reason=reason)
    parameters = drop_end_states(parameters)
    weighted = weighted.select(parameters.names)
    return EstimatorFit(task, parameters, weighted, start, warnings, adequacy, symmetry)


def _list_method_warnings(
    task: EstimationTask,
    experiments: list[Experiment],
    parameters: Parameters,
    estimate: Estimate,
) -> tuple[str, ...]:
    """List the warnings of output error or frequency-response error alone."""
    if task.method is Method.OE:
        priors = task.list_priors()
        return tuple(_warn_of_input_noise(task, experiments, parameters, estimate, priors))
    if task.method is not Method.FRE:
        return ()
    measured = task.maneuvers[0].measured
    return warn_of_interpolation(
        compute_interpolation_bias(
            task.maneuvers, build_experiments(task), experiments, parameters, estimate.values
        ),
        compute_poles(task, parameters, estimate),
        measured.omega,
        measured.assigned_input,
    )


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


_BUILT_IN: dict[str, Estimator] = {
    Method.OE: Estimator(title="Output error", fit=fit_likelihood),
    Method.FRE: Estimator(title="Frequency-response error", fit=fit_likelihood),
    Method.EE: Estimator(title="Equation error", fit=fit_regressions),
}


# --- Computation of a run from its task, without a database, in any process -----------------------


@dataclass(frozen=True, slots=True)
class ComputedRun:
    """Result of an estimation.

    ``held`` are the derivatives that were not free, ``at_limit`` the parameters that converged
    to a physical limit, ``moved`` those that the named cause of a rejected model moves by more
    than their standard errors, which have none. ``versions`` is the software of the worker.
    ``modal_std`` are the standard deviations due to the modal table, ``condition_std`` those due
    to mass, inertia, airspeed and density, which the covariance does not include; ``shares`` those
    of the variances by their causes. ``shape_spread`` is that of mode shapes, None where it was not
    estimated, ``posterior`` the estimate of all parameters, with those that are no results.
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
    condition_std: dict[str, float]
    shares: dict[str, VarianceShares]
    shape_spread: float | None = None
    at_limit: tuple[str, ...] = ()
    moved: frozenset[str] = frozenset()
    retained: ComputedRetainedModes | None = None
    posterior: Estimate | None = None


def compute_run(task: EstimationTask, report: ReportProgress) -> ComputedRun:
    """Compute one estimation.

    Parameters
    ----------
    task
        Task from ``prepare``.
    report
        Called at every iteration; an exception that it raises (``Cancelled``) ends the run.

    Raises
    ------
    ExtensionFailed
        If the estimator of another package fails.
    """
    began = time.perf_counter()
    estimator = find_estimator(task.method)
    with report_errors(estimator.package):
        fit = _fit(estimator, task, report)
    moved: frozenset[str] = frozenset()
    if fit.adequacy.state is not AdequacyState.CONSISTENT and not estimator.package:
        fit, moved = _name_cause(estimator, task, fit, report)
    task, parameters, estimate = fit.task, fit.parameters, fit.estimate
    overlap = max(maneuver.measured.resolution_overlap for maneuver in task.maneuvers)
    estimate = estimate.scale_covariance(overlap)
    at_limit = find_parameters_at_limits(parameters, estimate.values)
    unknown = at_limit | np.array([name in moved for name in estimate.names])
    estimate = estimate.without_std_errors(None if not estimate.outcome.is_optimum else unknown)
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
    condition_std, shares = compute_variance_budget(task, parameters, estimate, overlap)
    retained = marginalise(task, estimate, shares)
    limited = {name for name, out in zip(estimate.names, at_limit, strict=True) if out}
    if retained is not None:
        warnings += warn_of_poor_prediction(task.spread)
        of_retained = set(task.mode_names[len(task.structure.modes) :])
        poles = tuple(pole for pole in poles if pole.name not in of_retained)
    passing = estimate.nuisance - task.marginalised  # states at the ends of records
    posterior = estimate.select([n for n in estimate.names if n not in passing])
    estimate = estimate.select([n for n in estimate.names if n not in estimate.nuisance])
    return ComputedRun(
        estimate=estimate,
        poles=poles,
        start=fit.start,
        warnings=(
            *warnings,
            *_warn_of_signs(task, estimate),
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
        moved=moved,
        seconds=time.perf_counter() - began,
        versions=read_versions(),
        provenance=task.provenance,
        adequacy=fit.adequacy,
        symmetry=fit.symmetry,
        modal_std=task.modal_std,
        condition_std=condition_std,
        shares=shares,
        shape_spread=task.shape_spread if task.assumed.intersection(task.extras) else None,
        posterior=posterior if np.isfinite(posterior.std_errors).all() else None,
    )


def _fit(estimator: Estimator, task: EstimationTask, report: ReportProgress) -> EstimatorFit:
    """Fit a task; where inputs move in steps, again with what samples of the outputs lack."""
    fit = estimator.fit(task, report)
    if not task.has_steps:
        return fit
    for _ in range(_STEP_ROUNDS):
        if not fit.estimate.outcome.is_optimum:
            break
        table = fit.parameters.table(fit.estimate.values)
        report(Progress(message="Fitting without the errors of samples between steps"))
        fit = estimator.fit(task.correct_steps(table), report)
    return fit


def _warn_of_signs(task: EstimationTask, estimate: Estimate) -> tuple[str, ...]:
    """Warn of surfaces whose derivatives contradict their prediction, or nature without one."""
    if task.predicted is not None:
        return warn_of_reversed_surfaces(estimate, task.predicted)
    is_longitudinal = task.model.body.axis == LONGITUDINAL.axis
    return warn_of_implausible_surfaces(
        estimate, task.model.inputs, is_longitudinal=is_longitudinal
    )


def _name_cause(
    estimator: Estimator, task: EstimationTask, fit: EstimatorFit, report: ReportProgress
) -> tuple[EstimatorFit, frozenset[str]]:
    """Name the cause of a rejected fit; return the fit with it and the parameters that it moves.

    Corrected data have their optimum near that of the data as recorded, which is a start in place
    of equation error.
    """
    if fit.estimate.outcome.is_optimum and task.starts:
        near = {"the fit without correction": fit.parameters.table(fit.estimate.values)}
        task = replace(task, starts={**task.starts, **near}, try_equation_error=False)

    def refit(corrected: EstimationTask) -> TestedFit:
        report(Progress(fraction=_PROGRESS_BEFORE_CAUSE, message="Searching for the cause"))
        found = _fit(estimator, corrected, lambda progress: None)
        return TestedFit(found.estimate, found.adequacy)

    adequacy, moved = name_cause(task, TestedFit(fit.estimate, fit.adequacy), refit)
    return replace(fit, adequacy=adequacy), moved
