"""AeroelasticModel: equations of motion of one condition for any derivatives (Eqs 5-16)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Complex, Float

from flexsid.errors import BadInput
from flexsid.sysid.model.condition import FlightCondition
from flexsid.sysid.model.derivatives import (
    DerivativeTable,
    coefficients,
    list_derivative_names,
    variables,
)
from flexsid.sysid.model.frequency_shape import FrequencyShape, build_lagged_forces
from flexsid.sysid.model.longitudinal import LONGITUDINAL
from flexsid.sysid.model.rigid_body import (
    ACCELERATION,
    INTEGRAL,
    POSITION,
    RATE,
    Kinematics,
    RigidBody,
    SensorRows,
)
from flexsid.sysid.modes.shapes import StructuralModes

if TYPE_CHECKING:
    import control

_LARGEST_CONDITION = 1e6  # of eigenvectors: relative errors of a response remain below 1e-9


@dataclass(frozen=True, slots=True)
class StateSpace:
    """A, B, C, D with the names of states, inputs and outputs (Eq. 5)."""

    A: Float[np.ndarray, "n_x n_x"]
    B: Float[np.ndarray, "n_x n_u"]
    C: Float[np.ndarray, "n_y n_x"]
    D: Float[np.ndarray, "n_y n_u"]
    states: tuple[str, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]

    def to_control(self) -> control.StateSpace:
        """Convert to a system of python-control."""
        import control  # also imports matplotlib, which takes seconds

        return control.StateSpace(
            self.A,
            self.B,
            self.C,
            self.D,
            states=list(self.states),
            inputs=list(self.inputs),
            outputs=list(self.outputs),
        )


@dataclass(frozen=True, slots=True)
class AeroelasticModel:
    """Condition, structural modes, inputs and sensors; derivatives are arguments.

    The motion is r = [rigid-body motions, eta_1..n]; the attitude and etadot = s eta are
    eliminated, so that K(s) r = F u has a row for each of them only. Without a ``shape`` the
    air forces are quasi-steady.

    Notes
    -----
    Source: Eqs 5-17; Waszak and Schmidt, J. Aircraft 25 (1988) 563-571, doi:10.2514/3.45623.
    """

    condition: FlightCondition
    modes: StructuralModes
    inputs: tuple[str, ...]
    sensors: SensorRows
    body: RigidBody = LONGITUDINAL
    shape: FrequencyShape | None = None

    def __post_init__(self) -> None:
        """Refuse a frequency shape of other derivatives.

        Raises
        ------
        BadInput
            If its axis, modes or inputs are not those of the model.
        """
        if self.shape is None:
            return
        own = (self.body.axis, self.modes.numbers, self.inputs)
        if (self.shape.body.axis, self.shape.modes, self.shape.inputs) != own:
            raise BadInput(
                f"the frequency shape is of the {self.shape.body.axis} axis, modes "
                f"{self.shape.modes} and inputs {self.shape.inputs}, the model of the {own[0]} "
                f"axis, modes {own[1]} and inputs {own[2]}; build the shape for those",
                code="shape-of-other-model",
            )

    @property
    def n_rigid(self) -> int:
        """Number of rigid-body motions, which come first."""
        return self.body.size

    @property
    def motions(self) -> tuple[str, ...]:
        """Names of the motions."""
        return self.body.name_motions(self.modes.numbers)

    @property
    def coefficients(self) -> tuple[str, ...]:
        """Names of the rows of the derivatives."""
        return coefficients(self.modes.numbers, self.body)

    @property
    def variables(self) -> tuple[str, ...]:
        """Names of the columns of the derivatives."""
        return variables(self.modes.numbers, self.inputs, self.body)

    @property
    def derivative_names(self) -> tuple[str, ...]:
        """Names of all derivatives, row by row."""
        return list_derivative_names(self.modes.numbers, self.inputs, self.body)

    @property
    def outputs(self) -> tuple[str, ...]:
        """Names of the outputs."""
        return self.sensors.names

    def with_modes(self, count: int) -> AeroelasticModel:
        """Return the same model with its first modes only."""
        end = self.n_rigid + count
        rows = SensorRows(self.sensors.names, self.sensors.polynomial[:, :, :end])
        modes = self.modes.select(self.modes.numbers[:count])
        shape = None if self.shape is None else self.shape.select(modes.numbers, self.inputs)
        return replace(self, modes=modes, sensors=rows, shape=shape)

    def fill_table(self, values: Mapping[str, float]) -> DerivativeTable:
        """Fill a table of this model's derivatives from values by name; others are zero."""
        return DerivativeTable.from_names(self.modes.numbers, self.inputs, values, self.body)

    def row_factors(self) -> Float[np.ndarray, " n_rows"]:
        """Compute the dimensional factors of the coefficient rows (Eq. 12)."""
        return self.body.row_factors(self.condition, self.modes.mass)

    def column_factors(self) -> Float[np.ndarray, " n_w"]:
        """Compute the dimensional factors of the variables (Eq. 12)."""
        n = len(self.modes.numbers)
        return self.body.column_factors(self.condition, n, len(self.inputs))

    def derivative_factors(
        self, omega: Float[np.ndarray, " n_omega"]
    ) -> Complex[np.ndarray, "n_omega n_rows n_w"] | None:
        """Compute the factors on the derivatives by frequency; None where all are one.

        Raises
        ------
        BadInput
            If a frequency is beyond the frequency shape.
        """
        if self.shape is None:
            return None
        return self.shape.at(np.asarray(omega, dtype=float) * self.condition.rate_factor)

    def known_dynamics(
        self, omega: Float[np.ndarray, " n_omega"]
    ) -> Complex[np.ndarray, "n_omega n_r n_r"]:
        """Compute K(s) without aerodynamics: kinematics, thrust, gravity and structure."""
        s = 1j * np.asarray(omega, dtype=float)
        first, n_r = self.n_rigid, len(self.motions)
        known = self._compute_kinematics()
        K = np.zeros((s.size, n_r, n_r), dtype=complex)
        rigid = s[:, None, None] * known.inertia - known.coupling
        rigid -= np.outer(known.gravity, known.attitude_rate) / s[:, None, None]
        K[:, :first, :first] = rigid
        modal = np.arange(first, n_r)
        w, z = self.modes.omega, self.modes.zeta
        K[:, modal, modal] = s[:, None] ** 2 + 2.0 * z * w * s[:, None] + w**2
        return K

    def response(
        self, derivatives: DerivativeTable, omega: Float[np.ndarray, " n_omega"]
    ) -> Complex[np.ndarray, "n_omega n_y n_u"]:
        """Compute the frequency responses of all outputs to all inputs (Eq. 6), no instruments.

        The derivatives are of exactly this model's modes and inputs, the frequencies above zero.
        [rad/s]

        Raises
        ------
        BadInput
            If an undamped pole is at a frequency.
        """
        return self.sensors.response(omega) @ self.motion(derivatives, omega)

    def motion(
        self, derivatives: DerivativeTable, omega: Float[np.ndarray, " n_omega"]
    ) -> Complex[np.ndarray, "n_omega n_r n_u"]:
        """Compute the frequency responses of the motion to all inputs.

        Beyond the highest k of a frequency shape its factors are held: only simulations reach
        there, with what is left of the inputs.
        """
        return _solve(*self._build_equations(derivatives, omega))

    def respond(
        self,
        derivatives: DerivativeTable,
        omega: Float[np.ndarray, " n_omega"],
        inputs: Complex[np.ndarray, "n_omega n_u"],
    ) -> Complex[np.ndarray, "n_omega n_y"]:
        """Compute the outputs for inputs by frequency, as ``response`` times these.

        By partial fractions, a tenth of the work, for a quasi-steady model whose eigenvectors are
        apart; else one equation is solved at each frequency in place of one for each input.
        """
        if self.shape is None:
            found = _sum_partial_fractions(self.state_space(derivatives), omega, inputs)
            if found is not None:
                return found
        dynamics, load = self._build_equations(derivatives, omega)
        motion = _solve(dynamics, load @ inputs[:, :, None])
        return (self.sensors.response(omega) @ motion)[:, :, 0]

    def _build_equations(
        self, derivatives: DerivativeTable, omega: Float[np.ndarray, " n_omega"]
    ) -> tuple[Complex[np.ndarray, "n_omega n_r n_r"], np.ndarray]:
        """Compute the matrix on the motion, and the load of each input, (n_omega, n_r, n_u)."""
        n_r, n_w = len(self.motions), len(self.variables) - len(self.inputs)
        forces = self.row_factors()[:, None] * derivatives.values * self.column_factors()
        if self.shape is not None:
            k = np.asarray(omega, dtype=float) * self.condition.rate_factor
            forces = forces * self.shape.at(np.minimum(k, self.shape.k[-1]))
        s = 1j * np.asarray(omega, dtype=float)
        K = self.known_dynamics(omega) - forces[..., :n_r]
        K[:, :, self.n_rigid :] -= s[:, None, None] * forces[..., n_r:n_w]
        return K, np.broadcast_to(forces[..., n_w:], (s.size, n_r, len(self.inputs)))

    def state_space(self, derivatives: DerivativeTable) -> StateSpace:
        """Assemble A, B, C, D for derivatives of exactly this model's modes and inputs.

        Instruments are not included. With a frequency shape, lag states follow those of the
        motion.
        """
        n, first = len(self.modes.numbers), self.n_rigid
        known = self._compute_kinematics()
        forced = self.force_matrix()
        state_columns = self.variable_states()
        n_x = forced.shape[0]
        if self.shape is None:
            forces = self.row_factors()[:, None] * derivatives.values * self.column_factors()
            A = np.zeros((n_x, n_x))
            A[:, state_columns] = forced @ forces[:, : state_columns.size]
            B = forced @ forces[:, state_columns.size :]
            names = self.variables[: state_columns.size]
            states = (*names[:first], self.body.attitude, *names[first:])
        else:
            lagged = build_lagged_forces(self.shape, self.condition)
            states = lagged.states
            loads = np.einsum("rw,rwz->rz", derivatives.values, lagged.loads)
            forces = forced @ (self.row_factors()[:, None] * loads)
            A, B = np.hsplit(np.vstack([forces, lagged.lag_rates]), [len(states)])
        inverse = np.linalg.inv(known.inertia)
        A[:first, :first] += inverse @ known.coupling
        A[:first, first] += inverse @ known.gravity
        A[first, :first] = known.attitude_rate
        eta, etadot = np.arange(first + 1, first + 1 + n), np.arange(first + 1 + n, n_x)
        A[eta, etadot] = 1.0
        A[etadot, eta] -= self.modes.omega**2
        A[etadot, etadot] -= 2.0 * self.modes.zeta * self.modes.omega
        C, D = self.output_matrices(A, B)
        return StateSpace(A, B, C, D, states, self.inputs, self.outputs)

    def variable_states(self) -> np.ndarray:
        """Return the states that cause forces, in the order of the variables (no attitude)."""
        n, first = len(self.modes.numbers), self.n_rigid
        return np.r_[:first, first + 1 : first + 1 + 2 * n]

    def force_matrix(self) -> Float[np.ndarray, "n_x n_rows"]:
        """Compute the effect of every dimensional force on the rates of the states.

        The inverse of the inertia couples the moments; each mode has its own row.
        """
        n, first = len(self.modes.numbers), self.n_rigid
        forced = np.zeros((first + 1 + 2 * n, first + n))
        forced[:first, :first] = np.linalg.inv(self._compute_kinematics().inertia)
        forced[first + 1 + n :, first:] = np.eye(n)
        return forced

    def _compute_kinematics(self) -> Kinematics:
        return self.body.kinematics(self.condition, self.condition.trim)

    def output_matrices(
        self, A: Float[np.ndarray, "n_x n_x"], B: Float[np.ndarray, "n_x n_u"]
    ) -> tuple[Float[np.ndarray, "n_y n_x"], Float[np.ndarray, "n_y n_u"]]:
        """Compute C and D of dynamics whose first states are those of ``state_space``."""
        n, first = len(self.modes.numbers), self.n_rigid
        P = self.sensors.polynomial
        eta = np.arange(first + 1, first + 1 + n)
        C = np.zeros((P.shape[1], A.shape[0]))
        C[:, np.r_[:first, eta]] = P[POSITION]
        C[:, first] = P[INTEGRAL, :, 1]  # the attitude integrates the second motion, and others
        C[:, eta + n] += P[RATE, :, first:]
        rates = np.r_[:first, eta + n]  # of the rigid body and of etadot: they come from A and B
        weights = np.concatenate([P[RATE, :, :first], P[ACCELERATION, :, first:]], axis=1)
        return C + weights @ A[rates], weights @ B[rates]


def _sum_partial_fractions(
    system: StateSpace, omega: np.ndarray, inputs: np.ndarray
) -> np.ndarray | None:
    """Compute C (s - A)^-1 B u + D u; None where the eigenvectors of A lose accuracy."""
    poles, vectors = np.linalg.eig(system.A)
    if np.linalg.cond(vectors) > _LARGEST_CONDITION:
        return None
    with np.errstate(divide="ignore", invalid="ignore"):
        states = inputs @ np.linalg.solve(vectors, system.B).T / (1j * omega[:, None] - poles)
        outputs = states @ (system.C @ vectors).T + inputs @ system.D.T
    return outputs if np.isfinite(outputs).all() else None


def _solve(dynamics: np.ndarray, load: np.ndarray) -> np.ndarray:
    try:
        return np.linalg.solve(dynamics, load)
    except np.linalg.LinAlgError:
        raise BadInput(
            "the model has an undamped pole exactly at one of the frequencies, where its "
            "response is unbounded; change the frequency or the damping",
            code="pole-at-frequency",
        ) from None
