"""Equation error: each coefficient regressed on motion and inputs (Eqs 23-24)."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from jaxtyping import Complex, Float

from flexsid.errors import BadInput
from flexsid.sysid.estimation.estimate import ErrorComponents, Estimate, FittedSpectra, Outcome
from flexsid.sysid.estimation.experiment import Parameters
from flexsid.sysid.estimation.flight_noise import (
    AssignedCommands,
    ProcessNoise,
    estimate_process_noise,
)
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.regression.least_squares import ErrorsInVariables, Regression, regress
from flexsid.sysid.regression.reconstruction import ReconstructedMotion
from flexsid.sysid.signals import FrequencyData, check_finite


def compute_aerodynamic_coefficients(
    model: AeroelasticModel, motion: ReconstructedMotion
) -> Complex[np.ndarray, "n_omega n_rows"]:
    """Compute the spectra of the coefficients of force, moments and modes from the motion. [s]"""
    K = model.known_dynamics(motion.omega)
    return np.matmul(K, motion.values[:, :, None])[:, :, 0] / model.row_factors()


def build_regressors(
    model: AeroelasticModel, motion: ReconstructedMotion, inputs: FrequencyData
) -> Complex[np.ndarray, "n_omega n_w"]:
    """Compute the spectra of nondimensional motions, eta, etadot c/2V and the inputs. [s]

    Without a frequency shape, by which ``shape_regressors`` multiplies those of each row.
    """
    rates = 1j * motion.omega[:, None] * motion.values[:, model.n_rigid :]
    u = inputs.pick(model.inputs).values
    return np.concatenate([motion.values, rates, u], axis=1) * model.column_factors()


def shape_regressors(
    X: Complex[np.ndarray, "n_omega n_w"],
    factors: Complex[np.ndarray, "n_omega n_rows n_w"] | None,
    row: int | np.ndarray,
    columns: np.ndarray | slice = slice(None),
) -> Complex[np.ndarray, "n_omega n_c"]:
    """Select the regressors of a row (or one row for each column), with its frequency shape."""
    return X[:, columns] if factors is None else X[:, columns] * factors[:, row, columns]


def equation_error(
    model: AeroelasticModel,
    motion: ReconstructedMotion,
    inputs: FrequencyData,
    parameters: Parameters,
    *,
    input_noise: Float[np.ndarray, "n_omega n_u"] | None = None,
    commands: AssignedCommands | None = None,
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
        The free derivatives; the others contribute with their fixed value.
    input_noise
        Variance of the spectra of the deflections; none by default. [(rad s)^2]
    commands
        Of every harmonic, by which motion due to turbulence is recognised; none by default.
    compensate
        Weight the frequencies by the uncertainty of the reconstructed motion and of the inputs,
        and remove the bias due to their noise from the normal equations; without it, the plain
        least squares of Eq. 24.

    Raises
    ------
    BadInput
        If a parameter other than a derivative is free.
    NotIdentifiable
        If a coefficient has more free derivatives than data, or collinear ones.

    Notes
    -----
    Source: Eqs 23-24; Klein and Morelli, Aircraft System Identification,
    doi:10.2514/4.861505, ch. 5 and 7.

    Departure: Eq. 24 takes the regressors as exact. Higher modes are reconstructed
    with little signal, and plain least squares then biases their derivatives
    towards zero with standard errors that are too small.
    """
    rows = range(len(model.coefficients))
    coloured = motion.with_coloured_errors()
    noise = MotionNoise(model, coloured, input_noise) if compensate else None
    if noise is not None and commands is not None:
        u = inputs.pick(model.inputs).values
        turbulent = estimate_process_noise(
            motion.omega, motion.values, coloured.covariance, u, commands
        )
        if turbulent is not None:
            noise = MotionNoise(model, coloured, np.zeros(u.shape), process_noise=turbulent)
    return equation_error_rows(model, motion, inputs, parameters, rows, noise)[0]


