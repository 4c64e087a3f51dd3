"""Fit of output error or frequency-response error without the noise that feedback correlates."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from flexsid.records.run import Method, Progress, ReportProgress
from flexsid.sysid.estimation.estimate import Estimate, Outcome, count_iterations
from flexsid.sysid.estimation.experiment import Experiment
from flexsid.sysid.estimation.feedback_noise import (
    CorrectedInputs,
    remove_feedback_noise,
)
from flexsid.sysid.estimation.joint_noise import estimate_joint_noise, has_input_noise
from flexsid.sysid.estimation.likelihood import maximize
from flexsid.sysid.estimation.noise_spectrum import NoiseSpectrum
from flexsid.sysid.estimation.parameters import Parameters
from flexsid.sysid.estimation.weighted_fit import weight_by_noise_spectrum
from flexsid.sysid.signals import FrequencyData
from flexsid.workflow.fits.equation_error_fit import assign_commands
from flexsid.workflow.fits.estimation_task import EstimationTask, ManeuverData
from flexsid.workflow.fits.experiments import build_experiments, build_fit_settings
from flexsid.workflow.fits.likelihood_fit import correct_interpolation
from flexsid.workflow.fits.nuisance_parameters import refit_until_consistent
from flexsid.workflow.fits.starting_values import collect_starting_points


@dataclass(frozen=True, slots=True)
class CorrectedFit:
    """A fit to corrected data: the task with these data, their noise, and the estimate."""

    task: EstimationTask
    experiments: list[Experiment]
    noise: tuple[NoiseSpectrum, ...]
    parameters: Parameters
    estimate: Estimate
    spread: float
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

    def remove(parameters: Parameters, spread: float) -> CorrectedInputs | None:
        def report_iteration(number: int) -> None:
            report(Progress(message=f"Errors in variables, iteration {number}"))

        settings = build_fit_settings(task, spread)
        return remove_feedback_noise(experiments, noise, parameters, settings, report_iteration)

    tried = ((name, one, remove(one, task.spread)) for name, one in candidates.items())
    start, parameters, found = next(
        (each for each in tried if each[2] is not None), ("", None, None)
    )
    if parameters is None or found is None or not found.is_significant:
        return None

    def refit(estimate: Estimate, spread: float) -> Estimate:
        nonlocal found
        again = remove(replace(parameters, start=estimate.values), spread)
        if again is None:
            return estimate
        found = again
        return _fit_corrected(task, found, parameters, spread).estimate

    estimate = _fit_corrected(task, found, parameters, task.spread).estimate
    spread, _ = refit_until_consistent(task, estimate, refit)
    fit = _fit_corrected(task, found, parameters, spread)
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
    task: EstimationTask, found: CorrectedInputs, parameters: Parameters, spread: float
) -> CorrectedFit:
    """Fit the corrected data with weights from their noise spectrum."""
    pairs = zip(task.maneuvers, found.experiments, strict=True)
    task = replace(task, corrected=tuple(_correct(*each) for each in pairs))
    experiments = build_experiments(task)
    if task.method is Method.FRE:
        experiments = correct_interpolation(task, experiments, parameters, found.theta)
    settings = build_fit_settings(task, spread)
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
    return CorrectedFit(task, experiments, found.noise, parameters, estimate, spread, "")


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
