"""Noise that feedback correlates between inputs and outputs: a fit by errors in variables.

Turbulence moves the aircraft, and the controller the surfaces with it. Near the flutter speed the
correlation of the measured inputs with the noise of the outputs biases every method that takes the
inputs as exact. The commands are known and repeat nothing of it: what deviates from a smooth
response to them is noise of inputs and outputs alike.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Complex, Float

from flexsid.sysid.estimation.estimate import IterationStep
from flexsid.sysid.estimation.experiment import Experiment, Parameters
from flexsid.sysid.estimation.flight_noise import LEAST_SHARE, compute_rms
from flexsid.sysid.estimation.frequency_domain_model import FrequencyDomainModel
from flexsid.sysid.estimation.kronecker import NormalForm
from flexsid.sysid.estimation.likelihood import FitSettings, build_prior, count_effective_parameters
from flexsid.sysid.estimation.linear_algebra import compute_bounds
from flexsid.sysid.estimation.noise import NoiseSpectrum, SpectralMatrix

ADDED_NOISE = (100.0, 10.0, 1.0, 0.1, 0.0)
"""Independent noise of the fits in sequence that is added to the estimated one, relative to the
variance of each signal. The first cost has one minimum, and each fit starts near its own: without
the others three of eight fits in moderate turbulence at .95 V_f end in a wrong one."""

_LARGEST_RESIDUALS = 3.0
"""Power of the residuals over that of the noise up to which the model is taken as right: 1.0 to 1.9
in 50 flights without and with turbulence, 3.3 and above in other minima."""

_LEAST_SHARE_OF_PART = 0.1
"""As ``LEAST_SHARE``, of a part of a maneuver: .01 to .03 in still air, up to .07 with many gaps,
.13 to .5 in light and moderate turbulence."""

_MAX_STEPS = 40  # with one noise
_MAX_TRIALS = 14  # dampings of one step
_CONVERGED = 0.02  # largest step, in standard errors
_NEAR = 1.0  # the same for a fit that only starts another
_ROUNDING = 1e-6  # of a parameter
_LEAST_DAMPING = 1e-4  # of unit diagonal
_DAMPING_FACTORS = (4.0, 9.0)  # more after a trial that failed, less after a step


@dataclass(frozen=True, slots=True)
class CorrectedInputs:
    """Maneuvers without the noise that feedback correlates, and the estimate behind it.

    ``experiments`` have the inputs without their noise that the residuals determine, and the
    measured outputs less the response to that noise, so that the residuals are the same. ``noise``
    is the noise spectrum of the outputs. ``share`` is the noise removed from each input of each
    maneuver over its rms, ``residual_power`` that of the residuals over that of the noise.
    ``steps`` are those of the fit without added noise.
    """

    experiments: tuple[Experiment, ...]
    noise: tuple[NoiseSpectrum, ...]
    theta: Float[np.ndarray, " n_theta"]
    share: Float[np.ndarray, "n_maneuvers n_u"]
    residual_power: float
    steps: tuple[IterationStep, ...]

    @property
    def is_significant(self) -> bool:
        """Whether the noise removed can have an effect on the results."""
        return bool(self.share.max() > LEAST_SHARE)


def remove_feedback_noise(
    experiments: Sequence[Experiment],
    noise: Sequence[NoiseSpectrum],
    parameters: Parameters,
    settings: FitSettings,
    report: Callable[[int], None] = lambda iteration: None,
    added_noise: Sequence[float] = ADDED_NOISE,
    largest_residuals: float = _LARGEST_RESIDUALS,
) -> CorrectedInputs | None:
    """Remove the noise from the inputs that the residuals of a fit determine.

    Parameters
    ----------
    experiments
        Output error of each maneuver.
    noise
        Joint noise spectrum of the outputs and inputs of each maneuver.
    parameters, settings
        Free parameters with their start, and priors.
    report
        Called with the number of each iteration, from 1; an exception ends the fit.
    added_noise
        Independent noise of the fits in sequence; only 0 where the start is near the optimum.
    largest_residuals
        Power of the residuals over that of the noise up to which an optimum is the right one.

    Returns
    -------
    CorrectedInputs or None
        None where the fit does not converge to residuals of the size of the noise.

    Notes
    -----
    With the joint noise spectrum S of outputs Z and inputs U, the residual e = Z - G U has the
    covariance C = [I -G] S [I -G]^H at theta. The cost sum e^H C^-1 e is that of errors in
    variables, the true inputs concentrated out; they are u = U - S_ue C^-1 e with
    S_ue = [0 I] S [I -G]^H. Its gradient is -2 Re sum (G' u)^H C^-1 e, its expected curvature
    2 Re sum (G' u)^H C^-1 (G' u): those of output error with the inputs u. The expected cost of
    the noise is the same at every theta, so that the estimate is consistent, and finite where a
    pole of the model crosses the imaginary axis. The free motion from the state at the end of a
    record, with turbulence a random one, is part of the noise. As u is uncorrelated with e, other
    estimators are consistent with the inputs u and the outputs e + G u.
    Source: Pintelon and Schoukens, System Identification, 2nd ed., 2012, ch. 9 and 12.
    """
    maneuvers = []
    for one, own in zip(experiments, noise, strict=True):
        model = FrequencyDomainModel(one, parameters)
        maneuvers.append(ErrorsInVariablesModel(model, NormalForm(model), own))
    theta, count = parameters.start, 0
    fit: _Optimum | None = None
    for added in added_noise:

        def report_step(step: int, begun: int = count) -> None:
            report(begun + step)

        noisier = [one.with_noise_added(added) for one in maneuvers]
        fit = _fit(noisier, theta, settings, _NEAR if added else _CONVERGED, report_step)
        if fit is None:
            return None
        theta, count = fit.theta, count + len(fit.steps)
    if fit is None or fit.residual_power > largest_residuals:
        return None
    corrected = [_correct(one, point) for one, point in zip(experiments, fit.points, strict=True)]
    share = [_compute_share(one, point) for one, point in zip(experiments, fit.points, strict=True)]
    return CorrectedInputs(
        experiments=tuple(corrected),
        noise=tuple(
            replace(one.noise, density=SpectralMatrix(point.covariance, point.weights.block))
            for one, point in zip(maneuvers, fit.points, strict=True)
        ),
        theta=theta,
        share=np.array(share),
        residual_power=fit.residual_power,
        steps=tuple(fit.steps),
    )


def compute_costs(
    experiment: Experiment,
    noise: NoiseSpectrum,
    parameters: Parameters,
    theta: Float[np.ndarray, " n_theta"],
) -> Float[np.ndarray, " n_omega"]:
    """Compute the cost of each frequency by errors in variables, see ``remove_feedback_noise``.

    Its negative is the log likelihood, the true inputs concentrated out, less a constant that does
    not depend on the model.
    """
    model = FrequencyDomainModel(experiment, parameters)
    return ErrorsInVariablesModel(model, NormalForm(model), noise).evaluate(theta).costs


def has_feedback_noise(
    experiment: Experiment, noise: NoiseSpectrum, parameters: Parameters
) -> bool:
    """Whether the residuals of a part of a maneuver determine noise of the inputs with an effect.

    Parameters
    ----------
    experiment
        Output error.
    noise
        Joint noise spectrum of outputs and inputs.
    parameters
        Their starting values are those of a fit: near any, the share is within .03 of that at the
        optimum of errors in variables.
    """
    model = FrequencyDomainModel(experiment, parameters)
    point = ErrorsInVariablesModel(model, NormalForm(model), noise).evaluate(parameters.start)
    return bool(_compute_share(experiment, point).max() > _LEAST_SHARE_OF_PART)


def _compute_share(
    experiment: Experiment, point: ErrorsInVariablesPoint
) -> Float[np.ndarray, " n_u"]:
    """Compute the rms of the noise of each input over that of the input."""
    size = np.maximum(compute_rms(experiment.inputs), np.finfo(float).tiny)
    return compute_rms(point.inputs - experiment.inputs) / size


def _correct(experiment: Experiment, point: ErrorsInVariablesPoint) -> Experiment:
    """Replace the inputs by those without noise, and subtract its response from the outputs."""
    noise = experiment.inputs - point.inputs
    response = np.matmul(point.transfer, noise[:, :, None])[:, :, 0]
    return replace(experiment, inputs=point.inputs, measured=experiment.measured - response)


@dataclass(frozen=True, slots=True)
class ErrorsInVariablesPoint:
    """One maneuver at one theta: residuals, their covariance, and the inputs without noise.

    ``costs`` are e^H C^-1 e of each frequency.
    """

    residuals: Complex[np.ndarray, "n_omega n_y"]
    covariance: Complex[np.ndarray, "n_omega n_y n_y"]
    weights: SpectralMatrix
    inputs: Complex[np.ndarray, "n_omega n_u"]
    transfer: Complex[np.ndarray, "n_omega n_y n_u"]
    costs: Float[np.ndarray, " n_omega"]

    @property
    def cost(self) -> float:
        """Sum over the frequencies."""
        return float(self.costs.sum())


@dataclass(frozen=True, slots=True)
class ErrorsInVariablesModel:
    """Model and joint noise spectrum of one maneuver."""

    model: FrequencyDomainModel
    form: NormalForm
    noise: NoiseSpectrum

    def with_noise_added(self, share: float) -> ErrorsInVariablesModel:
        """Return the same with independent noise, a share of the variance of each signal."""
        density = self.noise.density
        blocks, own = density.blocks.copy(), np.arange(density.blocks.shape[1])
        blocks[:, own, own] *= 1.0 + share
        noise = replace(self.noise, density=SpectralMatrix(blocks, density.block))
        return replace(self, noise=noise)

    def evaluate(self, theta: Float[np.ndarray, " n_theta"]) -> ErrorsInVariablesPoint:
        """Compute the residuals, their weights, and the inputs without noise."""
        model, one = self.model, self.model.experiment
        response = model.respond(theta)
        G = model.respond_to_inputs(theta, response)
        n_y, S = one.measured.shape[1], self.noise.density.expand_blocks()
        joint = S[:, :, :n_y] - S[:, :, n_y:] @ G.conj().transpose(0, 2, 1)
        covariance = joint[:, :n_y] - G @ joint[:, n_y:]
        weights = SpectralMatrix(covariance, np.arange(one.omega.size)).inverse()
        e = one.measured - response.outputs
        weighted = weights.times(e[:, :, None])
        noise = np.matmul(joint[:, n_y:], weighted)[:, :, 0]
        costs = np.sum(np.real(e.conj() * weighted[:, :, 0]), axis=1)
        return ErrorsInVariablesPoint(e, covariance, weights, one.inputs - noise, G, costs)

    def expand(
        self, theta: Float[np.ndarray, " n_theta"], point: ErrorsInVariablesPoint
    ) -> tuple[Float[np.ndarray, "n_theta n_theta"], Float[np.ndarray, " n_theta"]]:
        """Compute the normal matrix and the gradient."""
        model = self.model.with_inputs(point.inputs)
        sensitivity = model.sensitivity(theta, model.respond(theta))
        return self.form.equations(sensitivity, point.residuals, point.weights)


@dataclass(frozen=True, slots=True)
class _Optimum:
    """A fit that converged; the power of its residuals is in units of the noise."""

    theta: Float[np.ndarray, " n_theta"]
    points: list[ErrorsInVariablesPoint]
    residual_power: float
    steps: list[IterationStep]


def _fit(
    maneuvers: Sequence[ErrorsInVariablesModel],
    theta: Float[np.ndarray, " n_theta"],
    settings: FitSettings,
    tolerance: float,
    report: Callable[[int], None],
) -> _Optimum | None:
    """Minimise the cost by damped Gauss-Newton; None where that does not converge.

    The tolerance is of the largest step, in standard errors.
    """
    mean, prior = build_prior(maneuvers[0].model.parameters, settings.priors)

    def evaluate(
        theta: Float[np.ndarray, " n_theta"],
    ) -> tuple[list[ErrorsInVariablesPoint], float]:
        try:
            points = [one.evaluate(theta) for one in maneuvers]
        except np.linalg.LinAlgError:  # no finite response
            return [], np.inf
        cost = sum(point.cost for point in points) + float((theta - mean) @ prior @ (theta - mean))
        return points, cost if np.isfinite(cost) else np.inf

    points, cost = evaluate(theta)
    damping, steps = 0.0, [IterationStep(0, cost, np.inf)]
    for number in range(1, _MAX_STEPS + 1):
        report(number)
        N, g = prior, prior @ (mean - theta)
        for one, point in zip(maneuvers, points, strict=True):
            part = one.expand(theta, point)
            N, g = N + part[0], g + part[1]
        bounds = compute_bounds(N) if np.isfinite(cost) else None
        if bounds is None:
            return None
        size = 1.0 / np.sqrt(np.diag(N))
        scaled, right = N * np.outer(size, size), size * g
        step = size * np.linalg.solve(scaled, right)
        error = np.maximum(bounds, _ROUNDING * np.abs(theta))
        if np.max(np.abs(step) / error) < tolerance:
            n_data = sum(2 * point.residuals.size for point in points)
            power = 2.0 * sum(point.cost for point in points)
            power /= max(n_data - count_effective_parameters(N, prior), 1.0)
            return _Optimum(theta, points, power, steps)
        for _ in range(_MAX_TRIALS):
            step = size * np.linalg.solve(scaled + damping * np.eye(theta.size), right)
            tried, reached = evaluate(theta + step)
            if reached < cost:
                break
            damping = max(_DAMPING_FACTORS[0] * damping, _LEAST_DAMPING)
        else:
            return None
        theta, points, cost = theta + step, tried, reached
        steps.append(IterationStep(number, cost, float(np.max(np.abs(step) / error))))
        damping = damping / _DAMPING_FACTORS[1] if damping > _LEAST_DAMPING else 0.0
    return None
