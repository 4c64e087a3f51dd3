"""Roots and flutter of derivatives with a frequency shape, by the p-k method."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float
from scipy.interpolate import CubicSpline
from scipy.linalg import block_diag

from flexsid.errors import BadInput, NotIdentifiable
from flexsid.sysid.aerodynamics.coefficients import UnsteadyCoefficients
from flexsid.sysid.aerodynamics.pk_flutter import ModalSystem, build_free_system
from flexsid.sysid.aerodynamics.splines import Reference
from flexsid.sysid.model.derivatives import coefficients, variables
from flexsid.sysid.model.rigid_body import FreeFlight
from flexsid.sysid.stability.poles import Aeroelastic

_STEP = 1e-5  # of k and airspeed, in central differences


def build_shaped_system(aircraft: Aeroelastic) -> ModalSystem:
    """Build free flight of rigid body and modes with the air forces theta S(k), in SI units.

    Parameters
    ----------
    aircraft
        With a frequency shape.

    Raises
    ------
    BadInput
        If the motion has no coordinates of second order, as that with airspeed, or the frequency
        shape is of another axis.
    NotIdentifiable
        If a derivative is no number.
    """
    assert aircraft.shape is not None
    table = aircraft.derivatives
    if aircraft.shape.body.axis != table.body.axis:
        raise BadInput(
            f"the frequency shape is of the {aircraft.shape.body.axis} axis, the derivatives are "
            f"of the {table.body.axis} one",
            code="shape-of-other-model",
        )
    if not np.isfinite(table.values).all():
        raise NotIdentifiable("the model has a derivative that is not finite; select other runs")
    c, modes = aircraft.condition, aircraft.modes
    shape = aircraft.shape.select(table.modes, table.inputs)
    C = UnsteadyCoefficients(
        shape.k,
        coefficients(table.modes, table.body),
        variables(table.modes, table.inputs, table.body),
        shape.factors * table.values,
    )
    reference = Reference(c.area, c.chord, c.chord, np.zeros(3))
    rigid = describe_free_flight(aircraft)
    return build_free_system(C, reference, rigid, modes.mass, modes.omega, modes.zeta)


def describe_free_flight(aircraft: Aeroelastic) -> FreeFlight:
    """Describe the rigid body of an aircraft in coordinates of second order.

    Raises
    ------
    BadInput
        If its motion has none.
    """
    body = aircraft.derivatives.body
    if body.free_flight is None:
        raise BadInput(
            f"the roots of {body.axis} motion over airspeed are not computed with a frequency "
            "shape; select runs without one",
            code="axis-not-supported",
        )
    return body.free_flight(aircraft.condition)


@dataclass(frozen=True, slots=True, eq=False)
class ShapedRoots:
    """One root at each airspeed, with what its slopes need.

    ``left`` and ``right`` are the vectors for which F v = 0 and w^H F = 0, of the p-k matrix F(p).
    """

    system: ModalSystem
    airspeed: Float[np.ndarray, " n"]
    roots: Complex[np.ndarray, " n"]
    density: float

    def evaluate(
        self, k: Float[np.ndarray, " n"], airspeed: Float[np.ndarray, " n"]
    ) -> Complex[np.ndarray, "n n_q n_q"]:
        """Evaluate F = M p^2 + D p + K - qbar (Re Q + p b/V Im Q/k) at the roots."""
        s, p = self.system, self.roots[:, None, None]
        Q = CubicSpline(s.k, s.forces, axis=0)(np.minimum(k, s.k[-1]))
        pressure = (0.5 * self.density * airspeed**2)[:, None, None]
        rate = (s.b / airspeed / k)[:, None, None]
        air = pressure * (np.real(Q) + p * rate * np.imag(Q))
        return s.mass * p**2 + s.damping * p + s.stiffness - air

    def reduced_frequency(self) -> Float[np.ndarray, " n"]:
        """Reduced frequency of each root."""
        return np.imag(self.roots) * self.system.b / self.airspeed

    def decompose(
        self,
    ) -> tuple[Complex[np.ndarray, "n n_q"], Complex[np.ndarray, "n n_q"]]:
        """Return left and right null vectors of F."""
        U, _, Vh = np.linalg.svd(self.evaluate(self.reduced_frequency(), self.airspeed))
        return U[:, :, -1], Vh[:, -1].conj()

    def differentiate(self) -> tuple[Complex[np.ndarray, "n n_q n_q"], ...]:
        """Differentiate F by p with k held, by k, and by the airspeed."""
        s, k, V = self.system, self.reduced_frequency(), self.airspeed
        Q = CubicSpline(s.k, s.forces, axis=0)(np.minimum(k, s.k[-1]))
        rate = (0.5 * self.density * V * s.b / k)[:, None, None]
        by_p = 2.0 * s.mass * self.roots[:, None, None] + s.damping - rate * np.imag(Q)
        by_k = (self.evaluate(k * (1 + _STEP), V) - self.evaluate(k * (1 - _STEP), V)) / (
            2.0 * _STEP * k[:, None, None]
        )
        by_V = (self.evaluate(k, V * (1 + _STEP)) - self.evaluate(k, V * (1 - _STEP))) / (
            2.0 * _STEP * V[:, None, None]
        )
        return by_p, by_k, by_V


def compute_shaped_participation(
    found: ShapedRoots, aircraft: Aeroelastic
) -> Float[np.ndarray, "n_motions n"]:
    """Compute the share of the motions of the rigid body and of each mode in every root.

    The parts of w^H (dF/dp) v, as left times right eigenvector elsewhere.
    """
    left, right = found.decompose()
    by_p = found.differentiate()[0]
    part = np.abs(left.conj() * (by_p @ right[:, :, None])[:, :, 0]).T
    membership = describe_free_flight(aircraft).membership
    n_rigid = membership.shape[1]
    share = np.vstack([membership @ part[:n_rigid], part[n_rigid:]])
    return share / share.sum(axis=0)


def _load_by_derivative(
    found: ShapedRoots,
    aircraft: Aeroelastic,
    left: Complex[np.ndarray, "n n_q"],
    right: Complex[np.ndarray, "n n_q"],
) -> Complex[np.ndarray, "n n_rows n_w"]:
    """Compute w^H (dF/dc) v of every derivative of the table."""
    assert aircraft.shape is not None
    table, b, V = aircraft.derivatives, found.system.b, found.airspeed
    k = found.reduced_frequency()
    shape = aircraft.shape.select(table.modes, table.inputs)
    s = shape.at(np.minimum(k, shape.k[-1]))
    rate, ik = (found.roots * b / V / k)[:, None], 1j * k[:, None]
    rigid = describe_free_flight(aircraft)
    n, first = len(table.modes), table.body.size

    def respond(forces: Complex[np.ndarray, "n n_rows"], motion: int) -> np.ndarray:
        return (np.real(forces) + rate * np.imag(forces)) * right[:, motion, None]

    load = np.zeros(s.shape, dtype=complex)  # inputs have no part in a root
    for motion in range(first):
        for q in range(first):
            moved = rigid.position[motion, q] + ik / b * rigid.rate[motion, q]
            load[:, :, motion] += respond(moved * s[:, :, motion], q)
    for motion in range(first, first + n):
        load[:, :, motion] = respond(s[:, :, motion], motion)
        load[:, :, n + motion] = respond(ik * s[:, :, n + motion], motion)
    condition = aircraft.condition
    force = block_diag(rigid.force, condition.area * condition.chord * np.eye(n))
    pressure = 0.5 * found.density * V**2
    return -(pressure[:, None] * (left.conj() @ force))[:, :, None] * load


def compute_shaped_slopes(
    found: ShapedRoots, aircraft: Aeroelastic, rows: np.ndarray, columns: np.ndarray
) -> tuple[
    Complex[np.ndarray, "n n_theta"], Complex[np.ndarray, " n"], Complex[np.ndarray, "n n_modes"]
]:
    """Differentiate roots by derivatives, by airspeed, and by squared frequencies of modes.

    Notes
    -----
    From w^H dF v = 0 with dF = F_p dp + F_k b/V d(Im p) + F_k (-k/V) dV + F_V dV + F_theta dtheta,
    two real equations in the real and imaginary part of dp.
    """
    left, right = found.decompose()

    def project(F: np.ndarray) -> np.ndarray:
        return (left.conj()[:, None] @ F @ right[:, :, None])[:, 0, 0]

    by_p, by_k, by_V = (project(F) for F in found.differentiate())
    k, V, b = found.reduced_frequency(), found.airspeed, found.system.b
    through = by_k * b / V
    equation = np.stack(
        [
            np.stack([np.real(by_p), np.real(1j * by_p + through)], axis=-1),
            np.stack([np.imag(by_p), np.imag(1j * by_p + through)], axis=-1),
        ],
        axis=-2,
    )

    def solve(right_side: Complex[np.ndarray, "n m"]) -> Complex[np.ndarray, "n m"]:
        both = np.stack([np.real(right_side), np.imag(right_side)], axis=-2)
        moved = np.linalg.solve(equation, -both)
        return moved[:, 0] + 1j * moved[:, 1]

    by_theta = _load_by_derivative(found, aircraft, left, right)[:, rows, columns]
    modal = slice(aircraft.derivatives.body.size, None)
    mass = np.diag(found.system.mass)[modal]
    by_stiffness = left.conj()[:, modal] * mass * right[:, modal]
    by_speed = (by_V - by_k * k / V)[:, None]
    return solve(by_theta), solve(by_speed)[:, 0], solve(by_stiffness)
