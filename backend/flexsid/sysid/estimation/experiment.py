"""Experiment: the lines of one maneuver, and the fast response of the model at them.

The derivatives enter force rows only, so the sensitivity of every output to
derivative (i, j) is G_i w_j: the output's response to a unit force in row i times
the variable j. The normal matrix is then a product of two small matrices summed
over lines (the Kronecker form); no Jacobian is ever stored.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float

from flexsid.sysid.estimation.parameters import Extra, Parameters
from flexsid.sysid.model.aeroelastic import AeroelasticModel


@dataclass(frozen=True, slots=True)
class Experiment:
    """What was measured at the lines of one maneuver.

    ``instruments`` is each output's measured over true response; inputs have
    theirs removed already. Lines of one ``group`` share a noise covariance:
    one group for OE, one per input for FRE. Where lines are computed from others,
    ``source`` holds those, and ``gain`` how the noise of each enters each line here.
    """

    name: str
    model: AeroelasticModel
    instruments: Complex[np.ndarray, "n_omega n_y"]
    omega: Float[np.ndarray, " n_omega"]
    inputs: Complex[np.ndarray, "n_omega n_u"]
    measured: Complex[np.ndarray, "n_omega n_y"]
    group: np.ndarray
    group_names: tuple[str, ...]
    source: Experiment | None = None
    gain: Complex[np.ndarray, "n_omega n_source"] | None = None


@dataclass(frozen=True, slots=True)
class Response:
    """The model's answer at every line for one theta."""

    motion: Complex[np.ndarray, "n_omega n_r"]
    outputs: Complex[np.ndarray, "n_omega n_y"]
    unit_motion: Complex[np.ndarray, "n_omega n_r n_r"]
    sensors: Complex[np.ndarray, "n_omega n_y n_r"]


@dataclass(frozen=True, slots=True)
class Sensitivity:
    """Sensitivity in its factored form: forces G, variables w, and dense extras."""

    forces: Complex[np.ndarray, "n_omega n_y n_r"]
    variables: Complex[np.ndarray, "n_omega n_w"]
    extras: Complex[np.ndarray, "n_omega n_y n_extra"]


