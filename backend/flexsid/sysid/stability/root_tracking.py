"""Flutter: roots tracked over airspeed, and their crossings of the imaginary axis."""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np
from jaxtyping import Complex, Float
from scipy.interpolate import CubicSpline
from scipy.optimize import brentq, linear_sum_assignment

from flexsid.errors import BadInput
from flexsid.sysid.aerodynamics.pk_flutter import PkRoots, track_pk_roots, track_pk_systems
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.rigid_body import PHUGOID, SPIRAL, SensorRows
from flexsid.sysid.stability.poles import (
    Aeroelastic,
    Modal,
    StateFamily,
    build_state_family,
    compute_participation,
    decompose_states,
    name_roots,
)
from flexsid.sysid.stability.shaped_roots import (
    ShapedRoots,
    build_shaped_system,
    compute_shaped_participation,
)

# --- Flutter: roots tracked over airspeed, and their crossings of the imaginary axis --------------

_SHAPED_SPEEDS = 16  # airspeeds at which p-k roots are solved
_OSCILLATING = 0.5  # of the airspeeds, at which a root with a frequency shape must oscillate
STATIC_ROOT_RAD_S = 1e-3  # a slower root neither oscillates nor grows in a maneuver


class Mechanism(StrEnum):
    """Mechanism of an instability."""

    FLUTTER = "flutter"
    DIVERGENCE = "divergence"
    SPIRAL = "spiral"
    PHUGOID = "phugoid"


_SLOW_FLIGHT = {Mechanism.SPIRAL, Mechanism.PHUGOID}  # a pilot or autopilot stabilises it
SLOW_MOTIONS = (PHUGOID, SPIRAL)


@dataclass(frozen=True, slots=True)
class FlutterCrossing:
    """A root on the imaginary axis.

    ``frequency`` is zero for divergence [rad/s]; ``participation`` the share of every motion
    in the unstable root. ``recovers_at`` is where a hump becomes stable again [m/s].
    """

    airspeed: float
    frequency: float
    mechanism: Mechanism
    branch: int
    participation: dict[str, float]
    recovers_at: float | None = None


@dataclass(frozen=True, slots=True)
class RootLocus:
    """Roots over airspeed (or another parameter); a column is one root.

    Of complex pairs it is the root above the real axis; where a pair has become two real
    roots, the less stable of them. ``names`` are the motions that
    dominate the roots at the lowest speed.
    """

    airspeed: Float[np.ndarray, " n_v"]
    roots: Complex[np.ndarray, "n_v n_branches"]
    names: tuple[str, ...]
    crossings: tuple[FlutterCrossing, ...]

    @property
    def flutter(self) -> FlutterCrossing | None:
        """First crossing of flutter or divergence."""
        return next(iter(self.dangerous), None)

    @property
    def dangerous(self) -> tuple[FlutterCrossing, ...]:
        """Crossings of flutter and divergence: slowly unstable flight is neither."""
        return tuple(one for one in self.crossings if one.mechanism not in _SLOW_FLIGHT)

    @property
    def fast(self) -> tuple[int, ...]:
        """Branches without spiral and phugoid."""
        kinds = map(_classify, self.names, np.imag(self.roots[0]).tolist())
        return tuple(k for k, kind in enumerate(kinds) if kind not in _SLOW_FLIGHT)

    @property
    def unstable(self) -> tuple[int, ...]:
        """Branches that are unstable at the lowest speed, without spiral and phugoid."""
        return tuple(k for k in self.fast if np.real(self.roots[0, k]) > 0.0)

    def damping(self) -> Float[np.ndarray, "n_v n_branches"]:
        """Damping ratios; negative where unstable. [1]"""
        size = np.abs(self.roots)
        return -np.real(self.roots) / np.where(size > 0.0, size, 1.0)


Family = Callable[[Float[np.ndarray, " n"]], StateFamily]
"""State matrices at values of the parameter along which roots are tracked."""


