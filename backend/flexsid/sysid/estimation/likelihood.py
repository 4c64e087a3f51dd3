"""Maximum likelihood with unknown noise, shared by OE and FRE (Eqs 19 and 22).

The residual covariance S and the parameters are estimated in alternation: S from the
current residuals, then one Levenberg-Marquardt step with S held. A step that reduces
the weighted residuals also reduces the cost with S concentrated out, so that the
recorded cost never increases.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from flexsid.errors import BadInput, Cancelled, NotIdentifiable
from flexsid.sysid.estimation import noise
from flexsid.sysid.estimation.covariance import FinalSpectra, compute_covariance, invert_regular
from flexsid.sysid.estimation.estimate import (
    ErrorComponents,
    Estimate,
    FittedSpectra,
    IterationStep,
    Outcome,
    count_iterations,
)
from flexsid.sysid.estimation.experiment import SHAPE_ERRORS, Experiment, Parameters
from flexsid.sysid.estimation.frequency_domain_model import (
    FrequencyDomainModel,
    ModelResponse,
    Sensitivity,
    estimate_measured_motion,
)
from flexsid.sysid.estimation.kronecker import NormalForm
from flexsid.sysid.estimation.linear_algebra import (
    compute_step_size,
    is_gradient_small,
    list_curvatures,
    solve_damped_step,
)
from flexsid.sysid.estimation.priors import build_information, name_priors

Report = Callable[[int, float], None]
_GOOD_REDUCTION = 0.75  # of the predicted cost reduction: no further trial is made
_CONVERGING = 0.3  # ratio of successive steps below which they converge
_ALIGNED = 0.9  # cosine of two steps with one direction
_LARGEST_RATIO = 0.97  # of successive steps, for their extrapolation
_QUICK = 4  # iterations after which a fit counts as slow
_ALONG = 0.1  # of a step: distance of the differences for its geodesic acceleration
_POOR_START = 0.4  # share of the measured power in the residuals
_DAMPING_AT_START = 1e-4  # of the diagonal of the normal matrix
_DAMPING_AFTER_INITIAL_STEP = 1e-6  # after a Sanathanan-Koerner step: the optimum is near
_ALMOST_NONE = 1e-10  # damping against rounding alone
_LARGEST_DAMPING = 1e9  # no step reduces the cost
_CONVERGED_DAMPING = 1e-3  # above, small steps are due to damping and not convergence
_LONG = 30  # iterations after which a fit of mode shapes need only be close: products of
# parameters (of a mode's motion and the errors of its shape) bend the cost, so that steps wander
# about the optimum. Elsewhere small steps of a long fit are a slow way to it.
_CLOSE = 0.1  # standard errors of any combination of parameters from the optimum, by the gradient
_NEAR = 20  # standard errors: smaller steps count as near the optimum
_ROUNDING = 1e-12  # relative increase of the cost that counts as rounding


@dataclass(frozen=True, slots=True, kw_only=True)
class FitSettings:
    """Settings of the maximisation.

    ``tolerance`` is the distance to the optimum, in standard errors, at convergence;
    ``priors`` are value and standard deviation by parameter name.
    """

    max_iterations: int = 50
    tolerance: float = 2e-2
    noise: str = "diagonal"
    priors: Mapping[str, tuple[float, float]] | None = None


@dataclass(frozen=True, slots=True)
class _State:
    """Responses, residuals, covariances and cost at one theta."""

    theta: np.ndarray
    responses: list[ModelResponse]
    residuals: list[np.ndarray]
    densities: list[noise.SpectralMatrix]
    cost: float


@dataclass(frozen=True, slots=True)
class _Expansion:
    """Normal matrix N = Re sum J^H W J, g = Re sum J^H W nu and sensitivities at a state."""

    N: np.ndarray
    g: np.ndarray
    weights: list[noise.SpectralMatrix]
    sensitivities: list[Sensitivity]


def maximize(
    experiments: Sequence[Experiment],
    parameters: Parameters,
    settings: FitSettings = FitSettings(),
    report: Report | None = None,
) -> Estimate:
    """Maximise the likelihood of the measured spectra.

    Parameters
    ----------
    experiments
        One or more maneuvers that share the parameters.
    parameters
        Free parameters and their starting values.
    settings
        Limits, noise model, priors.
    report
        Called with iteration and cost after every accepted step; if it raises
        ``Cancelled`` the fit ends with the present values.

    Returns
    -------
    Estimate
        With its outcome, also if the iteration did not converge.

    Raises
    ------
    BadInput
        If a prior belongs to no free parameter or has no standard deviation.
    NotIdentifiable
        If there are more parameters than independent measured numbers.

    Notes
    -----
    Minimises J = sum nu^H S^-1 nu + M ln|S|, with S and the parameters in alternation (Eqs 19-20;
    Klein and Morelli, Aircraft System Identification, doi:10.2514/4.861505, ch. 6). S concentrated
    out is in the curvature of each Levenberg-Marquardt step.
    """
    problem = _Problem(experiments, parameters, settings)
    n_data = sum(2 * e.measured.size for e in experiments)
    n_free = int(np.count_nonzero(np.diag(problem.prior_information) == 0.0))
    if n_data <= n_free:
        raise NotIdentifiable(
            f"{n_free} parameters are free but the data are only {n_data} "
            "real numbers; free fewer parameters or widen the band",
            parameters=n_free,
            data=n_data,
        )
    return problem.run(report or (lambda iteration, cost: None))


class _Problem:
    """Models, priors and methods of one maximisation."""

    def __init__(
        self, experiments: Sequence[Experiment], parameters: Parameters, settings: FitSettings
    ) -> None:
        self.experiments = experiments
        self.parameters = parameters
        self.settings = settings
        self.models = [FrequencyDomainModel(e, parameters) for e in experiments]
        self.forms = [NormalForm(model) for model in self.models]
        self.measured_powers = [
            noise.compute_group_powers(e.measured, e.group, len(e.group_names)) for e in experiments
        ]
        self.prior_mean, self.prior_information = build_prior(parameters, settings.priors)

    def at(self, theta: np.ndarray) -> _State:
        """Compute the state at theta; the cost is infinite without a finite response."""
        responses = [model.respond(theta) for model in self.models]
        residuals = [
            e.measured - r.outputs for e, r in zip(self.experiments, responses, strict=True)
        ]
        if not all(np.isfinite(nu).all() for nu in residuals):
            return _State(theta, responses, residuals, [], np.inf)
        densities = []
        away = theta - self.prior_mean
        cost = float(away @ self.prior_information @ away)
        for e, nu, power in zip(self.experiments, residuals, self.measured_powers, strict=True):
            density, part = noise.compute_residual_density(nu, power, e.group, self.settings.noise)
            densities.append(density)
            cost += part
        return _State(theta, responses, residuals, densities, cost)

    def run(self, report: Report) -> Estimate:
        """Iterate from the starting values until an outcome is reached."""
        state = self.at(self.parameters.start)
        if not np.isfinite(state.cost):
            raise NotIdentifiable(
                "the model has no finite response at the starting values; start from a "
                "prediction or from equation error",
                code="bad-start",
            )
        steps = [IterationStep(0, state.cost, np.inf)]
        bent = any(extra.kind in SHAPE_ERRORS for extra in self.parameters.extras)
        bent_after = _LONG if bent else self.settings.max_iterations
        damping = _DAMPING_AT_START
        pace: np.ndarray | None = None
        outcome = Outcome.ITERATION_LIMIT
        for iteration in range(1, self.settings.max_iterations + 1):
            near, slow = steps[-1].step < _NEAR, iteration > _QUICK
            weights = [noise.compute_likelihood_weights(S) for S in state.densities]
            is_poor = iteration == 1 and self._is_poor_start(state)
            around = self.expand(state, weights, measured=is_poor)
            found = self._take_initial_step(state, around) if is_poor else None
            if found is None:
                around = self.expand(state, weights) if is_poor else around
                found = self._take_step(state, around, damping, near=near, slow=slow)
            if found is None:
                small = is_gradient_small(around.N, around.g)
                outcome = Outcome.CONVERGED if small else Outcome.DIVERGED
                break
            trial, damping = found
            # Of a quadratic cost: its reduction is half the square of the distance.
            reduction = float(around.g @ (trial.theta - state.theta))
            is_close = iteration > bent_after and 2.0 * reduction < _CLOSE**2
            trial, pace = self._extrapolate(state, trial, around.N, pace)
            size = compute_step_size(around.N, trial.theta - state.theta)
            state = trial
            steps.append(IterationStep(iteration, state.cost, size))
            try:
                report(iteration, state.cost)
            except Cancelled:
                outcome = Outcome.CANCELLED
                break
            remaining = _predict_remaining(steps)
            is_near = is_close or remaining < self.settings.tolerance
            if is_near and damping <= _CONVERGED_DAMPING:
                outcome = Outcome.CONVERGED
                break
        return self._build_estimate(state, steps, outcome)

    def expand(
        self, state: _State, weights: list[noise.SpectralMatrix], *, measured: bool = False
    ) -> _Expansion:
        """Expand the cost to second order at a state, with the noise covariance held.

        Notes
        -----
        With S held the gradient of the cost is -2 g and its Gauss-Newton curvature 2 N, so
        that the step is N^-1 g. With the motion estimated from the sensors in place of the
        model's, measured less modelled outputs are G Theta w for a change Theta of any size,
        apart from noise: far from the optimum this step is longer than with the motion of a
        model of other resonances. Near it, noise of that motion would cause bias.
        Source: Sanathanan and Koerner (1963).
        """
        N = self.prior_information.copy()
        g = self.prior_information @ (self.prior_mean - state.theta)
        sensitivities = []
        for form, response, nu, W in zip(
            self.forms, state.responses, state.residuals, weights, strict=True
        ):
            if measured:
                response = replace(response, motion=estimate_measured_motion(response, nu, W))
            sensitivity = form.model.sensitivity(state.theta, response)
            sensitivities.append(sensitivity)
            n_part, g_part = form.equations(sensitivity, nu, W)
            N += n_part
            g += g_part
        return _Expansion(N, g, weights, sensitivities)

    def compute_concentrated_curvature(
        self, state: _State, around: _Expansion
    ) -> Float[np.ndarray, "n_theta any"]:
        """Compute the reduction of N with S concentrated out, as columns of a square.

        Notes
        -----
        With S(theta) = 1/M sum nu nu^H the concentrated cost is sum M ln |S|. Its curvature is
        2 N - M tr(S^-1 dS/dtheta_i S^-1 dS/dtheta_j), in addition to terms of second
        derivatives: N is reduced by 2/M tr(H_i H_j) with H_i = -M/2 dS/dtheta_i whitened by
        W = S^-1; for a diagonal S, by 2/M g_o g_o^T of every output o. Without this term the
        iteration converges only linearly for a model of too low an order.
        """
        columns = [np.empty((state.theta.size, 0))]
        for form, sensitivity, nu, W in zip(
            self.forms, around.sensitivities, state.residuals, around.weights, strict=True
        ):
            counts = np.bincount(W.block)
            if not W.is_diagonal and noise.shrinkage(int(counts.min()), nu.shape[1]) > 0.0:
                continue  # a shrunk S does not minimise the cost
            gradients = form.output_gradients if W.is_diagonal else form.matrix_gradients
            parts = gradients(sensitivity, nu, W)
            columns.extend(np.sqrt(2.0 / n) * g for n, g in zip(counts, parts, strict=True))
        return np.concatenate(columns, axis=1)

    def _take_step(
        self, state: _State, around: _Expansion, damping: float, *, near: bool, slow: bool
    ) -> tuple[_State, float] | None:
        """Take the best step of the least damping that reduces the cost, None without one.

        With S concentrated out the curvature is accurate near the optimum; far from it
        another one may reduce the cost more, so that several are tried.
        """
        concentrated = self.compute_concentrated_curvature(state, around)
        while damping < _LARGEST_DAMPING:
            best = state
            for matrix in list_curvatures(around.N, concentrated, slow=slow):
                delta = solve_damped_step(matrix, np.diag(around.N), around.g, damping)
                if delta is None:
                    continue
                trial = self.at(state.theta + delta)
                if trial.cost <= best.cost + _ROUNDING * abs(best.cost):
                    best = trial
                    expected = float(around.g @ delta)
                    if near or state.cost - trial.cost > _GOOD_REDUCTION * expected:
                        break
            if best is state:
                best = self._accelerate(state, around, damping)
            if best is not state:
                return best, max(0.1 * damping, 1e-12)
            damping *= 10.0
        return None

    def _extrapolate(
        self, state: _State, trial: _State, N: np.ndarray, before: np.ndarray | None
    ) -> tuple[_State, np.ndarray | None]:
        """Change the length of a step along the one before; the step to compare the next with.

        Notes
        -----
        Without the second derivatives of the model the iteration converges linearly where
        residuals are large: steps keep their direction and change by a constant ratio r, which is
        -0.95 where the curvature is half of the true one, so that each step overshoots. The sum of
        all further steps is 1 / (1 - r) times the first (Aitken's extrapolation).
        """
        step = trial.theta - state.theta
        if before is None or not before.any():
            return trial, step
        scaled = N @ step
        along, own, other = before @ scaled, step @ scaled, before @ N @ before
        ratio = along / other
        is_linear = abs(ratio) > _CONVERGING and ratio < 1.0
        if not is_linear or along**2 < _ALIGNED**2 * own * other:
            return trial, step
        summed = self.at(state.theta + step / (1.0 - min(ratio, _LARGEST_RATIO)))
        return (summed, None) if summed.cost < trial.cost else (trial, step)

    def _is_poor_start(self, state: _State) -> bool:
        """Whether the residuals exceed ``_POOR_START`` of the measured power on average."""
        left = []
        for e, nu, power in zip(
            self.experiments, state.residuals, self.measured_powers, strict=True
        ):
            left.append(noise.compute_group_powers(nu, e.group, len(e.group_names)) / power)
        return bool(np.mean(np.concatenate(left)) > _POOR_START)

    def _take_initial_step(self, state: _State, around: _Expansion) -> tuple[_State, float] | None:
        """Take a full Sanathanan-Koerner step, None if it does not reduce the cost."""
        delta = solve_damped_step(around.N, np.diag(around.N), around.g, _ALMOST_NONE)
        if delta is None:
            return None
        trial = self.at(state.theta + delta)
        return (trial, _DAMPING_AFTER_INITIAL_STEP) if trial.cost < state.cost else None

    def _accelerate(self, state: _State, around: _Expansion, damping: float) -> _State:
        """Add the geodesic acceleration to a step; the same state if the cost is not reduced.

        Notes
        -----
        Source: Transtrum and Sethna, geodesic acceleration of Levenberg-Marquardt steps.
        Near flutter a resonance between two frequencies makes valleys of the cost so narrow
        that a correction of a hundredth of the step halves the cost.
        """
        diagonal = np.diag(around.N)
        delta = solve_damped_step(around.N, diagonal, around.g, damping)
        if delta is None:
            return state
        gradient = np.zeros_like(delta)
        for form, sensitivity, response, W in zip(
            self.forms, around.sensitivities, state.responses, around.weights, strict=True
        ):
            after = form.model.respond(state.theta + _ALONG * delta).outputs
            before = form.model.respond(state.theta - _ALONG * delta).outputs
            curvature = (after - 2.0 * response.outputs + before) / _ALONG**2
            gradient -= 0.5 * form.gradient(sensitivity, curvature, W)
        acceleration = solve_damped_step(around.N, diagonal, gradient, damping)
        if acceleration is None or not diagonal @ acceleration**2 < diagonal @ delta**2:
            return state
        trial = self.at(state.theta + delta + acceleration)
        return trial if trial.cost < state.cost else state

    def _build_estimate(
        self, state: _State, steps: list[IterationStep], outcome: Outcome
    ) -> Estimate:
        n_data = sum(2 * e.measured.size for e in self.experiments)
        uncorrected = self.expand(
            state, [noise.compute_likelihood_weights(S) for S in state.densities]
        )
        n_effective = count_effective_parameters(uncorrected.N, self.prior_information)
        inflation = n_data / max(n_data - n_effective, 1.0)
        around = self.expand(
            state, [noise.compute_likelihood_weights(S.scaled(inflation)) for S in state.densities]
        )
        lines = [
            FinalSpectra(
                form, sensitivity, nu, W, source=self._compute_source_residuals(form, state)
            )
            for form, sensitivity, nu, W in zip(
                self.forms, around.sensitivities, state.residuals, around.weights, strict=True
            )
        ]
        found = compute_covariance(lines, around.N, self.prior_information, inflation)
        weak = found.weak_directions(self.parameters.names)
        message = describe_outcome(outcome, steps)
        if weak:
            collinear = (
                "These parameters are not separately identifiable: "
                + "; ".join(weak)
                + ". Hold some of them fixed, or specify a prior."
            )
            if outcome is Outcome.CONVERGED:
                outcome, message = Outcome.SINGULAR_INFORMATION, collinear
            else:
                message = f"{message} {collinear}"
        fitted = tuple(
            FittedSpectra(
                name,
                e.model.outputs,
                e.omega[pick],
                e.measured[pick],
                response.outputs[pick],
                None if correlation is None else correlation[np.ix_(pick, pick)],
            )
            for e, response, correlation in zip(
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
            components=ErrorComponents(
                tuple((e.source or e).omega for e in self.experiments),
                found.noise_components,
                name_priors(self.parameters.names, self.settings.priors),
                found.prior_components,
            ),
        )

    def _compute_source_residuals(self, form: NormalForm, state: _State) -> np.ndarray | None:
        """Compute the residuals of the data points from which those of a maneuver were computed."""
        source = form.model.experiment.source
        if source is None:
            return None
        model = FrequencyDomainModel(source, self.parameters)
        return source.measured - model.respond(state.theta).outputs


_MESSAGES = {
    Outcome.CONVERGED: "Converged in {iterations}.",
    Outcome.ITERATION_LIMIT: (
        "Stopped at the limit of {limit} before the steps became small{in_all}; values are "
        "those of the last step and have no standard errors: raise the limit or start closer."
    ),
    Outcome.CANCELLED: (
        "Cancelled after {iterations}; values are those of the last step, not of the optimum."
    ),
    Outcome.DIVERGED: (
        "No step reduces the cost although the gradient is not zero ({iterations}); values "
        "have no standard errors: start closer, or free fewer parameters."
    ),
}


def describe_outcome(outcome: Outcome, steps: Sequence[IterationStep]) -> str:
    """Describe the outcome of a fit and the number of iterations of all its stages."""
    if outcome is Outcome.SINGULAR_INFORMATION:
        outcome = Outcome.CONVERGED
    last = steps[-1]
    count = count_iterations(last.iteration)
    begun = next(step.iteration for step in steps if step.stage == last.stage)
    if last.stage:
        first = next(step.iteration for step in steps if step.stage)
        again = "fit" if last.stage == 1 else "fits"
        count += (
            f" ({last.iteration - first} of them in {last.stage} {again} after correcting for "
            "the ends of the record)"
        )
    return _MESSAGES[outcome].format(
        iterations=count,
        limit=count_iterations(last.iteration - begun),
        in_all=f", {count} in all" if last.stage else "",
    )


def count_effective_parameters(
    information: Float[np.ndarray, "n_theta n_theta"],
    prior: Float[np.ndarray, "n_theta n_theta"],
) -> float:
    """Compute the number of parameters that the data determine: n_theta - tr(P N^-1).

    Notes
    -----
    N is the whole information and P that of the priors in it. A parameter that its
    prior determines takes no degree of freedom from the residuals.
    Source: MacKay, Bayesian interpolation, Neural Computation 4 (1992), eq. 4.9.
    """
    held = np.flatnonzero(np.diag(prior))
    if not held.size:
        return float(len(prior))
    own = np.diag(information)
    size = 1.0 / np.sqrt(np.where(own > np.finfo(float).tiny, own, 1.0))
    scaled = information * np.outer(size, size)
    strength = prior * np.outer(size, size)
    inverse = invert_regular(scaled)
    if inverse is None:
        right = np.zeros((len(prior), held.size))
        right[held, np.arange(held.size)] = 1.0
        inverse = np.zeros_like(scaled)
        inverse[:, held] = np.linalg.lstsq(scaled, right, rcond=1e-13)[0]
    removed = float(np.sum(inverse * strength))
    return len(prior) - float(np.clip(removed, 0.0, held.size))


def build_prior(
    parameters: Parameters, priors: Mapping[str, tuple[float, float]] | None
) -> tuple[Float[np.ndarray, " n_theta"], Float[np.ndarray, "n_theta n_theta"]]:
    """Return the means of the priors, and their information 1/2 C^-1; zero without a prior.

    Raises
    ------
    BadInput
        If a prior belongs to no free parameter or has no standard deviation.
    """
    mean = parameters.start.copy()
    for name, (value, sigma) in (priors or {}).items():
        if name not in parameters.names:
            raise BadInput(
                f"the prior of '{name}' belongs to no free parameter; free it or drop the prior",
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
        mean[parameters.names.index(name)] = value
    return mean, build_information(parameters.names, priors)


def _predict_remaining(steps: Sequence[IterationStep]) -> float:
    """Predict the remaining standard errors if steps decrease at the last rate."""
    last, before = steps[-1].step, steps[-2].step
    rate = last / before if np.isfinite(before) and before > 0 else 1.0
    return last * rate / (1.0 - rate) if rate < _CONVERGING else last
