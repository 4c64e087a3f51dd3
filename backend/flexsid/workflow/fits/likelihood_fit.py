"""Output-error and frequency-response-error fits of a task by maximum likelihood."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from flexsid.errors import Cancelled
from flexsid.records.run import Method, Progress, ReportProgress
from flexsid.sysid.estimation.end_states import list_end_state_names
from flexsid.sysid.estimation.estimate import Estimate, Outcome, count_iterations
from flexsid.sysid.estimation.experiment import Experiment, Parameters
from flexsid.sysid.estimation.feedback_noise import (
    CorrectedInputs,
    remove_feedback_noise,
)
from flexsid.sysid.estimation.interpolation import correct_interpolation, fit_without_interpolation
from flexsid.sysid.estimation.leakage import correct_leakage, join_histories
from flexsid.sysid.estimation.likelihood import maximize
from flexsid.sysid.estimation.maneuver_data import estimate_maneuver_noise
from flexsid.sysid.estimation.multistart import PERTURBED_STARTS, Optimum, maximize_from_starts
from flexsid.sysid.estimation.noise import NoiseSpectrum
from flexsid.sysid.estimation.weighted_fit import weight_by_noise_spectrum
from flexsid.workflow.fits.equation_error_fit import collect_starting_points
from flexsid.workflow.fits.estimation_task import (
    EstimationTask,
    build_experiments,
    build_fit_settings,
    compute_poles,
    refit_until_consistent,
    select_moved_poles,
)

# --- Output-error and frequency-response-error fits of a task by maximum likelihood ---------------

_PROGRESS_BEFORE_REFITS = 0.9  # progress when fits from perturbed starts or new priors remain
_PROGRESS_BEFORE_LEAKAGE = 0.95  # progress when the leakage correction and weighting remain
PROGRESS_BEFORE_WEIGHTING = 0.97
"""Progress when the fit weighted with the noise spectrum and the tests of the model remain."""


def maximize_task(
    task: EstimationTask,
    experiments: list[Experiment],
    report: ReportProgress,
    n_perturbed: int = PERTURBED_STARTS,
    candidates: Mapping[str, Parameters] | None = None,
    known: Optimum | None = None,
) -> Optimum:
    """Maximise the likelihood of a task from every start and return the best optimum.

    ``candidates`` are the start parameters by name, by default those of the task; ``known`` is
    where the maximisation from one of them ended.
    """
    if candidates is None:
        candidates = collect_starting_points(task, report)
    starts, settings = candidates, build_fit_settings(task)

    def report_iteration(name: str, number: int, iteration: int, cost: float) -> None:
        share = number / len(starts) if number < len(starts) else _PROGRESS_BEFORE_REFITS
        fraction = share + (1.0 - share) * iteration / settings.max_iterations / len(starts)
        message = f"Iteration {iteration} from {name}"
        report(Progress(iteration=iteration, cost=cost, fraction=fraction, message=message))

    def count_moved_poles(end: Optimum) -> int:
        return len(select_moved_poles(task, compute_poles(task, end.parameters, end.estimate)))

    best = maximize_from_starts(
        experiments, starts, settings, count_moved_poles, report_iteration, n_perturbed, known
    )
    nuisance = task.marginalised | frozenset(list_end_state_names(best.parameters))
    return replace(best, estimate=replace(best.estimate, nuisance=nuisance))


def refit(
    task: EstimationTask,
    experiments: list[Experiment],
    parameters: Parameters,
    estimate: Estimate,
    report: ReportProgress,
) -> Estimate:
    """Fit again from an estimate, with other data or other spreads of the priors.

    Raises
    ------
    Cancelled
        If ``report`` cancels the run.
    """
    begun = estimate.steps[-1].iteration

    def report_iteration(iteration: int, cost: float) -> None:
        report(
            Progress(
                iteration=begun + iteration,
                cost=cost,
                fraction=_PROGRESS_BEFORE_REFITS,
                message=f"Iteration {begun + iteration} with a prior spread of {task.spread:.2g}",
            )
        )

    again = maximize(
        experiments,
        replace(parameters, start=estimate.values),
        build_fit_settings(task),
        report_iteration,
    )
    if again.outcome is Outcome.CANCELLED:
        raise Cancelled(again.message)
    return replace(join_histories(estimate, again), nuisance=estimate.nuisance)


def refit_with_leakage_correction(
    task: EstimationTask,
    experiments: list[Experiment],
    parameters: Parameters,
    estimate: Estimate,
    report: ReportProgress,
) -> tuple[list[Experiment], Estimate]:
    """Correct for leakage and fit again until both converge.

    Raises
    ------
    Cancelled
        If ``report`` cancels the run.
    """

    def report_iteration(iteration: int, cost: float) -> None:
        message = f"Iteration {iteration}, correcting leakage"
        report(
            Progress(
                iteration=iteration, cost=cost, fraction=_PROGRESS_BEFORE_LEAKAGE, message=message
            )
        )

    corrected, again = correct_leakage(
        experiments, parameters, estimate, build_fit_settings(task), report_iteration
    )
    if again.outcome is Outcome.CANCELLED:
        raise Cancelled(again.message)
    return corrected, replace(again, nuisance=estimate.nuisance)


def refit_with_interpolation_correction(
    task: EstimationTask,
    experiments: list[Experiment],
    parameters: Parameters,
    estimate: Estimate,
    report: ReportProgress,
) -> tuple[list[Experiment], Estimate]:
    """Subtract the errors by interpolation and fit again, until both converge.

    Parameters
    ----------
    experiments
        Frequency-response error.
    estimate
        A finished fit; data and fit are unchanged where it is no optimum, where the bias is
        small, and where a further fit does not converge.

    Raises
    ------
    Cancelled
        If ``report`` cancels the run.
    """
    return fit_without_interpolation(
        task.maneuvers,
        build_experiments(task),
        experiments,
        parameters,
        estimate,
        lambda corrected, found: refit(task, corrected, parameters, found, report),
    )


# --- Fit of output error or frequency-response error without the noise that feedback correlates


@dataclass(frozen=True, slots=True)
class CorrectedFit:
    """A fit to corrected data: the task with these data, their noise, and the estimate."""

    task: EstimationTask
    experiments: list[Experiment]
    noise: tuple[NoiseSpectrum, ...]
    parameters: Parameters
    estimate: Estimate
    start: str


def fit_without_feedback_noise(
    task: EstimationTask, report: ReportProgress, candidates: Mapping[str, Parameters] | None = None
) -> CorrectedFit | None:
    """Fit with the inputs without their noise that feedback correlates with the outputs.

    Parameters
    ----------
    task
        Output error or frequency-response error.
    candidates
        Start parameters by name, by default those of the task; the first with which errors in
        variables converge is used.

    Returns
    -------
    CorrectedFit or None
        None where commands are not recorded, the noise of the inputs is too small for an effect,
        or no fit converges.

    Notes
    -----
    Errors in variables give inputs, outputs and the noise spectrum at its optimum, which is the
    estimate of output error. Frequency responses are computed from the corrected spectra and
    fitted from the same optimum, with weights from the spectrum of their own residuals.
    """
    experiments = build_experiments(task, Method.OE)
    noise = estimate_maneuver_noise(task.maneuvers, experiments)
    if noise is None:
        return None
    if candidates is None:
        candidates = collect_starting_points(task, report)

    def remove(task: EstimationTask, parameters: Parameters) -> CorrectedInputs | None:
        def report_iteration(number: int) -> None:
            report(Progress(message=f"Errors in variables, iteration {number}"))

        settings = build_fit_settings(task)
        return remove_feedback_noise(experiments, noise, parameters, settings, report_iteration)

    tried = ((name, one, remove(task, one)) for name, one in candidates.items())
    start, parameters, found = next(
        (each for each in tried if each[2] is not None), ("", None, None)
    )
    if parameters is None or found is None or not found.is_significant:
        return None

    def correct_again(task: EstimationTask, estimate: Estimate) -> Estimate:
        nonlocal found
        again = remove(task, replace(parameters, start=estimate.values))
        if again is None:
            return estimate
        found = again
        return _fit_corrected(task, found, parameters).estimate

    estimate = _fit_corrected(task, found, parameters).estimate
    task, _ = refit_until_consistent(task, estimate, correct_again)
    fit = _fit_corrected(task, found, parameters)
    return replace(fit, start=start)


def _fit_corrected(
    task: EstimationTask, found: CorrectedInputs, parameters: Parameters
) -> CorrectedFit:
    """Fit the corrected data with weights from their noise spectrum."""
    pairs = zip(task.maneuvers, found.experiments, strict=True)
    task = replace(task, corrected=tuple(data.replace_spectra(one) for data, one in pairs))
    experiments = build_experiments(task)
    if task.method is Method.FRE:
        experiments = correct_interpolation(task.maneuvers, experiments, parameters, found.theta)
    settings = build_fit_settings(task)
    at_optimum = replace(parameters, start=found.theta)
    base = maximize(experiments, at_optimum, replace(settings, max_iterations=0))
    base = replace(
        base,
        start=parameters.start,
        steps=found.steps,
        outcome=Outcome.CONVERGED,
        message=f"Converged in {count_iterations(found.steps[-1].iteration)}.",
        nuisance=task.marginalised,
    )
    known = found.noise if task.method is Method.OE else None
    estimate = weight_by_noise_spectrum(experiments, parameters, base, settings, known=known)
    if estimate.noise is not None:
        description = f"{estimate.noise.description}; {_describe_correction(task, found)}"
        noise = replace(estimate.noise, description=description)
        estimate = replace(estimate, noise=noise)
    return CorrectedFit(task, experiments, found.noise, parameters, estimate, "")


def _describe_correction(task: EstimationTask, found: CorrectedInputs) -> str:
    maneuver, number = np.unravel_index(int(found.share.argmax()), found.share.shape)
    name = task.maneuvers[int(maneuver)].model.inputs[int(number)]
    return (
        "inputs without the noise that feedback correlates with the outputs, up to "
        f"{found.share.max():.0%} of the rms of {name} (errors in variables)"
    )
