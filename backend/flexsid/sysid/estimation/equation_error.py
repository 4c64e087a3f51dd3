"""Equation error: each coefficient regressed on motion and inputs (Eqs 23-24)."""

from __future__ import annotations

import numpy as np
from jaxtyping import Complex, Float

from flexsid.errors import BadInput
from flexsid.sysid.estimation.estimate import Estimate, FittedLines, Outcome
from flexsid.sysid.estimation.parameters import Parameters
from flexsid.sysid.estimation.reconstruction import ReconstructedMotion
from flexsid.sysid.estimation.regression import Disturbance, regress
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.derivatives import coefficients
from flexsid.sysid.signals import FrequencyData, check_finite


def aerodynamic_coefficients(
    model: AeroelasticModel, motion: ReconstructedMotion
) -> Complex[np.ndarray, "n_omega n_rows"]:
    """Spectra of C_Z, C_m and C_Qi that cause the motion. [s]"""
    K = model.known_dynamics(motion.omega)
    return np.matmul(K, motion.values[:, :, None])[:, :, 0] / model.row_factors()


def regressors(
    model: AeroelasticModel, motion: ReconstructedMotion, inputs: FrequencyData
) -> Complex[np.ndarray, "n_omega n_w"]:
    """Spectra of alpha, q c/2V, eta, etadot c/2V and the inputs. [s]"""
    rates = 1j * motion.omega[:, None] * motion.values[:, 2:]
    u = inputs.pick(model.inputs).values
    return np.concatenate([motion.values, rates, u], axis=1) * model.column_factors()


def equation_error(
    model: AeroelasticModel,
    motion: ReconstructedMotion,
    inputs: FrequencyData,
    parameters: Parameters,
    *,
    compensate: bool = True,
) -> Estimate:
    """Estimate the free derivatives, one linear regression per coefficient.

    Parameters
    ----------
    model
        Condition, modes and inputs.
    motion
        Reconstructed motion with its uncertainty.
    inputs
        Surface deflections, instrument dynamics removed. [rad s]
    parameters
        Which derivatives are free; the others contribute with their held value.
    compensate
        Weight the lines by the uncertainty of the reconstructed motion and take
        the bias of its noise out of the normal equations; without it, the plain
        least squares of Eq. 24.

    Raises
    ------
    BadInput
        If something else than a derivative is free.
    NotIdentifiable
        If a coefficient has more free derivatives than data, or collinear ones.

    Notes
    -----
    Departure: Eq. 24 takes the regressors as exact. Higher modes are reconstructed
    with little signal, and plain least squares then pulls their derivatives
    towards zero with error bars that do not tell.
    """
    if parameters.extras:
        raise BadInput(
            "equation error estimates derivatives only; delays, scale factors and structural "
            "parameters need OE or FRE",
            code="not-in-method",
        )
    check_finite(inputs.pick(model.inputs).values, model.inputs)
    X = regressors(model, motion, inputs)
    z = aerodynamic_coefficients(model, motion)
    disturbances = MotionNoise(model, motion.coloured()) if compensate else None
    held = parameters.base.values.copy()
    held[parameters.rows, parameters.columns] = 0.0
    size = parameters.start.size
    values = np.empty(size)
    covariance = np.zeros((size, size))
    corrected = np.zeros((size, size))
    lines = []
    for row, name in enumerate(coefficients(model.modes.numbers)):
        place = np.flatnonzero(parameters.rows == row)
        fitted = X @ held[row]
        if place.size:
            columns = parameters.columns[place]
            noise = None if disturbances is None else disturbances.of_row(row, held[row], columns)
            result = regress(
                X[:, columns],
                z[:, row] - fitted,
                tuple(parameters.names[i] for i in place),
                noise,
            )
            values[place] = result.values
            covariance[np.ix_(place, place)] = result.covariance
            corrected[np.ix_(place, place)] = result.corrected_covariance
            fitted = fitted + X[:, columns] @ result.values
        lines.append(FittedLines(name, (name,), motion.omega, z[:, row : row + 1], fitted[:, None]))
    return Estimate(
        names=parameters.names,
        values=values,
        start=parameters.start,
        covariance=covariance,
        corrected_covariance=corrected,
        lines=tuple(lines),
        steps=(),
        outcome=Outcome.CONVERGED,
        message="Solved directly: one linear regression per coefficient.",
    )


class MotionNoise:
    """How the error of the reconstructed motion enters regressors and coefficients."""

    def __init__(self, model: AeroelasticModel, motion: ReconstructedMotion) -> None:
        n = len(model.modes.numbers)
        n_w = 2 + 2 * n + len(model.inputs)
        s = 1j * motion.omega
        L = np.zeros((s.size, n_w, 2 + n), dtype=complex)
        L[:, np.arange(2 + n), np.arange(2 + n)] = 1.0
        L[:, 2 + n + np.arange(n), 2 + np.arange(n)] = s[:, None]
        self.regressor = L * model.column_factors()[:, None]
        self.coefficient = model.known_dynamics(motion.omega) / model.row_factors()[:, None]
        self.spread = self.regressor @ motion.covariance
        self.regressors = np.real(self.spread @ self.regressor.conj().transpose(0, 2, 1))
        self.covariance = motion.covariance
        self.doubt = motion.doubt
        self.disagreement = motion.disagreement

    def of_row(self, row: int, held: Float[np.ndarray, " n_w"], columns: np.ndarray) -> Disturbance:
        """Errors of the row's free regressors and dependent variable."""
        dependent = self.coefficient[:, row] - np.tensordot(held, self.regressor, axes=(0, 1))
        cross = np.matmul(self.spread, dependent.conj()[:, :, None])[:, :, 0]
        own = np.matmul(self.covariance, dependent.conj()[:, :, None])[:, :, 0]
        return Disturbance(
            self.regressors[:, columns[:, None], columns],
            np.real(cross[:, columns]),
            np.real(np.sum(dependent * own, axis=1)),
            self.doubt,
            self._systematic(dependent, columns),
        )

    def _systematic(
        self, dependent: Complex[np.ndarray, "n_omega n_r"], columns: np.ndarray
    ) -> Complex[np.ndarray, "n_omega n_y p_1"] | None:
        if self.disagreement is None:
            return None
        rows = np.concatenate([self.regressor[:, columns], dependent[:, None, :]], axis=1)
        return self.disagreement @ rows.transpose(0, 2, 1)
