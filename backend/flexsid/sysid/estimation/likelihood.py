"""Maximum likelihood with unknown noise, shared by OE and FRE (Eqs 19 and 22).

The residuals' density S and the parameters are relaxed in turn: S from the
current residuals, then one Levenberg-Marquardt step with S held. A step that
lowers the weighted residuals also lowers the likelihood with S concentrated out,
so the recorded cost never rises.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy.linalg import lapack

from flexsid.errors import NotIdentifiable
from flexsid.sysid.estimation import noise
from flexsid.sysid.estimation.covariance import FinalLines, covariance
from flexsid.sysid.estimation.estimate import Estimate, FittedLines, Outcome, Step
from flexsid.sysid.estimation.experiment import (
    Experiment,
    LineModel,
    Response,
    Sensitivity,
)
from flexsid.sysid.estimation.parameters import Parameters

Report = Callable[[int, float], None]
_NEAR = 20  # standard errors: steps below count as near the optimum


@dataclass(frozen=True, slots=True, kw_only=True)
class FitSettings:
    """How to maximise.

    ``tolerance`` is the largest step, in standard errors, that counts as none;
    ``priors`` holds value and standard deviation by parameter name.
    """

    max_iterations: int = 50
    tolerance: float = 1e-2
    noise: str = "diagonal"
    priors: Mapping[str, tuple[float, float]] | None = None


@dataclass(frozen=True, slots=True)
class _State:
    """Everything at one theta."""

    theta: np.ndarray
    responses: list[Response]
    residuals: list[np.ndarray]
    densities: list[np.ndarray]
    cost: float


@dataclass(frozen=True, slots=True)
class _Expansion:
    """Normal matrix, gradient and sensitivities around a state.

    ``gradients`` (n_theta, any) are those of single outputs, scaled so that their outer
    product is what letting S follow takes off the curvature; None for a full S.
    """

    N: np.ndarray
    g: np.ndarray
    gradients: np.ndarray | None
    sensitivities: list[Sensitivity]


def maximize(
    experiments: Sequence[Experiment],
    parameters: Parameters,
    settings: FitSettings = FitSettings(),
    report: Report | None = None,
) -> Estimate:
    """Find the parameters under which the measured lines are most likely.

    Parameters
    ----------
    experiments
        One or more maneuvers that share the parameters.
    parameters
        What is free and where it starts.
    settings
        Limits, noise model, priors.
    report
        Called with iteration and cost after every accepted step; an exception
        it raises (``Cancelled``) ends the fit.

    Returns
    -------
    Estimate
        With a named outcome; also where the iteration did not converge.

    Raises
    ------
    NotIdentifiable
        If there are more parameters than independent measured numbers.
    """
    n_data = sum(2 * e.measured.size for e in experiments)
    if n_data <= parameters.start.size:
        raise NotIdentifiable(
            f"{parameters.start.size} parameters are free but the lines hold only {n_data} "
            "numbers; free fewer parameters or widen the band",
            parameters=parameters.start.size,
            data=n_data,
        )
    problem = _Problem(experiments, parameters, settings)
    return problem.run(report or (lambda iteration, cost: None))


class _Problem:
    """Bookkeeping of one maximisation."""

    def __init__(
        self, experiments: Sequence[Experiment], parameters: Parameters, settings: FitSettings
    ) -> None:
        self.experiments = experiments
        self.parameters = parameters
        self.settings = settings
        self.models = [LineModel(e, parameters) for e in experiments]
        self.prior_mean, self.prior_information = _prior(parameters, settings)

    def at(self, theta: np.ndarray) -> _State:
        """Everything at theta; the cost is infinite where the model has no response."""
        responses = [model.respond(theta) for model in self.models]
        residuals = [
            e.measured - r.outputs for e, r in zip(self.experiments, responses, strict=True)
        ]
        if not all(np.isfinite(nu).all() for nu in residuals):
            return _State(theta, responses, residuals, [], np.inf)
        densities = [
            noise.residual_density(nu, e.measured, e.group, len(e.group_names), self.settings.noise)
            for e, nu in zip(self.experiments, residuals, strict=True)
        ]
        offset = theta - self.prior_mean
        cost = float(self.prior_information @ offset**2)
        for nu, S, e in zip(residuals, densities, self.experiments, strict=True):
            cost += noise.negative_log_likelihood(nu, S, e.group)
        return _State(theta, responses, residuals, densities, cost)

    def weights(self, densities: list[np.ndarray]) -> list[np.ndarray]:
        return [
            noise.line_weights(S, e.group) for S, e in zip(densities, self.experiments, strict=True)
        ]

    def run(self, report: Report) -> Estimate:
        state = self.at(self.parameters.start)
        if not np.isfinite(state.cost):
            raise NotIdentifiable(
                "the model has no finite response at the starting values; start from a "
                "prediction or from equation error",
                code="bad-start",
            )
        steps = [Step(0, state.cost, np.inf)]
        damping = 1e-4
        outcome = Outcome.ITERATION_LIMIT
        for iteration in range(1, self.settings.max_iterations + 1):
            near = steps[-1].step < _NEAR
            around = self.expand(state, self.weights(state.densities))
            found = self._step(state, around, damping, near=near)
            if found is None:
                small = _gradient_is_small(around.N, around.g)
                outcome = Outcome.CONVERGED if small else Outcome.DIVERGED
                break
            trial, damping = found
            size = _size_in_std_errors(around.N, trial.theta - state.theta)
            state = trial
            steps.append(Step(iteration, state.cost, size))
            report(iteration, state.cost)
            if size < self.settings.tolerance and damping <= 1e-3:
                outcome = Outcome.CONVERGED
                break
        return self._estimate(state, steps, outcome)

    def expand(self, state: _State, weights: list[np.ndarray]) -> _Expansion:
        """Expand the cost around a state.

        With a diagonal S concentrated out the cost is sum M ln c_o, whose curvature
        lacks 2/M g_o g_o^T of every output o. Without this term the relaxation of S
        converges only linearly where the model is of too low an order.
        """
        N = np.diag(self.prior_information)
        g = self.prior_information * (self.prior_mean - state.theta)
        columns, sensitivities = [], []
        for model, response, nu, W in zip(
            self.models, state.responses, state.residuals, weights, strict=True
        ):
            sensitivity = model.sensitivity(state.theta, response)
            sensitivities.append(sensitivity)
            n_part, g_part = model.normal_equations(sensitivity, nu, W)
            N, g = N + n_part, g + g_part
            if W.ndim == 2:
                counts = np.bincount(model.experiment.group)
                gradients = model.output_gradients(sensitivity, nu, W)
                columns.extend(gradients * np.sqrt(2.0 / counts)[:, None, None])
        stacked = np.concatenate(columns, axis=1) if columns else None
        return _Expansion(N, g, stacked, sensitivities)

    def _step(
        self, state: _State, around: _Expansion, damping: float, *, near: bool
    ) -> tuple[_State, float] | None:
        """Best trial with the least damping that lowers the cost.

        With S concentrated out the curvature is exact near the optimum; far from it either
        matrix may lead further, so both are tried.
        """
        scale = np.sqrt(np.maximum(np.diag(around.N), np.finfo(float).tiny))
        candidates = [around.N / np.outer(scale, scale)]
        if around.gradients is not None:
            scaled = around.gradients / scale[:, None]
            candidates.insert(0, candidates[0] - scaled @ scaled.T)
        while damping < 1e9:
            best = state
            for matrix in candidates:
                delta = _damped_step(matrix, around.g / scale, damping)
                if delta is None:
                    continue
                trial = self.at(state.theta + delta / scale)
                if trial.cost <= best.cost + 1e-12 * abs(best.cost):
                    best = trial
                    if near:
                        break
            if best is not state:
                return best, max(0.1 * damping, 1e-12)
            damping *= 10.0
        return None

    def _estimate(self, state: _State, steps: list[Step], outcome: Outcome) -> Estimate:
        n_theta = state.theta.size
        n_data = sum(2 * e.measured.size for e in self.experiments)
        inflation = n_data / (n_data - n_theta)
        weights = [W / inflation for W in self.weights(state.densities)]
        around = self.expand(state, weights)
        lines = [
            FinalLines(model, sensitivity, nu, W, state.theta)
            for model, sensitivity, nu, W in zip(
                self.models, around.sensitivities, state.residuals, weights, strict=True
            )
        ]
        found = covariance(lines, around.N, self.prior_information, inflation)
        weak = found.weak_directions(self.parameters.names)
        message = _MESSAGES[outcome].format(iterations=len(steps) - 1)
        if weak:
            if outcome is Outcome.CONVERGED:
                outcome = Outcome.SINGULAR_INFORMATION
            message = (
                "The data do not tell these parameters apart: "
                + "; ".join(weak)
                + ". Hold some of them fixed, or give a prior."
            )
        fitted = tuple(
            FittedLines(
                name, e.model.outputs, e.omega[pick], e.measured[pick], response.outputs[pick]
            )
            for e, response in zip(self.experiments, state.responses, strict=True)
            for name, pick in ((n, e.group == k) for k, n in enumerate(e.group_names))
        )
        return Estimate(
            names=self.parameters.names,
            values=state.theta,
            start=self.parameters.start,
            covariance=found.plain,
            corrected_covariance=found.corrected,
            lines=fitted,
            steps=tuple(steps),
            outcome=outcome,
            message=message,
        )


_MESSAGES = {
    Outcome.CONVERGED: "Converged in {iterations} iterations.",
    Outcome.ITERATION_LIMIT: (
        "Stopped at the limit of {iterations} iterations before the steps became small; "
        "raise the limit or start closer."
    ),
    Outcome.DIVERGED: (
        "No step lowers the cost although the gradient is not zero ({iterations} iterations); "
        "start closer, or free fewer parameters."
    ),
}


def _prior(
    parameters: Parameters, settings: FitSettings
) -> tuple[Float[np.ndarray, " n_theta"], Float[np.ndarray, " n_theta"]]:
    mean = parameters.start.copy()
    information = np.zeros_like(mean)
    for name, (value, sigma) in (settings.priors or {}).items():
        index = parameters.names.index(name)
        mean[index] = value
        information[index] = 0.5 / sigma**2
    return mean, information


def _damped_step(matrix: np.ndarray, g: np.ndarray, damping: float) -> np.ndarray | None:
    """Solve with the diagonal raised, None where the matrix is still not positive."""
    damped = matrix.copy()
    damped[np.diag_indices(g.size)] += damping
    factor, info = lapack.dpotrf(damped, lower=False, overwrite_a=True)
    return None if info != 0 else lapack.dpotrs(factor, g, lower=False)[0]


def _size_in_std_errors(N: np.ndarray, delta: np.ndarray) -> float:
    """Largest step against a lower bound of its standard error, correlation ignored."""
    return float(np.max(np.abs(delta) * np.sqrt(2.0 * np.diag(N))))


def _gradient_is_small(N: np.ndarray, g: np.ndarray) -> bool:
    return bool(np.max(np.abs(g) / np.sqrt(np.maximum(np.diag(N), 1e-300))) < 1e-2)
