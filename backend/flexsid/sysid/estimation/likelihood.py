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
from scipy import linalg

from flexsid.errors import NotIdentifiable
from flexsid.sysid.estimation import noise
from flexsid.sysid.estimation.covariance import covariance
from flexsid.sysid.estimation.estimate import Estimate, FittedLines, Outcome, Step
from flexsid.sysid.estimation.experiment import Experiment, LineModel, Response
from flexsid.sysid.estimation.parameters import Parameters

Report = Callable[[int, float], None]


@dataclass(frozen=True, slots=True, kw_only=True)
class FitSettings:
    """How to maximise.

    ``tolerance`` is the largest step, in standard errors, that counts as none;
    ``priors`` holds value and standard deviation by parameter name.
    """

    max_iterations: int = 50
    tolerance: float = 1e-3
    noise: str = "diagonal"
    priors: Mapping[str, tuple[float, float]] | None = None


@dataclass(frozen=True, slots=True)
class _State:
    """Everything at one theta."""

    theta: np.ndarray
    responses: list[Response]
    residuals: list[np.ndarray]


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
        responses = [model.respond(theta) for model in self.models]
        residuals = [
            e.measured - r.outputs for e, r in zip(self.experiments, responses, strict=True)
        ]
        return _State(theta, responses, residuals)

    def densities(self, state: _State) -> list[np.ndarray]:
        return [
            noise.residual_density(nu, e.measured, e.group, len(e.group_names), self.settings.noise)
            for e, nu in zip(self.experiments, state.residuals, strict=True)
        ]

    def weights(self, densities: list[np.ndarray]) -> list[np.ndarray]:
        return [
            noise.line_weights(S, e.group) for S, e in zip(densities, self.experiments, strict=True)
        ]

    def cost(self, state: _State, densities: list[np.ndarray]) -> float:
        """Negative log likelihood with these densities, constants dropped."""
        offset = state.theta - self.prior_mean
        total = float(self.prior_information @ offset**2)
        for nu, S, e in zip(state.residuals, densities, self.experiments, strict=True):
            total += noise.weighted_square(nu, noise.line_weights(S, e.group))
            total += noise.log_determinant(S, e.group)
        return total

    def run(self, report: Report) -> Estimate:
        state = self.at(self.parameters.start)
        if not all(np.isfinite(nu).all() for nu in state.residuals):
            raise NotIdentifiable(
                "the model has no finite response at the starting values; start from a "
                "prediction or from equation error",
                code="bad-start",
            )
        densities = self.densities(state)
        steps = [Step(0, self.cost(state, densities), np.inf)]
        damping = 1e-4
        outcome = Outcome.ITERATION_LIMIT
        for iteration in range(1, self.settings.max_iterations + 1):
            N, g, curvature = self.quadratic(state, self.weights(densities))
            found = self._step(state, N, g, curvature, steps[-1].cost, damping)
            if found is None:
                outcome = Outcome.CONVERGED if _gradient_is_small(N, g) else Outcome.DIVERGED
                break
            trial, damping = found
            size = _size_in_std_errors(N, trial.theta - state.theta)
            state, densities = trial, self.densities(trial)
            steps.append(Step(iteration, self.cost(state, densities), size))
            report(iteration, steps[-1].cost)
            if size < self.settings.tolerance and damping <= 1e-3:
                outcome = Outcome.CONVERGED
                break
        return self._estimate(state, densities, steps, outcome)

    def quadratic(
        self, state: _State, weights: list[np.ndarray]
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray | None]:
        """Normal matrix, gradient, and what letting S follow takes off the curvature.

        With a diagonal S concentrated out the cost is sum M ln c_o, whose curvature
        lacks 2/M g_o g_o^T of every output o. Without this term the relaxation of S
        converges only linearly where the model is of too low an order.
        """
        N, g = (
            np.diag(self.prior_information),
            self.prior_information * (self.prior_mean - state.theta),
        )
        columns = []
        for model, response, nu, W in zip(
            self.models, state.responses, state.residuals, weights, strict=True
        ):
            sensitivity = model.sensitivity(state.theta, response)
            n_part, g_part = model.normal_equations(sensitivity, nu, W)
            N, g = N + n_part, g + g_part
            if W.ndim == 2:
                counts = np.bincount(model.experiment.group)
                gradients = model.output_gradients(sensitivity, nu, W)
                columns.extend(gradients * np.sqrt(2.0 / counts)[:, None, None])
        if not columns:
            return N, g, None
        stacked = np.concatenate(columns, axis=1)
        return N, g, stacked @ stacked.T

    def _step(
        self,
        state: _State,
        N: np.ndarray,
        g: np.ndarray,
        curvature: np.ndarray | None,
        before: float,
        damping: float,
    ) -> tuple[_State, float] | None:
        scale = np.sqrt(np.maximum(np.diag(N), np.finfo(float).tiny))
        outer = np.outer(scale, scale)
        candidates = [N / outer] if curvature is None else [(N - curvature) / outer, N / outer]
        diagonal = np.diag_indices(scale.size)
        while damping < 1e9:
            for scaled in candidates:
                damped = scaled.copy()
                damped[diagonal] += damping
                try:
                    factor = linalg.cho_factor(damped, check_finite=False)
                except linalg.LinAlgError:
                    continue
                delta = linalg.cho_solve(factor, g / scale, check_finite=False) / scale
                trial = self.at(state.theta + delta)
                if all(np.isfinite(nu).all() for nu in trial.residuals):
                    after = self.cost(trial, self.densities(trial))
                    if after <= before + 1e-12 * abs(before):
                        return trial, max(0.1 * damping, 1e-12)
            damping *= 10.0
        return None

    def _estimate(
        self, state: _State, densities: list[np.ndarray], steps: list[Step], outcome: Outcome
    ) -> Estimate:
        n_theta = state.theta.size
        n_data = sum(2 * e.measured.size for e in self.experiments)
        inflation = n_data / (n_data - n_theta)
        weights = [W / inflation for W in self.weights(densities)]
        N = self.quadratic(state, weights)[0]
        found = covariance(self.models, state.theta, weights, N, self.prior_information, inflation)
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
        lines = tuple(
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
            lines=lines,
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


def _size_in_std_errors(N: np.ndarray, delta: np.ndarray) -> float:
    """Largest step against a lower bound of its standard error, correlation ignored."""
    return float(np.max(np.abs(delta) * np.sqrt(2.0 * np.diag(N))))


def _gradient_is_small(N: np.ndarray, g: np.ndarray) -> bool:
    return bool(np.max(np.abs(g) / np.sqrt(np.maximum(np.diag(N), 1e-300))) < 1e-2)
