"""Rigid and modal motion in time: Kalman filter and Rauch-Tung-Striebel smoother.

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
from flexsid.sysid.estimation.reconstruction import ReconstructedMotion
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.preparation.process_model import fit_process_model

_CONVERGED = 1e-9  # relative change of a covariance that ends its recursion
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
            settled = bool(k > 10 and change < _CONVERGED)
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
