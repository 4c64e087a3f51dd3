"""Output-error and frequency-response-error fits of a task by maximum likelihood."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
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
from flexsid.sysid.estimation.flight_noise import estimate_joint_noise, has_input_noise
from flexsid.sysid.estimation.frequency_domain_model import FrequencyDomainModel
from flexsid.sysid.estimation.leakage import correct_leakage, join_histories
from flexsid.sysid.estimation.likelihood import maximize
from flexsid.sysid.estimation.noise import NoiseSpectrum
from flexsid.sysid.estimation.weighted_fit import weight_by_noise_spectrum
from flexsid.sysid.signals import FrequencyData
from flexsid.workflow.fits.equation_error_fit import assign_commands, collect_starting_points
from flexsid.workflow.fits.estimation_task import (
    EstimationTask,
    ManeuverData,
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

_INTERPOLATION_ROUNDS = 4  # corrections of frequency responses in sequence
_SMALL_BIAS = 0.1  # of a frequency response by interpolation, in standard deviations
_PERTURBATION = 0.3  # of a start value, relative to it
PERTURBED_STARTS = 3
"""Perturbed starts at most, where no other start converged."""

SAME_COST = 1e-3
"""Optima whose costs differ by less are the same."""


def compute_interpolation_bias(
    task: EstimationTask,
    experiments: list[Experiment],
    parameters: Parameters,
    theta: np.ndarray,
) -> float:
    """Compute the bias of frequency responses by interpolation that remains in the data.

    Returns
    -------
    float
        Largest of any output and input: rms over its harmonics, in standard deviations of the
        response.
    """
    largest = 0.0
    as_measured = build_experiments(task)
    errors = _compute_interpolation_errors(task, as_measured, parameters, theta)
    for data, one, raw, error in zip(task.maneuvers, experiments, as_measured, errors, strict=True):
        left = one.measured - raw.measured + error
        for number, measured in enumerate(data.measured.responses.values()):
            if measured.std is not None and measured.omega.size:
                relative = np.abs(left[one.group == number])
                relative /= np.maximum(measured.std[..., 0], 1e-300)
                largest = max(largest, float(np.sqrt(np.mean(relative**2, axis=0)).max()))
    return largest


def _compute_interpolation_errors(
    task: EstimationTask,
    experiments: list[Experiment],
    parameters: Parameters,
    theta: np.ndarray,
) -> list[np.ndarray]:
    """Compute the errors of frequency responses by interpolation between harmonics of one input.

    Notes
    -----
    The modelled outputs of the recorded inputs pass through the estimation of responses as the
    measured ones do; what is estimated is compared with the modelled responses.
    """
    errors = []
    for data, experiment in zip(task.maneuvers, experiments, strict=True):
        error = np.zeros_like(experiment.measured)
        if experiment.source is not None:
            spectra = data.measured
            outputs = FrequencyDomainModel(experiment.source, parameters).respond(theta).outputs
            found = spectra.estimate_responses(
                FrequencyData(spectra.omega, outputs, spectra.outputs.names)
            )
            estimated = np.concatenate([one.values[..., 0] for one in found.values()])
            error = estimated - FrequencyDomainModel(experiment, parameters).respond(theta).outputs
        errors.append(error)
    return errors


def correct_interpolation(
    task: EstimationTask,
    experiments: list[Experiment],
    parameters: Parameters,
    theta: np.ndarray,
) -> list[Experiment]:
    """Subtract the errors by interpolation that a model has from measured frequency responses."""
    errors = _compute_interpolation_errors(task, experiments, parameters, theta)
    return [
        replace(one, measured=one.measured - error)
        for one, error in zip(experiments, errors, strict=True)
    ]


def maximize_from_starts(
    task: EstimationTask,
    experiments: list[Experiment],
    report: ReportProgress,
    n_perturbed: int = PERTURBED_STARTS,
    candidates: Mapping[str, Parameters] | None = None,
) -> tuple[Parameters, str, Estimate]:
    """Maximise the likelihood from every start and return the best optimum.

    At most ``n_perturbed`` perturbed starts follow where no start converged. ``candidates`` are
    the start parameters by name, by default those of the task.
    """
    if candidates is None:
        candidates = collect_starting_points(task, report)
    settings = build_fit_settings(task)
    limit = settings.max_iterations

    def attempt(
        name: str, parameters: Parameters, share: float
    ) -> tuple[Parameters, str, Estimate]:
        def report_iteration(iteration: int, cost: float) -> None:
            report(
                Progress(
                    iteration=iteration,
                    cost=cost,
                    fraction=share + (1.0 - share) * iteration / limit / len(candidates),
                    message=f"Iteration {iteration} from {name}",
                )
            )

        estimate = maximize(experiments, parameters, settings, report_iteration)
        if estimate.outcome is Outcome.CANCELLED:
            raise Cancelled(estimate.message)
        nuisance = task.marginalised | frozenset(list_end_state_names(parameters))
        return parameters, name, replace(estimate, nuisance=nuisance)

    ends = [
        attempt(name, parameters, number / len(candidates))
        for number, (name, parameters) in enumerate(candidates.items())
    ]
    best = _select_best(task, ends)
    for seed in range(n_perturbed):
        if best[2].outcome in (Outcome.CONVERGED, Outcome.SINGULAR_INFORMATION):
            break
        parameters, name, _ = best
        factors = 1.0 + _PERTURBATION * np.random.default_rng(seed).uniform(
            -1, 1, parameters.start.size
        )
        perturbed = replace(parameters, start=parameters.start * factors)
        name = f"{name.split(', perturbed')[0]}, perturbed"
        best = _select_best(task, [best, attempt(name, perturbed, _PROGRESS_BEFORE_REFITS)])
    return best


def _select_best(
    task: EstimationTask, ends: list[tuple[Parameters, str, Estimate]]
) -> tuple[Parameters, str, Estimate]:
    """Select the optimum of largest likelihood among those with fewest poles moved into the band.

    Of optima of equal likelihood, the first that converged.
    """
    moved = [len(select_moved_poles(task, compute_poles(task, end[0], end[2]))) for end in ends]
    ends = [end for end, n in zip(ends, moved, strict=True) if n == min(moved)]
    lowest = min(end[2].steps[-1].cost for end in ends)
    same = [end for end in ends if end[2].steps[-1].cost < lowest + SAME_COST]
    return min(same, key=lambda end: end[2].outcome is not Outcome.CONVERGED)


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
    corrected, found = experiments, estimate
    for _ in range(_INTERPOLATION_ROUNDS):
        if not found.outcome.is_optimum:
            return experiments, estimate
        bias = compute_interpolation_bias(task, corrected, parameters, found.values)
        if not bias > _SMALL_BIAS:
            break
        corrected = correct_interpolation(task, experiments, parameters, found.values)
        found = refit(task, corrected, parameters, found, report)
    return corrected, found


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
    noise = estimate_task_noise(task, experiments)
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


def estimate_task_noise(
    task: EstimationTask, experiments: Sequence[Experiment]
) -> list[NoiseSpectrum] | None:
    """Estimate the joint noise spectrum of outputs and inputs of each maneuver of a task.

    Parameters
    ----------
    experiments
        Output error of the maneuvers.

    Returns
    -------
    list of NoiseSpectrum or None
        None where commands are not recorded, or the inputs have too little noise for an effect.
    """
    commands = [assign_commands(data.measured) for data in task.maneuvers]
    known = [own for own in commands if own is not None]
    is_fine = any(data.measured.resolution_overlap > 1.0 for data in task.maneuvers)
    if len(known) < len(commands) or is_fine:
        return None
    pairs = list(zip(experiments, known, strict=True))
    if not any(has_input_noise(one.inputs, own) for one, own in pairs):
        return None
    joint = [
        estimate_joint_noise(one.omega, np.concatenate([one.measured, one.inputs], axis=1), own)
        for one, own in pairs
    ]
    noise = [own for own in joint if own is not None]
    return noise if len(noise) == len(joint) else None


def _fit_corrected(
    task: EstimationTask, found: CorrectedInputs, parameters: Parameters
) -> CorrectedFit:
    """Fit the corrected data with weights from their noise spectrum."""
    pairs = zip(task.maneuvers, found.experiments, strict=True)
    task = replace(task, corrected=tuple(_correct(*each) for each in pairs))
    experiments = build_experiments(task)
    if task.method is Method.FRE:
        experiments = correct_interpolation(task, experiments, parameters, found.theta)
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


def _correct(data: ManeuverData, experiment: Experiment) -> ManeuverData:
    """Replace the spectra of a maneuver by the corrected ones."""
    spectra, model = data.measured, experiment.model
    inputs = FrequencyData(spectra.omega, experiment.inputs, model.inputs)
    outputs = FrequencyData(spectra.omega, experiment.measured, model.outputs)
    excited = spectra.excited
    measured = replace(
        spectra,
        inputs=_replace_values(spectra.inputs, inputs),
        outputs=_replace_values(spectra.outputs, outputs),
        excited=replace(excited, inputs=_replace_values(excited.inputs, inputs)),
    )
    return replace(data, measured=measured)


def _replace_values(data: FrequencyData, new: FrequencyData) -> FrequencyData:
    """Replace the values of the signals that are in both."""
    values = data.values.copy()
    for number, name in enumerate(data.names):
        if name in new.names:
            values[:, number] = new.values[:, new.names.index(name)]
    return FrequencyData(data.omega, values, data.names)
