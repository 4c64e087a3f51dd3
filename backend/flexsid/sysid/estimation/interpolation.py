"""Errors of frequency responses by interpolation between the harmonics of one input.

Each input has its own harmonics: the responses to the others are interpolated there, which is
wrong where a resonance is narrower than their spacing.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from jaxtyping import Complex, Float

from flexsid.sysid.estimation.estimate import Estimate
from flexsid.sysid.estimation.experiment import Experiment, Parameters
from flexsid.sysid.estimation.frequency_domain_model import FrequencyDomainModel
from flexsid.sysid.estimation.maneuver_data import ManeuverData
from flexsid.sysid.signals import FrequencyData

_ROUNDS = 4  # corrections of frequency responses in sequence
_SMALL_BIAS = 0.1  # of a frequency response by interpolation, in standard deviations


def compute_interpolation_bias(
    maneuvers: Sequence[ManeuverData],
    measured: Sequence[Experiment],
    corrected: Sequence[Experiment],
    parameters: Parameters,
    theta: Float[np.ndarray, " n_theta"],
) -> float:
    """Compute the bias of frequency responses by interpolation that remains in the data.

    Parameters
    ----------
    maneuvers
        Data of the experiments.
    measured, corrected
        Frequency-response error as measured, and as fitted.
    parameters, theta
        The model.

    Returns
    -------
    float
        Largest of any output and input: rms over its harmonics, in standard deviations of the
        response. [1]
    """
    largest = 0.0
    errors = _compute_errors(maneuvers, measured, parameters, theta)
    for data, one, raw, error in zip(maneuvers, corrected, measured, errors, strict=True):
        left = one.measured - raw.measured + error
        for number, response in enumerate(data.measured.responses.values()):
            if response.std is not None and response.omega.size:
                relative = np.abs(left[one.group == number])
                relative /= np.maximum(response.std[..., 0], 1e-300)
                largest = max(largest, float(np.sqrt(np.mean(relative**2, axis=0)).max()))
    return largest


def correct_interpolation(
    maneuvers: Sequence[ManeuverData],
    experiments: Sequence[Experiment],
    parameters: Parameters,
    theta: Float[np.ndarray, " n_theta"],
) -> list[Experiment]:
    """Subtract the errors by interpolation that a model has from measured frequency responses."""
    errors = _compute_errors(maneuvers, experiments, parameters, theta)
    return [
        replace(one, measured=one.measured - error)
        for one, error in zip(experiments, errors, strict=True)
    ]


def fit_without_interpolation(
    maneuvers: Sequence[ManeuverData],
    measured: Sequence[Experiment],
    experiments: Sequence[Experiment],
    parameters: Parameters,
    estimate: Estimate,
    refit: Callable[[list[Experiment], Estimate], Estimate],
) -> tuple[list[Experiment], Estimate]:
    """Subtract the errors by interpolation and fit again, until both converge.

    Parameters
    ----------
    maneuvers
        Data of the experiments.
    measured, experiments
        Frequency-response error as measured, and as fitted.
    parameters, estimate
        A finished fit; data and fit are unchanged where it is no optimum, where the bias is
        small, and where a further fit does not converge.
    refit
        Fits corrected data from an estimate.
    """
    corrected, found = list(experiments), estimate
    for _ in range(_ROUNDS):
        if not found.outcome.is_optimum:
            return list(experiments), estimate
        bias = compute_interpolation_bias(maneuvers, measured, corrected, parameters, found.values)
        if not bias > _SMALL_BIAS:
            break
        corrected = correct_interpolation(maneuvers, experiments, parameters, found.values)
        found = refit(corrected, found)
    return corrected, found


def _compute_errors(
    maneuvers: Sequence[ManeuverData],
    experiments: Sequence[Experiment],
    parameters: Parameters,
    theta: Float[np.ndarray, " n_theta"],
) -> list[Complex[np.ndarray, "n_data n_y"]]:
    """Compute the errors of frequency responses by interpolation.

    Notes
    -----
    The modelled outputs of the recorded inputs pass through the estimation of responses as the
    measured ones do; what is estimated is compared with the modelled responses.
    """
    errors = []
    for data, experiment in zip(maneuvers, experiments, strict=True):
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
