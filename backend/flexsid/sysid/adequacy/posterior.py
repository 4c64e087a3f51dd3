"""Posterior of a finished output-error fit beyond its quadratic approximation, by sampling.

In coordinates in which the approximation is standard normal its motion is a rotation, which is
exact; only what the posterior differs by is integrated. A Gaussian posterior then accepts every
step, of any length.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy import linalg

from flexsid.errors import NotIdentifiable
from flexsid.sysid.estimation import noise
from flexsid.sysid.estimation.experiment import Experiment, Parameters
from flexsid.sysid.estimation.frequency_domain_model import FrequencyDomainModel
from flexsid.sysid.estimation.kronecker import NormalForm
from flexsid.sysid.estimation.likelihood import build_prior, count_effective_parameters

# --- Samples of a posterior by Hamiltonian Monte Carlo about its Gaussian approximation -----------

_ANGLES = (0.25 * np.pi, 0.75 * np.pi)  # of a trajectory: about a quarter turn, independent samples
_FIRST_STEP, _LEAST_STEP, _LARGEST_STEP = 0.4, 0.02, 0.25 * np.pi  # rad
_ACCEPTANCE = 0.8  # aimed at, optimal for leapfrog steps
_DISPERSION = 1.4  # of the first samples, in standard deviations: chains begin apart
_DIVERGENT = 1e3  # increase of the Hamiltonian at which a trajectory ends
_HALVINGS = 20  # of a first sample whose potential is infinite

Potential = Callable[[Float[np.ndarray, " n"]], tuple[float, Float[np.ndarray, " n"]]]
"""Negative log density and its gradient; infinite where the density is zero."""


@dataclass(frozen=True, slots=True)
class Samples:
    """Samples by chain, with the share of accepted trajectories after warm-up."""

    values: Float[np.ndarray, "n_chains n_samples n"]
    acceptance: float


def sample_density(
    potential: Potential,
    n: int,
    *,
    n_chains: int = 4,
    n_warm_up: int = 50,
    n_samples: int = 200,
    seed: int = 0,
    report: Callable[[float], None] = lambda fraction: None,
) -> Samples:
    """Sample a density that is about standard normal.

    Parameters
    ----------
    potential
        Negative log density and its gradient.
    n
        Dimension.
    n_chains, n_warm_up, n_samples
        Chains; samples of each that adapt the step and are not returned; samples of each.
    seed
        Of the random numbers.
    report
        Called with the fraction done; may raise to stop.

    Notes
    -----
    With the potential U and the momentum p the Hamiltonian U(x) + p^2/2 is split into
    (x^2 + p^2)/2, whose motion is a rotation of (x, p), and U - x^2/2, which changes p only.
    A step is half a rotation, the kick, half a rotation. Trajectories have random lengths; the step
    is adapted by Robbins and Monro's recursion.
    Sources: Neal (2011), MCMC using Hamiltonian dynamics, section 5.5.1; Shahbaba, Lan, Johnson and
    Neal (2014), Split Hamiltonian Monte Carlo, Statistics and Computing 24.
    """
    rng = np.random.default_rng(seed)
    values = np.empty((n_chains, n_samples, n))
    accepted, total = 0.0, n_chains * (n_warm_up + n_samples)
    for chain in range(n_chains):
        x = _DISPERSION * rng.normal(size=n)
        energy, _ = potential(x)
        for _ in range(_HALVINGS):
            if np.isfinite(energy):
                break
            x = 0.5 * x
            energy, _ = potential(x)
        step = _FIRST_STEP
        for k in range(n_warm_up + n_samples):
            report((chain * (n_warm_up + n_samples) + k) / total)
            p = rng.normal(size=n)
            angle = rng.uniform(*_ANGLES)
            count = int(np.ceil(angle / step))
            moved = _follow(potential, x, p, angle / count, count, energy + _DIVERGENT)
            probability = 0.0
            if moved is not None:
                trial, p_end, trial_energy = moved
                change = energy + 0.5 * p @ p - trial_energy - 0.5 * p_end @ p_end
                probability = float(np.exp(min(0.0, change)))
                if rng.uniform() < probability:
                    x, energy = trial, trial_energy
            if k < n_warm_up:
                rate = 1.0 / np.sqrt(k + 1.0)
                step = float(
                    np.clip(
                        step * np.exp(rate * (probability - _ACCEPTANCE)),
                        _LEAST_STEP,
                        _LARGEST_STEP,
                    )
                )
            else:
                accepted += probability
                values[chain, k - n_warm_up] = x
    return Samples(values, accepted / (n_chains * n_samples))


def _follow(
    potential: Potential, x: np.ndarray, p: np.ndarray, step: float, count: int, limit: float
) -> tuple[np.ndarray, np.ndarray, float] | None:
    """Follow a trajectory to its end; None where the potential exceeds a limit."""
    c, s = np.cos(0.5 * step), np.sin(0.5 * step)
    for _ in range(count):
        x, p = c * x + s * p, c * p - s * x
        energy, gradient = potential(x)
        if not energy < limit or not np.isfinite(gradient).all():
            return None
        p = p - step * (gradient - x)
        x, p = c * x + s * p, c * p - s * x
    energy, _ = potential(x)
    return (x, p, energy) if np.isfinite(energy) else None


def compute_scale_reduction(
    values: Float[np.ndarray, "n_chains n_samples n"],
) -> Float[np.ndarray, " n"]:
    """Compute the potential scale reduction R-hat of chains split in halves; 1 at convergence.

    Notes
    -----
    Source: Gelman et al. (2013), Bayesian Data Analysis, third edition, eq. 11.4.
    """
    halves = _split(values)
    length = halves.shape[1]
    within = halves.var(axis=1, ddof=1).mean(axis=0)
    between = halves.mean(axis=1).var(axis=0, ddof=1)
    ratio = np.divide(between, within, out=np.zeros_like(within), where=within > 0.0)
    return np.sqrt((length - 1) / length + ratio)


def compute_sample_size(
    values: Float[np.ndarray, "n_chains n_samples n"],
) -> Float[np.ndarray, " n"]:
    """Compute the effective number of independent samples, at most that of all samples.

    Notes
    -----
    From the autocorrelation over the chains up to the first negative sum of two (Geyer's initial
    positive sequence). Source: Gelman et al. (2013), section 11.5.
    """
    halves = _split(values)
    n_chains, length, n = halves.shape
    centred = halves - halves.mean(axis=1, keepdims=True)
    spectrum = np.fft.rfft(centred, 2 * length, axis=1)
    power = np.fft.irfft(np.abs(spectrum) ** 2, 2 * length, axis=1)[:, :length].mean(axis=0)
    variance = halves.var(axis=1, ddof=1).mean(axis=0) * (length - 1) / length
    variance = variance + halves.mean(axis=1).var(axis=0, ddof=1)
    own = power[0] / length
    with np.errstate(invalid="ignore", divide="ignore"):
        rho = 1.0 - (own - power / length) / variance
    rho = np.where(np.isfinite(rho), rho, 1.0)
    rho[0] = 1.0
    pairs = rho[: length // 2 * 2].reshape(-1, 2, n).sum(axis=1)
    time = 2.0 * np.sum(pairs * (np.minimum.accumulate(pairs, axis=0) > 0.0), axis=0) - 1.0
    return n_chains * length / np.maximum(time, 1.0)


def _split(values: np.ndarray) -> np.ndarray:
    half = values.shape[1] // 2
    return np.concatenate([values[:, :half], values[:, half : 2 * half]])


# --- Posterior of a finished output-error fit beyond its quadratic approximation ------------------

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
        g, N = prior @ (mean - at), prior
        energy = float(g @ (mean - at))
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
    prior: Float[np.ndarray, "n_theta n_theta"],
) -> list[noise.SpectralMatrix]:
    """Estimate the weights from the residuals, corrected for the fitted parameters."""
    densities, information, n_data = [], prior, 0
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
