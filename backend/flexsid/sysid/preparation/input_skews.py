"""Time skews of the measured surfaces against the motion that they cause.

Redundancy times sensors against each other; surfaces have none. But the coefficients that
the motion tells are sums over motion and surfaces with real derivatives (Eq. 23), and a
surface that was recorded late leaves a residual that no real derivative explains.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float

from flexsid.errors import NotIdentifiable
from flexsid.sysid.estimation.equation_error import aerodynamic_coefficients, regressors
from flexsid.sysid.estimation.reconstruction import Motion
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.preparation.redundancy import strong_lines
from flexsid.sysid.signals import FrequencyData

_STEPS = 30
_LARGEST_STEP_RAD = 0.3
_SMALL_S = 1e-7
_NEIGHBOURS = 8


@dataclass(frozen=True, slots=True)
class InputSkews:
    """Delay of every input beyond the reference of the motion, with standard errors. [s]"""

    names: tuple[str, ...]
    delay_s: Float[np.ndarray, " n_u"]
    delay_std: Float[np.ndarray, " n_u"]


def find_input_skews(model: AeroelasticModel, motion: Motion, inputs: FrequencyData) -> InputSkews:
    """Find the delays with which real derivatives explain most of all coefficients.

    Parameters
    ----------
    model
        Condition, modes and inputs.
    motion
        Reconstructed from sensors whose delays are undone.
    inputs
        Surface deflections, known instruments undone. [rad s]

    Raises
    ------
    NotIdentifiable
        If there are fewer lines than derivatives, or a surface causes nothing.

    Notes
    -----
    Derivatives are projected out (Kaufman 1975); coefficients count by how well they are
    explained. Errors grow where neighbouring lines share residuals.
    """
    u = inputs.pick(model.inputs).values
    some = strong_lines(u)
    omega, u = motion.omega[some], u[some]
    C = aerodynamic_coefficients(model, motion)[some]
    X = regressors(model, motion, inputs)[some]
    n_u, n_lines = u.shape[1], u.shape[0]
    if 2 * n_lines < 2 * X.shape[1] or n_u == 0:
        raise NotIdentifiable(
            f"{n_lines} lines are too few for {X.shape[1]} derivatives", code="too-few-lines"
        )
    rest = X[:, : X.shape[1] - n_u]
    problem = _Problem(omega, rest, u, C)
    delay = np.zeros(n_u)
    weight = np.ones(C.shape[1])
    for _ in range(_STEPS):
        residual, slopes = problem.linearise(delay)
        weight = 1.0 / np.maximum(np.mean(residual**2, axis=0), 1e-300)
        normal = np.einsum("kru,krv,r->uv", slopes, slopes, weight)
        gradient = np.einsum("kru,kr,r->u", slopes, residual, weight)
        size = np.sqrt(np.diag(normal))
        if not np.all(size > 0) or np.linalg.cond(normal / np.outer(size, size)) > 1e10:
            raise NotIdentifiable(
                "the coefficients do not tell when the surfaces moved", code="no-redundancy"
            )
        step = np.linalg.solve(normal, gradient)
        limit = _LARGEST_STEP_RAD / omega[-1]
        step = np.clip(step, -limit, limit)
        delay = delay + step
        if np.max(np.abs(step)) < _SMALL_S:
            break
    return InputSkews(model.inputs, delay, problem.std(delay, weight))


@dataclass(frozen=True, slots=True)
class _Problem:
    """Coefficients (n_omega, n_rows), motion columns and inputs at the lines."""

    omega: Float[np.ndarray, " n_omega"]
    rest: Complex[np.ndarray, "n_omega n_rest"]
    u: Complex[np.ndarray, "n_omega n_u"]
    C: Complex[np.ndarray, "n_omega n_rows"]

    def linearise(self, delay: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Residuals (2 n_omega, n_rows), and how each falls with each delay (..., n_u)."""
        turned = self.u * np.exp(1j * self.omega[:, None] * delay)
        X = _real(np.concatenate([self.rest, turned], axis=1))
        q, r = np.linalg.qr(X / np.linalg.norm(X, axis=0))
        z = _real(self.C)
        inside = q.T @ z
        theta = np.linalg.solve(r, inside) / np.linalg.norm(X, axis=0)[:, None]
        residual = z - q @ inside
        gains = theta[self.rest.shape[1] :]
        change = _real(1j * self.omega[:, None] * turned)[:, None, :] * gains.T[None]
        flat = change.reshape(change.shape[0], -1)
        flat = flat - q @ (q.T @ flat)
        return residual, flat.reshape(change.shape)

    def std(self, delay: np.ndarray, weight: np.ndarray) -> Float[np.ndarray, " n_u"]:
        """Standard errors, for residuals that neighbouring lines share too."""
        residual, slopes = self.linearise(delay)
        normal = np.einsum("kru,krv,r->uv", slopes, slopes, weight)
        inverse = np.linalg.inv(normal)
        score = np.einsum("kru,kr,r->ku", slopes, residual, weight)
        n = self.omega.size
        score = score[:n] + score[n:]
        meat = score.T @ score
        for lag in range(1, min(_NEIGHBOURS, n - 1) + 1):
            shared = (1.0 - lag / (_NEIGHBOURS + 1.0)) * (score[lag:].T @ score[:-lag])
            meat += shared + shared.T
        coloured = np.diag(inverse @ meat @ inverse)
        return np.sqrt(np.maximum(np.diag(inverse), coloured))


def _real(values: np.ndarray) -> np.ndarray:
    return np.concatenate([np.real(values), np.imag(values)])