def track_roots(
    aircraft: Aeroelastic,
    airspeed: Float[np.ndarray, " n_v"],
    density: float | None = None,
) -> RootLocus:
    """Track all roots over rising airspeeds and find their crossings exactly.

    Parameters
    ----------
    aircraft
        Derivatives on a structure.
    airspeed
        Rising, close enough that shapes change little from one to the next. [m/s]
    density
        Of the air; that of the known condition by default. [kg/m3]

    Raises
    ------
    BadInput
        If the airspeeds do not rise, or are not positive.
    NotIdentifiable
        If a derivative is no number.

    Notes
    -----
    Crossings are solved for, not interpolated; with a frequency shape the roots are those of the
    p-k method (Hassig, J. Aircraft 8 (1971) 885-889, doi:10.2514/3.44311).
    """
    if not (np.diff(airspeed) > 0.0).all():
        raise BadInput("airspeeds must rise from one to the next", code="bad-airspeed")
    if aircraft.shape is not None:
        return _track_shaped_roots(aircraft, airspeed, density)
    return track_family_roots(
        lambda speeds: build_state_family(aircraft, speeds, density), airspeed, aircraft.motions
    )


def _track_shaped_roots(
    aircraft: Aeroelastic, airspeed: Float[np.ndarray, " n_v"], density: float | None
) -> RootLocus:
    """Track the oscillatory roots by the p-k method; divergence is not searched."""
    system = build_shaped_system(aircraft)
    air = aircraft.condition.density if density is None else density
    # Each airspeed is solved on its own: a few of them, with splines between, are enough.
    some = airspeed[:: max(1, airspeed.size // _SHAPED_SPEEDS)]
    some = some if some[-1] == airspeed[-1] else np.append(some, airspeed[-1])

    def share_root(at: float, root: complex) -> Float[np.ndarray, " n_motions"]:
        there = ShapedRoots(system, np.array([at]), np.array([root]), air)
        return compute_shaped_participation(there, aircraft)[:, 0]

    return _build_shaped_locus(
        track_pk_roots(system, some, air), airspeed, aircraft.motions, share_root
    )


def track_shaped_loadings(
    build: Callable[[float], Aeroelastic],
    along: Float[np.ndarray, " n_loadings"],
    airspeed: float,
    density: float,
) -> RootLocus:
    """Track the roots of a frequency shape along rising loadings, such as fuel, at one airspeed.

    ``build`` gives the aircraft at a loading.
    """
    systems = [build_shaped_system(build(at)) for at in along.tolist()]

    def share_root(at: float, root: complex) -> Float[np.ndarray, " n_motions"]:
        aircraft = build(at)
        system = build_shaped_system(aircraft)
        there = ShapedRoots(system, np.array([airspeed]), np.array([root]), density)
        return compute_shaped_participation(there, aircraft)[:, 0]

    found = track_pk_systems(systems, along, airspeed, density)
    return _build_shaped_locus(found, along, build(float(along[0])).motions, share_root)


def _build_shaped_locus(
    found: PkRoots,
    along: Float[np.ndarray, " n_v"],
    motions: tuple[str, ...],
    share_root: Callable[[float, complex], Float[np.ndarray, " n_motions"]],
) -> RootLocus:
    """Build the locus of p-k roots, whose places are some of ``along``.

    Where a root does not oscillate, it is drawn at its nearest value; roots that oscillate at
    less than half of the places are omitted unless they become unstable.
    """
    some, known = found.airspeed, np.isfinite(found.roots)
    unstable = {crossing.branch for crossing in found.crossings}
    own = [k for k in range(known.shape[1]) if k in unstable or known[:, k].mean() >= _OSCILLATING]
    roots = np.empty((along.size, len(own)), dtype=complex)
    shares = np.empty((len(motions), len(own)))
    for column, branch in enumerate(own):
        at, values = some[known[:, branch]], found.roots[known[:, branch], branch]
        within = np.clip(along, at[0], at[-1])
        roots[:, column] = CubicSpline(at, values)(within) if at.size > 1 else values[0]
        shares[:, column] = share_root(float(at[0]), complex(values[0]))
    crossings = []
    for crossing in found.crossings:
        participation = share_root(crossing.airspeed, 1j * crossing.omega).tolist()
        column = own.index(crossing.branch)
        stable = np.flatnonzero((along > crossing.airspeed) & (np.real(roots[:, column]) < 0.0))
        crossings.append(
            FlutterCrossing(
                crossing.airspeed,
                crossing.omega,
                Mechanism.FLUTTER,
                column,
                dict(zip(motions, participation, strict=True)),
                float(along[stable[0]]) if stable.size else None,
            )
        )
    names = name_roots(shares, motions) if own else ()
    return RootLocus(along, roots, names, tuple(crossings))


def track_family_roots(
    family: Family, along: Float[np.ndarray, " n_v"], motions: tuple[str, ...]
) -> RootLocus:
    """Track all roots along rising airspeeds or another parameter of the state matrices.

    Places are rising and close enough that shapes change little from one to the next; the
    motions name the rows of the family's membership.

    Notes
    -----
    Roots of neighbouring places belong together by the modal assurance of left with right
    vectors; the assignment is optimal over all. A crossing is refined between two places
    by Brent's method on the real parts.
    """
    x = np.asarray(along, dtype=float)
    states = family(x)
    modal = decompose_states(states.A)
    order = _match_roots(modal)
    values = np.take_along_axis(modal.values, order, axis=1)
    upper, branch_of = _find_pairs(values)
    names = name_roots(
        compute_participation(modal, 0, states.membership)[:, order[0, upper]], motions
    )
    crossings: list[FlutterCrossing] = []
    for column, branch in enumerate(branch_of):
        crossings += _find_crossings(family, x, modal, order[:, column], int(branch), motions)
    # Both roots of a pair have the same crossing.
    once = {(c.branch, round(c.airspeed / x[-1], 8)): c for c in crossings}
    found = tuple(sorted(once.values(), key=lambda crossing: crossing.airspeed))
    return RootLocus(x, _select_less_stable(values, upper, branch_of), names, found)


def _match_roots(modal: Modal) -> np.ndarray:
    """Column of every branch at every speed, (n_v, n_x)."""
    n_v, n_x = modal.values.shape
    order = np.empty((n_v, n_x), dtype=int)
    order[0] = np.argsort(np.abs(modal.values[0]))
    assurance = np.abs(modal.left[:-1].conj().transpose(0, 2, 1) @ modal.right[1:])
    reach = np.abs(modal.values[:-1, :, None] - modal.values[1:, None, :])
    reach /= np.abs(modal.values[:-1]).max(axis=1)[:, None, None]
    for k in range(n_v - 1):
        before = order[k]
        cost = reach[k][before] - np.minimum(assurance[k][before], 1.0)
        order[k + 1] = linear_sum_assignment(cost)[1]
    return order


def _find_pairs(values: Complex[np.ndarray, "n_v n_x"]) -> tuple[np.ndarray, np.ndarray]:
    """One column of every pair, that above the real axis, and the branch of every column."""
    height = np.imag(values).sum(axis=0)
    lone = np.abs(np.imag(values)).max(axis=0) < STATIC_ROOT_RAD_S
    upper = np.flatnonzero((height > 0.0) | lone)
    branch_of = np.empty(values.shape[1], dtype=int)
    branch_of[upper] = np.arange(upper.size)
    for column in np.flatnonzero((height <= 0.0) & ~lone):
        distance = np.abs(values[:, upper].conj() - values[:, [column]]).min(axis=0)
        branch_of[column] = int(np.argmin(distance))
    return upper, branch_of


def _select_less_stable(
    values: Complex[np.ndarray, "n_v n_x"], upper: np.ndarray, branch_of: np.ndarray
) -> Complex[np.ndarray, "n_v n_branches"]:
    roots = values[:, upper].copy()
    for column, branch in enumerate(branch_of):
        one, other = roots[:, branch], values[:, column]
        real = np.maximum(np.abs(np.imag(other)), np.abs(np.imag(one))) < STATIC_ROOT_RAD_S
        worse = real & (np.real(other) > np.real(one))
        roots[worse, branch] = other[worse]
    return roots


def _find_crossings(
    family: Family,
    x: Float[np.ndarray, " n_v"],
    modal: Modal,
    columns: np.ndarray,
    branch: int,
    motions: tuple[str, ...],
) -> list[FlutterCrossing]:
    growth = np.real(modal.values[np.arange(x.size), columns])
    entries = np.flatnonzero((growth[:-1] < 0.0) & (growth[1:] >= 0.0))
    exits = np.flatnonzero((growth[:-1] >= 0.0) & (growth[1:] < 0.0))
    found = []
    for k in entries.tolist():
        at = _refine_crossing(family, x, modal, k)
        states = family(np.array([at]))
        there = decompose_states(states.A)
        root = _find_axis_root(there)
        frequency = float(np.imag(there.values[0, root]))
        later = exits[exits > k]
        recovery = _refine_crossing(family, x, modal, int(later[0])) if later.size else None
        shares = compute_participation(there, 0, states.membership)[:, root].tolist()
        participation = dict(zip(motions, shares, strict=True))
        mechanism = _classify(max(motions, key=participation.__getitem__), frequency)
        found.append(
            FlutterCrossing(at, max(frequency, 0.0), mechanism, branch, participation, recovery)
        )
    return found


def _classify(motion: str, frequency: float) -> Mechanism:
    """Classify an instability by the motion that dominates it, and its frequency. [rad/s]"""
    if motion == PHUGOID:
        return Mechanism.PHUGOID
    if frequency > STATIC_ROOT_RAD_S:
        return Mechanism.FLUTTER
    return Mechanism.SPIRAL if motion == SPIRAL else Mechanism.DIVERGENCE


def _refine_crossing(family: Family, x: Float[np.ndarray, " n_v"], modal: Modal, k: int) -> float:
    """Place between x[k] and x[k + 1] at which the number of unstable roots changes.

    Real parts in order of size are continuous.
    """
    unstable = np.count_nonzero(np.real(modal.values[k : k + 2]) >= 0.0, axis=1)
    place = int(unstable.min())
    low, high = float(x[k]), float(x[k + 1])
    growth = functools.partial(_compute_growth, family=family, place=place)
    if growth(low) * growth(high) > 0.0:  # one root becomes unstable as another becomes stable
        return 0.5 * (low + high)
    return float(brentq(growth, low, high, xtol=1e-10 * high, rtol=1e-14))


def _compute_growth(x: float, family: Family, place: int) -> float:
    """Compute the real part of a root, counted from the largest."""
    A = family(np.array([x])).A[0]
    return float(np.sort(np.real(np.linalg.eigvals(A)))[::-1][place])


def _find_axis_root(there: Modal) -> int:
    """The root nearest the imaginary axis; of a pair, the one above the real axis."""
    values = there.values[0]
    below = np.imag(values) < -STATIC_ROOT_RAD_S
    return int(np.argmin(np.where(below, np.inf, np.abs(np.real(values)))))


# --- Flutter of a frequency shape by rational functions: a second method beside p-k ---------------

AGREEMENT = 0.003
"""Of the flutter speed, within which both methods agree: 0.02 % for 16 to 80 strips of FLEX-28U."""

_REACHES = (0.005, 0.02, 0.1)  # of the airspeed, to either side: the search for the crossing


def find_rational_crossing(
    aircraft: Aeroelastic, crossing: FlutterCrossing, density: float
) -> tuple[float, float] | None:
    """Find the flutter speed of the state matrix with lag states near a p-k crossing.

    Parameters
    ----------
    aircraft
        With a frequency shape.
    crossing
        Of the p-k method.
    density
        Of the air. [kg/m3]

    Returns
    -------
    tuple
        Airspeed [m/s] and frequency [rad/s]; None if no root crosses the axis within 10 % of the
        airspeed.

    Notes
    -----
    The root nearest to the crossing, with the trim of the known condition as in the p-k method;
    lags as in ``fit_rational_functions``.
    """
    assert aircraft.shape is not None
    table, body = aircraft.derivatives, aircraft.derivatives.body
    shape = aircraft.shape.select(table.modes, table.inputs)
    sensors = SensorRows((), np.zeros((4, 0, body.size + len(table.modes))))

    def compute_root(airspeed: float) -> complex:
        condition = replace(aircraft.condition, airspeed=airspeed, density=density)
        model = AeroelasticModel(condition, aircraft.modes, table.inputs, sensors, body, shape)
        roots = np.linalg.eigvals(model.state_space(table).A)
        return complex(roots[np.argmin(np.abs(roots - 1j * crossing.frequency))])

    for reach in _REACHES:
        low, high = crossing.airspeed * (1.0 - reach), crossing.airspeed * (1.0 + reach)
        if compute_root(low).real < 0.0 <= compute_root(high).real:
            at = float(brentq(lambda V: compute_root(V).real, low, high, xtol=1e-6 * high))
            return at, compute_root(at).imag
    return None
