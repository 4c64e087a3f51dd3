"""Fit weighted with the noise spectrum of the record: turbulence costs precision, not bias.

The likelihood of ``likelihood`` has one noise covariance for all frequencies. In turbulence the
noise depends on frequency and is common to all outputs: from the optimum of the likelihood the
parameters are estimated again, with the inverse spectral matrix of the noise as weights.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from flexsid.sysid.estimation.covariance import FinalSpectra, compute_bound, compute_covariance
from flexsid.sysid.estimation.end_states import STATE
from flexsid.sysid.estimation.estimate import Estimate, NoiseEstimate, Outcome
from flexsid.sysid.estimation.experiment import Experiment, Parameters
from flexsid.sysid.estimation.frequency_domain_model import FrequencyDomainModel
from flexsid.sysid.estimation.kronecker import NormalForm
from flexsid.sysid.estimation.likelihood import (
    FitSettings,
    build_prior,
    count_effective_parameters,
)
from flexsid.sysid.estimation.linear_algebra import compute_bounds
from flexsid.sysid.estimation.noise import NoiseSpectrum, SpectralMatrix, estimate_noise_spectrum

_COVERED = 0.9  # share of the source's frequencies between the outermost ones that have a
# response; less: inputs are omitted
ROUNDS = 20  # noise spectra in sequence
_STEPS = 3  # of Gauss-Newton with one noise spectrum, at most
_SMALL = 0.02  # change by a step, in standard errors, after which no other follows: the next one
# is of its square, and another noise spectrum changes more
_CONVERGED = 0.05  # largest change of a result by a round, in standard errors
_SETTLED = 0.3  # the same after the last round: the number of directions may alternate
_ROUNDING = 1e-6  # of a parameter


@dataclass(frozen=True, slots=True)
class _Weighted:
    """Model of one maneuver, and that of the data points whose noise it shares."""

    form: NormalForm
    source: FrequencyDomainModel

    def estimate_noise(
        self, theta: Float[np.ndarray, " n_theta"], known: NoiseSpectrum | None
    ) -> tuple[NoiseSpectrum, SpectralMatrix] | None:
        """Estimate the noise spectrum at the parameters, and the weights of the data points.

        A known noise spectrum of the source is not estimated.

        Notes
        -----
        Frequency responses share the noise of the outputs that they were computed from: that
        of data point k is sum_m |gain_km|^2 times the spectral matrix at its frequency.
        """
        source, own = self.source.experiment, self.form.model.experiment
        is_common = (source.omega >= own.omega.min()) & (source.omega <= own.omega.max())
        if own.omega.size < _COVERED * np.count_nonzero(is_common):
            return None  # inputs outside the model move the outputs of the source
        found = known
        if found is None:
            residuals = source.measured - self.source.respond(theta).outputs
            found = estimate_noise_spectrum(residuals)
        if found is None:
            return None
        weights = found.density.inverse()
        if own.gain is None:
            return found, weights
        variance = np.sum(np.abs(own.gain) ** 2, axis=1)
        middles = 0.5 * (source.omega[1:] + source.omega[:-1])
        at = weights.block[np.searchsorted(middles, own.omega)]
        blocks = weights.blocks[at] / variance[:, None, None]
        return found, SpectralMatrix(blocks, np.arange(own.omega.size))


def weight_by_noise_spectrum(
    experiments: Sequence[Experiment],
    parameters: Parameters,
    estimate: Estimate,
    settings: FitSettings,
    report: Callable[[int], None] = lambda iteration: None,
    max_rounds: int = ROUNDS,
    start: Float[np.ndarray, " n_theta"] | None = None,
    known: Sequence[NoiseSpectrum] | None = None,
) -> Estimate:
    """Estimate again with weights from the noise spectrum of each maneuver.

    Parameters
    ----------
    experiments, parameters, estimate, settings
        A finished fit.
    report
        Called with the number of each noise spectrum, from 1; an exception ends the fit.
    max_rounds
        Largest number of noise spectra in sequence.
    start
        Where to start; by default at the estimate.
    known
        Noise spectrum of each maneuver, or of the data points from which its own were computed;
        by default estimated from the residuals.

    Returns
    -------
    Estimate
        Values and covariance of the weighted fit, and the noise estimate that was used. The
        given one, with the noise estimate behind it, where it has not converged, the record
        has too few frequencies for a noise spectrum, or the weighted fit fails. Where the
        weighted fit does not converge, ``noise.converged`` is False.

    Notes
    -----
    Solves Re sum J^H W nu = 0 by Gauss-Newton with W = S^-1 held, S at every segment of
    frequencies from its neighbours without itself, and repeats it with the S of the solution.
    W is independent of nu at the same frequency, so that the solution is consistent for any
    W. Covariance: the sandwich of ``covariance`` with the residuals of each segment, on which
    its weights do not depend. Feedback correlates the measured inputs with turbulence; the
    weights remove most of it, but near flutter a bias of some standard errors remains, unless
    the inputs are those of ``feedback_noise``.
    """
    used = describe_common_noise(experiments, settings)
    fallback = replace(estimate, noise=used)
    failed = replace(estimate, noise=replace(used, converged=False))
    change = np.inf
    if estimate.outcome is not Outcome.CONVERGED:
        return fallback
    maneuvers = [_prepare(e, parameters) for e in experiments]
    spectra: list[tuple[NoiseSpectrum, SpectralMatrix]] = []
    mean, prior = build_prior(parameters, settings.priors)
    theta = estimate.values if start is None else start
    is_result = np.array(
        [True] * parameters.rows.size + [e.kind != STATE for e in parameters.extras]
    )
    for number in range(1, max_rounds + 1):
        report(number)
        try:
            pairs = zip(maneuvers, known or [None] * len(maneuvers), strict=True)
            noises = [one.estimate_noise(theta, spectrum) for one, spectrum in pairs]
        except np.linalg.LinAlgError:  # a step to parameters without a finite response
            return failed
        if any(found is None for found in noises):
            return fallback
        spectra = [found for found in noises if found is not None]
        weights = [W for _, W in spectra]
        before, error = theta, np.ones_like(theta)
        for _ in range(_STEPS):
            N, g = _expand(maneuvers, weights, theta, mean, prior)
            step = _solve(N, g)
            bounds = None if step is None else compute_bounds(N)
            if step is None or bounds is None or not np.isfinite(step).all():
                return failed
            theta = theta + step
            # Standard errors of data without noise are smaller than the changes by rounding.
            error = np.maximum(bounds, _ROUNDING * np.abs(theta))
            if np.max(np.abs(step) / error) < _SMALL:
                break
        change = float(np.max((np.abs(theta - before) / error)[is_result]))
        if change < _CONVERGED:
            break
    found = _build(maneuvers, spectra, theta, (mean, prior), fallback)
    if found.noise is None or change < _SETTLED:
        return found
    return replace(found, noise=replace(found.noise, converged=False))


def compute_weighting_change(before: Estimate, weighted: Estimate) -> float:
    """Compute the root mean square change of the results by the weights, in standard errors.

    Nuisance parameters are no results; the standard errors are those without the weights.

    Notes
    -----
    Both estimates are consistent unless the inputs are correlated with the noise, as by
    feedback of turbulence; then their change has at most the variance of the first. A change
    beyond its errors shows a bias of at least one of them.
    Source: Hausman (1978), Specification tests in econometrics, Econometrica 46.
    """
    own = np.array([name not in before.nuisance for name in before.names])
    change = (weighted.values - before.values) / before.std_errors
    return float(np.sqrt(np.mean(change[own] ** 2)))


def widen_by_change(estimate: Estimate, change: Float[np.ndarray, " n_theta"]) -> Estimate:
    """Add the change of the values by the weights to the covariance, as a bias of that size."""
    bias = np.outer(change, change)
    return replace(estimate, corrected_covariance=estimate.corrected_covariance + bias)


def describe_common_noise(
    experiments: Sequence[Experiment], settings: FitSettings
) -> NoiseEstimate:
    """Describe the noise estimate of the likelihood, one covariance for all frequencies."""
    n_frequencies = min(int(np.bincount(e.group).min()) for e in experiments)
    return NoiseEstimate(
        f"one {settings.noise} covariance of the residuals for all frequencies", n_frequencies
    )


def _prepare(experiment: Experiment, parameters: Parameters) -> _Weighted:
    source = experiment.source or experiment
    return _Weighted(
        NormalForm(FrequencyDomainModel(experiment, parameters)),
        FrequencyDomainModel(source, parameters),
    )


def _expand(
    maneuvers: Sequence[_Weighted],
    weights: Sequence[SpectralMatrix],
    theta: Float[np.ndarray, " n_theta"],
    mean: Float[np.ndarray, " n_theta"],
    prior: Float[np.ndarray, "n_theta n_theta"],
) -> tuple[Float[np.ndarray, "n_theta n_theta"], Float[np.ndarray, " n_theta"]]:
    """Compute the normal matrix and the gradient, priors included."""
    N, g = prior, prior @ (mean - theta)
    for one, W in zip(maneuvers, weights, strict=True):
        model = one.form.model
        response = model.respond(theta)
        residuals = model.experiment.measured - response.outputs
        part = one.form.equations(model.sensitivity(theta, response), residuals, W)
        N, g = N + part[0], g + part[1]
    return N, g


def _solve(
    N: Float[np.ndarray, "n_theta n_theta"], g: Float[np.ndarray, " n_theta"]
) -> np.ndarray | None:
    """Solve for the step in scaled parameters; None for a singular matrix."""
    diagonal = np.diag(N)
    if not (np.isfinite(N).all() and np.all(diagonal > 0.0)):
        return None
    size = 1.0 / np.sqrt(diagonal)
    try:
        return size * np.linalg.solve(N * np.outer(size, size), size * g)
    except np.linalg.LinAlgError:
        return None


def _compute_weighted_power(final: FinalSpectra) -> float:
    """Compute sum nu^H W nu."""
    weighted = final.weights.times(final.residuals[:, :, None])[:, :, 0]
    return float(np.real(np.vdot(final.residuals, weighted)))


def _build(
    maneuvers: Sequence[_Weighted],
    spectra: Sequence[tuple[NoiseSpectrum, SpectralMatrix]],
    theta: Float[np.ndarray, " n_theta"],
    priors: tuple[np.ndarray, np.ndarray],
    estimate: Estimate,
) -> Estimate:
    """Build the estimate with covariance and fitted spectra at the parameters."""
    mean, prior = priors
    weights = [W for _, W in spectra]
    N, _ = _expand(maneuvers, weights, theta, mean, prior)
    n_data = sum(2 * one.source.experiment.measured.size for one in maneuvers)
    n_effective = count_effective_parameters(N, prior)
    inflation = n_data / max(n_data - n_effective, 1.0)
    final, fitted = [], []
    for one, W in zip(maneuvers, weights, strict=True):
        model, experiment = one.form.model, one.form.model.experiment
        response = model.respond(theta)
        outputs = response.outputs
        source = None
        if experiment.source is not None:
            source = experiment.source.measured - one.source.respond(theta).outputs
        final.append(
            FinalSpectra(
                one.form,
                model.sensitivity(theta, response),
                experiment.measured - outputs,
                W,
                neighbours=0,
                noise=source,
                source=source,
            )
        )
        fitted.extend(outputs[experiment.group == k] for k in range(len(experiment.group_names)))
    found = compute_covariance(final, N, prior, inflation)
    # W is independent of the residuals: their weighted power is that of S over its estimate.
    power = sum(_compute_weighted_power(one) for one in final)
    size = sum(2 * one.residuals.size for one in final)
    level = 2.0 * power / max(size - n_effective, 1.0)
    bound = compute_bound((N - prior) / level + prior)
    if found.lacking.size:
        return (
            estimate
            if estimate.noise is None
            else replace(estimate, noise=replace(estimate.noise, converged=False))
        )
    directions = np.mean([spectrum.n_directions for spectrum, _ in spectra])
    return replace(
        estimate,
        values=theta,
        covariance=bound,
        corrected_covariance=found.corrected,
        components=None
        if estimate.components is None
        else replace(
            estimate.components, noise=found.noise_components, prior=found.prior_components
        ),
        lines=tuple(
            replace(block, fitted=values)
            for block, values in zip(estimate.lines, fitted, strict=True)
        ),
        noise=NoiseEstimate(
            "spectral matrix of the residuals at neighbouring harmonics, with "
            f"{directions:.1f} directions of common noise",
            min(spectrum.n_frequencies for spectrum, _ in spectra),
        ),
    )