def equation_error_rows(
    model: AeroelasticModel,
    motion: ReconstructedMotion,
    inputs: FrequencyData,
    parameters: Parameters,
    rows: Iterable[int],
    motion_noise: MotionNoise | None,
) -> tuple[Estimate, dict[int, Regression]]:
    """Estimate the derivatives of some coefficients; see ``equation_error``.

    Returns
    -------
    Estimate, dict
        The estimate, and the regression of every coefficient with free derivatives, by row.
    """
    if parameters.extras:
        raise BadInput(
            "equation error estimates derivatives only; delays, scale factors and structural "
            "parameters need OE or FRE",
            code="not-in-method",
        )
    check_finite(inputs.pick(model.inputs).values, model.inputs)
    X = build_regressors(model, motion, inputs)
    z = compute_aerodynamic_coefficients(model, motion)
    factors = model.derivative_factors(motion.omega)
    held = parameters.base.values.copy()
    held[parameters.rows, parameters.columns] = 0.0
    size = parameters.start.size
    values = np.empty(size)
    covariance = np.zeros((size, size))
    corrected = np.zeros((size, size))
    components = np.zeros((size, motion.omega.size))
    lines = []
    regressions: dict[int, Regression] = {}
    names = model.coefficients
    for row in rows:
        name = names[row]
        own = np.flatnonzero(parameters.rows == row)
        fitted = shape_regressors(X, factors, row) @ held[row]
        if own.size:
            columns = parameters.columns[own]
            errors = None
            if motion_noise is not None:
                errors = motion_noise.compute_row_errors(row, held[row], columns)
            mine = shape_regressors(X, factors, row, columns)
            result = regress(
                mine,
                z[:, row] - fitted,
                tuple(parameters.names[i] for i in own),
                errors,
            )
            regressions[row] = result
            values[own] = result.values
            covariance[np.ix_(own, own)] = result.covariance
            corrected[np.ix_(own, own)] = result.corrected_covariance
            components[own] = result.components
            fitted = fitted + mine @ result.values
        lines.append(
            FittedSpectra(name, (name,), motion.omega, z[:, row : row + 1], fitted[:, None])
        )
    estimate = Estimate(
        names=parameters.names,
        values=values,
        start=parameters.start,
        covariance=covariance,
        corrected_covariance=corrected,
        lines=tuple(lines),
        steps=(),
        outcome=Outcome.CONVERGED,
        message="Solved directly: one linear regression per coefficient.",
        components=ErrorComponents((motion.omega,), (components,), (), np.zeros((size, 0))),
    )
    return estimate, regressions


def build_variable_matrix(
    model: AeroelasticModel, s: Complex[np.ndarray, " n_omega"]
) -> Complex[np.ndarray, "n_omega n_w n_r"]:
    """Build the matrix from the motion to the variables without factors: rates are s eta."""
    n_r, n = len(model.motions), len(model.modes.numbers)
    L = np.zeros((s.size, len(model.variables), n_r), dtype=complex)
    L[:, np.arange(n_r), np.arange(n_r)] = 1.0
    L[:, n_r + np.arange(n), model.n_rigid + np.arange(n)] = s[:, None]
    return L


