"""Frequency-domain model: response and exact sensitivities at the frequencies of an experiment.

The derivatives enter force rows only, so the sensitivity of every output to
derivative (i, j) is G_i w_j: the output's response to a unit force in row i times
the variable j. A factor on a mode's frequency or damping acts like one more variable
of that mode's row; a delay, a scale factor or an error of a mode shape affects one output only.

With a frequency shape the variable j of row i is s_ij w_j: every row has variables of its own.
"""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Complex, Float

from flexsid.sysid.estimation.end_states import STATE, FreeMotion, compute_free_motion
from flexsid.sysid.estimation.experiment import SHAPE_ERRORS, Experiment, Parameters
from flexsid.sysid.estimation.linear_algebra import Elimination
from flexsid.sysid.estimation.noise import SpectralMatrix
from flexsid.sysid.estimation.nuisance import ShapeErrors

# --- Frequency-domain model: response and exact sensitivities at the frequencies of an experiment


@dataclass(frozen=True, slots=True)
class ModelResponse:
    """Response of the model at every frequency for one theta.

    ``sensors`` are the outputs per motion; ``delayed`` the factor of delays and scale factors
    on each output, None without them. ``motion`` is the response to the inputs; the outputs
    include the ``free`` motion from end states, None without them, as do the variables of the
    forces, by ``free_variables``, and errors of mode shapes, by ``free_accelerations`` of modes.
    """

    motion: Complex[np.ndarray, "n_omega n_r"]
    outputs: Complex[np.ndarray, "n_omega n_y"]
    unit_motion: Complex[np.ndarray, "n_omega n_r n_r"]
    sensors: Complex[np.ndarray, "n_omega n_y n_r"]
    delayed: Complex[np.ndarray, "n_omega n_y"] | None
    free: FreeMotion | None = None
    free_variables: Complex[np.ndarray, "n_omega n_x"] | None = None
    free_accelerations: Complex[np.ndarray, "n_omega n_modes"] | None = None


@dataclass(frozen=True, slots=True)
class Sensitivity:
    """Sensitivity in its factored form: forces G, variables w, and single outputs' own.

    ``ends`` are the outputs per end state, None without them; they are the last parameters.
    Frequency is the last axis where sums over it are products of contiguous rows.
    """

    forces: Complex[np.ndarray, "n_omega n_y n_r"]
    variables: Complex[np.ndarray, "n_w n_omega"]
    own: Complex[np.ndarray, "n_own n_omega"]
    ends: Complex[np.ndarray, "n_omega n_y n_ends"] | None = None


