"""Posterior of a finished output-error fit beyond its quadratic approximation."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy import linalg

from flexsid.errors import NotIdentifiable
from flexsid.sysid.estimation import noise
from flexsid.sysid.estimation.experiment import Experiment
from flexsid.sysid.estimation.frequency_domain_model import FrequencyDomainModel
from flexsid.sysid.estimation.kronecker import NormalForm
from flexsid.sysid.estimation.likelihood import build_prior, count_effective_parameters
from flexsid.sysid.estimation.monte_carlo_sampling import sample_density
from flexsid.sysid.estimation.parameters import Parameters

_STEPS = 12  # of Gauss-Newton, to the optimum with the weights held
_CONVERGED = 1e-3  # standard errors of the last step
_LEAST_PIVOT = 1e-6  # of the factor of the information with unit diagonal: singular below
_RELATIVE_FLOOR = 1e-20  # of the measured power: weights of noise-free data stay finite


@dataclass(frozen=True, slots=True)
class PosteriorSamples:
    """Samples of the parameters by chain, about the optimum with the same weights.

    ``covariance`` is that of the quadratic (Laplace) approximation at the optimum.
    """

    values: Float[np.ndarray, "n_chains n_samples n_theta"]
    optimum: Float[np.ndarray, " n_theta"]
    covariance: Float[np.ndarray, "n_theta n_theta"]
    acceptance: float

    @property
    def std_errors(self) -> Float[np.ndarray, " n_theta"]:
        """Standard errors of the quadratic approximation."""
        return np.sqrt(np.diag(self.covariance))


def sample_posterior(
    experiments: Sequence[Experiment],
    parameters: Parameters,
    theta: Float[np.ndarray, " n_theta"],
    priors: Mapping[str, tuple[float, float]] | None = None,
    *,
    densities: Sequence[noise.SpectralMatrix] | None = None,
    n_samples: int = 200,
    seed: int = 0,
    report: Callable[[float], None] = lambda fraction: None,
) -> PosteriorSamples:
    """Sample the posterior of a fit with the noise held at that of its residuals.

    Parameters
    ----------
    experiments, parameters
        Data and free parameters of the fit.
    theta
        Estimate.
    priors
        Mean and standard deviation by parameter, of the fit.
    densities
        Spectral matrix of the noise of each experiment; by default from its residuals.
    n_samples
        Of each of four chains.
    seed
        Of the random numbers.
    report
        Called with the fraction done; may raise to stop.

    Raises
    ------
    NotIdentifiable
        If the information is singular, or there is no optimum near the estimate.

    Notes
    -----
    The negative log posterior is sum nu^H W nu + sum (theta - mean)^2 / (2 sigma^2) with
    W = S^-1; without ``densities`` S is the variance of every output from residuals at neighbouring
    frequencies. Its
    quadratic approximation has the covariance (2 N)^-1, N the Gauss-Newton normal matrix; in
    coordinates in which this is the unit matrix the sampler has the exact gradient.
    """
    models = [FrequencyDomainModel(e, parameters) for e in experiments]
    forms = [NormalForm(model) for model in models]
    mean, prior = build_prior(parameters, priors)

    def expand(
        at: np.ndarray, weights: Sequence[noise.SpectralMatrix], *, with_matrix: bool
    ) -> tuple[float, np.ndarray, np.ndarray]:
        """Compute the potential, g = -1/2 of its gradient, and N."""
        energy = float(prior @ (at - mean) ** 2)
        g, N = prior * (mean - at), np.diag(prior)
        for model, form, W in zip(models, forms, weights, strict=True):
            response = model.respond(at)
            nu = model.experiment.measured - response.outputs
            if not np.isfinite(nu).all():
                return np.inf, g, N
            energy += float(np.real(np.vdot(nu, W.times(nu[:, :, None]))))
            sensitivity = model.sensitivity(at, response)
            g = g + form.gradient(sensitivity, nu, W)
            if with_matrix:
                N = N + form.matrix(sensitivity, W)
        return energy, g, N

    if densities is None:
        weights = _estimate_weights(models, theta, prior)
    else:
        weights = [density.inverse() for density in densities]
    optimum, T = _find_optimum(lambda at: expand(at, weights, with_matrix=True), theta)

    def potential(x: np.ndarray) -> tuple[float, np.ndarray]:
        energy, g, _ = expand(optimum + T @ x, weights, with_matrix=False)
        return energy, -2.0 * (T.T @ g)

    found = sample_density(potential, theta.size, n_samples=n_samples, seed=seed, report=report)
    return PosteriorSamples(
        optimum + found.values @ T.T,
        optimum,
        T @ T.T,
        found.acceptance,
    )


def _estimate_weights(
    models: Sequence[FrequencyDomainModel],
    theta: Float[np.ndarray, " n_theta"],
    prior: Float[np.ndarray, " n_theta"],
) -> list[noise.SpectralMatrix]:
    """Estimate the weights from the residuals, corrected for the fitted parameters."""
    densities, information, n_data = [], np.diag(prior), 0
    for model in models:
        experiment = model.experiment
        response = model.respond(theta)
        nu = experiment.measured - response.outputs
        smooth = noise.smooth_density(nu, experiment.group, len(experiment.group_names))
        power = np.real(np.einsum("bii->bi", smooth.blocks))
        floor = _RELATIVE_FLOOR * np.mean(np.abs(experiment.measured) ** 2, axis=0)
        density = noise.SpectralMatrix(np.maximum(power, floor), smooth.block)
        densities.append(density)
        sensitivity = model.sensitivity(theta, response)
        information = information + NormalForm(model).matrix(sensitivity, density.inverse())
        n_data += 2 * nu.size
    n_effective = count_effective_parameters(information, prior)
    inflation = n_data / max(n_data - n_effective, 1.0)
    return [density.scaled(inflation).inverse() for density in densities]


def _find_optimum(
    expand: Callable[[np.ndarray], tuple[float, np.ndarray, np.ndarray]],
    theta: Float[np.ndarray, " n_theta"],
) -> tuple[Float[np.ndarray, " n_theta"], Float[np.ndarray, "n_theta n_theta"]]:
    """Find the optimum near an estimate, and T with T T^T = (2 N)^-1 there."""
    energy, g, N = expand(theta)
    for _ in range(_STEPS):
        T = _factor_covariance(N)
        step = 2.0 * T @ (T.T @ g)
        share = 1.0
        while True:  # halved until it does not increase the potential
            trial = expand(theta + share * step)
            if trial[0] <= energy + _CONVERGED**2 or share < _CONVERGED:
                break
            share *= 0.5
        theta = theta + share * step
        energy, g, N = trial
        if np.sqrt(2.0 * share**2 * step @ N @ step) < _CONVERGED * np.sqrt(theta.size):
            return theta, _factor_covariance(N)
    raise NotIdentifiable(
        "the posterior has no optimum near the estimate of the run; check that the run converged "
        "and that its parameters are identifiable",
        code="no-optimum",
    )


def _factor_covariance(N: Float[np.ndarray, "n n"]) -> Float[np.ndarray, "n n"]:
    """Return T with T T^T = (2 N)^-1."""
    size = np.sqrt(np.diag(N))
    factor, info = linalg.lapack.dpotrf(N / np.outer(size, size), lower=True)
    if info != 0 or not np.diag(factor).min() > _LEAST_PIVOT:
        raise NotIdentifiable(
            "the information of the run is singular, so that it has no posterior; hold parameters "
            "fixed, or specify priors",
            code="singular-information",
        )
    inverse = linalg.solve_triangular(factor, np.eye(len(N)), lower=True)
    return inverse.T / size[:, None] / np.sqrt(2.0)