class MotionNoise:
    """Propagation of the errors of motion and inputs to regressors and coefficients.

    Parameters
    ----------
    model, motion
        Model, and reconstructed motion with its covariance.
    input_noise
        Variance of the spectra of the deflections; None: no error. [(rad s)^2]
    motion_per_input
        Error of the motion per error of the inputs, where it was reconstructed with them.
    process_noise
        Covariance of motion and inputs instead of those of their measurement.
    """

    def __init__(
        self,
        model: AeroelasticModel,
        motion: ReconstructedMotion,
        input_noise: Float[np.ndarray, "n_omega n_u"] | None = None,
        motion_per_input: Complex[np.ndarray, "n_omega n_r n_u"] | None = None,
        process_noise: ProcessNoise | None = None,
    ) -> None:
        s = 1j * motion.omega
        self.regressor = build_variable_matrix(model, s) * model.column_factors()[:, None]
        self.factors = model.derivative_factors(motion.omega)
        self.coefficient = model.known_dynamics(motion.omega) / model.row_factors()[:, None]
        self.covariance = motion.covariance
        self.disagreement = motion.disagreement
        self.relative_std = motion.relative_std
        if input_noise is not None:
            self._add_inputs(input_noise, motion_per_input)
        if process_noise is not None:
            self.covariance = process_noise.covariance
            self.relative_std = process_noise.relative_std
        self.spread = self.regressor @ self.covariance
        self.regressors = np.real(self.spread @ self.regressor.conj().transpose(0, 2, 1))

    def _add_inputs(
        self,
        input_noise: Float[np.ndarray, "n_omega n_u"],
        motion_per_input: Complex[np.ndarray, "n_omega n_r n_u"] | None,
    ) -> None:
        """Append the errors of the inputs to those of the motion."""
        n_omega, n_w, n_r = self.regressor.shape
        n_u = input_noise.shape[1]
        T = np.zeros((n_omega, n_r, n_u)) if motion_per_input is None else motion_per_input
        TS = T * input_noise[:, None, :]
        own = np.zeros((n_omega, n_u, n_u))
        own[:, np.arange(n_u), np.arange(n_u)] = input_noise
        self.covariance = np.concatenate(
            [
                np.concatenate([self.covariance + TS @ T.conj().transpose(0, 2, 1), TS], axis=2),
                np.concatenate([TS.conj().transpose(0, 2, 1), own], axis=2),
            ],
            axis=1,
        )
        of_inputs = np.zeros((n_omega, n_w, n_u))
        of_inputs[:, n_w - n_u + np.arange(n_u), np.arange(n_u)] = 1.0
        self.regressor = np.concatenate([self.regressor, of_inputs], axis=2)
        none = np.zeros((*self.coefficient.shape[:2], n_u))
        self.coefficient = np.concatenate([self.coefficient, none], axis=2)
        if self.disagreement is not None:
            none = np.zeros((*self.disagreement.shape[:2], n_u))
            self.disagreement = np.concatenate([self.disagreement, none], axis=2)

    def compute_row_errors(
        self, row: int, held: Float[np.ndarray, " n_w"], columns: np.ndarray
    ) -> ErrorsInVariables:
        """Compute the errors of the free regressors and dependent variable of one row."""
        regressor, spread, regressors = self.regressor, self.spread, self.regressors
        if self.factors is not None:
            regressor = self.factors[:, row, :, None] * regressor
            spread = self.factors[:, row, :, None] * spread
            regressors = np.real(spread @ regressor.conj().transpose(0, 2, 1))
        dependent = self.coefficient[:, row] - np.tensordot(held, regressor, axes=(0, 1))
        cross = np.matmul(spread, dependent.conj()[:, :, None])[:, :, 0]
        own = np.matmul(self.covariance, dependent.conj()[:, :, None])[:, :, 0]
        return ErrorsInVariables(
            regressors[:, columns[:, None], columns],
            np.real(cross[:, columns]),
            np.real(np.sum(dependent * own, axis=1)),
            self.relative_std,
            self._compute_systematic(dependent, regressor[:, columns]),
        )

    def _compute_systematic(
        self,
        dependent: Complex[np.ndarray, "n_omega n_r"],
        regressor: Complex[np.ndarray, "n_omega p n_r"],
    ) -> Complex[np.ndarray, "n_omega n_y p_1"] | None:
        if self.disagreement is None:
            return None
        rows = np.concatenate([regressor, dependent[:, None, :]], axis=1)
        return self.disagreement @ rows.transpose(0, 2, 1)
