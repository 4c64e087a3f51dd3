"""Equation error with out-of-band modes as nuisance parameters.

The motion of modes above the band cannot be reconstructed from a few sensors. It follows from
the motion in the band and the inputs by the equations of these modes, whose derivatives have a
prior: sensors then need to resolve the motion in the band only.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Complex, Float, Inexact

from flexsid.errors import NotIdentifiable
from flexsid.sysid.estimation.estimate import (
    ErrorComponents,
    Estimate,
    Outcome,
    scale_rows,
)
from flexsid.sysid.estimation.experiment import Parameters
from flexsid.sysid.estimation.linear_algebra import sum_products
from flexsid.sysid.estimation.noise import SpectralMatrix, smooth_density
from flexsid.sysid.estimation.priors import name_priors
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.regression.equation_error import (
    MotionNoise,
    build_regressors,
    compute_aerodynamic_coefficients,
    equation_error_rows,
    shape_regressors,
)
from flexsid.sysid.regression.reconstruction import (
    ReconstructedMotion,
    SensorEquations,
    complete_noise_guess,
    solve_sensor_equations,
)
from flexsid.sysid.signals import FrequencyData, check_finite, check_signal

_ITERATIONS = 12  # of the nuisance parameters
_CONVERGED = 0.1  # largest step of a nuisance parameter, in its standard errors
_HALVINGS = 6  # of a step that does not reduce the cost
_UNSETTLED = 0.5  # further change of a derivative of the band, in standard errors: no optimum
_LARGEST_STEP = 3.0  # of a nuisance parameter, in standard deviations of its prior


@dataclass(frozen=True, slots=True)
class _OutOfBandMotion:
    """Motion of out-of-band modes, eta = T r + t, and their response to unit forces."""

    T: Complex[np.ndarray, "n_omega n_o n_i"]
    t: Complex[np.ndarray, "n_omega n_o"]
    per_force: Complex[np.ndarray, "n_omega n_o n_o"]


_SOLVED = (
    "Solved by one linear regression per coefficient, with the derivatives of out-of-band modes as "
    "nuisance parameters."
)
_NOT_SOLVED = (
    "The derivatives of out-of-band modes did not converge: a further step would move a derivative "
    "by {:.2g} standard errors. Add outputs, or retain fewer modes."
)


def marginal_equation_error(
    model: AeroelasticModel,
    outputs: FrequencyData,
    instruments: Complex[np.ndarray, "n_omega n_y"],
    inputs: FrequencyData,
    parameters: Parameters,
    priors: Mapping[str, tuple[float, float]],
    n_modes: int,
    guess: Float[np.ndarray, " n_y"] | None = None,
    input_noise: Float[np.ndarray, "n_omega n_u"] | None = None,
) -> tuple[Estimate, ReconstructedMotion]:
    """Estimate derivatives by equation error with out-of-band modes marginalised.

    Parameters
    ----------
    model
        Condition, inputs, sensors, and all modes: first those in the band.
    outputs
        Spectra as recorded. [output unit * s]
    instruments
        Recorded over true response. [1]
    inputs
        Surface deflections, instrument dynamics removed. [rad s]
    parameters
        Free derivatives, the nuisance parameters included.
    priors
        Mean and standard deviation of every nuisance parameter.
    n_modes
        Number of modes in the band.
    guess
        Prior of the sensors' noise, as of ``reconstruct_motion``, NaN or None where it is
        unknown; see ``complete_noise_guess``. [output unit * s]
    input_noise
        Variance of the spectra of the deflections; none by default. [(rad s)^2]

    Returns
    -------
    Estimate, ReconstructedMotion
        Estimates of all parameters, and the motion of all modes.

    Raises
    ------
    BadInput
        If a parameter other than a derivative is free, an output has no signal, or a spectrum is
        not finite.
    NotIdentifiable
        If the motion in the band is not observable, or regressors are collinear.

    Notes
    -----
    With nuisance parameters nu, their modes' rows K_oo eta_o = F_o u - K_oi r_i give
    eta_o(r_i, u; nu). The sensors' rows become (P_i + P_o T) r_i, and the regressions of the
    band are those of ``equation_error`` with nu held. nu minimises the residuals of the
    sensors' redundancy and of the equations together with its prior (Gauss-Newton, the
    derivatives of the band eliminated). Noise of motion and inputs is part of residuals and of
    the variables that multiply nu; its mean is subtracted from the gradient.
    Cov(theta) = Cov(theta | nu) + J Cov(nu) J^T with J = d theta / d nu; Cov(nu) is the sandwich
    with the observed covariance of the residuals of all sensors and equations, which share the
    errors of motion and inputs.
    Sources: variable projection, Golub and Pereyra, SIAM Journal on Numerical Analysis 10 (1973);
    corrected score, Nakamura, Biometrika 77 (1990).
    """
    z = outputs.pick(model.outputs).values
    check_signal(z, model.outputs)
    check_finite(inputs.pick(model.inputs).values, model.inputs)
    P = instruments[:, :, None] * model.sensors.response(outputs.omega)
    # Of the record as such: without the known motion of out-of-band modes its signal is another.
    sigma = complete_noise_guess(z, guess, inputs.pick(model.inputs).values)
    problem = _MarginalProblem(model, P, z, inputs, parameters, priors, n_modes, sigma, input_noise)
    solution = problem.solve(parameters.start)
    for _ in range(_ITERATIONS):
        if solution.relative_step < _CONVERGED:
            break
        trial = problem.take_step(solution)
        if trial is None:
            break
        solution = trial
    return problem.build_estimate(solution), solution.motion


@dataclass(frozen=True, slots=True)
class _MarginalSolution:
    """Regressions with the nuisance parameters held, and the Gauss-Newton step of these.

    ``theta`` are all parameters, ``slope`` is the change of those of the band with the nuisance
    parameters; ``plain`` is the covariance of these for white residuals, ``covariance`` that for
    the observed ones. ``components`` are those of the noise in the nuisance parameters,
    ``prior_components`` those of their priors.
    """

    theta: np.ndarray
    motion: ReconstructedMotion
    conditional: Estimate
    slope: Float[np.ndarray, "n_own n_nu"]
    step: Float[np.ndarray, " n_nu"]
    cost: float
    plain: Float[np.ndarray, "n_nu n_nu"]
    covariance: Float[np.ndarray, "n_nu n_nu"]
    components: Float[np.ndarray, "n_nu n_omega"]
    prior_components: Float[np.ndarray, "n_nu n_nu"]

    @property
    def relative_step(self) -> float:
        """Largest step of a nuisance parameter, in its standard errors."""
        return float(np.max(np.abs(self.step) / np.sqrt(np.diag(self.covariance))))


@dataclass(frozen=True, slots=True)
class _Sensitivity:
    """Change of all residuals with the nuisance parameters, in standard deviations of residuals.

    Coefficient c of out-of-band mode o changes the residuals of the sensors by the product of
    ``per_force`` of the mode and variable c, so that sums over sensors are of the modes alone, of
    which there are few: the dense matrix takes five times as long. ``of_equations`` has the
    residuals of the equations. ``places`` are mode and coefficient of ``parameters`` in the flat
    table of ``variables``; other parameters do not change the residuals of sensors.
    """

    per_force: Complex[np.ndarray, "n_omega n_y n_o"]
    variables: Complex[np.ndarray, "n_omega n_o n_c"]
    of_equations: Complex[np.ndarray, "n_omega n_i n_nu"]
    parameters: np.ndarray
    places: np.ndarray

    def square(self, S: SpectralMatrix | None) -> Float[np.ndarray, "n_nu n_nu"]:
        """Compute Re sum V^H S V of the sensitivity V; S is one where it is None."""
        E, adjoint = self.of_equations, self.per_force.conj().transpose(0, 2, 1)
        n_y = self.per_force.shape[1]
        if S is None:
            result = sum_products(E, E)
            of_modes = adjoint @ self.per_force
        else:
            blocks = S.expand_blocks()
            result = sum_products(E, blocks[:, n_y:, n_y:] @ E)
            left = adjoint @ blocks[:, :n_y]
            mixed = self._sum_over_frequencies(left[:, :, n_y:] @ E)
            result[self.parameters] += mixed
            result[:, self.parameters] += mixed.T
            of_modes = left[:, :, :n_y] @ self.per_force
        every = of_modes[..., None] * self.variables[:, None]
        pairs = self._sum_over_frequencies(every.reshape(*of_modes.shape[:2], -1))
        result[np.ix_(self.parameters, self.parameters)] += pairs[:, self.places]
        return result

    def _sum_over_frequencies(
        self, of_modes: Complex[np.ndarray, "n_omega n_o n"]
    ) -> Float[np.ndarray, "n_out n"]:
        """Sum the products of every mode with its variables."""
        each = [
            sum_products(self.variables[:, o], of_modes[:, o]) for o in range(of_modes.shape[1])
        ]
        return np.concatenate(each)[self.places]

    def project(
        self, residuals: Complex[np.ndarray, "n_omega n_e"]
    ) -> Float[np.ndarray, "n_nu n_omega"]:
        """Compute Re V^H times the residuals of every frequency."""
        n_y = self.per_force.shape[1]
        result = np.real(np.einsum("kin,ki->nk", self.of_equations.conj(), residuals[:, n_y:]))
        of_modes = np.matmul(self.per_force.conj().transpose(0, 2, 1), residuals[:, :n_y, None])
        each = np.real(self.variables.conj() * of_modes).reshape(len(residuals), -1)
        result[self.parameters] += each[:, self.places].T
        return result


class _MarginalProblem:
    """Equations of one maneuver; constant quantities are computed once."""

    def __init__(
        self,
        model: AeroelasticModel,
        P: Complex[np.ndarray, "n_omega n_y n_r"],
        z: Complex[np.ndarray, "n_omega n_y"],
        inputs: FrequencyData,
        parameters: Parameters,
        priors: Mapping[str, tuple[float, float]],
        n_modes: int,
        guess: Float[np.ndarray, " n_y"],
        input_noise: Float[np.ndarray, "n_omega n_u"] | None,
    ) -> None:
        self.input_noise = input_noise
        self.model, self.P, self.z, self.inputs = model, P, z, inputs
        self.parameters, self.guess = parameters, guess
        first = model.n_rigid
        self.n_i = first + n_modes
        self.omega = inputs.omega
        n = len(model.modes.numbers)
        column = parameters.columns
        of_mode = np.where(
            (column >= first) & (column < first + 2 * n), (column - first) % max(n, 1), -1
        )
        is_nuisance = (parameters.rows >= self.n_i) | (of_mode >= n_modes)
        self.nuisance = np.flatnonzero(is_nuisance)
        self.own = np.flatnonzero(~is_nuisance)
        self.of_rows = np.flatnonzero(parameters.rows[self.nuisance] >= self.n_i)
        mean, std = np.array([priors[parameters.names[k]] for k in self.nuisance]).T
        self.mean, self.information = mean, std**-2.0
        self.prior_names = name_priors(parameters.names, priors)
        self.factors = model.row_factors()
        self.dynamics = model.known_dynamics(self.omega)
        self.shape = model.derivative_factors(self.omega)
        self.u = inputs.pick(model.inputs).values

    def take_step(self, solution: _MarginalSolution) -> _MarginalSolution | None:
        """Take the largest part of a step that reduces the cost or the next step; else None.

        The step is limited to the range where the equations are nearly linear. The cost is not
        least where the gradient without the bias by noise is zero, so that near the solution
        the next step decides.
        """
        largest = np.max(np.abs(solution.step) * np.sqrt(self.information))
        step = solution.step * min(1.0, _LARGEST_STEP / largest)
        for part in 0.5 ** np.arange(_HALVINGS):
            theta = solution.theta.copy()
            theta[self.nuisance] += part * step
            try:
                trial = self.solve(theta)
            except NotIdentifiable:
                continue  # the motion is not observable there: the step is too long
            if trial.cost < solution.cost or trial.relative_step < solution.relative_step:
                return trial
        return None

    def solve(self, theta: np.ndarray) -> _MarginalSolution:
        """Reconstruct and regress for one value of the nuisance parameters, and expand there."""
        n_i = self.n_i
        around = self._compute_out_of_band_motion(theta)
        of_motion = self.P[:, :, :n_i] + self.P[:, :, n_i:] @ around.T
        known = np.matmul(self.P[:, :, n_i:], around.t[:, :, None])[:, :, 0]
        names = self.model.motions[:n_i]
        equations = SensorEquations(
            self.omega, of_motion, self.z - known, self.model.outputs, names
        )
        inner = solve_sensor_equations(equations, self.guess)
        motion = _extend_motion(inner, around)
        held = self._hold_nuisance(theta)
        per_input = self._compute_motion_per_input(theta, inner, equations, around)
        noise = MotionNoise(self.model, motion.with_coloured_errors(), self.input_noise, per_input)
        conditional, regressions = equation_error_rows(
            self.model, motion, self.inputs, held, range(n_i), noise
        )
        theta = theta.copy()
        theta[self.own] = conditional.values
        X = build_regressors(self.model, motion, self.inputs)
        residual = compute_aerodynamic_coefficients(self.model, motion)[:, :n_i]
        values = self.parameters.table(theta).values
        if self.shape is None:
            residual = residual - X @ values[:n_i].T
        else:
            residual = residual - np.einsum("krw,kw,rw->kr", self.shape[:, :n_i], X, values[:n_i])
        # Residuals of the sensors, then of the equations.
        sensors = equations.z - np.matmul(of_motion, inner.values[:, :, None])[:, :, 0]
        n_y = sensors.shape[1]
        every = np.concatenate([sensors, residual], axis=1)
        variance = np.empty(every.shape)
        variance[:, :n_y] = inner.noise**2
        if inner.colour is not None:
            variance[:, :n_y] *= inner.colour[:, None]
        variance[:, n_y:] = np.mean(np.abs(residual) ** 2, axis=0)
        K = self._assemble(theta)[0][:, :n_i] / self.factors[:n_i, None]
        per_coefficient = self._differentiate_residuals(K, inner, equations, around)
        rows, columns = (
            places[self.nuisance] for places in (self.parameters.rows, self.parameters.columns)
        )
        per_error = np.concatenate([np.zeros((len(K), n_y, K.shape[2])), K], axis=1)
        if self.input_noise is not None:
            control = self._get_control(theta)
            per_input = per_coefficient @ control[:, n_i:]
            per_input[:, n_y:] = -control[:, :n_i]
            per_error = np.concatenate([per_error, per_input], axis=2)
        common = per_error @ noise.spread.conj().transpose(0, 2, 1)
        of_equations = np.zeros((len(K), n_i, rows.size), dtype=complex)
        out = self.of_rows
        of_equations[:, :, out] = per_coefficient[:, n_y:, rows[out] - n_i]
        direct = np.flatnonzero(rows < n_i)
        of_equations[:, rows[direct], direct] = -1.0
        of_equations *= shape_regressors(X, self.shape, rows, columns)[:, None]
        slope = np.zeros((self.own.size, rows.size))
        for row, fit in regressions.items():
            mine = np.flatnonzero(held.rows == row)
            variance[:, n_y + row] = fit.variance
            Xr = shape_regressors(X, self.shape, row, held.columns[mine])
            weights = Xr.conj() / fit.variance[:, None]
            slope[mine] = fit.inverse @ np.real(weights.T @ of_equations[:, row])
            of_equations[:, row] -= Xr @ slope[mine]
        std = np.sqrt(variance)
        scaled = every / std
        sensitivity = _Sensitivity(
            per_coefficient[:, :n_y] / std[:, :n_y, None],
            np.broadcast_to(X[:, None], (len(X), self.P.shape[2] - n_i, X.shape[1]))
            if self.shape is None
            else X[:, None] * self.shape[:, n_i:],
            of_equations / std[:, n_y:, None],
            out,
            (rows[out] - n_i) * X.shape[1] + columns[out],
        )
        information = 2.0 * sensitivity.square(None)
        by_frequency = 2.0 * sensitivity.project(scaled)
        # The errors of motion and inputs are part of residuals and variables alike.
        conjugate = None if self.shape is None else self.shape.conj()
        weighted = common / variance[:, :, None]
        moved = per_coefficient.conj().transpose(0, 2, 1) @ weighted
        if conjugate is not None:
            moved, weighted = moved * conjugate[:, n_i:], weighted[:, n_y:] * conjugate[:, :n_i]
        else:
            weighted = weighted[:, n_y:]
        by_frequency[out] -= 2.0 * np.real(moved[:, rows[out] - n_i, columns[out]]).T
        by_frequency[direct] += 2.0 * np.real(weighted[:, rows[direct], columns[direct]]).T
        for row, fit in regressions.items():
            mine = np.flatnonzero(held.rows == row)
            moment = shape_regressors(common[:, n_y + row], conjugate, row, held.columns[mine])
            moment = moment / fit.variance[:, None]
            by_frequency += 2.0 * slope[mine].T @ np.real(moment).T
        gradient = by_frequency.sum(axis=1)
        density = smooth_density(scaled, np.zeros(self.omega.size, dtype=int), 1)
        scores = 2.0 * sensitivity.square(density)
        total = information + np.diag(self.information)
        scale = 1.0 / np.sqrt(np.diag(total))
        inverse = np.linalg.inv(total * np.outer(scale, scale)) * np.outer(scale, scale)
        offset = theta[self.nuisance] - self.mean
        step = -inverse @ (gradient + self.information * offset)
        middle = np.diag(self.information) + scores
        of_noise = scale_rows(-inverse @ by_frequency, np.diag(inverse @ scores @ inverse.T))
        return _MarginalSolution(
            theta,
            motion,
            conditional,
            slope,
            step,
            self._compute_cost(inner, residual, offset),
            inverse,
            inverse @ middle @ inverse.T,
            of_noise,
            inverse * np.sqrt(self.information),
        )

    def _hold_nuisance(self, theta: np.ndarray) -> Parameters:
        """Return the parameters of the band, with the nuisance parameters held."""
        return replace(
            self.parameters,
            names=tuple(self.parameters.names[k] for k in self.own),
            start=self.parameters.start[self.own],
            base=self.parameters.table(theta),
            rows=self.parameters.rows[self.own],
            columns=self.parameters.columns[self.own],
        )

    def _compute_cost(
        self, inner: ReconstructedMotion, residual: np.ndarray, offset: np.ndarray
    ) -> float:
        """Compute the negative log posterior of the nuisance parameters, without constants.

        Notes
        -----
        With M frequencies and the variances concentrated out it is M (1 - n_i/n_y) sum ln s_y^2
        of the sensors' noise, of which the motion takes n_i of n_y degrees of freedom, plus
        M sum ln of the mean squared residual of every equation, plus the prior.
        """
        n_omega, n_y = self.z.shape
        redundancy = (1.0 - self.n_i / n_y) * np.sum(np.log(inner.noise**2))
        equations_power = np.sum(np.log(np.mean(np.abs(residual) ** 2, axis=0)))
        likelihood = n_omega * (redundancy + equations_power)
        return float(likelihood + 0.5 * self.information @ offset**2)

    def _compute_out_of_band_motion(self, theta: np.ndarray) -> _OutOfBandMotion:
        n_i = self.n_i
        K, load = self._assemble(theta)
        per_force = np.linalg.inv(K[:, n_i:, n_i:])
        return _OutOfBandMotion(
            T=-per_force @ K[:, n_i:, :n_i],
            t=np.matmul(per_force, load[:, n_i:, None])[:, :, 0],
            per_force=per_force * self.factors[n_i:],
        )

    def _assemble(self, theta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return K(s), with aerodynamics, and the forces of the inputs."""
        n_r, n_w = self.P.shape[2], self.model.column_factors().size - self.u.shape[1]
        forces = (
            self.factors[:, None]
            * self.parameters.table(theta).values
            * self.model.column_factors()
        )
        if self.shape is not None:
            forces = forces * self.shape
        K = self.dynamics - forces[..., :n_r]
        K[:, :, self.model.n_rigid :] -= 1j * self.omega[:, None, None] * forces[..., n_r:n_w]
        load = forces[..., n_w:]
        if self.shape is None:
            return K, self.u @ load.T
        return K, np.matmul(load, self.u[:, :, None])[:, :, 0]

    def _get_control(self, theta: np.ndarray) -> Inexact[np.ndarray, "n_omega n_r n_u"]:
        """Return the control derivatives of all rows, with their frequency shape."""
        n_u = self.u.shape[1]
        control = self.parameters.table(theta).values[:, -n_u:]
        if self.shape is not None:
            return control * self.shape[:, :, -n_u:]
        return np.broadcast_to(control, (self.omega.size, *control.shape))

    def _compute_motion_per_input(
        self,
        theta: np.ndarray,
        inner: ReconstructedMotion,
        equations: SensorEquations,
        around: _OutOfBandMotion,
    ) -> Complex[np.ndarray, "n_omega n_r n_u"]:
        """Compute the error of the motion per error of the inputs, which drive all modes."""
        direct = around.per_force @ self._get_control(theta)[:, self.n_i :]
        moved = self.P[:, :, self.n_i :] @ direct
        inside = -self._compute_gain(inner, equations) @ moved
        return np.concatenate([inside, around.T @ inside + direct], axis=1)

    def _compute_gain(self, inner: ReconstructedMotion, equations: SensorEquations) -> np.ndarray:
        """Change of the motion in the band per change of the sensors."""
        weighted = equations.P.conj().transpose(0, 2, 1) / inner.noise**2
        return inner.covariance @ weighted

    def _differentiate_residuals(
        self,
        K: Complex[np.ndarray, "n_omega n_i n_r"],
        inner: ReconstructedMotion,
        equations: SensorEquations,
        around: _OutOfBandMotion,
    ) -> Complex[np.ndarray, "n_omega n_y_n_i n_o"]:
        """Change of all residuals per unit coefficient of every out-of-band mode.

        Of the residuals of the sensors, then of those of the equations in the band.
        """
        n_i = self.n_i
        moved = self.P[:, :, n_i:] @ around.per_force
        inside = -self._compute_gain(inner, equations) @ moved
        outside = around.per_force + around.T @ inside
        return np.concatenate(
            [
                -moved - equations.P @ inside,
                K[:, :, :n_i] @ inside + K[:, :, n_i:] @ outside,
            ],
            axis=1,
        )

    def build_estimate(self, solution: _MarginalSolution) -> Estimate:
        """Assemble values and covariances of all parameters."""
        size = self.parameters.start.size
        J = np.zeros((size, self.nuisance.size))
        J[self.own] = solution.slope
        J[self.nuisance] = np.eye(self.nuisance.size)
        plain, corrected = (J @ C @ J.T for C in (solution.plain, solution.covariance))
        own = np.ix_(self.own, self.own)
        components = np.zeros((size, self.omega.size))
        if solution.conditional.components is not None:
            components[self.own] = solution.conditional.components.noise[0]
        plain[own] += solution.conditional.covariance
        corrected[own] += solution.conditional.corrected_covariance
        change = np.abs(solution.slope @ solution.step)
        moved = float(np.max(change / np.sqrt(np.diag(corrected)[self.own])))
        outcome, message = Outcome.CONVERGED, _SOLVED
        if not moved < _UNSETTLED:
            outcome, message = Outcome.ITERATION_LIMIT, _NOT_SOLVED.format(moved)
        return replace(
            solution.conditional,
            names=self.parameters.names,
            values=solution.theta,
            start=self.parameters.start,
            covariance=plain,
            corrected_covariance=corrected,
            outcome=outcome,
            message=message,
            components=ErrorComponents(
                (self.omega,),
                (components + J @ solution.components,),
                self.prior_names,
                J @ solution.prior_components,
            ),
        )


def _extend_motion(inner: ReconstructedMotion, around: _OutOfBandMotion) -> ReconstructedMotion:
    """Add the motion of the out-of-band modes and its covariance."""
    n_omega, _, n_i = around.T.shape
    every = np.concatenate([np.broadcast_to(np.eye(n_i), (n_omega, n_i, n_i)), around.T], axis=1)
    offset = np.concatenate([np.zeros((n_omega, n_i)), around.t], axis=1)
    values = np.matmul(every, inner.values[:, :, None])[:, :, 0] + offset
    disagreement = inner.disagreement
    return replace(
        inner,
        values=values,
        covariance=every @ inner.covariance @ every.conj().transpose(0, 2, 1),
        disagreement=None if disagreement is None else disagreement @ every.transpose(0, 2, 1),
    )