class FrequencyDomainModel:
    """Model of an experiment; everything independent of theta is computed once.

    Attributes
    ----------
    pair_rows, pair_columns
        Force row and variable of every parameter that acts as a force.
    factors
        Factors of the frequency shape on the derivatives, None for a quasi-steady model.
    own_outputs
        Output of every parameter that affects one output only.
    order
        Indices in theta of these two kinds and of the end states, one after the other.
    """

    def __init__(self, experiment: Experiment, parameters: Parameters) -> None:
        model = experiment.model
        self.experiment = experiment
        self.parameters = parameters
        self.s = 1j * experiment.omega
        self.sensors = experiment.instruments[:, :, None] * model.sensors.response(experiment.omega)
        self.n_rigid = model.n_rigid
        self.dynamics = model.known_dynamics(experiment.omega)
        self._powers = np.stack([np.ones_like(experiment.omega), experiment.omega], axis=1)
        self.rows = model.row_factors()
        self.columns = model.column_factors()
        self._factors = self.rows[:, None] * self.columns
        self.factors = model.derivative_factors(experiment.omega)
        self._inputs = np.ascontiguousarray(experiment.inputs.T)
        first = parameters.rows.size
        extras = list(enumerate(parameters.extras, start=first))
        self._modal = [(k, e) for k, e in extras if e.kind in ("omega", "zeta")]
        self._shapes = [(k, e) for k, e in extras if e.kind == "shape"]
        self._delays = [(k, e.output) for k, e in extras if e.kind == "delay"]
        self._scales = [(k, e.output) for k, e in extras if e.kind == "scale"]
        own = [(k, e) for k, e in extras if e.kind not in ("omega", "zeta", STATE)]
        self._ends = tuple((k, e) for k, e in extras if e.kind == STATE)
        self.own_outputs = np.array([e.output for _, e in own], dtype=int)
        self.pair_rows = np.array(
            [*parameters.rows.tolist(), *(self.n_rigid + e.mode for _, e in self._modal)], dtype=int
        )
        variable, n_variables = parameters.columns, self.columns.size
        if self.factors is not None:
            variable = parameters.rows * n_variables + variable
            n_variables *= self.rows.size
        added = n_variables + np.arange(len(self._modal))
        self.pair_columns = np.append(variable, added).astype(int)
        known = self._factors[parameters.rows, parameters.columns]
        self.scale = np.append(known, np.ones(len(self._modal)))
        ordered = [*self._modal, *own, *self._ends]
        self.order = np.array([*range(first), *(k for k, _ in ordered)])
        self._own = own
        errors = [(row, k, e) for row, (k, e) in enumerate(own) if e.kind in SHAPE_ERRORS]
        self._shape_errors = ShapeErrors(experiment, errors) if errors else None
        # Reserved once: new memory takes as long to obtain as to fill.
        self._forces = np.empty(self.sensors.shape, dtype=complex)
        self._elimination = Elimination(*self.dynamics.shape[:2])

    def respond(self, theta: Float[np.ndarray, " n_theta"]) -> ModelResponse:
        """Compute the outputs at theta: one small inverse per frequency."""
        n_r = self.dynamics.shape[1]
        n = n_r - self.n_rigid
        forces = self._factors * self.parameters.table(theta).values
        if self.factors is None:
            by_power = np.zeros((2, n_r, n_r, 2))  # of omega: 0 is real, 1 is imaginary
            by_power[0, :, :, 0] = forces[:, :n_r]
            by_power[1, :, self.n_rigid :, 1] = forces[:, n_r : n_r + n]
            K = (self._powers @ by_power.reshape(2, -1)).view(complex).reshape(self.dynamics.shape)
            load = self.experiment.inputs @ forces[:, n_r + n :].T
        else:
            shaped = forces * self.factors
            K = shaped[:, :, :n_r].copy()
            K[:, :, self.n_rigid :] += self.s[:, None, None] * shaped[:, :, n_r : n_r + n]
            load = np.matmul(shaped[:, :, n_r + n :], self.experiment.inputs[:, :, None])[:, :, 0]
        np.subtract(self.dynamics, K, out=K)
        if self._modal:
            self._tune_modes(theta, K)
        # The columns of the inverse are the motion under unit forces.
        unit_motion = self._elimination.inverse(K)
        motion = np.matmul(unit_motion, load[:, :, None])[:, :, 0]
        sensors = self._change_shapes(theta)
        outputs = np.matmul(sensors, motion[:, :, None])[:, :, 0]
        free = free_variables = free_accelerations = None
        if self._ends:
            free = self._compute_free_motion(theta, unit_motion, np.matmul(sensors, unit_motion))
            ends = theta[[k for k, _ in self._ends]]
            moved, free_variables, free_accelerations = free.sum(ends)
            outputs += moved
        delayed = self._compute_delay_factors(theta) if self._delays or self._scales else None
        if delayed is not None:
            outputs *= delayed
        of_ends = free, free_variables, free_accelerations
        return ModelResponse(motion, outputs, unit_motion, sensors, delayed, *of_ends)

    def respond_to_inputs(
        self, theta: Float[np.ndarray, " n_theta"], response: ModelResponse
    ) -> Complex[np.ndarray, "n_omega n_y n_u"]:
        """Compute the outputs per unit of each input, from the response at theta."""
        n_u = self.experiment.inputs.shape[1]
        load = self._factors[:, -n_u:] * self.parameters.table(theta).values[:, -n_u:]
        if self.factors is not None:
            load = load * self.factors[:, :, -n_u:]
        outputs = response.sensors @ (response.unit_motion @ load)
        return outputs if response.delayed is None else outputs * response.delayed[:, :, None]

    def with_inputs(self, inputs: Complex[np.ndarray, "n_omega n_u"]) -> FrequencyDomainModel:
        """Return the model with other inputs; it shares the memory of its sensitivities."""
        other = copy(self)
        other.experiment = replace(self.experiment, inputs=inputs)
        other._inputs = np.ascontiguousarray(inputs.T)
        return other

    def _compute_free_motion(
        self, theta: Float[np.ndarray, " n_theta"], unit_motion: np.ndarray, outputs: np.ndarray
    ) -> FreeMotion:
        """Compute the free motion per end state, as the instruments record it."""
        one = self.experiment
        extras = [extra for _, extra in self._ends]
        table = self.parameters.table(theta)
        unit = (unit_motion, outputs, one.instruments)
        edges_s = dict(enumerate(one.edges_s, start=one.first_end))
        model = one.model
        if self._shape_errors is not None:
            model = self._shape_errors.apply(theta, model)
        return compute_free_motion(model, table, one.omega, edges_s, extras, *unit)

    def sensitivity(
        self, theta: Float[np.ndarray, " n_theta"], response: ModelResponse
    ) -> Sensitivity:
        """Compute factored sensitivities of the outputs; the next call overwrites them."""
        free = response.free
        ends = None if free is None else free.expand_outputs()
        if free is not None:
            forces = free.unit_outputs
        else:
            forces = np.matmul(response.sensors, response.unit_motion, out=self._forces)
        if response.delayed is not None:
            forces = np.multiply(forces, response.delayed[:, :, None], out=self._forces)
            ends = None if ends is None else ends * response.delayed[:, :, None]
        motion = response.motion.T
        n_r, n_w = motion.shape[0], self.columns.size
        n_x = 2 * n_r - self.n_rigid
        first_modal = n_w if self.factors is None else n_r * n_w
        variables = np.empty((first_modal + len(self._modal), self.s.size), dtype=complex)
        variables[:n_r] = motion
        np.multiply(self.s, motion[self.n_rigid :], out=variables[n_r:n_x])
        variables[n_x:n_w] = self._inputs
        if response.free_variables is not None:
            # The forces of a part of a record are those of its own motion, the free one included.
            variables[:n_x] += response.free_variables.T
        if self.factors is not None:
            of_rows = variables[:first_modal].reshape(n_r, n_w, -1)
            np.multiply(self.factors.transpose(1, 2, 0), variables[:n_w].copy(), out=of_rows)
        for column, (k, extra) in enumerate(self._modal, start=first_modal):
            change = self._differentiate_mode(theta, extra.kind, extra.mode, theta[k])
            variables[column] = -change * response.motion[:, self.n_rigid + extra.mode]
        own = self._compute_own_sensitivity(theta, response)
        return Sensitivity(forces, variables, own, ends)

    def jacobian(self, sensitivity: Sensitivity) -> Complex[np.ndarray, "n_omega n_y n_theta"]:
        """Expand all sensitivities, where the Kronecker form is not applicable."""
        return expand_sensitivity(self, sensitivity)

    def list_own_parameters(self) -> np.ndarray:
        """Return the index in theta of every parameter of ``own_outputs``."""
        first = self.pair_rows.size
        return self.order[first : first + self.own_outputs.size]

    def _tune_modes(
        self,
        theta: Float[np.ndarray, " n_theta"],
        K: Complex[np.ndarray, "n_omega n_r n_r"],
    ) -> None:
        """Apply the frequency and damping factors of theta to the modes."""
        modes = self.experiment.model.modes
        frequency, damping = self._collect_modal_factors(theta)
        w, z = modes.omega * frequency, modes.zeta * damping
        modal = self.n_rigid + np.arange(modes.omega.size)
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

    def _change_shapes(
        self, theta: Float[np.ndarray, " n_theta"]
    ) -> Complex[np.ndarray, "n_omega n_y n_r"]:
        """Return the outputs per motion with the factors and errors of mode shapes."""
        if not self._shapes and self._shape_errors is None:
            return self.sensors
        sensors = self.sensors.copy()
        for k, extra in self._shapes:
            sensors[:, extra.output, self.n_rigid + extra.mode] *= theta[k]
        if self._shape_errors is not None:
            self._shape_errors.add(theta, sensors)
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
            elif extra.kind == "shape":
                mode = self.n_rigid + extra.mode
                seen = response.sensors[:, extra.output, mode] / theta[k]
                np.multiply(seen, response.motion[:, mode], out=row)
                if response.delayed is not None:
                    row *= response.delayed[:, extra.output]
        if self._shape_errors is not None:
            motion = response.motion[:, self.n_rigid :]
            levels = [motion, self.s[:, None] * motion, (self.s**2)[:, None] * motion]
            if response.free_variables is not None and response.free_accelerations is not None:
                n_r, n = response.motion.shape[1], motion.shape[1]
                free = response.free_variables
                levels[0] = levels[0] + free[:, n_r - n : n_r]
                levels[1] += free[:, n_r:]
                levels[2] += response.free_accelerations
            self._shape_errors.differentiate(levels, response.delayed, own)
        return own


