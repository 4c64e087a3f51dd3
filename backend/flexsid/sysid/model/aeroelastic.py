"""AeroelasticModel: equations of motion of one condition for any derivatives (Eqs 5-16)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Complex, Float

from flexsid.errors import BadInput
from flexsid.sysid.model.condition import GRAVITY, FlightCondition
from flexsid.sysid.model.derivatives import DerivativeTable, variables
from flexsid.sysid.model.sensors import ACCELERATION, INTEGRAL, POSITION, RATE, SensorRows
from flexsid.sysid.modes.shapes import StructuralModes

if TYPE_CHECKING:
    import control


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

    @classmethod
    def from_control(cls, system: control.StateSpace) -> StateSpace:
        """Convert a continuous system of python-control with its names.

        Raises
        ------
        BadInput
            If the system is sampled.
        """
        if system.isdtime(strict=True):
            raise BadInput(
                f"the system is sampled every {system.dt} s; give a continuous one",
                code="sampled-system",
            )
        return cls(
            A=np.asarray(system.A, dtype=float),
            B=np.asarray(system.B, dtype=float),
            C=np.asarray(system.C, dtype=float),
            D=np.asarray(system.D, dtype=float),
            states=tuple(system.state_labels),
            inputs=tuple(system.input_labels),
            outputs=tuple(system.output_labels),
        )

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

    The motion is r = [alpha, q, eta_1..n]; theta = q/s and etadot = s eta are
    eliminated, so that K(s) r = F u has only 2 + n rows.
    """

    condition: FlightCondition
    modes: StructuralModes
    inputs: tuple[str, ...]
    sensors: SensorRows

    @property
    def outputs(self) -> tuple[str, ...]:
        """Names of the outputs."""
        return self.sensors.names

    def with_modes(self, count: int) -> AeroelasticModel:
        """Return the same model with its first modes only."""
        rows = SensorRows(self.sensors.names, self.sensors.polynomial[:, :, : 2 + count])
        modes = self.modes.select(self.modes.numbers[:count])
        return AeroelasticModel(self.condition, modes, self.inputs, rows)

    def row_factors(self) -> Float[np.ndarray, " n_rows"]:
        """Compute the dimensional factors of the coefficient rows (Eq. 12)."""
        return self.condition.row_factors(self.modes.mass)

    def column_factors(self) -> Float[np.ndarray, " n_w"]:
        """Compute the dimensional factors of the variables (Eq. 12)."""
        return self.condition.column_factors(len(self.modes.numbers), len(self.inputs))

    def known_dynamics(
        self, omega: Float[np.ndarray, " n_omega"]
    ) -> Complex[np.ndarray, "n_omega n_r n_r"]:
        """Compute K(s) without aerodynamics: kinematics, thrust, gravity and structure."""
        s = 1j * np.asarray(omega, dtype=float)
        n = len(self.modes.numbers)
        K = np.zeros((s.size, 2 + n, 2 + n), dtype=complex)
        angle, attitude = self._kinematic_terms()
        K[:, 0, 0] = s - angle
        K[:, 0, 1] = -1.0 - attitude / s
        K[:, 1, 1] = s
        modal = np.arange(2, 2 + n)
        w, z = self.modes.omega, self.modes.zeta
        K[:, modal, modal] = s[:, None] ** 2 + 2.0 * z * w * s[:, None] + w**2
        return K

    def response(
        self, derivatives: DerivativeTable, omega: Float[np.ndarray, " n_omega"]
    ) -> Complex[np.ndarray, "n_omega n_y n_u"]:
        """Compute the frequency responses of all outputs to all inputs (Eq. 6), no instruments.

        Parameters
        ----------
        derivatives
            Of exactly this model's modes and inputs.
        omega
            Angular frequencies above zero. [rad/s]

        Raises
        ------
        BadInput
            If an undamped pole is at a frequency.
        """
        return self.sensors.response(omega) @ self.motion(derivatives, omega)

    def motion(
        self, derivatives: DerivativeTable, omega: Float[np.ndarray, " n_omega"]
    ) -> Complex[np.ndarray, "n_omega n_r n_u"]:
        """Compute the frequency responses of the motion [alpha, q, eta_1..n] to all inputs."""
        n_r = 2 + len(self.modes.numbers)
        forces = self.row_factors()[:, None] * derivatives.values * self.column_factors()
        s = 1j * np.asarray(omega, dtype=float)
        K = self.known_dynamics(omega) - forces[:, :n_r]
        K[:, :, 2:] -= s[:, None, None] * forces[:, n_r : 2 * n_r - 2]
        load = np.broadcast_to(forces[:, 2 * n_r - 2 :], (s.size, n_r, len(self.inputs)))
        try:
            return np.linalg.solve(K, load)
        except np.linalg.LinAlgError:
            raise BadInput(
                "the model has an undamped pole exactly at one of the frequencies, where its "
                "response is unbounded; change the frequency or the damping",
                code="pole-on-line",
            ) from None

    def state_space(self, derivatives: DerivativeTable) -> StateSpace:
        """Assemble A, B, C, D for these derivatives; instruments are not included.

        Parameters
        ----------
        derivatives
            Of exactly this model's modes and inputs.
        """
        n, n_u = len(self.modes.numbers), len(self.inputs)
        angle, attitude = self._kinematic_terms()
        forces = self.row_factors()[:, None] * derivatives.values * self.column_factors()
        force_rows, state_columns = self._force_indices()
        A = np.zeros((3 + 2 * n, 3 + 2 * n))
        B = np.zeros((3 + 2 * n, n_u))
        A[np.ix_(force_rows, state_columns)] = forces[:, : 2 + 2 * n]
        B[force_rows] = forces[:, 2 + 2 * n :]
        A[0, 0] += angle
        A[0, 1] += 1.0
        A[0, 2] += attitude
        A[2, 1] = 1.0
        eta, etadot = np.arange(3, 3 + n), np.arange(3 + n, 3 + 2 * n)
        A[eta, etadot] = 1.0
        A[etadot, eta] -= self.modes.omega**2
        A[etadot, etadot] -= 2.0 * self.modes.zeta * self.modes.omega
        C, D = self._outputs(A, B)
        states = ("alpha", "q", "theta", *variables(self.modes.numbers, ())[2:])
        return StateSpace(A, B, C, D, states, self.inputs, self.outputs)

    def read_derivatives(self, system: StateSpace) -> DerivativeTable:
        """Compute the nondimensional derivatives of a state-space model in these states.

        The inverse of ``state_space``: known kinematics and structure are subtracted,
        then the factors of Eq. 12 are removed.

        Parameters
        ----------
        system
            With this model's states and inputs by name, in any order.

        Raises
        ------
        BadInput
            If a state or input is missing or not of this model.
        """
        n, n_u = len(self.modes.numbers), len(self.inputs)
        states = ("alpha", "q", "theta", *variables(self.modes.numbers, ())[2:])
        x = _index_names(states, system.states, "states")
        A = system.A[np.ix_(x, x)]
        B = system.B[np.ix_(x, _index_names(self.inputs, system.inputs, "inputs"))]
        empty = DerivativeTable(self.modes.numbers, self.inputs, np.zeros((2 + n, 2 + 2 * n + n_u)))
        known = self.state_space(empty).A
        force_rows, state_columns = self._force_indices()
        forces = np.concatenate(
            [(A - known)[np.ix_(force_rows, state_columns)], B[force_rows]], axis=1
        )
        values = forces / self.row_factors()[:, None] / self.column_factors()
        return DerivativeTable(self.modes.numbers, self.inputs, values)

    def _force_indices(self) -> tuple[np.ndarray, np.ndarray]:
        """Return rows of x-dot with forces and columns of x that cause them (not theta)."""
        n = len(self.modes.numbers)
        return np.r_[0, 1, 3 + n : 3 + 2 * n], np.r_[0, 1, 3 : 3 + 2 * n]

    def _kinematic_terms(self) -> tuple[float, float]:
        """Compute the known terms of alpha-dot in alpha and theta (second matrix of Eq. 14a)."""
        c = self.condition
        gravity = GRAVITY * np.sin(c.gamma) / c.airspeed
        return float(gravity - c.thrust * np.cos(c.alpha) / (c.mass * c.airspeed)), -float(gravity)

    def _outputs(
        self, A: Float[np.ndarray, "n_x n_x"], B: Float[np.ndarray, "n_x n_u"]
    ) -> tuple[Float[np.ndarray, "n_y n_x"], Float[np.ndarray, "n_y n_u"]]:
        n = len(self.modes.numbers)
        P = self.sensors.polynomial
        motion = np.r_[0, 1, 3 : 3 + n]
        etadot = np.arange(3 + n, 3 + 2 * n)
        C = np.zeros((P.shape[1], A.shape[0]))
        C[:, motion] = P[POSITION]
        C[:, 2] = P[INTEGRAL, :, 1]
        C[:, etadot] += P[RATE, :, 2:]
        rates = np.r_[0, 1, etadot]  # alpha-dot, q-dot and eta-double-dot come from A and B
        weights = np.concatenate([P[RATE, :, :2], P[ACCELERATION, :, 2:]], axis=1)
        return C + weights @ A[rates], weights @ B[rates]


def _index_names(expected: tuple[str, ...], given: tuple[str, ...], what: str) -> list[int]:
    if sorted(expected) != sorted(given):
        raise BadInput(
            f"the system has {what} {', '.join(given)}; expected are {', '.join(expected)}",
            code="other-system",
        )
    return [given.index(name) for name in expected]
