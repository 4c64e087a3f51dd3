"""Output error of a growing record: derivatives and their standard errors at any time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Complex, Float

from flexsid.sysid.estimation.end_states import add_end_states
from flexsid.sysid.estimation.estimate import Estimate, Outcome
from flexsid.sysid.estimation.experiment import Experiment, Parameters
from flexsid.sysid.estimation.feedback_noise import (
    ADDED_NOISE,
    has_feedback_noise,
    remove_feedback_noise,
)
from flexsid.sysid.estimation.flight_noise import estimate_joint_noise_of_part
from flexsid.sysid.estimation.leakage import subtract_free_motion
from flexsid.sysid.estimation.likelihood import FitSettings, maximize
from flexsid.sysid.estimation.noise import NoiseSpectrum
from flexsid.sysid.estimation.weighted_fit import weight_by_noise_spectrum, widen_by_change
from flexsid.sysid.spectra.measured_spectra import compute_resolution_overlap

_APPROACH = 4  # iterations of maximum likelihood before the fit weighted with the noise spectrum
_MAX_ROUNDS = 8  # noise spectra in sequence: most records need 4 to 6; a few alternate between two
_FIRST_ERRORS_S = 5.0  # of a record without noise spectrum, before which a bias by turbulence
# cannot be noticed [s]
_NOT_CORRECTED = (
    "turbulence moves the surfaces through the controller, or the model omits modes: the fit "
    "without noise of the surfaces does not converge, or its residuals exceed the noise"
)
_ALTERNATING = "the noise spectrum does not converge"
_TOO_SHORT = (
    f"a bias by turbulence cannot be noticed before {_FIRST_ERRORS_S:g} s of a record with so few "
    "frequencies"
)
_LARGEST_RESIDUALS = 6.0
"""Power of the residuals over that of the noise: 1.2 to 5.6 at the right optimum. A short record
averages the noise over a wide band; standard errors grow with the root of this power."""


@dataclass(frozen=True, slots=True)
class GrowingStart:
    """Values from which the fits of a longer record start; no weighted ones without a spectrum.

    ``is_corrected`` is whether the weighted ones are of data without noise by feedback.
    """

    plain: Float[np.ndarray, " n_theta"]
    weighted: Float[np.ndarray, " n_theta"] | None
    is_corrected: bool = False


@dataclass(frozen=True, slots=True)
class GrowingFit:
    """Derivatives from a part of a maneuver.

    ``experiment`` has the spectra without the free motion from the end states: those of a whole
    maneuver with the same inputs, from which equation error estimates the same derivatives.
    ``estimate`` is weighted with the noise spectrum, ``plain`` has one covariance of the noise;
    they are one value where the record has too few frequencies for a spectrum, and where noise by
    feedback was removed.
    """

    estimate: Estimate
    experiment: Experiment
    plain: Estimate
    next_start: GrowingStart

    def widen(self, change: float) -> Estimate:
        """Add the change by the weights that errors do not explain to the covariance.

        Parameters
        ----------
        change
            Of the quantity of interest, in standard errors of ``plain``.

        Notes
        -----
        Without bias its variance is at most 1 (Hausman, see ``compute_weighting_change``): of the
        square z**2, max(0, z**2 - 1) is that of a bias.
        """
        share = np.sqrt(max(0.0, 1.0 - 1.0 / max(change, 1e-9) ** 2))
        return widen_by_change(self.estimate, share * (self.estimate.values - self.plain.values))


def select_resolved_frequencies(
    omega: Float[np.ndarray, " n_omega"], duration_s: float
) -> np.ndarray:
    """Select frequencies about 1/T apart: closer ones of a short record are not independent.

    Parameters
    ----------
    omega
        Frequencies of equal spacing, in order. [rad/s]
    duration_s
        Length T of the record. [s]

    Returns
    -------
    array
        Their indices.
    """
    return np.arange(0, omega.size, round(compute_resolution_overlap(omega, duration_s)))


def fit_growing_record(
    experiment: Experiment,
    parameters: Parameters,
    duration_s: float,
    priors: Mapping[str, tuple[float, float]] | None = None,
    before: GrowingStart | None = None,
    commands: Complex[np.ndarray, "n_omega n_commands"] | None = None,
    max_iterations: int = 20,
) -> GrowingFit:
    """Estimate derivatives from a part of a maneuver that begins and ends in motion.

    Parameters
    ----------
    experiment
        Output error, with the times of the ends of its stretches.
    parameters
        Derivatives, with their starting values.
    duration_s
        Length of the record without its gaps. [s]
    priors
        Of derivatives: mean and standard deviation.
    before
        Values of a shorter part of the record, from which this fit continues.
    commands
        Spectra of all commands, by which noise that feedback brings to the inputs is removed.
    max_iterations
        Limit of the maximisation.

    Returns
    -------
    GrowingFit
        The derivatives; the end states are marginalised. No standard errors where the fit has not
        converged, or the record is too short to notice a bias by turbulence; the message of the
        estimate states why.

    Raises
    ------
    NotIdentifiable
        If there are more parameters than independent measured numbers.

    Notes
    -----
    A few iterations of maximum likelihood lead near the optimum. The fit weighted with the noise
    spectrum follows from there, or from the one of the shorter record: in turbulence the likelihood
    with one covariance of the noise has an optimum that is many times less precise and, near
    flutter, biased: ``GrowingFit.widen``. Where the record has too few frequencies for a noise
    spectrum, the optimum of the likelihood is the result.

    With ``commands`` the noise that feedback brings to the inputs is removed, see
    ``remove_feedback_noise``. Where that fails there are no standard errors; where the residuals
    exceed the noise, variances are multiplied by their power.

    Frequencies closer than 1/T share noise: as after the flight, variances are multiplied by the
    number of frequencies per 1/T.
    """
    first = add_end_states(parameters, [experiment])
    n_theta = len(parameters.names)
    settings = FitSettings(max_iterations=max_iterations, priors=priors)
    before = before or GrowingStart(parameters.start, None)
    whole = replace(first, start=np.append(before.plain, first.start[n_theta:]))
    near = maximize([experiment], whole, replace(settings, max_iterations=_APPROACH))
    start = near.values
    if before.weighted is not None:
        start = np.append(before.weighted, near.values[n_theta:])
    at = replace(whole, start=start)
    noise = None if commands is None else _estimate_feedback_noise(experiment, at, commands)
    corrected = None
    if noise is not None:
        schedules = [(at, (0.0,))] if before.is_corrected else []
        schedules += [(at, ADDED_NOISE), (first, ADDED_NOISE)]
        corrected = _fit_without_feedback_noise(experiment, noise, schedules, settings)
    data, is_weighted = experiment, True
    if corrected is not None:
        data, found = corrected
    elif noise is not None:
        found = replace(near, outcome=Outcome.ITERATION_LIMIT, message=_NOT_CORRECTED)
    else:
        found = weight_by_noise_spectrum(
            [experiment],
            whole,
            replace(near, outcome=Outcome.CONVERGED),
            settings,
            max_rounds=_MAX_ROUNDS,
            start=start,
        )
        is_weighted = found.values is not near.values
        if not is_weighted:
            found = maximize([experiment], replace(whole, start=near.values), settings)
        elif found.noise is not None and not found.noise.converged:
            found = replace(found, outcome=Outcome.ITERATION_LIMIT, message=_ALTERNATING)
        if not is_weighted and found.outcome.is_optimum and duration_s < _FIRST_ERRORS_S:
            found = replace(found, message=_TOO_SHORT)
    complete = subtract_free_motion(data, whole, found.values)
    overlap = compute_resolution_overlap(experiment.omega, duration_s)
    estimate = found.select(parameters.names).scale_covariance(overlap)
    if not estimate.outcome.is_optimum or not (is_weighted or duration_s >= _FIRST_ERRORS_S):
        estimate = estimate.without_std_errors()
    plain = estimate
    if is_weighted and noise is None:
        plain = near.select(parameters.names).scale_covariance(overlap)
    next_start = replace(before, plain=plain.values)
    if noise is None or corrected is not None:
        weighted = estimate.values if is_weighted else None
        next_start = GrowingStart(plain.values, weighted, corrected is not None)
    return GrowingFit(estimate, complete, plain, next_start)


def _estimate_feedback_noise(
    experiment: Experiment,
    parameters: Parameters,
    commands: Complex[np.ndarray, "n_omega n_commands"],
) -> NoiseSpectrum | None:
    """Estimate the joint noise of outputs and inputs; None without an effect on the inputs."""
    signals = np.concatenate([experiment.measured, experiment.inputs], axis=1)
    noise = estimate_joint_noise_of_part(experiment.omega, signals, commands, experiment.edges_s)
    if noise is None or not has_feedback_noise(experiment, noise, parameters):
        return None
    return noise


def _fit_without_feedback_noise(
    experiment: Experiment,
    noise: NoiseSpectrum,
    schedules: Sequence[tuple[Parameters, tuple[float, ...]]],
    settings: FitSettings,
) -> tuple[Experiment, Estimate] | None:
    """Fit by errors in variables, from the first start with which they converge; None from none."""
    for parameters, added_noise in schedules:
        found = remove_feedback_noise(
            [experiment],
            [noise],
            parameters,
            settings,
            added_noise=added_noise,
            largest_residuals=_LARGEST_RESIDUALS,
        )
        if found is not None:
            break
    else:
        return None
    at_optimum = replace(parameters, start=found.theta)
    corrected = list(found.experiments)
    base = maximize(corrected, at_optimum, replace(settings, max_iterations=0))
    base = replace(base, outcome=Outcome.CONVERGED)
    estimate = weight_by_noise_spectrum(corrected, at_optimum, base, settings, known=found.noise)
    return corrected[0], estimate.scale_covariance(max(1.0, found.residual_power))
