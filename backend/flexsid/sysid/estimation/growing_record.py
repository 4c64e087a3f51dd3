"""Output error of a growing record: derivatives and their standard errors at any time."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from flexsid.sysid.estimation.end_states import add_end_states, remove_free_motion
from flexsid.sysid.estimation.estimate import Estimate, Outcome
from flexsid.sysid.estimation.experiment import Experiment
from flexsid.sysid.estimation.likelihood import FitSettings, maximize
from flexsid.sysid.estimation.parameters import Parameters
from flexsid.sysid.estimation.weighted_fit import weight_by_noise_spectrum

_APPROACH = 4  # iterations of maximum likelihood before the fit weighted with the noise spectrum
_MAX_ROUNDS = 8  # noise spectra in sequence: most records need 4 to 6, those that alternate between
# numbers of directions gain nothing by more, and the next second must not wait for them


@dataclass(frozen=True, slots=True)
class GrowingFit:
    """Derivatives from a part of a maneuver.

    ``experiment`` has the spectra without the free motion from the end states: those of a whole
    maneuver with the same inputs, from which equation error estimates the same derivatives.
    """

    estimate: Estimate
    experiment: Experiment


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
    return np.arange(0, omega.size, max(1, round(_compute_resolution_overlap(omega, duration_s))))


def fit_growing_record(
    experiment: Experiment,
    parameters: Parameters,
    duration_s: float,
    priors: Mapping[str, tuple[float, float]] | None = None,
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
    max_iterations
        Limit of the maximisation.

    Returns
    -------
    GrowingFit
        The derivatives; the end states are marginalised.

    Raises
    ------
    NotIdentifiable
        If there are more parameters than independent measured numbers.

    Notes
    -----
    A few iterations of maximum likelihood lead near the optimum. The fit weighted with the noise
    spectrum follows from there, as after the flight: in turbulence the likelihood with one
    covariance of the noise has an optimum that is many times less precise. Where the record
    has too few frequencies for a noise spectrum, that optimum is the result.

    Frequencies closer than 1/T share noise: as after the flight, variances are multiplied by the
    number of frequencies per 1/T.
    """
    whole = add_end_states(parameters, experiment)
    settings = FitSettings(max_iterations=max_iterations, priors=priors)
    near = maximize([experiment], whole, replace(settings, max_iterations=_APPROACH))
    found = weight_by_noise_spectrum(
        [experiment],
        whole,
        replace(near, outcome=Outcome.CONVERGED),
        settings,
        max_rounds=_MAX_ROUNDS,
    )
    if found.noise is None or not found.noise.converged or found.values is near.values:
        found = maximize([experiment], replace(whole, start=near.values), settings)
    complete = remove_free_motion(experiment, replace(whole, start=found.values))
    overlap = max(1.0, _compute_resolution_overlap(experiment.omega, duration_s))
    estimate = found.select(parameters.names).scale_covariance(overlap)
    if not estimate.outcome.is_optimum:
        estimate = estimate.without_std_errors()
    return GrowingFit(estimate, complete)


def _compute_resolution_overlap(omega: Float[np.ndarray, " n_omega"], duration_s: float) -> float:
    """Compute the number of frequencies per resolution 1/T of a record."""
    spacing_hz = float(np.median(np.diff(omega))) / (2.0 * np.pi)
    return 1.0 / (spacing_hz * duration_s)
