"""Rigid and modal motion in time: process model, Kalman filter and Rauch-Tung-Striebel smoother.

The smoother in time needs a model of the coefficients. They depend on the motion and the
surfaces, with derivatives fitted to the spectra, and on process noise. The derivatives are
not a result: their errors are part of the process noise.

In addition to the reconstruction at each frequency. The state is [alpha, q, theta], [eta,
etadot] of every mode, the surfaces, and the process noise of the aerodynamic coefficients C_Z,
C_m and C_Qi. Kinematics and the structure in vacuo are known; the derivatives of the
coefficients are fitted to the spectra; surfaces and process noise are white noise through a
Butterworth filter, with the density of the spectra; every sensor is a linear row of the state.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float
from scipy import linalg

from flexsid.errors import NotIdentifiable
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.derivatives import DerivativeTable
from flexsid.sysid.regression.equation_error import (
    build_variable_matrix,
    compute_aerodynamic_coefficients,
)
from flexsid.sysid.regression.reconstruction import ReconstructedMotion

# --- Process model of the aerodynamic coefficients: derivatives, and density of process noise -----

_ROUNDS = 10  # that estimate the size of coefficients
_EM_STEPS = 3  # steps of the EM algorithm, which converge from any start
_STEPS = 30  # of EM and Gauss-Newton together, at most
_HALVINGS = 6  # of a Gauss-Newton step, at most
_CONVERGED = 0.02  # relative change of a density that ends the steps
_PRIOR_SHARE = 0.5  # prior rms of the contribution of derivatives over the rms of the coefficient
_LEAST_FREEDOM = 0.5  # of the data points: the derivatives are not all free


@dataclass(frozen=True, slots=True)
class _Moments:
    """Sums over the frequencies per unit density: variables w, coefficients c, their errors."""

    w: Complex[np.ndarray, "n_omega n_w"]
    ww: Float[np.ndarray, "n_w n_w"]
    cw: Float[np.ndarray, "n_r n_w"]
    cc: Float[np.ndarray, " n_r"]


class _ProcessEquations:
    """Motion with its errors, in the equations of motion at each frequency.

    With theta the derivatives, K r = theta w + process noise, and w = L r + u.
    """

    def __init__(
        self,
        model: AeroelasticModel,
        motion: ReconstructedMotion,
        inputs: Complex[np.ndarray, "n_omega n_u"],
        shape: Float[np.ndarray, " n_omega"],
    ) -> None:
        columns, n_u = model.column_factors(), len(model.inputs)
        self.L = build_variable_matrix(model, 1j * motion.omega) * columns[:, None]
        self.u = np.zeros((motion.omega.size, columns.size), dtype=complex)
        self.u[:, columns.size - n_u :] = inputs * columns[columns.size - n_u :]
        self.K = model.known_dynamics(motion.omega) / model.row_factors()[:, None]
        self.motion = motion
        self.known = np.linalg.inv(motion.covariance)
        self.weighted = np.matmul(self.known, motion.values[:, :, None])
        self.shape = shape

    def compute_moments(
        self, theta: Float[np.ndarray, "n_r n_w"], density: Float[np.ndarray, " n_r"]
    ) -> _Moments:
        """Expected sums (E step) for these derivatives and this density of the process noise."""
        own = self.K - theta @ self.L
        left = own.conj().transpose(0, 2, 1) / (density * self.shape[:, None])[:, None, :]
        errors = np.linalg.inv(self.known + left @ own)
        r = np.matmul(errors, self.weighted + np.matmul(left, (self.u @ theta.T)[:, :, None]))
        w = np.matmul(self.L, r) + self.u[:, :, None]
        values, vectors = np.linalg.eigh(0.5 * (errors + errors.conj().transpose(0, 2, 1)))
        root = vectors * np.sqrt(np.maximum(values, 0.0))[:, None, :]
        weight = np.sqrt(1.0 / self.shape)[:, None, None]
        each = [
            np.concatenate([weight * mean, weight * (rows @ root)], axis=2)
            for mean, rows in ((w, self.L), (np.matmul(self.K, r), self.K))
        ]
        wide_w, wide_c = (one.transpose(1, 0, 2).reshape(one.shape[1], -1) for one in each)
        return _Moments(
            w[:, :, 0],
            np.real(wide_w @ wide_w.conj().T),
            np.real(wide_c @ wide_w.conj().T),
            np.sum(np.abs(wide_c) ** 2, axis=1),
        )

    def compute_misfit(
        self, theta: Float[np.ndarray, "n_r n_w"], density: Float[np.ndarray, " n_r"]
    ) -> float:
        """Twice the negative logarithm of the likelihood."""
        own = self.K - theta @ self.L
        left = np.matmul(own, self.motion.values[:, :, None]) - (self.u @ theta.T)[:, :, None]
        V = self._compute_covariance(own, density)
        fit = np.real(np.sum(left.conj() * np.linalg.solve(V, left)))
        return 2.0 * float(fit + np.sum(np.linalg.slogdet(V)[1]))

    def compute_error_covariance(
        self,
        theta: Float[np.ndarray, "n_r n_w"],
        density: Float[np.ndarray, " n_r"],
        w: Complex[np.ndarray, "n_omega n_w"],
        prior: Float[np.ndarray, "n_r n_w"],
    ) -> Float[np.ndarray, "n_theta n_theta"]:
        """Covariance of the errors of all derivatives, row by row."""
        inverse = np.linalg.inv(self._compute_covariance(self.K - theta @ self.L, density))
        n_r, n_w = theta.shape
        weight = inverse.conj().reshape(len(w), -1)
        products = (w[:, :, None] * w[:, None, :].conj()).reshape(len(w), -1)
        found = 2.0 * np.real(weight.T @ products).reshape(n_r, n_r, n_w, n_w)
        information = found.transpose(0, 2, 1, 3).reshape(n_r * n_w, -1) + np.diag(prior.ravel())
        size = np.sqrt(np.diag(information))
        return np.linalg.inv(information / np.outer(size, size)) / np.outer(size, size)

    def _compute_covariance(
        self, own: Complex[np.ndarray, "n_omega n_r n_r"], density: Float[np.ndarray, " n_r"]
    ) -> Complex[np.ndarray, "n_omega n_r n_r"]:
        """Covariance of the equation residuals: process noise and errors of the motion."""
        left = np.eye(density.size) * (density * self.shape[:, None])[:, None, :]
        return own @ self.motion.covariance @ own.conj().transpose(0, 2, 1) + left


def fit_process_model(
    model: AeroelasticModel,
    motion: ReconstructedMotion,
    inputs: Complex[np.ndarray, "n_omega n_u"],
    shape: Float[np.ndarray, " n_omega"],
) -> tuple[DerivativeTable, Float[np.ndarray, "n_r n_r"]]:
    """Fit derivatives of coefficients to motion and surfaces, and the density of process noise.

    ``inputs`` are deflections at the frequencies of the motion [rad s], ``shape`` is the variance
    of a data point for a density of one.

    Notes
    -----
    Source: Shumway and Stoffer 1982, doi:10.1111/j.1467-9892.1982.tb00349.x, at frequencies instead
    of samples: the motion is the posterior of its measured value with its error and of the process
    model. The derivatives follow by Gauss-Newton steps, as the EM algorithm alone is slow, and with
    a prior: the rms of all contributions together is that of the coefficient, which is estimated
    first.
    """
    equations = _ProcessEquations(model, motion, inputs, shape)
    theta = np.zeros((motion.values.shape[1], equations.u.shape[1]))
    n_omega = motion.omega.size
    C = compute_aerodynamic_coefficients(model, motion)
    density = np.mean(np.abs(C) ** 2 / shape[:, None], axis=0)
    moments = equations.compute_moments(theta, density)
    for _ in range(_ROUNDS):
        density = moments.cc / n_omega
        moments = equations.compute_moments(theta, density)
    usual = _estimate_prior_size(model, np.sqrt(np.diag(moments.ww) / n_omega))
    prior = 1.0 / (density[:, None] * usual**2)
    freedom = max(1.0 - theta.shape[1] / (2.0 * n_omega), _LEAST_FREEDOM)
    for k in range(_STEPS):
        if k < _EM_STEPS:
            theta = _maximise_derivatives(moments, density, prior)
        else:
            theta = _step_derivatives(equations, moments, theta, density, prior)
        moments = equations.compute_moments(theta, density)
        left = moments.cc - np.sum(theta * (2.0 * moments.cw - theta @ moments.ww), axis=1)
        update = np.maximum(left, 1e-12 * moments.cc) / (n_omega * freedom)
        change = float(np.max(np.abs(np.log(update / density))))
        density = update
        if change < _CONVERGED:
            break
    covariance = equations.compute_error_covariance(theta, density, moments.w, prior)
    power = np.real((moments.w / shape[:, None]).T @ moments.w.conj()) / n_omega
    uncertainty = np.einsum("ajbl,jl->ab", covariance.reshape(theta.shape * 2), power)
    table = DerivativeTable(model.modes.numbers, model.inputs, theta, model.body)
    return table, np.diag(density) + uncertainty


def _maximise_derivatives(
    moments: _Moments, density: Float[np.ndarray, " n_r"], prior: Float[np.ndarray, "n_r n_w"]
) -> Float[np.ndarray, "n_r n_w"]:
    """Derivatives of largest expected likelihood (M step)."""
    rows = [
        np.linalg.solve(moments.ww + 0.5 * level * np.diag(held), cw)
        for level, held, cw in zip(density, prior, moments.cw, strict=True)
    ]
    return np.stack(rows)


def _step_derivatives(
    equations: _ProcessEquations,
    moments: _Moments,
    theta: Float[np.ndarray, "n_r n_w"],
    density: Float[np.ndarray, " n_r"],
    prior: Float[np.ndarray, "n_r n_w"],
) -> Float[np.ndarray, "n_r n_w"]:
    """Derivatives after a Gauss-Newton step, halved until the likelihood grows."""
    slope = 2.0 * (moments.cw - theta @ moments.ww) / density[:, None] - theta * prior
    covariance = equations.compute_error_covariance(theta, density, moments.w, prior)
    step = (covariance @ slope.ravel()).reshape(theta.shape)

    def misfit(tried: np.ndarray) -> float:
        return equations.compute_misfit(tried, density) + float(np.sum(prior * tried**2))

    now = misfit(theta)
    for _ in range(_HALVINGS):
        if misfit(theta + step) < now:
            return theta + step
        step = 0.5 * step
    return theta


def _estimate_prior_size(
    model: AeroelasticModel, size: Float[np.ndarray, " n_w"]
) -> Float[np.ndarray, " n_w"]:
    """Prior standard deviation of derivatives: rms of the coefficient over that of the variable.

    Modes of equal mass are taken as equally effective, so that modes with little motion
    contribute little.
    """
    n, n_rigid = len(model.modes.numbers), model.n_rigid
    root_mass = np.sqrt(model.modes.mass)
    size = size.copy()
    for first in (n_rigid, n_rigid + n):
        if n:
            mine = slice(first, first + n)
            size[mine] = np.max(size[mine] * root_mass) / root_mass
    kinds = n_rigid + 2 * (n > 0) + len(model.inputs)
    return _PRIOR_SHARE / np.sqrt(kinds) / np.maximum(size, 1e-300)


# --- Rigid and modal motion in time: Kalman filter and Rauch-Tung-Striebel smoother ---------------

_FILTER_CONVERGED = 1e-9  # relative change of a covariance that ends its recursion
_CORNER = 0.5  # of the highest frequency: corner of the process noise
_START = 3.0  # of the level of each state: standard deviation of the initial state


@dataclass(frozen=True, slots=True)
class FilteredMotion:
    """States (n_samples, n_x) with standard errors; ``names`` has their order.

    After the states come q-dot, normal acceleration as read at the c.g., and etaddot of
    every mode. All in SI; coefficients are nondimensional.
    """

    rate_hz: float
    names: tuple[str, ...]
    values: Float[np.ndarray, "n_samples n_names"]
    std: Float[np.ndarray, "n_samples n_names"]


def filter_motion(
    model: AeroelasticModel,
    samples: Float[np.ndarray, "n_samples n_y"],
    rate_hz: float,
    motion: ReconstructedMotion,
    duration_s: float,
    inputs: Deflections,
    trim_s: float,
) -> FilteredMotion:
    """Estimate motion from all sensors by a Kalman filter and a smoother.

    Parameters
    ----------
    model
        Gives the sensor rows and the known dynamics.
    samples
        Outputs of the model on one clock, instruments and delays undone, trim removed; the
        record starts at trim. [output unit]
    rate_hz
        Samples per second, well above the highest mode. [Hz]
    motion
        The same maneuver at each frequency: gives noise of sensors and size of coefficients.
    duration_s
        Length of the transformed record. [s]
    inputs
        Surfaces of the model on the same clock, potentiometers undone.
    trim_s
        Length of the interval whose mean was subtracted as trim. [s]

    Raises
    ------
    NotIdentifiable
        If a motion is not observable by the sensors.

    Notes
    -----
    Source: Kalman 1960, doi:10.1115/1.3662552; Rauch, Tung and Striebel 1965, doi:10.2514/3.3166.
    The transform of white samples has variance sigma^2 T / rate, which relates the noise of spectra
    and samples.
    """
    system = _build_system(model, motion, duration_s, inputs)
    noise = np.concatenate([motion.noise, inputs.noise]) * np.sqrt(rate_hz / duration_s)
    H = system.H / noise[:, None]
    seen = np.concatenate([samples, inputs.samples], axis=1) / noise
    F, W = _discretise(system, 1.0 / rate_hz)
    states, predicted, filtered = _forward(F, W, H.T @ H, seen @ H)
    values, spread = _backward(F, states, predicted, filtered, system.rows)
    if not np.all(np.isfinite(values)):
        raise NotIdentifiable("the motion is not observable by the sensors", code="unobservable")
    # The error of the mean of the trim is constant.
    offsets = system.rows @ _compute_offset_states(system, H, rate_hz)
    spread += np.sum(offsets**2, axis=1) / (rate_hz * trim_s)
    std = np.sqrt(np.maximum(spread, 0.0))
    return FilteredMotion(rate_hz, system.names, values @ system.rows.T, std)


@dataclass(frozen=True, slots=True)
class Deflections:
    """Surfaces on the clock of the samples [rad], their spectra and noise [rad s]."""

    samples: Float[np.ndarray, "n_samples n_u"]
    spectra: Complex[np.ndarray, "n_omega n_u"]
    noise: Float[np.ndarray, " n_u"]


@dataclass(frozen=True, slots=True)
class _System:
    """x-dot = A x + w with w of density W, in states x of order one.

    ``H`` are the rows of sensors, then of surfaces; ``rows`` those of ``names``.
    """

    names: tuple[str, ...]
    A: Float[np.ndarray, "n_x n_x"]
    W: Float[np.ndarray, "n_x n_x"]
    H: Float[np.ndarray, "n_z n_x"]
    rows: Float[np.ndarray, "n_names n_x"]


def _build_system(
    model: AeroelasticModel, motion: ReconstructedMotion, duration_s: float, inputs: Deflections
) -> _System:
    """Dynamics with surfaces and process noise of the coefficients as states, scaled by spectra."""
    body, numbers = model.body, model.modes.numbers
    n_u, n_y = len(model.inputs), len(model.outputs)
    n_r = len(model.motions)
    corner = _CORNER * float(motion.omega[-1])
    shape = duration_s / (motion.omega**4 + corner**4)
    derivatives, process = fit_process_model(model, motion, inputs.spectra, shape)
    known = model.state_space(derivatives)
    n_k, n_v = known.A.shape[0], n_r + n_u
    A = np.zeros((n_k + 2 * n_v, n_k + 2 * n_v))
    A[:n_k, :n_k] = known.A
    forced, variables = model.force_matrix(), model.variable_states()
    value, slope = n_k + np.arange(n_v), n_k + n_v + np.arange(n_v)
    factors = model.row_factors()
    A[:n_k, value[:n_r]] = forced * factors
    A[:n_k, value[n_r:]] = known.B
    A[value, slope] = 1.0
    A[slope, value] = -(corner**2)
    A[slope, slope] = -np.sqrt(2.0) * corner
    density = np.zeros((n_v, n_v))
    density[:n_r, :n_r] = process
    density[n_r:, n_r:] = np.diag(np.mean(np.abs(inputs.spectra) ** 2 / shape[:, None], axis=0))
    W = np.zeros_like(A)
    W[np.ix_(slope, slope)] = density
    size = np.sqrt(np.diag(density) / (2.0 * np.sqrt(2.0) * corner**3))
    level = np.concatenate([_compute_levels(motion, duration_s, body.size), size, size * corner])
    H = np.zeros((n_y + n_u, len(A)))
    H[:n_y], _ = model.output_matrices(A, np.zeros((len(A), 0)))
    H[n_y + np.arange(n_u), value[n_r:]] = 1.0
    rows = np.zeros((n_k + n_r, len(A)))
    rows[:n_k, :n_k] = np.eye(n_k)
    rows[n_k : n_k + n_r, np.r_[variables, value[n_r:]]] = (
        derivatives.values * model.column_factors()
    )
    rows[n_k + np.arange(n_r), value[:n_r]] = 1.0
    specific_forces, accelerations = [], ()
    if body.acceleration:
        # a_z = V (alpha-dot - q) and thrust and gravity: V k_Z C_Z, a_y likewise
        specific_forces = [model.condition.airspeed * factors[0] * rows[n_k]]
        accelerations = (body.acceleration,)
    rows = np.vstack([rows, *specific_forces, A[np.r_[1 : body.size, n_k - len(numbers) : n_k]]])
    accelerations = (
        *accelerations,
        *(f"{motion}dot" for motion in body.motions[1:]),
        *(f"etaddot{number}" for number in numbers),
    )
    return _System(
        names=(*known.states, *model.coefficients, *accelerations),
        A=A / level[:, None] * level,
        W=W / np.outer(level, level),
        H=H * level,
        rows=rows * level,
    )


def _discretise(system: _System, step_s: float) -> tuple[np.ndarray, np.ndarray]:
    """Transition over one sample and covariance of the process noise, both exact (Van Loan)."""
    A, n_x = system.A, len(system.A)
    joined = linalg.expm(np.block([[-A, system.W], [np.zeros_like(A), A.T]]) * step_s)
    F = joined[n_x:, n_x:].T
    return F, F @ joined[:n_x, n_x:]


def _compute_offset_states(
    system: _System, H: Float[np.ndarray, "n_z n_x"], rate_hz: float
) -> Float[np.ndarray, "n_x n_z"]:
    """States due to a constant offset of each sensor, in units of its noise."""
    pushed = np.diag(system.W) > 0.0
    still = linalg.null_space(system.A[~pushed])
    left, seen = system.A[pushed] @ still, H @ still
    weighted = np.linalg.solve(system.W[np.ix_(pushed, pushed)], left)
    normal = rate_hz * seen.T @ seen + left.T @ weighted
    return still @ np.linalg.solve(normal, rate_hz * seen.T)


def _compute_levels(
    motion: ReconstructedMotion, duration_s: float, n_rigid: int
) -> Float[np.ndarray, " n_known"]:
    """Root mean square of rigid motion, attitude, eta and etadot from the spectra."""
    r, w = motion.values, motion.omega[:, None]
    columns = [r[:, :n_rigid], r[:, 1:2] / w, r[:, n_rigid:], r[:, n_rigid:] * w]
    power = np.sum(np.abs(np.concatenate(columns, axis=1)) ** 2, axis=0)
    rms = np.sqrt(2.0 * power) / duration_s
    return np.maximum(rms, 1e-12)


def _forward(
    F: np.ndarray, W: np.ndarray, information: np.ndarray, pull: np.ndarray
) -> tuple[np.ndarray, list[np.ndarray], list[np.ndarray]]:
    """Filtered states, and predicted and filtered covariances until they converge."""
    n_x = F.shape[0]
    eye = np.eye(n_x)
    predicted, filtered = [_START**2 * eye], []
    x = np.zeros(n_x)
    states = np.empty_like(pull)
    settled = False
    gain = complement = eye
    for k, now in enumerate(pull):
        if not settled:
            P = predicted[-1]
            root = _root(P)
            inner = linalg.cholesky(eye + root.T @ information @ root, lower=True)
            half = linalg.solve_triangular(inner, root.T, lower=True)
            gain = half.T @ half
            filtered.append(gain)
            complement = eye - gain @ information
            following = F @ gain @ F.T + W
            following = 0.5 * (following + following.T)
            change = np.max(np.abs(following - P) / np.sqrt(np.outer(np.diag(P), np.diag(P))))
            settled = bool(k > 10 and change < _FILTER_CONVERGED)
            predicted.append(following)
        x = complement @ x + gain @ now
        states[k] = x
        x = F @ x
    return states, predicted, filtered


def _root(P: np.ndarray) -> np.ndarray:
    """A factor of a covariance, negative eigenvalues from rounding set to zero."""
    values, vectors = linalg.eigh(P)
    return vectors * np.sqrt(np.maximum(values, 0.0))


def _backward(
    F: np.ndarray,
    states: np.ndarray,
    predicted: list[np.ndarray],
    filtered: list[np.ndarray],
    rows: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Smoothed states of every sample, and the variance of the output rows."""
    last = len(filtered) - 1
    values = states.copy()
    covariance = filtered[last]
    spread = np.empty((len(states), len(rows)))
    spread[-1] = _variance(rows, covariance)
    gain, settled = np.linalg.solve(predicted[last + 1], F @ filtered[last]).T, False
    for k in range(len(states) - 2, -1, -1):
        if k < last:
            gain, settled = np.linalg.solve(predicted[k + 1], F @ filtered[k]).T, False
        values[k] += gain @ (values[k + 1] - F @ states[k])
        if settled:
            spread[k] = spread[k + 1]
            continue
        place = min(k, last)
        change = gain @ (covariance - predicted[place + 1]) @ gain.T
        covariance = filtered[place] + 0.5 * (change + change.T)
        spread[k] = _variance(rows, covariance)
        settled = bool(k >= last and np.allclose(spread[k], spread[k + 1], rtol=1e-7, atol=0.0))
    return values, spread


def _variance(rows: np.ndarray, covariance: np.ndarray) -> np.ndarray:
    return np.maximum(np.sum((rows @ covariance) * rows, axis=1), 0.0)
