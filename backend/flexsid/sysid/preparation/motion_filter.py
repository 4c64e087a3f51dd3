"""Rigid and modal motion in time: Kalman filter and Rauch-Tung-Striebel smoother.

Beside the reconstruction line by line: the state is [alpha, q, theta], [eta, etadot] of every
mode, and the aerodynamic coefficients that move them, C_Z, C_m and C_Qi. Kinematics and the
structure in vacuo are known; coefficients are white noise through a Butterworth filter; every
sensor is a linear row of the state. How large coefficients are and how noisy the sensors is
taken from the reconstruction line by line, so that nothing is tuned.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy import linalg

from flexsid.errors import NotIdentifiable
from flexsid.sysid.estimation.equation_error import aerodynamic_coefficients
from flexsid.sysid.estimation.reconstruction import Motion
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.derivatives import DerivativeTable, coefficients
from flexsid.sysid.model.sensors import ACCELERATION, INTEGRAL, POSITION, RATE

_SETTLED = 1e-9  # relative change of a covariance that ends its recursion
_START = 3.0  # of the level of each state: knows little of where the record begins
_ROUNDS = 20  # of weights that rest on the density sought


@dataclass(frozen=True, slots=True)
class FilteredMotion:
    """States (n_samples, n_x) with standard errors; ``names`` tells their order.

    After the states come q-dot, normal acceleration as read at the c.g., and etaddot of
    every mode. All in SI; coefficients are nondimensional.
    """

    rate_hz: float
    names: tuple[str, ...]
    values: Float[np.ndarray, "n_samples n_names"]
    std: Float[np.ndarray, "n_samples n_names"]

    def column(self, name: str) -> int:
        """Place of a name."""
        return self.names.index(name)


def filter_motion(
    model: AeroelasticModel,
    samples: Float[np.ndarray, "n_samples n_y"],
    rate_hz: float,
    motion: Motion,
    duration_s: float,
) -> FilteredMotion:
    """Estimate motion from all sensors, forwards and then backwards.

    Parameters
    ----------
    model
        Gives the sensor rows and what is known of the dynamics.
    samples
        Outputs of the model on one clock, instruments and delays undone, trim removed; the
        record starts at trim. [output unit]
    rate_hz
        Samples per second, well above the highest mode. [Hz]
    motion
        The same maneuver line by line: tells noise of sensors and size of coefficients.
    duration_s
        Length of the record that the lines were transformed from. [s]

    Raises
    ------
    NotIdentifiable
        If the sensors leave a motion open.

    Notes
    -----
    Source: Kalman 1960; Rauch, Tung and Striebel 1965. A line of a transform of white
    samples has variance sigma^2 T / rate, which brings the noise of lines to samples.
    """
    system = _System.of(model, motion, duration_s)
    noise = motion.noise * np.sqrt(rate_hz / duration_s)
    H = system.outputs(model) / noise[:, None]
    F, W = system.step(1.0 / rate_hz)
    states, predicted, filtered = _forward(F, W, H.T @ H, (samples / noise) @ H)
    values, covariance = _backward(F, states, predicted, filtered)
    if not np.all(np.isfinite(values)):
        raise NotIdentifiable("the sensors leave the motion open", code="unobservable")
    rows = system.told()
    spread = np.einsum("ij,kjl,il->ki", rows, covariance, rows, optimize=True)
    return FilteredMotion(rate_hz, system.names, values @ rows.T, np.sqrt(np.maximum(spread, 0.0)))


@dataclass(frozen=True, slots=True)
class _System:
    """x-dot = A x + w with w of density W, in states of order one: true state = level x."""

    names: tuple[str, ...]
    A: Float[np.ndarray, "n_x n_x"]
    W: Float[np.ndarray, " n_x"]
    level: Float[np.ndarray, " n_x"]
    extra: Float[np.ndarray, "n_extra n_x"]

    @classmethod
    def of(cls, model: AeroelasticModel, motion: Motion, duration_s: float) -> _System:
        """Known dynamics with coefficients as states, scaled by what the lines tell."""
        c, numbers = model.condition, model.modes.numbers
        n = len(numbers)
        n_r = 2 + n
        empty = DerivativeTable(numbers, model.inputs, np.zeros((n_r, n_r + n + len(model.inputs))))
        known = model.state_space(empty)
        n_k = known.A.shape[0]
        A = np.zeros((n_k + 2 * n_r, n_k + 2 * n_r))
        A[:n_k, :n_k] = known.A
        forced = np.r_[0, 1, 3 + n : 3 + 2 * n]
        value, slope = n_k + np.arange(n_r), n_k + n_r + np.arange(n_r)
        A[forced, value] = model.row_factors()
        corner = float(motion.omega[-1])
        density = _driving(model, motion, duration_s, corner)
        A[value, slope] = 1.0
        A[slope, value] = -(corner**2)
        A[slope, slope] = -np.sqrt(2.0) * corner
        W = np.zeros(len(A))
        W[slope] = density
        size = np.sqrt(density / (2.0 * np.sqrt(2.0) * corner**3))
        level = np.concatenate([_levels(motion, duration_s), size, size * corner])
        # a_z = V (alpha-dot - q) and what thrust and gravity take: V k_Z C_Z
        extra = np.zeros((n_r, len(A)))
        extra[0, n_k] = c.airspeed * model.row_factors()[0]
        extra[1:] = A[forced[1:]]
        names = (
            *known.states,
            *coefficients(numbers),
            *(f"{name}_rate" for name in coefficients(numbers)),
            "normal",
            "qdot",
            *(f"etaddot{number}" for number in numbers),
        )
        return cls(names, A, W, level, extra)

    def step(self, step_s: float) -> tuple[np.ndarray, np.ndarray]:
        """Transition over one sample and covariance of what drives it, both exact."""
        A = self.A / self.level[:, None] * self.level
        W = np.diag(self.W / self.level**2)
        n_x = A.shape[0]
        joined = linalg.expm(np.block([[-A, W], [np.zeros_like(A), A.T]]) * step_s)
        F = joined[n_x:, n_x:].T
        return F, F @ joined[:n_x, n_x:]

    def outputs(self, model: AeroelasticModel) -> Float[np.ndarray, "n_y n_x"]:
        """Sensor rows on the scaled states; rates are rows of A."""
        P = model.sensors.polynomial
        n = len(model.modes.numbers)
        H = np.zeros((P.shape[1], self.A.shape[0]))
        H[:, np.r_[0, 1, 3 : 3 + n]] = P[POSITION]
        H[:, 2] = P[INTEGRAL, :, 1]
        etadot = np.arange(3 + n, 3 + 2 * n)
        H[:, etadot] += P[RATE, :, 2:]
        weights = np.concatenate([P[RATE, :, :2], P[ACCELERATION, :, 2:]], axis=1)
        H += weights @ self.A[np.r_[0, 1, etadot]]
        return H * self.level

    def told(self) -> Float[np.ndarray, "n_names n_x"]:
        """States and further quantities from scaled states."""
        return np.concatenate([np.eye(self.A.shape[0]), self.extra]) * self.level


def _levels(motion: Motion, duration_s: float) -> Float[np.ndarray, " n_known"]:
    """Root mean square of alpha, q, theta, eta and etadot over the lines."""
    r, w = motion.values, motion.omega[:, None]
    columns = [r[:, :2], r[:, 1:2] / w, r[:, 2:], r[:, 2:] * w]
    power = np.sum(np.abs(np.concatenate(columns, axis=1)) ** 2, axis=0)
    rms = np.sqrt(2.0 * power) / duration_s
    return np.maximum(rms, 1e-12)


def _driving(
    model: AeroelasticModel, motion: Motion, duration_s: float, corner: float
) -> Float[np.ndarray, " n_r"]:
    """Driving density of each coefficient's process, so that its lines are as large as seen.

    Lines count by how much they say: the noise that they carry is taken out, and where
    nothing is left the process is as large as may hide in the noise of all lines.
    """
    values = aerodynamic_coefficients(model, motion)
    through = model.known_dynamics(motion.omega) / model.row_factors()[:, None]
    spread = np.real(np.einsum("kij,kjl,kil->ki", through, motion.covariance, through.conj()))
    shape = (motion.omega[:, None] ** 4 + corner**4) / duration_s
    noise, signal = spread * shape, (np.abs(values) ** 2 - spread) * shape
    density = np.mean(np.abs(values) ** 2 * shape, axis=0)
    for _ in range(_ROUNDS):
        weight = 1.0 / (density + noise) ** 2
        hidden = 1.0 / np.sqrt(np.sum(weight, axis=0))
        density = np.maximum(np.sum(weight * signal, axis=0) / np.sum(weight, axis=0), hidden)
    return density


def _forward(
    F: np.ndarray, W: np.ndarray, information: np.ndarray, pull: np.ndarray
) -> tuple[np.ndarray, list[np.ndarray], list[np.ndarray]]:
    """Filtered states, and predicted and filtered covariances until they settle."""
    n_x = F.shape[0]
    eye = np.eye(n_x)
    predicted, filtered = [_START**2 * eye], []
    x = np.zeros(n_x)
    states = np.empty_like(pull)
    settled = False
    gain = keep = eye
    for k, now in enumerate(pull):
        if not settled:
            P = predicted[-1]
            root = _root(P)
            inner = linalg.cholesky(eye + root.T @ information @ root, lower=True)
            half = linalg.solve_triangular(inner, root.T, lower=True)
            gain = half.T @ half
            filtered.append(gain)
            keep = eye - gain @ information
            following = F @ gain @ F.T + W
            following = 0.5 * (following + following.T)
            change = np.max(np.abs(following - P) / np.sqrt(np.outer(np.diag(P), np.diag(P))))
            settled = bool(k > 10 and change < _SETTLED)
            predicted.append(following)
        x = keep @ x + gain @ now
        states[k] = x
        x = F @ x
    return states, predicted, filtered


def _root(P: np.ndarray) -> np.ndarray:
    """A factor of a covariance, whatever rounding did to it."""
    values, vectors = linalg.eigh(P)
    return vectors * np.sqrt(np.maximum(values, 0.0))


def _backward(
    F: np.ndarray, states: np.ndarray, predicted: list[np.ndarray], filtered: list[np.ndarray]
) -> tuple[np.ndarray, np.ndarray]:
    """Smoothed states with the covariance of every sample."""
    n, last = len(states), len(filtered) - 1
    values = states.copy()
    covariance = np.empty((n, *F.shape))
    covariance[-1] = filtered[min(n - 1, last)]
    settled_gain = None
    gain = F
    for k in range(n - 2, -1, -1):
        place = min(k, last)
        if place < last or settled_gain is None:
            gain = np.linalg.solve(predicted[place + 1], F @ filtered[place]).T
            if place == last:
                settled_gain = gain
        else:
            gain = settled_gain
        values[k] += gain @ (values[k + 1] - F @ states[k])
        change = gain @ (covariance[k + 1] - predicted[place + 1]) @ gain.T
        covariance[k] = filtered[place] + 0.5 * (change + change.T)
    return values, covariance
