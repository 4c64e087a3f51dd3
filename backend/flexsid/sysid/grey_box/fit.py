"""Maximum likelihood of a grey-box model: output error of spectra, and errors of responses.

Both compare the outputs C (s I - A)^-1 (B u + e) + D u with measured ones at every frequency. Of
a record u are the spectra of its inputs and e the states at its ends, of which nothing is assumed;
of a frequency response u is one at one input, and e is zero.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import scipy
from jaxtyping import Complex, Float

from flexsid.errors import BadInput, NotIdentifiable
from flexsid.sysid.estimation import noise
from flexsid.sysid.estimation.estimate import Outcome
from flexsid.sysid.estimation.linear_algebra import (
    compute_step_size,
    is_gradient_small,
    list_curvatures,
    solve_damped_step,
)
from flexsid.sysid.grey_box.model import (
    GreyBox,
    StateArrays,
    differentiate,
    is_analytic,
)
from flexsid.sysid.model.aeroelastic import StateSpace
from flexsid.sysid.signals import FrequencyResponse

_ITERATIONS = 100
_CONVERGED = 1e-3  # standard errors, of the largest step
_FIRST_DAMPING, _LEAST_DAMPING, _LARGEST_DAMPING = 1e-3, 1e-12, 1e9
_END_SPREAD = 10.0  # prior of a state at an end, in its rms amplitude: it only keeps N regular
_LEAST_SPREAD = 1e-6  # of the largest amplitude of a state: states that do not move
_SINGULAR = 1e-8  # of the largest singular value of the scaled Jacobian
_NAMED = 0.2  # least part of a parameter in a singular direction that is reported
_LEVERAGE = 0.95  # of a frequency in a direction: leave-one-out residuals stay finite


@dataclass(frozen=True, slots=True, kw_only=True)
class GreyBoxData:
    """Spectra of one record, or the responses to one input.

    Attributes
    ----------
    omega
        Frequencies in order. [rad/s]
    inputs, outputs
        Of the model, at every frequency. [unit * s] for a record
    instruments
        Responses of the sensors, by which modelled outputs are multiplied; None: the model's
        outputs are the recorded ones.
    std
        Standard deviation of the outputs' complex errors; None where it is not known. Its size
        is estimated per output, so that only its course over frequency matters.
    ends_s
        Times at which the record begins or ends in motion. At multiples of 1/T one stands for
        both; empty for responses and whole periods. [s]
    duration_s
        Duration of the record, 0 for responses. [s]
    name
        Name in the tests of the fit.
    """

    omega: Float[np.ndarray, " n_omega"]
    inputs: Complex[np.ndarray, "n_omega n_u"]
    outputs: Complex[np.ndarray, "n_omega n_y"]
    instruments: Complex[np.ndarray, "n_omega n_y"] | None = None
    std: Float[np.ndarray, "n_omega n_y"] | None = None
    ends_s: tuple[float, ...] = ()
    duration_s: float = 0.0
    name: str = ""

    def get_factors(self) -> Complex[np.ndarray, "n_omega n_y"]:
        """Return the factors of modelled outputs: instruments over the course of the noise."""
        factors = np.ones(self.outputs.shape, dtype=complex)
        if self.instruments is not None:
            factors *= self.instruments
        return factors if self.std is None else factors / self.std

    def scale_outputs(self) -> Complex[np.ndarray, "n_omega n_y"]:
        """Return the outputs over the course of the noise."""
        return self.outputs if self.std is None else self.outputs / self.std


@dataclass(frozen=True, slots=True, kw_only=True)
class GreyBoxEstimate:
    """Parameters of a grey-box model with their covariance.

    Attributes
    ----------
    model
        The model.
    values, covariance
        Of its parameters; the covariance is that for the observed residuals.
    cramer_rao
        Standard errors for white residuals that are independent between outputs.
    matrices
        A, B, C, D at the estimate.
    slopes
        Their derivatives by the parameters.
    cost
        Negative logarithm of the likelihood, without constants.
    n_data
        Real numbers that were fitted.
    n_ends
        States at the ends of records that were estimated too.
    residuals, modelled
        Of every data set, in units of its outputs.
    leverage
        Share of the noise that the fit removes from each residual.
    outcome, iterations
        How the maximisation ended.
    by_complex_step
        Whether derivatives are exact; else by central differences.
    """

    model: GreyBox
    values: Float[np.ndarray, " n_theta"]
    covariance: Float[np.ndarray, "n_theta n_theta"]
    cramer_rao: Float[np.ndarray, " n_theta"]
    matrices: StateSpace
    slopes: tuple[StateArrays, ...]
    cost: float
    n_data: int
    n_ends: int
    residuals: tuple[np.ndarray, ...]
    modelled: tuple[np.ndarray, ...]
    leverage: tuple[np.ndarray, ...]
    outcome: Outcome
    iterations: int
    by_complex_step: bool

    @property
    def std_errors(self) -> Float[np.ndarray, " n_theta"]:
        """Standard errors of the parameters."""
        return np.sqrt(np.diag(self.covariance))

    @property
    def bic(self) -> float:
        """Bayesian information criterion; of two models of the same data the lower is better."""
        n = self.values.size + self.n_ends
        return 2.0 * self.cost + n * float(np.log(self.n_data))

    def get_values(self) -> dict[str, float]:
        """Return the values by name."""
        return dict(zip(self.model.names, self.values.tolist(), strict=True))


def fit_grey_box(
    model: GreyBox,
    data: Sequence[GreyBoxData],
    condition: Any = None,
    report: Callable[[int, float], None] | None = None,
) -> GreyBoxEstimate:
    """Fit a grey-box model by maximum likelihood with unknown noise.

    Parameters
    ----------
    model
        Model with starting values and priors.
    data
        Spectra of records (output error), or responses (frequency-response error).
    condition
        Given to the function of the model.
    report
        Called with iteration and cost after every step.

    Raises
    ------
    BadInput
        If the channels of model and data differ, or the function returns no matrices.
    NotIdentifiable
        If the data do not determine the parameters, or there is no response at the start.

    Notes
    -----
    Minimises sum nu^H S^-1 nu + M ln |S| over the parameters and the diagonal covariance S of the
    residuals nu of each data set, by Levenberg-Marquardt with S concentrated out (Klein and
    Morelli, Aircraft System Identification, doi:10.2514/4.861505, ch. 6). At multiples of 1/T the
    ends of a record add C (s I - A)^-1 (x(0) - x(T)) exp(-s t_0) (Pintelon and Schoukens, System
    Identification, doi:10.1002/9781118287422, ch. 6). The covariance is
    1/2 N^-1 [Re sum J^H W S W J] N^-1 with S from neighbouring leave-one-out residuals, so that
    it holds for coloured residuals and ones that are correlated between outputs.
    """
    for one in data:
        n_u, n_y = one.inputs.shape[1], one.outputs.shape[1]
        if (n_u, n_y) != (len(model.inputs), len(model.outputs)):
            raise BadInput(
                f"the data have {n_u} inputs and {n_y} outputs; '{model.title}' has "
                f"{len(model.inputs)} and {len(model.outputs)}",
                code="other-channels",
            )
    analytic = is_analytic(model, model.starts, condition)
    estimate = _fit(model, data, condition, report, analytic=analytic)
    if analytic and not is_analytic(model, estimate.values, condition):
        estimate = _fit(model, data, condition, report, analytic=False)
    return estimate


def list_response_data(responses: Sequence[FrequencyResponse], model: GreyBox) -> list[GreyBoxData]:
    """Return the data of frequency responses for a grey-box model, one set for each input.

    Raises
    ------
    BadInput
        If a response has other outputs, or its input is none of the model.
    """
    outputs, inputs = tuple(model.outputs), tuple(model.inputs)
    data = []
    for one in responses:
        missing = [name for name in outputs if name not in one.outputs]
        missing += [name for name in one.inputs if name not in inputs]
        if missing:
            raise BadInput(
                f"the responses have no '{missing[0]}': they are of {', '.join(one.outputs)} to "
                f"{', '.join(one.inputs)}; '{model.title}' has {', '.join(outputs)} and "
                f"{', '.join(inputs)}",
                code="other-channels",
            )
        rows = [one.outputs.index(name) for name in outputs]
        for column, name in enumerate(one.inputs):
            unit = np.zeros((one.omega.size, len(inputs)), dtype=complex)
            unit[:, inputs.index(name)] = 1.0
            data.append(
                GreyBoxData(
                    omega=one.omega,
                    inputs=unit,
                    outputs=one.values[:, rows, column],
                    std=None if one.std is None else one.std[:, rows, column],
                    name=name,
                )
            )
    return data


# --- Response of the model, its derivatives, and the likelihood -----------------------------------


@dataclass(frozen=True, slots=True)
class _FitState:
    """Matrices, states, residuals and cost at parameters and end states; scaled by the noise."""

    theta: np.ndarray
    matrices: StateSpace
    motions: list[np.ndarray]
    modelled: list[np.ndarray]
    residuals: list[np.ndarray]
    densities: list[noise.SpectralMatrix]
    cost: float


@dataclass(frozen=True, slots=True)
class _GreyBoxProblem:
    """Model, data, and priors of parameters and end states."""

    model: GreyBox
    data: Sequence[GreyBoxData]
    condition: Any
    analytic: bool
    n_states: int
    mean: np.ndarray
    information: np.ndarray

    def at(self, theta: np.ndarray) -> _FitState | None:
        """Compute the state at theta; None without a finite response."""
        n = len(self.model.parameters)
        found = self.model.evaluate(theta[:n], self.condition)
        if not all(np.isfinite(one).all() for one in (found.A, found.B, found.C, found.D)):
            return None
        deviation = theta - self.mean
        cost = float(self.information @ deviation**2)
        motions, modelled, residuals, densities = [], [], [], []
        for one, ends in zip(self.data, self._split_ends(theta), strict=True):
            load = one.inputs @ found.B.T + _turn_ends(one) @ ends
            motion = _solve(found.A, one.omega, load[:, :, None])[:, :, 0]
            outputs = one.get_factors() * (motion @ found.C.T + one.inputs @ found.D.T)
            if not np.isfinite(outputs).all():
                return None
            nu = one.scale_outputs() - outputs
            group = np.zeros(one.omega.size, dtype=int)
            power = noise.compute_group_powers(one.scale_outputs(), group, 1)
            density, part = noise.compute_residual_density(nu, power, group, "diagonal")
            cost += part
            motions.append(motion)
            modelled.append(outputs)
            residuals.append(nu)
            densities.append(density)
        return _FitState(theta, found, motions, modelled, residuals, densities, cost)

    def try_at(self, theta: np.ndarray) -> _FitState | None:
        """Compute the state at a trial; None where the function has no value there."""
        try:
            return self.at(theta)
        except (ArithmeticError, ValueError):
            return None

    def _split_ends(self, theta: np.ndarray) -> list[np.ndarray]:
        """Return the states at the ends of every data set."""
        rest, result = theta[len(self.model.parameters) :], []
        for one in self.data:
            size = len(one.ends_s) * self.n_states
            result.append(rest[:size].reshape(len(one.ends_s), self.n_states))
            rest = rest[size:]
        return result

    def jacobian(self, state: _FitState) -> list[Complex[np.ndarray, "n_omega n_y n_theta"]]:
        """Differentiate the scaled outputs of every data set."""
        n = len(self.model.parameters)
        slopes = differentiate(self.model, state.theta[:n], self.condition, analytic=self.analytic)
        result, first = [], n
        for one, motion in zip(self.data, state.motions, strict=True):
            n_omega, n_y = one.outputs.shape
            size = len(one.ends_s) * self.n_states
            loads = [motion @ A.T + one.inputs @ B.T for A, B, _, _ in slopes]
            loads += [
                turn[:, None] * unit[None]
                for turn in _turn_ends(one).T
                for unit in np.eye(self.n_states)
            ]
            moved = _solve(state.matrices.A, one.omega, np.stack(loads, axis=2))
            J = np.zeros((n_omega, n_y, state.theta.size), dtype=complex)
            columns = np.append(np.arange(n), np.arange(first, first + size))
            J[:, :, columns] = state.matrices.C @ moved
            for k, (_, _, C, D) in enumerate(slopes):
                J[:, :, k] += motion @ C.T + one.inputs @ D.T
            result.append(one.get_factors()[:, :, None] * J)
            first += size
        return result


def _turn_ends(data: GreyBoxData) -> Complex[np.ndarray, "n_omega n_ends"]:
    return np.exp(-1j * np.outer(data.omega, np.array(data.ends_s, dtype=float)))


def _solve(
    A: Float[np.ndarray, "n_x n_x"],
    omega: Float[np.ndarray, " n_omega"],
    load: Complex[np.ndarray, "n_omega n_x n_k"],
) -> Complex[np.ndarray, "n_omega n_x n_k"]:
    """Solve (j omega I - A) x = load; not a number at an undamped pole."""
    if A.shape[0] == 0:
        return np.zeros(load.shape, dtype=complex)
    dynamics = 1j * omega[:, None, None] * np.eye(len(A)) - A
    try:
        return np.linalg.solve(dynamics, load)
    except np.linalg.LinAlgError:
        return np.full(load.shape, np.nan, dtype=complex)


# --- Maximisation ---------------------------------------------------------------------------------


def _fit(
    model: GreyBox,
    data: Sequence[GreyBoxData],
    condition: Any,
    report: Callable[[int, float], None] | None,
    *,
    analytic: bool,
) -> GreyBoxEstimate:
    begin = model.evaluate(model.starts, condition)
    n, n_x = len(model.parameters), begin.A.shape[0]
    n_ends = n_x * sum(len(one.ends_s) for one in data)
    mean, information = np.zeros(n + n_ends), np.zeros(n + n_ends)
    for k, one in enumerate(model.parameters):
        mean[k] = one.start
        if one.prior is not None:
            mean[k], information[k] = one.prior[0], 0.5 / one.prior[1] ** 2
    problem = _GreyBoxProblem(model, data, condition, analytic, n_x, mean, information)
    n_data = sum(2 * one.outputs.size for one in data)
    n_free = int(np.count_nonzero(information[:n] == 0.0))
    if n_data <= n_free + n_ends:
        raise NotIdentifiable(
            f"{n_free} parameters and {n_ends} states at the ends of records are free but the data "
            f"are only {n_data} real numbers; widen the band",
            parameters=n_free + n_ends,
            data=n_data,
        )
    state = problem.at(np.append(model.starts, np.zeros(n_ends)))
    if state is None:
        raise NotIdentifiable(
            f"'{model.title}' has no finite response at its starting values", code="bad-start"
        )
    outcome, total = Outcome.ITERATION_LIMIT, 0
    for _ in range(2 if n_ends else 1):  # amplitudes of the states are known after the first
        problem = _bound_ends(problem, state)
        again = problem.at(state.theta)
        assert again is not None
        state, outcome, iterations = _maximize(problem, again, report)
        total += iterations
    return _build_estimate(problem, state, outcome, total, n_data)


def _bound_ends(problem: _GreyBoxProblem, state: _FitState) -> _GreyBoxProblem:
    """Return the problem with priors of end states from the rms amplitude of the states.

    By Parseval's theorem the mean square of a state is 2/T^2 times the sum of its powers.
    """
    information, first = problem.information.copy(), len(problem.model.parameters)
    for one, motion in zip(problem.data, state.motions, strict=True):
        rms = np.sqrt(2.0 * np.sum(np.abs(motion) ** 2, axis=0)) / max(one.duration_s, 1e-300)
        rms = np.maximum(rms, _LEAST_SPREAD * rms.max(initial=0.0))
        spread = _END_SPREAD * np.where(rms > 0.0, rms, 1.0)
        for _ in one.ends_s:
            information[first : first + problem.n_states] = 0.5 / spread**2
            first += problem.n_states
    return replace(problem, information=information)


def _maximize(
    problem: _GreyBoxProblem, state: _FitState, report: Callable[[int, float], None] | None
) -> tuple[_FitState, Outcome, int]:
    damping = _FIRST_DAMPING
    for iteration in range(1, _ITERATIONS + 1):
        N, g, concentrated = _expand(problem, state)
        found = None
        while found is None and damping < _LARGEST_DAMPING:
            for curvature in list_curvatures(N, concentrated, slow=False):
                step = solve_damped_step(curvature, np.diag(N), g, damping)
                trial = None if step is None else problem.try_at(state.theta + step)
                if trial is not None and trial.cost < state.cost:
                    found = trial
                    break
            damping = damping * 10.0 if found is None else max(0.1 * damping, _LEAST_DAMPING)
        if found is None:
            at_optimum = is_gradient_small(N, g)
            return state, Outcome.CONVERGED if at_optimum else Outcome.DIVERGED, iteration
        size = compute_step_size(N, found.theta - state.theta)
        state = found
        if report is not None:
            report(iteration, state.cost)
        if size < _CONVERGED:
            return state, Outcome.CONVERGED, iteration
    return state, Outcome.ITERATION_LIMIT, _ITERATIONS


def _expand(
    problem: _GreyBoxProblem, state: _FitState
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Compute N, g, and the columns whose square S concentrated out removes from N."""
    N = np.diag(problem.information)
    g = problem.information * (problem.mean - state.theta)
    columns = []
    for J, nu, S in zip(problem.jacobian(state), state.residuals, state.densities, strict=True):
        rows = _as_rows(J, S)
        whitened = _whiten(nu, S)
        N += np.einsum("kri,krj->ij", rows, rows, optimize=True)
        by_output = np.einsum("kri,kr->ri", rows, whitened, optimize=True)
        n_y = nu.shape[1]
        of_outputs = by_output[:n_y] + by_output[n_y:]
        g += of_outputs.sum(axis=0)
        columns.append(np.sqrt(2.0 / len(nu)) * of_outputs.T)
    return N, g, np.concatenate(columns, axis=1)