class LineModel:
    """An experiment with all that does not depend on theta computed once."""

    def __init__(self, experiment: Experiment, parameters: Parameters) -> None:
        model = experiment.model
        self.experiment = experiment
        self.parameters = parameters
        self.s = 1j * experiment.omega
        self.sensors = experiment.instruments[:, :, None] * model.sensors.response(experiment.omega)
        self.dynamics = model.known_dynamics(experiment.omega)
        self.rows = model.row_factors()
        self.columns = model.column_factors()
        self.scale = self.rows[parameters.rows] * self.columns[parameters.columns]
        self._scale_pairs = np.outer(self.scale, self.scale)
        self._upper = np.triu_indices(self.rows.size)
        self._places = _places_of_pairs(parameters, self.rows.size, self.columns.size)

    def respond(self, theta: Float[np.ndarray, " n_theta"]) -> Response:
        """Outputs at theta: one small solve per line."""
        n_r = self.dynamics.shape[1]
        n = n_r - 2
        table = self.parameters.table(theta).values
        forces = self.rows[:, None] * table * self.columns
        K = self.dynamics - forces[:, :n_r]
        K[:, :, 2:] -= self.s[:, None, None] * forces[:, n_r : n_r + n]
        sensors = self._apply_extras(theta, K)
        load = self.experiment.inputs @ forces[:, n_r + n :].T
        # The inverse itself is wanted: its columns are the motion under unit forces.
        unit_motion = np.linalg.inv(K)
        motion = np.matmul(unit_motion, load[:, :, None])[:, :, 0]
        outputs = np.matmul(sensors, motion[:, :, None])[:, :, 0]
        return Response(motion, outputs, unit_motion, sensors)

    def sensitivity(self, theta: Float[np.ndarray, " n_theta"], response: Response) -> Sensitivity:
        """Factored sensitivities of the outputs around a response."""
        forces = np.matmul(response.sensors, response.unit_motion)
        variables = np.concatenate(
            [
                response.motion,
                self.s[:, None] * response.motion[:, 2:],
                self.experiment.inputs,
            ],
            axis=1,
        )
        return Sensitivity(forces, variables, self._extra_sensitivity(theta, response, forces))

    def _extra_values(self, theta: Float[np.ndarray, " n_theta"]) -> list[tuple[Extra, float]]:
        first = self.parameters.rows.size
        return list(zip(self.parameters.extras, theta[first:].tolist(), strict=True))

    def _apply_extras(
        self, theta: Float[np.ndarray, " n_theta"], K: Complex[np.ndarray, "n_omega n_r n_r"]
    ) -> Complex[np.ndarray, "n_omega n_y n_r"]:
        values = self._extra_values(theta)
        if not values:
            return self.sensors
        sensors = self.sensors.copy()
        modes = self.experiment.model.modes
        frequency = np.ones(modes.omega.size)
        damping = np.ones(modes.omega.size)
        for extra, value in values:
            if extra.kind == "omega":
                frequency[extra.mode] = value
            elif extra.kind == "zeta":
                damping[extra.mode] = value
            elif extra.kind == "shape":
                sensors[:, extra.output, 2 + extra.mode] *= value
        w, z = modes.omega * frequency, modes.zeta * damping
        change = 2.0 * self.s[:, None] * (z * w - modes.zeta * modes.omega) + w**2 - modes.omega**2
        modal = np.arange(2, 2 + modes.omega.size)
        K[:, modal, modal] += change
        for extra, value in values:
            if extra.kind == "delay":
                sensors[:, extra.output] *= np.exp(-self.s * value)[:, None]
            elif extra.kind == "scale":
                sensors[:, extra.output] *= value
        return sensors

    def _extra_sensitivity(
        self,
        theta: Float[np.ndarray, " n_theta"],
        response: Response,
        forces: Complex[np.ndarray, "n_omega n_y n_r"],
    ) -> Complex[np.ndarray, "n_omega n_y n_extra"]:
        values = self._extra_values(theta)
        result = np.zeros((*response.outputs.shape, len(values)), dtype=complex)
        modes = self.experiment.model.modes
        frequency = {e.mode: v for e, v in values if e.kind == "omega"}
        damping = {e.mode: v for e, v in values if e.kind == "zeta"}
        for column, (extra, value) in enumerate(values):
            if extra.kind == "delay":
                result[:, extra.output, column] = -self.s * response.outputs[:, extra.output]
            elif extra.kind == "scale":
                result[:, extra.output, column] = response.outputs[:, extra.output] / value
            elif extra.kind == "shape":
                seen = response.sensors[:, extra.output, 2 + extra.mode] / value
                result[:, extra.output, column] = seen * response.motion[:, 2 + extra.mode]
            else:
                w = modes.omega[extra.mode]
                z = modes.zeta[extra.mode]
                if extra.kind == "omega":
                    z = z * damping.get(extra.mode, 1.0)
                    change = 2.0 * z * w * self.s + 2.0 * value * w**2
                else:
                    change = 2.0 * z * w * frequency.get(extra.mode, 1.0) * self.s
                load = -change * response.motion[:, 2 + extra.mode]
                result[:, :, column] = forces[:, :, 2 + extra.mode] * load[:, None]
        return result

    def normal_equations(
        self,
        sensitivity: Sensitivity,
        residuals: Complex[np.ndarray, "n_omega n_y"],
        weights: Complex[np.ndarray, "n_omega n_y n_y"] | Float[np.ndarray, "n_omega n_y"],
    ) -> tuple[Float[np.ndarray, "n_theta n_theta"], Float[np.ndarray, " n_theta"]]:
        """Re sum J^H W J and Re sum J^H W nu in the Kronecker form.

        Parameters
        ----------
        sensitivity
            Factored sensitivities.
        residuals
            Measured less modelled outputs.
        weights
            Inverse noise covariance of each line, or its diagonal.
        """
        G, w, E = sensitivity.forces, sensitivity.variables, sensitivity.extras
        GE = np.concatenate([G, E], axis=2) if E.shape[2] else G
        if weights.ndim == 2:
            weighted = GE.conj() * weights[:, :, None]
        else:
            weighted = np.matmul(weights.conj().transpose(0, 2, 1), GE).conj()
        left = weighted.transpose(0, 2, 1)
        A = np.matmul(left, GE)
        b = np.matmul(left, residuals[:, :, None])[:, :, 0]
        n_r = G.shape[2]
        return self._assemble(A, b, w, n_r)

    def _assemble(
        self,
        A: Complex[np.ndarray, "n_omega n_all n_all"],
        b: Complex[np.ndarray, "n_omega n_all"],
        w: Complex[np.ndarray, "n_omega n_w"],
        n_r: int,
    ) -> tuple[Float[np.ndarray, "n_theta n_theta"], Float[np.ndarray, " n_theta"]]:
        rows, columns = self.parameters.rows, self.parameters.columns
        p = rows.size
        outer = (w.conj()[:, :, None] * w[:, None, :]).reshape(w.shape[0], -1)
        blocks = A[:, self._upper[0], self._upper[1]]
        product = np.real(blocks).T @ np.real(outer) - np.imag(blocks).T @ np.imag(outer)
        size = p + A.shape[1] - n_r
        N = np.empty((size, size))
        np.multiply(product.ravel()[self._places], self._scale_pairs, out=N[:p, :p])
        gradient = np.real(b[:, :n_r].T @ w.conj())
        g = np.concatenate([gradient[rows, columns] * self.scale, np.real(b[:, n_r:]).sum(axis=0)])
        if N.shape[0] > p:
            cross = np.real(np.tensordot(w.conj(), A[:, :n_r, n_r:], axes=(0, 0)))
            N[:p, p:] = cross[columns, rows] * self.scale[:, None]
            N[p:, :p] = N[:p, p:].T
            N[p:, p:] = np.real(A[:, n_r:, n_r:]).sum(axis=0)
        return N, g

    def jacobian(self, sensitivity: Sensitivity) -> Complex[np.ndarray, "n_omega n_y n_theta"]:
        """All sensitivities written out, for what the Kronecker form cannot do."""
        G, w = sensitivity.forces, sensitivity.variables
        rows, columns = self.parameters.rows, self.parameters.columns
        derivatives = G[:, :, rows] * (w[:, columns] * self.scale)[:, None, :]
        return np.concatenate([derivatives, sensitivity.extras], axis=2)

    def output_gradients(
        self,
        sensitivity: Sensitivity,
        residuals: Complex[np.ndarray, "n_omega n_y"],
        weights: Float[np.ndarray, "n_omega n_y"],
    ) -> Float[np.ndarray, "n_groups n_theta n_y"]:
        """Re sum J^H W nu of every single output, by group of lines."""
        group = self.experiment.group
        parts = []
        for g in range(len(self.experiment.group_names)):
            lines = group == g
            pull = (weights * residuals)[lines]
            loads = sensitivity.forces[lines].conj() * pull[:, :, None]
            spread = np.real(np.tensordot(loads, sensitivity.variables[lines].conj(), axes=(0, 0)))
            derivatives = spread[:, self.parameters.rows, self.parameters.columns].T
            extras = np.real(np.einsum("kye,ky->ey", sensitivity.extras[lines].conj(), pull))
            parts.append(np.concatenate([derivatives * self.scale[:, None], extras]))
        return np.stack(parts)


def _places_of_pairs(parameters: Parameters, n_r: int, n_w: int) -> np.ndarray:
    """Where the sum of conj(w_j) w_j' A_ii' of every pair of derivatives is kept.

    Only i <= i' is computed; the rest follows from A being Hermitian.
    """
    number = np.zeros((n_r, n_r), dtype=int)
    number[np.triu_indices(n_r)] = np.arange(n_r * (n_r + 1) // 2)
    i, j = parameters.rows[:, None], parameters.columns[:, None]
    k, m = parameters.rows[None, :], parameters.columns[None, :]
    pair = np.where(i <= k, number[i, k], number[k, i])
    return pair * n_w**2 + np.where(i <= k, j * n_w + m, m * n_w + j)