@dataclass(frozen=True, slots=True)
class FactoredModel:
    """Places of the columns of a factored sensitivity, as ``FrequencyDomainModel`` has them.

    ``rows`` and ``columns`` have one entry for each force and variable, ``sensors`` is of the
    shape of the forces.
    """

    rows: np.ndarray
    columns: np.ndarray
    pair_rows: np.ndarray
    pair_columns: np.ndarray
    scale: np.ndarray
    own_outputs: np.ndarray
    order: np.ndarray
    sensors: np.ndarray
    s: np.ndarray


def expand_sensitivity(
    model: FrequencyDomainModel | FactoredModel, sensitivity: Sensitivity
) -> Complex[np.ndarray, "n_omega n_y n_theta"]:
    """Expand all sensitivities of a factored form."""
    G, w = sensitivity.forces, sensitivity.variables.T
    n_pairs = model.pair_rows.size
    pairs = G[:, :, model.pair_rows]
    pairs *= (w[:, model.pair_columns] * model.scale)[:, None, :]
    if n_pairs == model.order.size and (model.order[1:] > model.order[:-1]).all():
        return pairs
    J = np.zeros((*G.shape[:2], model.order.size), dtype=complex)
    J[:, :, model.order[:n_pairs]] = pairs
    n_single = n_pairs + model.own_outputs.size
    J[:, model.own_outputs, model.order[n_pairs:n_single]] = sensitivity.own.T
    if sensitivity.ends is not None:
        J[:, :, model.order[n_single:]] = sensitivity.ends
    return J


