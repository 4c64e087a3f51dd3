"""Flutter by the p-k method: roots of a modal system in unsteady flow over airspeed.

Notes
-----
[M p^2 + D p + K - qbar (Re Q(k) + p b/V Im Q(k)/k)] xi = 0 with k = |Im p| b/V, b = cbar/2
(Hassig, J. Aircraft 8 (1971) 885-889; the rate term as in Rodden and Johnson, MSC/Nastran
Aeroelastic Analysis, 1994). Exact where damping is zero, an approximation elsewhere: below the
crossing it may be 10 % wrong in the damping of well-damped roots. Divergence is not searched.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float
from scipy.interpolate import CubicSpline
from scipy.optimize import brentq, linear_sum_assignment

from flexsid.errors import BadInput, NotIdentifiable
from flexsid.sysid.aerodynamics.coefficients import UnsteadyCoefficients
from flexsid.sysid.aerodynamics.normal_washes import Reference

MAX_ITERATIONS = 60
TOLERANCE = 1e-10  # of the size of a root
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
    rigid_mass: tuple[float, float],
    mass: Float[np.ndarray, " n"],
    omega: Float[np.ndarray, " n"],
    zeta: Float[np.ndarray, " n"],
) -> ModalSystem:
    """Build the system of heave (up), pitch and elastic modes in symmetric free flight.

    ``rigid_mass`` are mass and pitch inertia of the whole aircraft. Heave and pitch columns follow
    from alpha and q: -(i k/b) C_alpha and C_alpha + i k C_q.
    """
    modes = build_modal_system(coefficients, reference, mass, omega, zeta)
    rows, eta, etadot = _find_modes(coefficients)
    n = len(rows) + 2
    ik = 1j * coefficients.k[:, None]
    C = coefficients.values[:, [0, 1, *rows]]
    alpha, q = (C[:, :, coefficients.column(name)] for name in ("alpha", "q"))
    Q = np.empty((coefficients.k.size, n, n), dtype=complex)
    Q[:, :, 0], Q[:, :, 1] = -ik / modes.b * alpha, alpha + ik * q
    Q[:, :, 2:] = C[:, :, eta] + ik[:, :, None] * C[:, :, etadot]
    Q[:, 0] *= -reference.area
    Q[:, 1:] *= reference.area * reference.chord
    M, D, K = (np.zeros((n, n)) for _ in range(3))
    M[0, 0], M[1, 1] = rigid_mass
    M[2:, 2:], D[2:, 2:], K[2:, 2:] = modes.mass, modes.damping, modes.stiffness
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
    """State matrices of a system at an airspeed and a reduced frequency."""

    def __init__(self, system: ModalSystem, density: float) -> None:
        self.system, self._density = system, density
        M = system.mass
        self._spline = CubicSpline(system.k, np.linalg.solve(M, system.forces), axis=0)
        self._limit = np.imag(self._spline(0.0, 1))
        self._stiffness = np.linalg.solve(M, system.stiffness)
        self._damping = np.linalg.solve(M, system.damping)

    def matrices(
        self, airspeed: float, k: Float[np.ndarray, " n_k"]
    ) -> Float[np.ndarray, "n_k m m"]:
        Q = self._spline(np.minimum(k, self.system.k[-1]))
        lag = np.where(
            (k > STEADY_K)[:, None, None],
            Q.imag / np.maximum(k, STEADY_K)[:, None, None],
            self._limit,
        )
        pressure = 0.5 * self._density * airspeed**2
        n = self.system.mass.shape[0]
        A = np.zeros((k.size, 2 * n, 2 * n))
        A[:, :n, n:] = np.eye(n)
        A[:, n:, :n] = pressure * Q.real - self._stiffness
        A[:, n:, n:] = pressure * self.system.b / airspeed * lag - self._damping
        return A

    def decompose(self, airspeed: float, k: Float[np.ndarray, " n_k"]) -> tuple:
        return np.linalg.eig(self.matrices(airspeed, k))

    def iterate(self, airspeed: float, start: complex) -> tuple[complex, np.ndarray] | None:
        """Find the root near a start: the eigenvalue whose k is that of its matrix."""
        p = start
        for step in range(MAX_ITERATIONS):
            k = abs(p.imag) * self.system.b / airspeed
            if k < SLOWEST_K:
                return None
            values, vectors = self.decompose(airspeed, np.array([k]))
            nearest = int(np.argmin(np.abs(values[0] - p)))
            found = complex(values[0, nearest])
            if abs(found - p) <= TOLERANCE * abs(found):
                return found, vectors[0, :, nearest]
            p = found if step < MAX_ITERATIONS // 3 else 0.5 * (found + p)
        return None

    def find_all(self, airspeed: float, near: Sequence[complex] = ()) -> _Roots:
        """Find all oscillatory roots: starts are eigenvalues whose k is that of their matrix."""
        k = self.system.k
        values = self.decompose(airspeed, k)[0]
        own = values.imag * self.system.b / airspeed
        below = np.concatenate([[0.0], k[:-1]])[:, None]
        above = np.concatenate([k[1:], [k[-1]]])[:, None]
        starts = [*near, *values[(own >= below) & (own <= above) & (own > SLOWEST_K)].tolist()]
        roots: list[complex] = []
        vectors: list[np.ndarray] = []
        for start in starts:
            # Neighbouring matrices give the same root many times over.
            if any(abs(start - root) < SAME_ROOT * abs(root) for root in roots):
                continue
            found = self.iterate(airspeed, start)
            if found is None or any(abs(found[0] - r) < SAME_ROOT * abs(r) for r in roots):
                continue
            roots.append(found[0])
            vectors.append(found[1])
        order = np.argsort(np.imag(roots)) if roots else []
        m = 2 * self.system.mass.shape[0]
        return _Roots(
            np.array([roots[i] for i in order], dtype=complex),
            np.array([vectors[i] for i in order], dtype=complex).reshape(-1, m),
        )


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
    parts = (system.mass, system.damping, system.stiffness, system.forces)
    if not all(np.isfinite(part).all() for part in parts):
        raise NotIdentifiable("a matrix of the flutter analysis is not a number")
    pencil = _Pencil(system, density)
    branches: list[dict[int, complex]] = []
    current: list[int] = []
    before: _Roots | None = None
    for index, speed in enumerate(V.tolist()):
        roots = pencil.find_all(speed, [] if before is None else before.values.tolist())
        columns = [-1] * roots.values.size
        if before is not None:
            for old, new in _match(before, roots):
                columns[new] = current[old]
        for position, root in enumerate(roots.values.tolist()):
            if columns[position] < 0:
                columns[position] = len(branches)
                branches.append({})
            branches[columns[position]][index] = root
        before, current = roots, columns
    table = np.full((V.size, len(branches)), np.nan + 0j)
    for column, branch in enumerate(branches):
        for index, root in branch.items():
            table[index, column] = root
    found = [
        _refine(pencil, V, branch, column, index)
        for column, branch in enumerate(branches)
        for index in range(V.size - 1)
        if index in branch
        and index + 1 in branch
        and branch[index].real < 0.0 <= branch[index + 1].real
    ]
    return PkRoots(V, table, tuple(sorted(found, key=lambda crossing: crossing.airspeed)))


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
    pencil: _Pencil, V: Float[np.ndarray, " n_v"], branch: dict[int, complex], column: int, at: int
) -> PkCrossing:
    """Crossing between two airspeeds; linear between them where the root is lost on the way."""
    low, high = float(V[at]), float(V[at + 1])

    def guess(speed: float) -> complex:
        share = (speed - low) / (high - low)
        return (1.0 - share) * branch[at] + share * branch[at + 1]

    def root(speed: float) -> complex:
        start = guess(speed)
        found = pencil.iterate(speed, start)
        return start if found is None else found[0]

    growth = [branch[at].real, branch[at + 1].real]
    speed = low + (high - low) * growth[0] / (growth[0] - growth[1])
    omega = guess(speed).imag
    if root(low).real < 0.0 <= root(high).real:
        exact = float(brentq(lambda v: root(v).real, low, high, xtol=1e-9 * high, rtol=1e-12))
        on_axis = root(exact)
        if abs(on_axis.real) < AXIS_TOLERANCE * abs(on_axis):
            speed, omega = exact, on_axis.imag
    return PkCrossing(speed, omega, omega * pencil.system.b / speed, column)
