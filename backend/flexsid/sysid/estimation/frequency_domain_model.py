"""Frequency-domain model: response and exact sensitivities at the frequencies of an experiment.

The derivatives enter force rows only, so the sensitivity of every output to
derivative (i, j) is G_i w_j: the output's response to a unit force in row i times
the variable j. A factor on a mode's frequency or damping acts like one more variable
of that mode's row; a delay or scale factor affects one output only.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float

from flexsid.sysid.estimation.elimination import Elimination
from flexsid.sysid.estimation.experiment import Experiment
from flexsid.sysid.estimation.parameters import Parameters


@dataclass(frozen=True, slots=True)
class ModelResponse:
    """Response of the model at every frequency for one theta.

    ``sensors`` are the outputs per motion; ``delayed`` the factor of delays and scale factors
    on each output, None without them.
    """

    motion: Complex[np.ndarray, "n_omega n_r"]
    outputs: Complex[np.ndarray, "n_omega n_y"]
    unit_motion: Complex[np.ndarray, "n_omega n_r n_r"]
    sensors: Complex[np.ndarray, "n_omega n_y n_r"]
    delayed: Complex[np.ndarray, "n_omega n_y"] | None


@dataclass(frozen=True, slots=True)
class Sensitivity:
    """Sensitivity in its factored form: forces G, variables w, and single outputs' own.

    Frequency is the last axis where sums over it are products of contiguous rows.
    """

    forces: Complex[np.ndarray, "n_omega n_y n_r"]
    variables: Complex[np.ndarray, "n_w n_omega"]
    own: Complex[np.ndarray, "n_own n_omega"]


class FrequencyDomainModel:
    """Model of an experiment; everything independent of theta is computed once.

    Attributes
    ----------
    pair_rows, pair_columns
        Force row and variable of every parameter that acts as a force.
    own_outputs
        Output of every parameter that affects one output only.
    order
        Indices in theta of these two kinds, one after the other.
    """

    def __init__(self, experiment: Experiment, parameters: Parameters) -> None:
        model = experiment.model
        self.experiment = experiment
        self.parameters = parameters
        self.s = 1j * experiment.omega
        self.sensors = experiment.instruments[:, :, None] * model.sensors.response(experiment.omega)
        self.dynamics = model.known_dynamics(experiment.omega)
        self._powers = np.stack([np.ones_like(experiment.omega), experiment.omega], axis=1)
        self.rows = model.row_factors()
        self.columns = model.column_factors()
        self._factors = self.rows[:, None] * self.columns
        self._inputs = np.ascontiguousarray(experiment.inputs.T)
        first = parameters.rows.size
        extras = list(enumerate(parameters.extras, start=first))
        self._modal = [(k, e) for k, e in extras if e.kind in ("omega", "zeta")]
        self._shapes = [(k, e) for k, e in extras if e.kind == "shape"]
        self._delays = [(k, e.output) for k, e in extras if e.kind == "delay"]
        self._scales = [(k, e.output) for k, e in extras if e.kind == "scale"]
        own = [(k, e) for k, e in extras if e.kind not in ("omega", "zeta")]
        self.own_outputs = np.array([e.output for _, e in own], dtype=int)
        self.pair_rows = np.array(
            [*parameters.rows.tolist(), *(2 + e.mode for _, e in self._modal)], dtype=int
        )
        added = self.columns.size + np.arange(len(self._modal))
        self.pair_columns = np.append(parameters.columns, added).astype(int)
        known = self._factors[parameters.rows, parameters.columns]
        self.scale = np.append(known, np.ones(len(self._modal)))
        self.order = np.array([*range(first), *(k for k, _ in self._modal), *(k for k, _ in own)])
        self._own = own
        # Reserved once: new memory takes as long to obtain as to fill.
        self._forces = np.empty(self.sensors.shape, dtype=complex)
        self._elimination = Elimination(*self.dynamics.shape[:2])

    def respond(self, theta: Float[np.ndarray, " n_theta"]) -> ModelResponse:
        """Compute the outputs at theta: one small inverse per frequency."""
        n_r = self.dynamics.shape[1]
        n = n_r - 2
        forces = self._factors * self.parameters.table(theta).values
        by_power = np.zeros((2, n_r, n_r, 2))  # of omega: 0 is real, 1 is imaginary
        by_power[0, :, :, 0] = forces[:, :n_r]
        by_power[1, :, 2:, 1] = forces[:, n_r : n_r + n]
        K = (self._powers @ by_power.reshape(2, -1)).view(complex).reshape(self.dynamics.shape)
        np.subtract(self.dynamics, K, out=K)
        if self._modal:
            self._tune_modes(theta, K)
        load = self.experiment.inputs @ forces[:, n_r + n :].T
        # The columns of the inverse are the motion under unit forces.
        unit_motion = self._elimination.inverse(K)
        motion = np.matmul(unit_motion, load[:, :, None])[:, :, 0]
        sensors = self._scale_shapes(theta) if self._shapes else self.sensors
        outputs = np.matmul(sensors, motion[:, :, None])[:, :, 0]
        delayed = self._compute_delay_factors(theta) if self._delays or self._scales else None
        if delayed is not None:
            outputs *= delayed
        return ModelResponse(motion, outputs, unit_motion, sensors, delayed)

    def sensitivity(
        self, theta: Float[np.ndarray, " n_theta"], response: ModelResponse
    ) -> Sensitivity:
        """Compute factored sensitivities of the outputs; the next call overwrites them."""
        forces = np.matmul(response.sensors, response.unit_motion, out=self._forces)
        if response.delayed is not None:
            forces *= response.delayed[:, :, None]
        motion = response.motion.T
        n_r, n_w = motion.shape[0], self.columns.size
        variables = np.empty((n_w + len(self._modal), self.s.size), dtype=complex)
        variables[:n_r] = motion
        np.multiply(self.s, motion[2:], out=variables[n_r : 2 * n_r - 2])
        variables[2 * n_r - 2 : n_w] = self._inputs
        for column, (k, extra) in enumerate(self._modal, start=n_w):
            change = self._differentiate_mode(theta, extra.kind, extra.mode, theta[k])
            variables[column] = -change * response.motion[:, 2 + extra.mode]
        return Sensitivity(forces, variables, self._compute_own_sensitivity(theta, response))

    def jacobian(self, sensitivity: Sensitivity) -> Complex[np.ndarray, "n_omega n_y n_theta"]:
        """Expand all sensitivities, where the Kronecker form is not applicable."""
        G, w = sensitivity.forces, sensitivity.variables.T
        n_pairs = self.pair_rows.size
        J = np.zeros((*G.shape[:2], self.order.size), dtype=complex)
        J[:, :, self.order[:n_pairs]] = (
            G[:, :, self.pair_rows] * (w[:, self.pair_columns] * self.scale)[:, None, :]
        )
        J[:, self.own_outputs, self.order[n_pairs:]] = sensitivity.own.T
        return J

    def _tune_modes(
        self,
        theta: Float[np.ndarray, " n_theta"],
        K: Complex[np.ndarray, "n_omega n_r n_r"],
    ) -> None:
        """Apply the frequency and damping factors of theta to the modes."""
        modes = self.experiment.model.modes
        frequency, damping = self._collect_modal_factors(theta)
        w, z = modes.omega * frequency, modes.zeta * damping
        modal = np.arange(2, 2 + modes.omega.size)
        K[:, modal, modal] += (
            2.0 * self.s[:, None] * (z * w - modes.zeta * modes.omega) + w**2 - modes.omega**2
        )

    def _collect_modal_factors(
        self, theta: Float[np.ndarray, " n_theta"]
    ) -> tuple[np.ndarray, np.ndarray]:
        n = self.experiment.model.modes.omega.size
        factors = {"omega": np.ones(n), "zeta": np.ones(n)}
        for k, extra in self._modal:
            factors[extra.kind][extra.mode] = theta[k]
        return factors["omega"], factors["zeta"]

    def _differentiate_mode(
        self, theta: Float[np.ndarray, " n_theta"], kind: str, mode: int, value: float
    ) -> Complex[np.ndarray, " n_omega"]:
        """Differentiate the mode's own dynamics by a factor on frequency or damping."""
        modes = self.experiment.model.modes
        frequency, damping = self._collect_modal_factors(theta)
        w, z = modes.omega[mode], modes.zeta[mode]
        if kind == "omega":
            return 2.0 * z * damping[mode] * w * self.s + 2.0 * value * w**2
        return 2.0 * z * w * frequency[mode] * self.s

    def _scale_shapes(
        self, theta: Float[np.ndarray, " n_theta"]
    ) -> Complex[np.ndarray, "n_omega n_y n_r"]:
        sensors = self.sensors.copy()
        for k, extra in self._shapes:
            sensors[:, extra.output, 2 + extra.mode] *= theta[k]
        return sensors

    def _compute_delay_factors(
        self, theta: Float[np.ndarray, " n_theta"]
    ) -> Complex[np.ndarray, "n_omega n_y"]:
        n_y = self.sensors.shape[1]
        delay, factor = np.zeros(n_y), np.ones(n_y)
        for k, output in self._delays:
            delay[output] += theta[k]
        for k, output in self._scales:
            factor[output] *= theta[k]
        phase = np.outer(self.experiment.omega, delay)
        # Cosine and sine take a tenth of the time of the complex exponential.
        return factor * (np.cos(phase) - 1j * np.sin(phase))

    def _compute_own_sensitivity(
        self, theta: Float[np.ndarray, " n_theta"], response: ModelResponse
    ) -> Complex[np.ndarray, "n_own n_omega"]:
        own = np.empty((len(self._own), self.s.size), dtype=complex)
        for row, (k, extra) in zip(own, self._own, strict=True):
            if extra.kind == "delay":
                np.multiply(-self.s, response.outputs[:, extra.output], out=row)
            elif extra.kind == "scale":
                np.divide(response.outputs[:, extra.output], theta[k], out=row)
            else:
                seen = response.sensors[:, extra.output, 2 + extra.mode] / theta[k]
                np.multiply(seen, response.motion[:, 2 + extra.mode], out=row)
                if response.delayed is not None:
                    row *= response.delayed[:, extra.output]
        return own
