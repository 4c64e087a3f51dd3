"""What the estimators are measured against, written plainly.

``toolbox`` works as the field's toolboxes do: the state-space model is assembled
anew for every perturbed parameter, solved frequency by frequency, and the Jacobian
is made of central differences. ``least_squares`` is scipy's solver on the model
vectorised over frequencies. Both relax the residuals' variances in turn, as the
estimators do, and share nothing with them but the model's numbers.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.derivatives import DerivativeTable


@dataclass(frozen=True, slots=True)
class Problem:
    """One output-error problem: all derivatives of the model free.

    Every output is seen through a second-order sensor and a delay, as in flight.
    """

    model: AeroelasticModel
    omega: np.ndarray
    inputs: np.ndarray
    measured: np.ndarray
    natural_frequency: np.ndarray
    damping: np.ndarray
    delay_s: np.ndarray
    start: np.ndarray

    def instrument(self, s: complex | np.ndarray) -> np.ndarray:
        """Sensor dynamics and delay of every output at s = j omega."""
        wn, zeta = self.natural_frequency, self.damping
        return wn**2 / (s * s + 2.0 * zeta * wn * s + wn**2) * np.exp(-s * self.delay_s)


@dataclass(frozen=True, slots=True)
class Fitted:
    """Where a baseline ended."""

    theta: np.ndarray
    iterations: int


def matrices(problem: Problem, theta: np.ndarray) -> tuple[np.ndarray, ...]:
    """A, B, C, D at theta."""
    model = problem.model
    shape = (2 + len(model.modes.numbers), -1)
    table = DerivativeTable(model.modes.numbers, model.inputs, theta.reshape(shape))
    system = model.state_space(table)
    return system.A, system.B, system.C, system.D


def outputs_by_loop(problem: Problem, theta: np.ndarray) -> np.ndarray:
    """Outputs by Eq. 20, the response matrix of one frequency after the other."""
    A, B, C, D = matrices(problem, theta)
    identity = np.eye(A.shape[0])
    result = np.empty_like(problem.measured)
    for k, w in enumerate(problem.omega):
        s = 1j * w
        H = C @ np.linalg.solve(s * identity - A, B) + D
        result[k] = problem.instrument(s) * (H @ problem.inputs[k])
    return result


def outputs_at_once(problem: Problem, theta: np.ndarray) -> np.ndarray:
    """Outputs, all frequencies in one call."""
    A, B, C, D = matrices(problem, theta)
    resolvent = 1j * problem.omega[:, None, None] * np.eye(A.shape[0]) - A
    x = np.linalg.solve(resolvent, (problem.inputs @ B.T)[:, :, None])[:, :, 0]
    sensed = problem.instrument(1j * problem.omega[:, None])
    return sensed * (x @ C.T + problem.inputs @ D.T)


def toolbox_jacobian(problem: Problem, theta: np.ndarray) -> np.ndarray:
    """Central differences, (n_omega, n_y, n_theta)."""
    columns = []
    for index in range(theta.size):
        step = 1e-4 * max(abs(theta[index]), 1e-3)
        high, low = theta.copy(), theta.copy()
        high[index] += step
        low[index] -= step
        difference = outputs_by_loop(problem, high) - outputs_by_loop(problem, low)
        columns.append(difference / (2.0 * step))
    return np.stack(columns, axis=2)


def toolbox_iteration(problem: Problem, theta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """One Gauss-Newton step with variances from the residuals, and its standard errors."""
    residual = problem.measured - outputs_by_loop(problem, theta)
    weight = 1.0 / np.mean(np.abs(residual) ** 2, axis=0)
    J = toolbox_jacobian(problem, theta)
    flat = (J * np.sqrt(weight)[:, None]).reshape(-1, theta.size)
    right = (residual * np.sqrt(weight)).ravel()
    normal = np.real(flat.conj().T @ flat)
    scale = np.sqrt(np.diag(normal))
    gradient = np.real(flat.conj().T @ right) / scale
    step = np.linalg.solve(normal / np.outer(scale, scale), gradient) / scale
    return step, 1.0 / (np.sqrt(2.0) * scale)


def toolbox(problem: Problem, tolerance: float = 1e-2, max_iterations: int = 40) -> Fitted:
    """Gauss-Newton with step halving and alternating variances.

    Ends when the largest step, in standard errors, is below ``tolerance``. Our maximisation
    ends as soon as steps shrink so fast that less than twice that is left to go.
    """
    theta = problem.start.copy()

    def cost(at: np.ndarray) -> float:
        residual = problem.measured - outputs_by_loop(problem, at)
        return float(np.sum(np.log(np.mean(np.abs(residual) ** 2, axis=0))))

    before = cost(theta)
    for iteration in range(1, max_iterations + 1):
        step, sigma = toolbox_iteration(problem, theta)
        share = 1.0
        while (after := cost(theta + share * step)) > before and share > 1e-3:
            share *= 0.5
        theta = theta + share * step
        if np.max(np.abs(share * step) / sigma) < tolerance:
            return Fitted(theta, iteration)
        before = after
    return Fitted(theta, max_iterations)


def by_least_squares(problem: Problem, rounds: int = 3) -> Fitted:
    """scipy's solver with 2-point differences, variances relaxed between rounds."""
    theta = problem.start.copy()
    evaluations = 0
    for _ in range(rounds):
        residual = problem.measured - outputs_at_once(problem, theta)
        weight = 1.0 / np.sqrt(np.mean(np.abs(residual) ** 2, axis=0))

        def stacked(at: np.ndarray, weight: np.ndarray = weight) -> np.ndarray:
            nu = ((problem.measured - outputs_at_once(problem, at)) * weight).ravel()
            return np.concatenate([np.real(nu), np.imag(nu)])

        found = least_squares(stacked, theta, jac="2-point", x_scale="jac", method="trf")
        theta = found.x
        evaluations += found.nfev
    return Fitted(theta, evaluations)
