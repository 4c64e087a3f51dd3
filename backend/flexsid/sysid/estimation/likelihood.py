"""Maximum likelihood with unknown noise, shared by OE and FRE (Eqs 19 and 22).

The residuals' density S and the parameters are relaxed in turn: S from the
current residuals, then one Levenberg-Marquardt step with S held. A step that
lowers the weighted residuals also lowers the likelihood with S concentrated out,
so the recorded cost never rises.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from flexsid.errors import BadInput, Cancelled, NotIdentifiable
from flexsid.sysid.estimation import noise
from flexsid.sysid.estimation.covariance import FinalLines, covariance
from flexsid.sysid.estimation.estimate import (
    Estimate,
    FittedLines,
    IterationStep,
    Outcome,
    count_iterations,
)
from flexsid.sysid.estimation.experiment import Experiment
from flexsid.sysid.estimation.kronecker import NormalForm
from flexsid.sysid.estimation.line_model import LineModel, ModelResponse, Sensitivity
from flexsid.sysid.estimation.measured_motion import motion_seen
from flexsid.sysid.estimation.parameters import Parameters
from flexsid.sysid.estimation.steps import (
    curvatures,
    damped_step,
    gradient_is_small,
    size_in_std_errors,
)

Report = Callable[[int, float], None]
_AS_EXPECTED = 0.75  # of what the curvature promises: good enough to look no further
_CONVERGING = 0.3  # share of the step before: smaller ones shrink for good
_QUICK = 4  # iterations that may pass before a fit counts as slow
_ALONG = 0.1  # of a step: where its bend is felt
_LOST = 0.4  # share of the measured power that the model leaves
_AFTER_LEAP = 1e-6  # damping, for the optimum is near
_ALMOST_NONE = 1e-10  # damping against rounding alone
_NEAR = 20  # standard errors: steps below count as near the optimum


@dataclass(frozen=True, slots=True, kw_only=True)
class FitSettings:
    """How to maximise.

    ``tolerance`` is how far from the optimum, in standard errors, counts as there;
    ``priors`` holds value and standard deviation by parameter name.
    """

    max_iterations: int = 50
    tolerance: float = 2e-2
    noise: str = "diagonal"
    priors: Mapping[str, tuple[float, float]] | None = None


@dataclass(frozen=True, slots=True)
class _State:
    """Everything at one theta."""

    theta: np.ndarray
    responses: list[ModelResponse]
    residuals: list[np.ndarray]
    densities: list[noise.LineMatrix]
    cost: float


@dataclass(frozen=True, slots=True)
class _Expansion:
    """Normal matrix, gradient and sensitivities around a state, for these weights."""

    N: np.ndarray
    g: np.ndarray
    weights: list[noise.LineMatrix]
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
        Called with iteration and cost after every accepted step; where it raises
        ``Cancelled`` the fit ends with what it has reached.

    Returns
    -------
    Estimate
        With a named outcome; also where the iteration did not converge.

    Raises
    ------
    BadInput
        If a prior is of no free parameter or has no spread.
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
        self.forms = [NormalForm(model) for model in self.models]
        self.measured_powers = [
            noise.group_powers(e.measured, e.group, len(e.group_names)) for e in experiments
        ]
        self.prior_mean, self.prior_information = _prior(parameters, settings)

    def at(self, theta: np.ndarray) -> _State:
        """Everything at theta; the cost is infinite where the model has no response."""
        responses = [model.respond(theta) for model in self.models]
        residuals = [
            e.measured - r.outputs for e, r in zip(self.experiments, responses, strict=True)
        ]
        if not all(np.isfinite(nu).all() for nu in residuals):
            return _State(theta, responses, residuals, [], np.inf)
        densities = []
        cost = float(self.prior_information @ (theta - self.prior_mean) ** 2)
        for e, nu, power in zip(self.experiments, residuals, self.measured_powers, strict=True):
            density, part = noise.residual_density(nu, power, e.group, self.settings.noise)
            densities.append(density)
            cost += part
        return _State(theta, responses, residuals, densities, cost)

    def run(self, report: Report) -> Estimate:
        state = self.at(self.parameters.start)
        if not np.isfinite(state.cost):
            raise NotIdentifiable(
                "the model has no finite response at the starting values; start from a "
                "prediction or from equation error",
                code="bad-start",
            )
        steps = [IterationStep(0, state.cost, np.inf)]
        damping = 1e-4
        outcome = Outcome.ITERATION_LIMIT
        for iteration in range(1, self.settings.max_iterations + 1):
            near, slow = steps[-1].step < _NEAR, iteration > _QUICK
            weights = [noise.likelihood_weights(S) for S in state.densities]
            leaping = iteration == 1 and self._is_lost(state)
            around = self.expand(state, weights, measured=leaping)
            found = self._leap(state, around) if leaping else None
            if found is None:
                around = self.expand(state, weights) if leaping else around
                found = self._step(state, around, damping, near=near, slow=slow)
            if found is None:
                small = gradient_is_small(around.N, around.g)
                outcome = Outcome.CONVERGED if small else Outcome.DIVERGED
                break
            trial, damping = found
            size = size_in_std_errors(around.N, trial.theta - state.theta)
            state = trial
            steps.append(IterationStep(iteration, state.cost, size))
            try:
                report(iteration, state.cost)
            except Cancelled:
                outcome = Outcome.CANCELLED
                break
            if _left_to_go(steps) < self.settings.tolerance and damping <= 1e-3:
                outcome = Outcome.CONVERGED
                break
        return self._estimate(state, steps, outcome)

    def expand(
        self, state: _State, weights: list[noise.LineMatrix], *, measured: bool = False
    ) -> _Expansion:
        """Expand the cost around a state, with the noise held.

        Notes
        -----
        With the motion that the sensors tell in place of the model's, measured less modelled
        outputs are G Theta w for a change Theta of any size, but for the noise: far from the
        optimum that leads further than the motion of a model whose resonances lie elsewhere.
        Near it, noise in that motion would bias. Source: Sanathanan and Koerner (1963).
        """
        N = np.diag(self.prior_information)
        g = self.prior_information * (self.prior_mean - state.theta)
        sensitivities = []
        for form, response, nu, W in zip(
            self.forms, state.responses, state.residuals, weights, strict=True
        ):
            if measured:
                response = replace(response, motion=motion_seen(response, nu, W))
            sensitivity = form.model.sensitivity(state.theta, response)
            sensitivities.append(sensitivity)
            n_part, g_part = form.equations(sensitivity, nu, W)
            N += n_part
            g += g_part
        return _Expansion(N, g, weights, sensitivities)

    def followed(self, state: _State, around: _Expansion) -> Float[np.ndarray, "n_theta any"]:
        """What letting S follow takes off the curvature, as columns of a square.

        With S concentrated out the cost is sum M ln |S|, whose curvature lacks
        2/M tr(H_i H_j) of the whitened matrices H_i = dS/dtheta_i; of a diagonal S,
        2/M g_o g_o^T of every output o. Without this term the relaxation of S converges
        only linearly where the model is of too low an order.
        """
        columns = [np.empty((state.theta.size, 0))]
        for form, sensitivity, nu, W in zip(
            self.forms, around.sensitivities, state.residuals, around.weights, strict=True
        ):
            counts = np.bincount(W.block)
            if not W.is_diagonal and noise.shrinkage(int(counts.min()), nu.shape[1]) > 0.0:
                continue  # a shrunk S is no minimum of the cost
            gradients = form.output_gradients if W.is_diagonal else form.matrix_gradients
            parts = gradients(sensitivity, nu, W)
            columns.extend(np.sqrt(2.0 / n) * g for n, g in zip(counts, parts, strict=True))
        return np.concatenate(columns, axis=1)

    def _step(
        self, state: _State, around: _Expansion, damping: float, *, near: bool, slow: bool
    ) -> tuple[_State, float] | None:
        """Best trial with the least damping that lowers the cost.

        With S concentrated out the curvature is exact near the optimum; far from it another
        may lead further, so that several are tried.
        """
        followed = self.followed(state, around)
        while damping < 1e9:
            best = state
            for matrix in curvatures(around.N, followed, slow=slow):
                delta = damped_step(matrix, np.diag(around.N), around.g, damping)
                if delta is None:
                    continue
                trial = self.at(state.theta + delta)
                if trial.cost <= best.cost + 1e-12 * abs(best.cost):
                    best = trial
                    expected = float(around.g @ delta)
                    if near or state.cost - trial.cost > _AS_EXPECTED * expected:
                        break
            if best is state:
                best = self._bent(state, around, damping)
            if best is not state:
                return best, max(0.1 * damping, 1e-12)
            damping *= 10.0
        return None

    def _is_lost(self, state: _State) -> bool:
        """Whether the model leaves so much of what sensors measure that its motion misleads."""
        left = []
        for e, nu, power in zip(
            self.experiments, state.residuals, self.measured_powers, strict=True
        ):
            left.append(noise.group_powers(nu, e.group, len(e.group_names)) / power)
        return bool(np.mean(np.concatenate(left)) > _LOST)

    def _leap(self, state: _State, around: _Expansion) -> tuple[_State, float] | None:
        """Full step of an expansion by measured motion, None where it does not lower the cost."""
        delta = damped_step(around.N, np.diag(around.N), around.g, _ALMOST_NONE)
        if delta is None:
            return None
        trial = self.at(state.theta + delta)
        return (trial, _AFTER_LEAP) if trial.cost < state.cost else None

    def _bent(self, state: _State, around: _Expansion, damping: float) -> _State:
        """Follow the bend of a valley where no straight step leads down; the same if none does.

        Notes
        -----
        Source: Transtrum and Sethna, geodesic acceleration of Levenberg-Marquardt steps.
        Near flutter a resonance between two lines makes valleys so narrow that a correction
        of a hundredth of the step halves the cost.
        """
        diagonal = np.diag(around.N)
        delta = damped_step(around.N, diagonal, around.g, damping)
        if delta is None:
            return state
        pull = np.zeros_like(delta)
        for form, sensitivity, response, W in zip(
            self.forms, around.sensitivities, state.responses, around.weights, strict=True
        ):
            after = form.model.respond(state.theta + _ALONG * delta).outputs
            before = form.model.respond(state.theta - _ALONG * delta).outputs
            curving = (after - 2.0 * response.outputs + before) / _ALONG**2
            pull -= 0.5 * form.gradient(sensitivity, curving, W)
        bend = damped_step(around.N, diagonal, pull, damping)
        if bend is None or not diagonal @ bend**2 < diagonal @ delta**2:
            return state
        trial = self.at(state.theta + delta + bend)
        return trial if trial.cost < state.cost else state

    def _estimate(self, state: _State, steps: list[IterationStep], outcome: Outcome) -> Estimate:
        n_theta = state.theta.size
        n_data = sum(2 * e.measured.size for e in self.experiments)
        inflation = n_data / (n_data - n_theta)
        around = self.expand(
            state, [noise.likelihood_weights(S.scaled(inflation)) for S in state.densities]
        )
        lines = [
            FinalLines(form, sensitivity, nu, W)
            for form, sensitivity, nu, W in zip(
                self.forms, around.sensitivities, state.residuals, around.weights, strict=True
            )
        ]
        found = covariance(lines, around.N, self.prior_information, inflation)
        weak = found.weak_directions(self.parameters.names)
        message = describe_outcome(outcome, steps)
        if weak:
            collinear = (
                "The data do not tell these parameters apart: "
                + "; ".join(weak)
                + ". Hold some of them fixed, or give a prior."
            )
            if outcome is Outcome.CONVERGED:
                outcome, message = Outcome.SINGULAR_INFORMATION, collinear
            else:
                message = f"{message} {collinear}"
        fitted = tuple(
            FittedLines(
                name,
                e.model.outputs,
                e.omega[pick],
                e.measured[pick],
                response.outputs[pick],
                None if alike is None else alike[np.ix_(pick, pick)],
            )
            for e, response, alike in zip(
                self.experiments,
                state.responses,
                (e.noise_correlation() for e in self.experiments),
                strict=True,
            )
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
    Outcome.CONVERGED: "Converged in {iterations}.",
    Outcome.ITERATION_LIMIT: (
        "Stopped at the limit of {limit} before the steps became small{in_all}; values are "
        "those reached by then and have no standard errors: raise the limit or start closer."
    ),
    Outcome.CANCELLED: (
        "Cancelled after {iterations}; values are those reached by then, not those of the optimum."
    ),
    Outcome.DIVERGED: (
        "No step lowers the cost although the gradient is not zero ({iterations}); values "
        "have no standard errors: start closer, or free fewer parameters."
    ),
}


def describe_outcome(outcome: Outcome, steps: Sequence[IterationStep]) -> str:
    """How a fit ended, and after how many iterations of all its stages."""
    if outcome is Outcome.SINGULAR_INFORMATION:
        outcome = Outcome.CONVERGED
    last = steps[-1]
    words = count_iterations(last.iteration)
    begun = next(step.iteration for step in steps if step.stage == last.stage)
    if last.stage:
        first = next(step.iteration for step in steps if step.stage)
        again = "fit" if last.stage == 1 else "fits"
        words += (
            f" ({last.iteration - first} of them in {last.stage} {again} after correcting for "
            "the ends of the record)"
        )
    return _MESSAGES[outcome].format(
        iterations=words,
        limit=count_iterations(last.iteration - begun),
        in_all=f", {words} in all" if last.stage else "",
    )


def _prior(
    parameters: Parameters, settings: FitSettings
) -> tuple[Float[np.ndarray, " n_theta"], Float[np.ndarray, " n_theta"]]:
    mean = parameters.start.copy()
    information = np.zeros_like(mean)
    for name, (value, sigma) in (settings.priors or {}).items():
        if name not in parameters.names:
            raise BadInput(
                f"the prior of '{name}' has no free parameter to act on",
                code="unknown-parameter",
                name=name,
            )
        if not (np.isfinite(value) and sigma > 0.0):
            raise BadInput(
                f"the prior of '{name}' is {value:g} with standard deviation {sigma:g}; give a "
                "finite value and a deviation above zero",
                code="bad-prior",
                name=name,
            )
        index = parameters.names.index(name)
        mean[index] = value
        information[index] = 0.5 / sigma**2
    return mean, information


def _left_to_go(steps: Sequence[IterationStep]) -> float:
    """Standard errors still to go if steps keep shrinking as the last one did."""
    last, before = steps[-1].step, steps[-2].step
    rate = last / before if np.isfinite(before) and before > 0 else 1.0
    return last * rate / (1.0 - rate) if rate < _CONVERGING else last
