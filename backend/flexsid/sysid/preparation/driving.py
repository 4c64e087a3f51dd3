"""What moves the aerodynamic coefficients: a first fit of derivatives, and what it leaves.

The smoother in time needs to know how coefficients move. Between lines and beside them they
follow the motion and the surfaces far more closely than any process of their own; how
closely, the lines tell. Nobody sees these derivatives: errors in them are part of what is left.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float

from flexsid.sysid.estimation.equation_error import aerodynamic_coefficients
from flexsid.sysid.estimation.reconstruction import ReconstructedMotion
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.derivatives import DerivativeTable

_ROUNDS = 10  # that tell how large coefficients are
_FIRST = 3  # steps of expectation maximisation, which come near from anywhere
_STEPS = 30
_HALVINGS = 6
_SETTLED = 0.02  # change of a density that ends them
_USUAL = 0.5  # root mean square of what derivatives bring, in that of the coefficient
_LEAST_FREEDOM = 0.5  # of the lines: the derivatives are not all free


@dataclass(frozen=True, slots=True)
class Driving:
    """Derivatives, and the density of what coefficients do besides."""

    derivatives: DerivativeTable
    density: Float[np.ndarray, "n_r n_r"]


@dataclass(frozen=True, slots=True)
class _Moments:
    """Sums over the lines, per density of one: variables w, coefficients c, and their errors."""

    w: Complex[np.ndarray, "n_omega n_w"]
    ww: Float[np.ndarray, "n_w n_w"]
    cw: Float[np.ndarray, "n_r n_w"]
    cc: Float[np.ndarray, " n_r"]


class _ProcessEquations:
    """Motion with its errors, in the form that the equations of motion take at lines.

    With theta the derivatives, K r = theta w + what is left, and w = L r + u.
    """

    def __init__(
        self,
        model: AeroelasticModel,
        motion: ReconstructedMotion,
        inputs: Complex[np.ndarray, "n_omega n_u"],
        shape: Float[np.ndarray, " n_omega"],
    ) -> None:
        n_r = motion.values.shape[1]
        n = n_r - 2
        s = 1j * motion.omega
        columns = model.column_factors()
        self.L = np.zeros((s.size, columns.size, n_r), dtype=complex)
        self.L[:, np.arange(n_r), np.arange(n_r)] = 1.0
        self.L[:, n_r + np.arange(n), 2 + np.arange(n)] = s[:, None]
        self.L *= columns[:, None]
        self.u = np.zeros((s.size, columns.size), dtype=complex)
        self.u[:, 2 * n_r - 2 :] = inputs * columns[2 * n_r - 2 :]
        self.K = model.known_dynamics(motion.omega) / model.row_factors()[:, None]
        self.motion = motion
        self.known = np.linalg.inv(motion.covariance)
        self.told = np.matmul(self.known, motion.values[:, :, None])
        self.shape = shape

    def moments(
        self, theta: Float[np.ndarray, "n_r n_w"], density: Float[np.ndarray, " n_r"]
    ) -> _Moments:
        """Expectations for these derivatives and this density of what is left."""
        own = self.K - theta @ self.L
        left = own.conj().transpose(0, 2, 1) / (density * self.shape[:, None])[:, None, :]
        errors = np.linalg.inv(self.known + left @ own)
        r = np.matmul(errors, self.told + np.matmul(left, (self.u @ theta.T)[:, :, None]))
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

    def misfit(
        self, theta: Float[np.ndarray, "n_r n_w"], density: Float[np.ndarray, " n_r"]
    ) -> float:
        """Twice the negative logarithm of the likelihood."""
        own = self.K - theta @ self.L
        left = np.matmul(own, self.motion.values[:, :, None]) - (self.u @ theta.T)[:, :, None]
        V = self._spread(own, density)
        fit = np.real(np.sum(left.conj() * np.linalg.solve(V, left)))
        return 2.0 * float(fit + np.sum(np.linalg.slogdet(V)[1]))

    def information(
        self,
        theta: Float[np.ndarray, "n_r n_w"],
        density: Float[np.ndarray, " n_r"],
        w: Complex[np.ndarray, "n_omega n_w"],
    ) -> Float[np.ndarray, "n_theta n_theta"]:
        """Of all derivatives, row by row."""
        inverse = np.linalg.inv(self._spread(self.K - theta @ self.L, density))
        n_r, n_w = theta.shape
        weight = inverse.conj().reshape(len(w), -1)
        products = (w[:, :, None] * w[:, None, :].conj()).reshape(len(w), -1)
        found = 2.0 * np.real(weight.T @ products).reshape(n_r, n_r, n_w, n_w)
        return found.transpose(0, 2, 1, 3).reshape(n_r * n_w, -1)

    def _spread(
        self, own: Complex[np.ndarray, "n_omega n_r n_r"], density: Float[np.ndarray, " n_r"]
    ) -> Complex[np.ndarray, "n_omega n_r n_r"]:
        """Covariance of what is left with what errors of the motion add to it."""
        left = np.eye(density.size) * (density * self.shape[:, None])[:, None, :]
        return own @ self.motion.covariance @ own.conj().transpose(0, 2, 1) + left


def fit_driving(
    model: AeroelasticModel,
    motion: ReconstructedMotion,
    inputs: Complex[np.ndarray, "n_omega n_u"],
    shape: Float[np.ndarray, " n_omega"],
) -> Driving:
    """Tell how coefficients follow motion and surfaces.

    Parameters
    ----------
    model
        What is known of the dynamics.
    motion
        Line by line, with its errors.
    inputs
        Deflections at the lines. [rad s]
    shape
        Variance of a line for a density of one.

    Notes
    -----
    Source: Shumway and Stoffer 1982, at lines instead of samples: the motion is taken as its
    measured value with its error, pulled towards what the derivatives make of it. The
    derivatives follow by Gauss-Newton steps, as expectation maximisation alone is slow, and
    with a prior: all together bring what the coefficient is, whose size is told first.
    """
    lines = _ProcessEquations(model, motion, inputs, shape)
    theta = np.zeros((motion.values.shape[1], lines.u.shape[1]))
    n_omega = motion.omega.size
    C = aerodynamic_coefficients(model, motion)
    density = np.mean(np.abs(C) ** 2 / shape[:, None], axis=0)
    moments = lines.moments(theta, density)
    for _ in range(_ROUNDS):
        density = moments.cc / n_omega
        moments = lines.moments(theta, density)
    usual = _usual(model, np.sqrt(np.diag(moments.ww) / n_omega))
    prior = 1.0 / (density[:, None] * usual**2)
    freedom = max(1.0 - theta.shape[1] / (2.0 * n_omega), _LEAST_FREEDOM)
    for k in range(_STEPS):
        if k < _FIRST:
            theta = _maximised(moments, density, prior)
        else:
            theta = _improved(lines, moments, theta, density, prior)
        moments = lines.moments(theta, density)
        left = moments.cc - np.sum(theta * (2.0 * moments.cw - theta @ moments.ww), axis=1)
        update = np.maximum(left, 1e-12 * moments.cc) / (n_omega * freedom)
        change = float(np.max(np.abs(np.log(update / density))))
        density = update
        if change < _SETTLED:
            break
    covariance = _covariance(lines, moments, theta, density, prior)
    power = np.real((moments.w / shape[:, None]).T @ moments.w.conj()) / n_omega
    doubt = np.einsum("ajbl,jl->ab", covariance.reshape(theta.shape * 2), power)
    table = DerivativeTable(model.modes.numbers, model.inputs, theta)
    return Driving(table, np.diag(density) + doubt)


def _maximised(
    moments: _Moments, density: Float[np.ndarray, " n_r"], prior: Float[np.ndarray, "n_r n_w"]
) -> Float[np.ndarray, "n_r n_w"]:
    """Derivatives that the expected motion makes most likely."""
    rows = [
        np.linalg.solve(moments.ww + 0.5 * level * np.diag(held), cw)
        for level, held, cw in zip(density, prior, moments.cw, strict=True)
    ]
    return np.stack(rows)


def _improved(
    lines: _ProcessEquations,
    moments: _Moments,
    theta: Float[np.ndarray, "n_r n_w"],
    density: Float[np.ndarray, " n_r"],
    prior: Float[np.ndarray, "n_r n_w"],
) -> Float[np.ndarray, "n_r n_w"]:
    """Derivatives after a Gauss-Newton step, halved until the likelihood grows."""
    slope = 2.0 * (moments.cw - theta @ moments.ww) / density[:, None] - theta * prior
    covariance = _covariance(lines, moments, theta, density, prior)
    step = (covariance @ slope.ravel()).reshape(theta.shape)

    def misfit(tried: np.ndarray) -> float:
        return lines.misfit(tried, density) + float(np.sum(prior * tried**2))

    now = misfit(theta)
    for _ in range(_HALVINGS):
        if misfit(theta + step) < now:
            return theta + step
        step = 0.5 * step
    return theta


def _covariance(
    lines: _ProcessEquations,
    moments: _Moments,
    theta: Float[np.ndarray, "n_r n_w"],
    density: Float[np.ndarray, " n_r"],
    prior: Float[np.ndarray, "n_r n_w"],
) -> Float[np.ndarray, "n_theta n_theta"]:
    """Of the errors of all derivatives, row by row."""
    information = lines.information(theta, density, moments.w) + np.diag(prior.ravel())
    size = np.sqrt(np.diag(information))
    return np.linalg.inv(information / np.outer(size, size)) / np.outer(size, size)


def _usual(model: AeroelasticModel, size: Float[np.ndarray, " n_w"]) -> Float[np.ndarray, " n_w"]:
    """Size of derivatives that bring what the coefficient is, over the number of kinds.

    Modes move the air alike where their masses are alike, so that those that hardly move
    bring little.
    """
    n = len(model.modes.numbers)
    root_mass = np.sqrt(model.modes.mass)
    size = size.copy()
    for first in (2, 2 + n):
        if n:
            mine = slice(first, first + n)
            size[mine] = np.max(size[mine] * root_mass) / root_mass
    kinds = 2 + 2 * (n > 0) + len(model.inputs)
    return _USUAL / np.sqrt(kinds) / np.maximum(size, 1e-300)
