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
from flexsid.sysid.estimation.weighted_fit import weight_by_noise_spectrum, widen_by_change

_APPROACH = 4  # iterations of maximum likelihood before the fit weighted with the noise spectrum
_MAX_ROUNDS = 8  # noise spectra in sequence: most records need 4 to 6; near flutter in turbulence
# many more, which the fits of the next seconds continue, since these must not wait
_FIRST_ERRORS_S = 5.0  # of a record without noise spectrum, before which a bias by turbulence
# cannot be noticed [s]


@dataclass(frozen=True, slots=True)
class GrowingStart:
    """Values from which the fits of a longer record start; no weighted ones without a spectrum."""

    plain: Float[np.ndarray, " n_theta"]
    weighted: Float[np.ndarray, " n_theta"] | None


@dataclass(frozen=True, slots=True)
class GrowingFit:
    """Derivatives from a part of a maneuver.

    ``experiment`` has the spectra without the free motion from the end states: those of a whole
    maneuver with the same inputs, from which equation error estimates the same derivatives.
    ``estimate`` is weighted with the noise spectrum, ``plain`` has one covariance of the noise;
    they are one value where the record has too few frequencies for a spectrum.
    """

    estimate: Estimate
    experiment: Experiment
    plain: Estimate

    @property
    def next_start(self) -> GrowingStart:
        """Where the fit of a longer record starts."""
        is_weighted = self.estimate is not self.plain
        return GrowingStart(self.plain.values, self.estimate.values if is_weighted else None)

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
    return np.arange(0, omega.size, max(1, round(_compute_resolution_overlap(omega, duration_s))))


def fit_growing_record(
    experiment: Experiment,
    parameters: Parameters,
    duration_s: float,
    priors: Mapping[str, tuple[float, float]] | None = None,
    before: GrowingStart | None = None,
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
    max_iterations
        Limit of the maximisation.

    Returns
    -------
    GrowingFit
        The derivatives; the end states are marginalised. No standard errors where the fit has not
        converged, or the record is too short to notice a bias by turbulence.

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

    Frequencies closer than 1/T share noise: as after the flight, variances are multiplied by the
    number of frequencies per 1/T.
    """
    whole = add_end_states(parameters, experiment)
    n_theta = len(parameters.names)
    settings = FitSettings(max_iterations=max_iterations, priors=priors)
    if before is not None:
        whole = replace(whole, start=np.append(before.plain, whole.start[n_theta:]))
    near = maximize([experiment], whole, replace(settings, max_iterations=_APPROACH))
    start = near.values
    if before is not None and before.weighted is not None:
        start = np.append(before.weighted, near.values[n_theta:])
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
        found = replace(found, outcome=Outcome.ITERATION_LIMIT)
    complete = remove_free_motion(experiment, replace(whole, start=found.values))
    overlap = max(1.0, _compute_resolution_overlap(experiment.omega, duration_s))
    estimate = found.select(parameters.names).scale_covariance(overlap)
    if not estimate.outcome.is_optimum or not (is_weighted or duration_s >= _FIRST_ERRORS_S):
        estimate = estimate.without_std_errors()
    plain = near.select(parameters.names).scale_covariance(overlap) if is_weighted else estimate
    return GrowingFit(estimate, complete, plain)


def _compute_resolution_overlap(omega: Float[np.ndarray, " n_omega"], duration_s: float) -> float:
    """Compute the number of frequencies per resolution 1/T of a record."""
    spacing_hz = float(np.median(np.diff(omega))) / (2.0 * np.pi)
    return 1.0 / (spacing_hz * duration_s)
