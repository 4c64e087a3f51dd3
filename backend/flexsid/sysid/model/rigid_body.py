"""Rigid body in one axis: motions, coefficients, known terms, and equations of its sensors.

Everything in which the models of the axes differ is one value of this class,
``longitudinal.LONGITUDINAL``, ``airspeed.AIRSPEED`` or ``lateral.LATERAL``; names of
derivatives, estimators, reduction, poles and flutter ask it. The rows of sensors are those of
``sensor_models``.

With the motion r of rigid body and modes every output is a known combination
y = (P_-1 / s + P_0 + P_1 s + P_2 s^2) r: theta = q/s, etadot = s eta, and
forces are expressed by the accelerations. No derivative enters P, so that one
model serves all three estimators without C and D of its own.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from jaxtyping import Complex, Float

from flexsid.errors import BadInput
from flexsid.sysid.model.condition import FlightCondition, Trim

# --- RigidBody: motions, coefficients and known terms of the rigid body in one axis ---------------

SPIRAL = "spiral"
"""Name of the slow real pole of bank angle: unstable in many aircraft, and no divergence."""

PHUGOID = "PH"
"""Name of the slow pole of airspeed and pitch angle: unstable in some aircraft, and no flutter."""


@dataclass(frozen=True, slots=True)
class Kinematics:
    """Known terms of E r-dot = forces + N r + g attitude, and attitude-dot = a r.

    Leading dimensions are those of the trim. The first force is divided by mV.
    """

    inertia: Float[np.ndarray, "n_rigid n_rigid"]
    coupling: Float[np.ndarray, "*n_v n_rigid n_rigid"]
    gravity: Float[np.ndarray, "*n_v n_rigid"]
    attitude_rate: Float[np.ndarray, "*n_v n_rigid"]


@dataclass(frozen=True, slots=True)
class FreeFlight:
    """The rigid body in coordinates of second order, such as heave and pitch.

    The motions, as ``scale_motions`` makes them nondimensional, are (position + rate d/dt / V) q;
    M q'' + D q' + K q = qbar force C with the coefficients C. ``membership`` assigns coordinates to
    poles.
    """

    position: Float[np.ndarray, "n_rigid n_rigid"]
    rate: Float[np.ndarray, "n_rigid n_rigid"]
    force: Float[np.ndarray, "n_rigid n_rigid"]
    mass: Float[np.ndarray, "n_rigid n_rigid"]
    damping: Float[np.ndarray, "n_rigid n_rigid"]
    stiffness: Float[np.ndarray, "n_rigid n_rigid"]
    membership: Float[np.ndarray, "n_poles n_rigid"]


@dataclass(frozen=True, slots=True)
class RigidBody:
    """Rigid-body part of the motion r = [motions..., eta_1..n] in one axis.

    Attributes
    ----------
    axis, symmetry
        Name of the axis; symmetry of its surfaces, modes and parts of pairs of sensors.
    motions, attitude
        Motions, first the angle of the flow; the attitude that integrates the others.
    coefficients
        Force and moments, one for each motion.
    poles
        Names of its poles, and the states that dominate each of them.
    acts_by_gravity
        Whether the attitude acts on the motion in level flight.
    acceleration
        Name of the specific force at the c.g., V times the force of the first row; empty where
        it is another one.
    kinematics
        Known terms at a condition and trim.
    scale_rows
        Dimensional factors of the coefficients. [1/s, 1/s2...]
    scale_motions
        Factors that make the motions nondimensional.
    free_flight
        The same motion at a condition in coordinates of second order, None where it has none.
    fast
        Rigid body without the slow motions, which are its last ones; the rows of sensors that
        do not measure these are those of it.
    """

    axis: str
    symmetry: Literal["symmetric", "antisymmetric"]
    motions: tuple[str, ...]
    attitude: str
    coefficients: tuple[str, ...]
    poles: Mapping[str, tuple[str, ...]]
    acts_by_gravity: bool
    acceleration: str
    kinematics: Callable[[FlightCondition, Trim], Kinematics]
    scale_rows: Callable[[FlightCondition, Trim], Float[np.ndarray, "*n_v n_rigid"]]
    scale_motions: Callable[[FlightCondition, Trim], Float[np.ndarray, "*n_v n_rigid"]]
    free_flight: Callable[[FlightCondition], FreeFlight] | None = None
    fast: RigidBody | None = None

    @property
    def size(self) -> int:
        """Number of rigid-body motions, and of their coefficients."""
        return len(self.motions)

    def compute_membership(self, n_rigid: int, n_modes: int) -> Float[np.ndarray, "n_poles n_x"]:
        """Assign states to poles: 1 where a state belongs to a pole of rigid body or modes.

        States are those of the rigid body, of which the last is the attitude where
        ``n_rigid`` includes it, eta..., etadot...
        """
        states = (*self.motions, self.attitude)[:n_rigid]
        membership = np.zeros((len(self.poles) + n_modes, n_rigid + 2 * n_modes))
        for row, own in enumerate(self.poles.values()):
            membership[row, [k for k, state in enumerate(states) if state in own]] = 1.0
        membership[len(self.poles) :, n_rigid:] = np.tile(np.eye(n_modes), 2)
        return membership

    def name_motions(self, modes: tuple[int, ...]) -> tuple[str, ...]:
        """Return the names of the motions: those of the rigid body, and eta of each mode."""
        return (*self.motions, *(f"eta{mode}" for mode in modes))

    def row_factors(
        self,
        condition: FlightCondition,
        generalized_mass: Float[np.ndarray, " n_modes"],
        trim: Trim | None = None,
    ) -> Float[np.ndarray, "*n_v n_rows"]:
        """Compute the dimensional factors of the coefficients (Eq. 12).

        The force is divided by mV and so enters the rate of the angle of the flow directly;
        modes have the chord in both axes. [1/s, 1/s2, 1/s2...]
        """
        at = condition.trim if trim is None else trim
        force = at.dynamic_pressure * condition.area
        mass = np.asarray(generalized_mass, dtype=float)
        modal = np.asarray(force * condition.chord)[..., None] / mass
        return np.concatenate([self.scale_rows(condition, at), modal], axis=-1)

    def column_factors(
        self, condition: FlightCondition, n_modes: int, n_inputs: int, trim: Trim | None = None
    ) -> Float[np.ndarray, "*n_v n_w"]:
        """Compute the factors of the variables: motions, eta, etadot, inputs (Eq. 12)."""
        at = condition.trim if trim is None else trim
        rate = np.asarray(condition.chord / (2.0 * at.airspeed))[..., None]
        columns = [
            self.scale_motions(condition, at),
            np.ones((*rate.shape[:-1], n_modes)),
            np.broadcast_to(rate, (*rate.shape[:-1], n_modes)),
            np.ones((*rate.shape[:-1], n_inputs)),
        ]
        return np.concatenate(columns, axis=-1)


def stack_factors(*factors: np.ndarray | float) -> Float[np.ndarray, "*n_v n"]:
    """Stack factors that may depend on the airspeed along the last axis."""
    return np.stack(np.broadcast_arrays(*factors), axis=-1)


# --- Sensor equations: outputs per rigid and elastic motion (Eq. 17), as polynomials in s ---------

INTEGRAL, POSITION, RATE, ACCELERATION = range(4)


@dataclass(frozen=True, slots=True)
class SensorRows:
    """Coefficients of 1/s, 1, s, s^2 for each output; axis 0 is the power."""

    names: tuple[str, ...]
    polynomial: Float[np.ndarray, "4 n_y n_r"]

    def response(
        self, omega: Float[np.ndarray, " n_omega"]
    ) -> Complex[np.ndarray, "n_omega n_y n_r"]:
        """Compute the outputs per unit motion at each frequency. [output unit]

        Raises
        ------
        BadInput
            If a frequency is not above zero.
        """
        w = np.asarray(omega, dtype=float)
        if not np.all(w > 0.0):
            raise BadInput(
                "a frequency is 0 Hz or negative, where motion has no frequency response; begin "
                "the band above 0 Hz",
                code="frequency-at-zero",
            )
        powers = np.stack([1.0 / w, np.ones_like(w), w, w * w], axis=1)
        weighted = np.array([-1j, 1.0, 1j, -1.0])[:, None] * self.polynomial.reshape(4, -1)
        response = (powers @ weighted.view(float)).view(complex)
        return response.reshape(w.size, *self.polynomial.shape[1:])

    def rigid_only(self, n_rigid: int) -> SensorRows:
        """Return the same sensors without elastic response (C_e = 0, Fig. 11)."""
        polynomial = self.polynomial.copy()
        polynomial[:, :, n_rigid:] = 0.0
        return SensorRows(self.names, polynomial)


@dataclass(frozen=True, slots=True, eq=False)
class Mounting:
    """Where a sensor is mounted: position in body axes at the c.g. [m], and the modes there.

    ``translation`` and ``rotation`` are the shapes at its point [m, rad], ``strain`` is that of
    its gauge. What the sensor does not measure is zero.
    """

    position: tuple[float, float, float]
    translation: Float[np.ndarray, "3 n_modes"]
    rotation: Float[np.ndarray, "3 n_modes"]
    strain: Float[np.ndarray, " n_modes"]

    @property
    def n_modes(self) -> int:
        """Number of modes."""
        return self.strain.size


def stack_rows(names: Sequence[str], rows: Sequence[Float[np.ndarray, "4 n_r"]]) -> SensorRows:
    """Stack single rows to one set."""
    return SensorRows(tuple(names), np.stack(rows, axis=1))


def body_axes(
    location: tuple[float, float, float], condition: FlightCondition
) -> tuple[float, float, float]:
    """Transform a structural location (x aft, y right, z up) to body axes at the c.g. [m]"""
    x, y, z = location
    return condition.x_cg - x, y, condition.z_cg - z


def strain_row(
    strain: Float[np.ndarray, " n_modes"], n_rigid: int = 2
) -> Float[np.ndarray, "4 n_r"]:
    """Build the row of a strain gauge from the modal strains, after the rigid-body motions. [1]"""
    row = np.zeros((4, n_rigid + strain.size))
    row[POSITION, n_rigid:] = strain
    return row