def expand_kept(
    model: FrequencyDomainModel, sensitivity: Sensitivity, kept: np.ndarray
) -> Complex[np.ndarray, "n_omega n_y n_kept"]:
    """Expand the sensitivities to all parameters but some that affect one output only."""
    of_own = np.isin(model.list_own_parameters(), kept)
    factored = FactoredModel(
        rows=model.rows,
        columns=model.columns,
        pair_rows=model.pair_rows,
        pair_columns=model.pair_columns,
        scale=model.scale,
        own_outputs=model.own_outputs[of_own],
        order=np.searchsorted(kept, model.order[np.isin(model.order, kept)]),
        sensors=model.sensors,
        s=model.s,
    )
    return expand_sensitivity(factored, replace(sensitivity, own=sensitivity.own[of_own]))


# --- Motion estimated from the sensors during a fit, independent of the modelled forces -----------

_PRIOR_POWER = 10.0  # prior variance of the motion's error over the power of its model


def estimate_measured_motion(
    response: ModelResponse,
    residuals: Complex[np.ndarray, "n_omega n_y"],
    weights: SpectralMatrix,
) -> Complex[np.ndarray, "n_omega n_r"]:
    """Estimate the motion by regularised least squares about that of the model.

    Parameters
    ----------
    response
        Of the model.
    residuals
        Measured less modelled outputs.
    weights
        Inverse noise covariance at each frequency.
    """
    P = response.sensors
    if response.delayed is not None:
        P = P * response.delayed[:, :, None]
    left = weights.times(P).conj().transpose(0, 2, 1)
    normal = left @ P
    size = np.sqrt(np.maximum(np.real(np.einsum("kii->ki", normal)), 1e-300))
    normal /= size[:, :, None] * size[:, None, :]
    likely = _PRIOR_POWER * np.mean(np.abs(response.motion) ** 2, axis=0) * size**2
    steps = np.arange(normal.shape[1])
    normal[:, steps, steps] += 1.0 / np.maximum(likely, np.finfo(float).tiny)
    gradient = (left @ residuals[:, :, None]) / size[:, :, None]
    return response.motion + np.linalg.solve(normal, gradient)[:, :, 0] / size