def _as_rows(
    J: Complex[np.ndarray, "n_omega n_y n_theta"], density: noise.SpectralMatrix
) -> Float[np.ndarray, "n_omega n_rows n_theta"]:
    """Return real and imaginary rows of the Jacobian over the noise, at every frequency."""
    scaled = J / np.sqrt(density.expand_blocks())[:, :, None]
    return np.concatenate([np.real(scaled), np.imag(scaled)], axis=1)


def _whiten(
    nu: Complex[np.ndarray, "n_omega n_y"], density: noise.SpectralMatrix
) -> Float[np.ndarray, "n_omega n_rows"]:
    scaled = nu / np.sqrt(density.expand_blocks())
    return np.concatenate([np.real(scaled), np.imag(scaled)], axis=1)


# --- Covariance -----------------------------------------------------------------------------------


def _build_estimate(
    problem: _GreyBoxProblem, state: _FitState, outcome: Outcome, iterations: int, n_data: int
) -> GreyBoxEstimate:
    n, n_theta = len(problem.model.parameters), state.theta.size
    inflation = n_data / max(n_data - n_theta, 1)
    densities = [one.scaled(inflation) for one in state.densities]
    rows = [_as_rows(J, S) for J, S in zip(problem.jacobian(state), densities, strict=True)]
    stacked = [one.reshape(-1, n_theta) for one in rows]
    stacked.append(np.diag(np.sqrt(problem.information)))
    inverse = _invert_factor(np.concatenate(stacked), problem)
    middle = np.diag(problem.information)
    leverage = []
    for one, nu, S in zip(rows, state.residuals, densities, strict=True):
        moved = one @ inverse
        hat = moved @ moved.transpose(0, 2, 1)
        own = np.eye(hat.shape[1]) - _LEVERAGE * hat
        alone = np.linalg.solve(own, _whiten(nu, S)[:, :, None])[:, :, 0]
        n_y = nu.shape[1]
        group = np.zeros(len(nu), dtype=int)
        spectrum = noise.smooth_density(alone[:, :n_y] + 1j * alone[:, n_y:], group, 1)
        of_noise = spectrum.blocks[spectrum.block]
        J = one[:, :n_y] + 1j * one[:, n_y:]
        middle += np.real(np.einsum("koi,kop,kpj->ij", J.conj(), of_noise, J, optimize=True))
        diagonal = np.einsum("krr->kr", hat)
        leverage.append(0.5 * (diagonal[:, :n_y] + diagonal[:, n_y:]))
    bread = inverse @ inverse.T
    covariance = 0.5 * bread @ middle @ bread
    unscaled = [1.0 if one.std is None else one.std for one in problem.data]
    slopes = differentiate(
        problem.model, state.theta[:n], problem.condition, analytic=problem.analytic
    )
    return GreyBoxEstimate(
        model=problem.model,
        values=state.theta[:n],
        covariance=0.5 * (covariance + covariance.T)[:n, :n],
        cramer_rao=np.sqrt(0.5 * np.diag(bread)[:n]),
        matrices=state.matrices,
        slopes=tuple(slopes),
        cost=state.cost,
        n_data=n_data,
        n_ends=n_theta - n,
        residuals=tuple(s * nu for s, nu in zip(unscaled, state.residuals, strict=True)),
        modelled=tuple(s * y for s, y in zip(unscaled, state.modelled, strict=True)),
        leverage=tuple(leverage),
        outcome=outcome,
        iterations=iterations,
        by_complex_step=problem.analytic,
    )


def _invert_factor(
    rows: Float[np.ndarray, "n_rows n_theta"], problem: _GreyBoxProblem
) -> Float[np.ndarray, "n_theta n_theta"]:
    """Return the inverse of R of the QR factorisation of the rows.

    Raises
    ------
    NotIdentifiable
        Naming the parameters of a direction of which the data contain nothing.
    """
    size = np.linalg.norm(rows, axis=0)
    names = problem.model.names
    for k, name in enumerate(names):
        if not size[k] > 0.0:
            raise NotIdentifiable(f"'{name}' has no effect on the outputs; remove or hold it")
    size = np.where(size > 0.0, size, 1.0)
    R = np.linalg.qr(rows / size, mode="r")
    _, singular, directions = np.linalg.svd(R)
    if singular[-1] < _SINGULAR * singular[0]:
        part = np.abs(directions[-1][: len(names)])
        weak = [name for name, one in zip(names, part.tolist(), strict=True) if one > _NAMED]
        raise NotIdentifiable(
            f"the data do not separate {' and '.join(weak) or 'the parameters'}: give one a prior, "
            "or hold it in the function"
        )
    return scipy.linalg.solve_triangular(R, np.eye(len(R))) / size[:, None]
