"""Process model of the aerodynamic coefficients: derivatives, and density of process noise.

The smoother in time needs a model of the coefficients. They depend on the motion and the
surfaces, with derivatives fitted to the spectra, and on process noise. The derivatives are
not a result: their errors are part of the process noise.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float

from flexsid.sysid.estimation.equation_error import (
    build_variable_matrix,
    compute_aerodynamic_coefficients,
)
from flexsid.sysid.estimation.reconstruction import ReconstructedMotion
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.derivatives import DerivativeTable

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
