"""Flutter by the p-k method: roots of a modal system in unsteady flow over airspeed.

Notes
-----
[M p^2 + D p + K - qbar (Re Q(k) + p b/V Im Q(k)/k)] xi = 0 with k = |Im p| b/V, b = cbar/2
(Hassig, J. Aircraft 8 (1971) 885-889, doi:10.2514/3.44311; the rate term as in Rodden and Johnson,
MSC/Nastran Aeroelastic Analysis, 1994). Exact where damping is zero, an approximation elsewhere:
below the crossing it may be 10 % wrong in the damping of well-damped roots. Divergence is not
searched.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float
from scipy.interpolate import CubicSpline
from scipy.linalg import block_diag
from scipy.optimize import brentq, linear_sum_assignment

from flexsid.errors import BadInput, NotIdentifiable
from flexsid.sysid.aerodynamics.coefficients import UnsteadyCoefficients
from flexsid.sysid.aerodynamics.splines import Reference
from flexsid.sysid.model.rigid_body import FreeFlight

MAX_ITERATIONS = 30
TOLERANCE = 1e-10  # of the size of a root
LONGEST_STEP = 0.3  # of the size of a root: longer Newton steps leave the neighbourhood
SAME_ROOT = 1e-6
AXIS_TOLERANCE = 1e-6  # of the size of a root: larger real parts are jumps between roots
STEADY_K = 1e-4  # below, Im Q/k is its limit at k = 0
SLOWEST_K = 1e-3  # slower roots do not flutter


@dataclass(frozen=True, slots=True, eq=False)
class ModalSystem:
    """M, D and K in generalised coordinates, and their air forces qbar Q(k) xi.

    Consistent units; ``k`` rises from 0, and ``b`` is the length it refers to: k = omega b/V.
    """

    mass: Float[np.ndarray, "n n"]
    damping: Float[np.ndarray, "n n"]
    stiffness: Float[np.ndarray, "n n"]
    k: Float[np.ndarray, " n_k"]
    forces: Complex[np.ndarray, "n_k n n"]
    b: float


@dataclass(frozen=True, slots=True)
class PkCrossing:
    """Where a root becomes unstable: airspeed, frequency [rad/s], k, and its column."""

    airspeed: float
    omega: float
    k: float
    branch: int


@dataclass(frozen=True, slots=True, eq=False)
class PkRoots:
    """Oscillatory roots over airspeed; a column is one root, NaN where it is not oscillatory.

    A root that is unstable from its first airspeed on has no crossing: ``unstable_from_start``
    lists these columns.
    """

    airspeed: Float[np.ndarray, " n_v"]
    roots: Complex[np.ndarray, "n_v n_branches"]
    crossings: tuple[PkCrossing, ...]

    @property
    def flutter(self) -> PkCrossing | None:
        """First crossing."""
        return self.crossings[0] if self.crossings else None

    @property
    def unstable_from_start(self) -> tuple[int, ...]:
        """Columns whose root grows at the first airspeed at which it oscillates."""
        first = np.argmax(np.isfinite(self.roots), axis=0)
        growth = np.real(self.roots[first, np.arange(self.roots.shape[1])])
        return tuple(np.flatnonzero(growth > 0.0).tolist())


def build_modal_system(
    coefficients: UnsteadyCoefficients,
    reference: Reference,
    mass: Float[np.ndarray, " n"],
    omega: Float[np.ndarray, " n"],
    zeta: Float[np.ndarray, " n"],
) -> ModalSystem:
    """Build the system of the modes alone; rigid motion, if any, is among the modes.

    Parameters
    ----------
    coefficients, reference
        With one eta and etadot column and one C_Q row per mode.
    mass, omega, zeta
        Generalised mass, frequency [rad/s] and damping ratio of each mode.
    """
    rows, eta, etadot = _find_modes(coefficients)
    k = coefficients.k
    C = coefficients.values[:, rows]
    Q = C[:, :, eta] + 1j * k[:, None, None] * C[:, :, etadot]
    Q = Q * reference.area * reference.chord
    M, D, K = (np.diag(v) for v in (mass, 2.0 * zeta * omega * mass, omega**2 * mass))
    return ModalSystem(M, D, K, k, Q, 0.5 * reference.chord)


def build_free_system(
    coefficients: UnsteadyCoefficients,
    reference: Reference,
    rigid: FreeFlight,
    mass: Float[np.ndarray, " n"],
    omega: Float[np.ndarray, " n"],
    zeta: Float[np.ndarray, " n"],
) -> ModalSystem:
    """Build the system of the rigid body and the elastic modes in free flight.

    Parameters
    ----------
    coefficients, reference
        Rows and columns begin with those of the rigid body.
    rigid
        Its coordinates, which come before the modes. Their columns follow from those of the
        motions: (position + (i k/b) rate), of heave -(i k/b) C_alpha.
    mass, omega, zeta
        As in ``build_modal_system``.
    """
    modes = build_modal_system(coefficients, reference, mass, omega, zeta)
    rows, eta, etadot = _find_modes(coefficients)
    first = rigid.mass.shape[0]
    ik = 1j * coefficients.k[:, None, None]
    C = coefficients.values[:, [*range(first), *rows]]
    motion = rigid.position + ik / modes.b * rigid.rate
    Q = np.concatenate([C[:, :, :first] @ motion, C[:, :, eta] + ik * C[:, :, etadot]], axis=2)
    Q[:, :first] = rigid.force @ Q[:, :first]
    Q[:, first:] *= reference.area * reference.chord
    M, D, K = (
        block_diag(of_body, of_modes)
        for of_body, of_modes in (
            (rigid.mass, modes.mass),
            (rigid.damping, modes.damping),
            (rigid.stiffness, modes.stiffness),
        )
    )
    return ModalSystem(M, D, K, modes.k, Q, modes.b)


def _find_modes(coefficients: UnsteadyCoefficients) -> tuple[list[int], list[int], list[int]]:
    rows = [i for i, name in enumerate(coefficients.rows) if name.startswith("CQ")]
    numbers = [coefficients.rows[row].removeprefix("CQ") for row in rows]
    eta, etadot = (
        [coefficients.column(f"{kind}{number}") for number in numbers] for kind in ("eta", "etadot")
    )
    return rows, eta, etadot


@dataclass(frozen=True, slots=True, eq=False)
class _Roots:
    """Roots above the real axis with their unit state vectors, at one airspeed."""

    values: Complex[np.ndarray, " n"]
    vectors: Complex[np.ndarray, "n m"]


class _Pencil:
    """F(p) = p^2 + M^-1 (D p + K - qbar (Re Q + p b/V Im Q/k)) of a system, at any airspeeds."""

    def __init__(self, system: ModalSystem, density: float) -> None:
        self.system, self._density = system, density
        M = system.mass
        self._spline = CubicSpline(system.k, np.linalg.solve(M, system.forces), axis=0)
        self._slope = self._spline.derivative()
        self._limit = np.imag(self._slope(0.0))
        self._stiffness = np.linalg.solve(M, system.stiffness)
        self._damping = np.linalg.solve(M, system.damping)

    def build_matrices(
        self, airspeed: Float[np.ndarray, " n"], k: Float[np.ndarray, " n"]
    ) -> Float[np.ndarray, "n m m"]:
        """State matrices at given reduced frequencies."""
        Q = self._spline(np.minimum(k, self.system.k[-1]))
        steady = (k <= STEADY_K)[:, None, None]
        lag = np.where(steady, self._limit, Q.imag / np.maximum(k, STEADY_K)[:, None, None])
        pressure = (0.5 * self._density * airspeed**2)[:, None, None]
        rate = (self.system.b / airspeed)[:, None, None]
        n = self.system.mass.shape[0]
        A = np.zeros((k.size, 2 * n, 2 * n))
        A[:, :n, n:] = np.eye(n)
        A[:, n:, :n] = pressure * Q.real - self._stiffness
        A[:, n:, n:] = pressure * rate * lag - self._damping
        return A

    def expand(
        self, airspeed: Float[np.ndarray, " n"], p: Complex[np.ndarray, " n"]
    ) -> tuple[Complex[np.ndarray, "n n_q n_q"], ...]:
        """F at its own k, its derivative by p with k held, and that by Im p through k."""
        rate = self.system.b / airspeed
        k = np.imag(p) * rate
        highest = self.system.k[-1]
        Q = self._spline(np.minimum(k, highest))
        slope = self._slope(np.minimum(k, highest)) * (k <= highest)[:, None, None]
        pressure = (0.5 * self._density * airspeed**2)[:, None, None]
        p, k, rate = p[:, None, None], k[:, None, None], rate[:, None, None]
        lag = Q.imag / k
        eye = np.eye(self.system.mass.shape[0])
        F = p**2 * eye + p * self._damping + self._stiffness
        F -= pressure * (Q.real + p * rate * lag)
        by_p = 2.0 * p * eye + self._damping - pressure * rate * lag
        by_k = -pressure * (slope.real + p * rate * (slope.imag - lag) / k)
        return F, by_p, by_k * rate

    def iterate(
        self, airspeed: Float[np.ndarray, " n"], start: Complex[np.ndarray, " n"]
    ) -> tuple[Complex[np.ndarray, " n"], Complex[np.ndarray, "n m"]]:
        """Find the root near each start, and its unit state vector; NaN where there is none.

        Newton's method on u^H F v = 0 with the singular vectors of the smallest singular value of
        F; as k depends on Im p alone, two real equations.
        """
        p, n = start.astype(complex), self.system.mass.shape[0]
        roots = np.full(p.size, np.nan + 0j)
        vectors = np.full((p.size, n), np.nan + 0j)
        at = np.arange(p.size)
        for _ in range(MAX_ITERATIONS):
            at = at[np.imag(p[at]) * self.system.b > SLOWEST_K * airspeed[at]]  # NaN fails too
            if not at.size:
                break
            F, by_p, by_omega = self.expand(airspeed[at], p[at])
            U, size, Vh = np.linalg.svd(F)
            left, right = U[:, :, -1].conj(), Vh[:, -1].conj()
            one, two = (
                (left[:, None] @ matrix @ right[:, :, None])[:, 0, 0] for matrix in (by_p, by_omega)
            )
            two = two + 1j * one
            with np.errstate(divide="ignore", invalid="ignore"):
                part = size[:, -1] / np.imag(one.conj() * two)
                step = part * (1j * np.imag(one) - np.imag(two))
                step *= np.minimum(1.0, LONGEST_STEP * np.abs(p[at]) / np.abs(step))
            step[size[:, -1] == 0.0] = 0.0
            p[at] += step
            done = np.abs(step) <= TOLERANCE * np.abs(p[at])
            roots[at[done]], vectors[at[done]] = p[at[done]], right[done]
            at = at[~done]
        states = np.full((p.size, 2 * n), np.nan + 0j)
        known = np.isfinite(roots)
        states[known, :n], states[known, n:] = (
            vectors[known],
            roots[known, None] * vectors[known],
        )
        states[known] /= np.linalg.norm(states[known], axis=1, keepdims=True)
        return roots, states

    def find_all(self, airspeed: Float[np.ndarray, " n_v"]) -> list[_Roots]:
        """Find all oscillatory roots: starts are eigenvalues whose k is that of their matrix."""
        k, n_v = self.system.k, airspeed.size
        V, below, above = (
            np.repeat(airspeed, k.size),
            np.tile(np.concatenate([[0.0], k[:-1]]), n_v)[:, None],
            np.tile(np.concatenate([k[1:], [k[-1]]]), n_v)[:, None],
        )
        values = np.linalg.eigvals(self.build_matrices(V, np.tile(k, n_v)))
        own = values.imag * self.system.b / V[:, None]
        place, column = np.nonzero((own >= below) & (own <= above) & (own > SLOWEST_K))
        roots, vectors = self.iterate(V[place], values[place, column])
        found = []
        for index in range(n_v):
            at = np.flatnonzero((place // k.size == index) & np.isfinite(roots))
            at = at[np.argsort(np.imag(roots[at]))]
            values = roots[at]
            # Neighbouring matrices are starts of the same root.
            same = np.abs(values[:, None] - values) < SAME_ROOT * np.abs(values)
            at = at[~np.tril(same, -1).any(axis=1)]
            found.append(_Roots(roots[at], vectors[at]))
        return found


def track_pk_roots(
    system: ModalSystem, airspeed: Float[np.ndarray, " n_v"], density: float
) -> PkRoots:
    """Find the oscillatory roots at each airspeed, join them to branches, and find crossings.

    Parameters
    ----------
    system
        In consistent units.
    airspeed
        Rising, positive.
    density
        Of the air.

    Raises
    ------
    BadInput
        If the airspeeds do not rise.
    NotIdentifiable
        If a matrix is not finite.

    Notes
    -----
    At each airspeed the eigenvalues at all tabulated k are starts of the iteration, so that no
    root depends on being followed from the airspeed before (van Zyl, J. Aircraft 38 (2001)
    598-600). Neighbours belong together by closeness and by the modal assurance of their vectors.
    """
    V = np.asarray(airspeed, dtype=float)
    if V.size == 0 or V[0] <= 0.0 or not (np.diff(V) > 0.0).all():
        raise BadInput("airspeeds must be positive and rise", code="bad-airspeed")
    pencil = _build_pencil(system, density)
    table = _join_roots(pencil.find_all(V))
    found = [_refine(pencil, V, table, column, at) for column, at in _find_entries(table)]
    return PkRoots(V, table, tuple(sorted(found, key=lambda crossing: crossing.airspeed)))


def track_pk_systems(
    systems: Sequence[ModalSystem],
    along: Float[np.ndarray, " n_systems"],
    airspeed: float,
    density: float,
) -> PkRoots:
    """Track the oscillatory roots of systems along a parameter, such as fuel, at one airspeed.

    Parameters
    ----------
    systems
        In consistent units, one for each value of the parameter.
    along
        Rising values; they take the place of the airspeeds of the result. Crossings are linear
        between them.
    airspeed, density
        Common to all.

    Raises
    ------
    NotIdentifiable
        If a matrix is not finite.
    """
    V = np.array([airspeed])
    table = _join_roots([_build_pencil(one, density).find_all(V)[0] for one in systems])
    found = []
    for column, at in _find_entries(table):
        before, after = table[at, column], table[at + 1, column]
        share = float(before.real / (before.real - after.real))
        omega = float((1.0 - share) * before.imag + share * after.imag)
        place = float((1.0 - share) * along[at] + share * along[at + 1])
        found.append(PkCrossing(place, omega, omega * systems[at].b / airspeed, column))
    return PkRoots(along, table, tuple(sorted(found, key=lambda crossing: crossing.airspeed)))


def _build_pencil(system: ModalSystem, density: float) -> _Pencil:
    parts = (system.mass, system.damping, system.stiffness, system.forces)
    if not all(np.isfinite(part).all() for part in parts):
        raise NotIdentifiable("a matrix of the flutter analysis is not a number")
    return _Pencil(system, density)


def _join_roots(every: Sequence[_Roots]) -> Complex[np.ndarray, "n_v n_branches"]:
    """Join the roots of neighbouring places to branches; NaN where a branch has no root."""
    branches: list[dict[int, complex]] = []
    current: list[int] = []
    for index, roots in enumerate(every):
        columns = [-1] * roots.values.size
        if index:
            for old, new in _match(every[index - 1], roots):
                columns[new] = current[old]
        for position, root in enumerate(roots.values.tolist()):
            if columns[position] < 0:
                columns[position] = len(branches)
                branches.append({})
            branches[columns[position]][index] = root
        current = columns
    table = np.full((len(every), len(branches)), np.nan + 0j)
    for column, branch in enumerate(branches):
        for index, root in branch.items():
            table[index, column] = root
    return table


def _find_entries(table: Complex[np.ndarray, "n_v n_branches"]) -> list[tuple[int, int]]:
    """Columns whose root becomes unstable, and the place before; NaN is neither."""
    growth = np.real(table)
    at, column = np.nonzero((growth[:-1] < 0.0) & (growth[1:] >= 0.0))
    return list(zip(column.tolist(), at.tolist(), strict=True))


def _match(before: _Roots, after: _Roots) -> list[tuple[int, int]]:
    if not before.values.size or not after.values.size:
        return []
    reach = np.abs(before.values[:, None] - after.values)
    reach /= np.maximum(np.abs(before.values)[:, None], np.abs(after.values))
    assurance = np.abs(before.vectors.conj() @ after.vectors.T)
    old, new = linear_sum_assignment(2.0 * reach - assurance)
    near = reach[old, new] < 0.5
    return list(zip(old[near].tolist(), new[near].tolist(), strict=True))


def _refine(
    pencil: _Pencil,
    V: Float[np.ndarray, " n_v"],
    table: Complex[np.ndarray, "n_v n_branches"],
    column: int,
    at: int,
) -> PkCrossing:
    """Crossing between two airspeeds; linear between them where the root is lost on the way."""
    low, high = float(V[at]), float(V[at + 1])
    ends = table[at : at + 2, column]

    def guess(speed: float) -> complex:
        share = (speed - low) / (high - low)
        return complex((1.0 - share) * ends[0] + share * ends[1])

    def root(speed: float) -> complex:
        start = guess(speed)
        found = complex(pencil.iterate(np.array([speed]), np.array([start]))[0][0])
        return found if np.isfinite(found) else start

    growth = np.real(ends)
    speed = float(low + (high - low) * growth[0] / (growth[0] - growth[1]))
    omega = guess(speed).imag
    if root(low).real < 0.0 <= root(high).real:
        exact = float(brentq(lambda v: root(v).real, low, high, xtol=1e-9 * high, rtol=1e-12))
        on_axis = root(exact)
        if abs(on_axis.real) < AXIS_TOLERANCE * abs(on_axis):
            speed, omega = exact, on_axis.imag
    return PkCrossing(speed, omega, omega * pencil.system.b / speed, column)
