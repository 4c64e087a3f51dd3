"""Flutter: roots followed over airspeed, and where one of them loses its damping."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from jaxtyping import Complex, Float
from scipy.optimize import brentq, linear_sum_assignment

from flexsid.sysid.stability.speeds import Aeroelastic, Modal, decompose, state_family

_STILL = 1e-3  # rad/s: a root slower than this neither oscillates nor diverges in a maneuver


class Mechanism(StrEnum):
    """What happens where a root becomes unstable."""

    FLUTTER = "flutter"
    DIVERGENCE = "divergence"


@dataclass(frozen=True, slots=True)
class Crossing:
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
    """Roots over airspeed; a column is one root followed by its shape.

    Of complex pairs the root above the real axis is kept; where a pair has become two real
    roots, the less stable of them. ``names`` are the motions that
    dominate the roots at the lowest speed.
    """

    airspeed: Float[np.ndarray, " n_v"]
    roots: Complex[np.ndarray, "n_v n_branches"]
    names: tuple[str, ...]
    crossings: tuple[Crossing, ...]

    @property
    def flutter(self) -> Crossing | None:
        """The first crossing, of whatever mechanism."""
        return self.crossings[0] if self.crossings else None

    def damping(self) -> Float[np.ndarray, "n_v n_branches"]:
        """Damping ratios; negative where unstable. [1]"""
        size = np.abs(self.roots)
        return -np.real(self.roots) / np.where(size > 0.0, size, 1.0)


def follow_roots(
    aircraft: Aeroelastic,
    airspeed: Float[np.ndarray, " n_v"],
    density: float | None = None,
) -> RootLocus:
    """Follow all roots over rising airspeeds and find their crossings exactly.

    Parameters
    ----------
    aircraft
        Derivatives on a structure.
    airspeed
        Rising, close enough that shapes change little from one to the next. [m/s]
    density
        Of the air; that of the known condition by default. [kg/m3]

    Notes
    -----
    Roots of neighbouring speeds belong together by the modal assurance of left with right
    vectors; the assignment is optimal over all. A crossing is refined between two speeds
    by Brent's method on the real parts.
    """
    V = np.asarray(airspeed, dtype=float)
    modal = decompose(state_family(aircraft, V, density))
    order = _followed(modal)
    values = np.take_along_axis(modal.values, order, axis=1)
    upper, branch_of = _pairs(values)
    names = _names(aircraft, modal, order[0, upper])
    crossings: list[Crossing] = []
    for column, branch in enumerate(branch_of):
        crossings += _crossings(aircraft, V, density, modal, order[:, column], int(branch))
    # Both roots of a pair tell of the same crossing.
    once = {(c.branch, round(c.airspeed / V[-1], 8)): c for c in crossings}
    found = tuple(sorted(once.values(), key=lambda crossing: crossing.airspeed))
    return RootLocus(V, _weaker(values, upper, branch_of), names, found)


def participation(modal: Modal, at: int, root: int, motions: tuple[str, ...]) -> dict[str, float]:
    """Share of every motion in a root: left times right vector, states of a motion added."""
    share = np.abs(modal.left[at, :, root] * modal.right[at, :, root])
    n = len(motions) - 1
    parts = [share[:2].sum(), *(share[2 + k] + share[2 + n + k] for k in range(n))]
    total = float(sum(parts))
    return {name: float(part) / total for name, part in zip(motions, parts, strict=True)}


def _followed(modal: Modal) -> np.ndarray:
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


def _pairs(values: Complex[np.ndarray, "n_v n_x"]) -> tuple[np.ndarray, np.ndarray]:
    """One column of every pair, that above the real axis, and the branch of every column."""
    height = np.imag(values).sum(axis=0)
    lone = np.abs(np.imag(values)).max(axis=0) < _STILL
    upper = np.flatnonzero((height > 0.0) | lone)
    branch_of = np.empty(values.shape[1], dtype=int)
    branch_of[upper] = np.arange(upper.size)
    for column in np.flatnonzero((height <= 0.0) & ~lone):
        distance = np.abs(values[:, upper].conj() - values[:, [column]]).min(axis=0)
        branch_of[column] = int(np.argmin(distance))
    return upper, branch_of


def _weaker(
    values: Complex[np.ndarray, "n_v n_x"], upper: np.ndarray, branch_of: np.ndarray
) -> Complex[np.ndarray, "n_v n_branches"]:
    roots = values[:, upper].copy()
    for column, branch in enumerate(branch_of):
        other = values[:, column]
        real = np.maximum(np.abs(np.imag(other)), np.abs(np.imag(roots[:, branch]))) < _STILL
        worse = real & (np.real(other) > np.real(roots[:, branch]))
        roots[worse, branch] = other[worse]
    return roots


def _names(aircraft: Aeroelastic, modal: Modal, roots: np.ndarray) -> tuple[str, ...]:
    shares = [participation(modal, 0, int(root), aircraft.motions) for root in roots]
    table = np.array([list(share.values()) for share in shares])
    named = [max(share, key=share.__getitem__) for share in shares]
    rows, columns = linear_sum_assignment(-table)
    for row, column in zip(rows, columns, strict=True):
        named[row] = aircraft.motions[column]
    return tuple(named)


def _crossings(
    aircraft: Aeroelastic,
    V: Float[np.ndarray, " n_v"],
    density: float | None,
    modal: Modal,
    columns: np.ndarray,
    branch: int,
) -> list[Crossing]:
    growth = np.real(modal.values[np.arange(V.size), columns])
    entries = np.flatnonzero((growth[:-1] < 0.0) & (growth[1:] >= 0.0))
    exits = np.flatnonzero((growth[:-1] >= 0.0) & (growth[1:] < 0.0))
    found = []
    for k in entries.tolist():
        speed = _refined(aircraft, V, density, modal, k)
        there = decompose(state_family(aircraft, np.array([speed]), density))
        root = _on_the_axis(there)
        frequency = float(np.imag(there.values[0, root]))
        later = exits[exits > k]
        recovery = _refined(aircraft, V, density, modal, int(later[0])) if later.size else None
        mechanism = Mechanism.FLUTTER if frequency > _STILL else Mechanism.DIVERGENCE
        shares = participation(there, 0, root, aircraft.motions)
        found.append(Crossing(speed, max(frequency, 0.0), mechanism, branch, shares, recovery))
    return found


def _refined(
    aircraft: Aeroelastic,
    V: Float[np.ndarray, " n_v"],
    density: float | None,
    modal: Modal,
    k: int,
) -> float:
    """Airspeed between V[k] and V[k + 1] at which the number of unstable roots changes.

    Real parts in order of size are continuous, whatever the roots do to each other.
    """
    unstable = np.count_nonzero(np.real(modal.values[k : k + 2]) >= 0.0, axis=1)
    place = int(unstable.min())

    def growth(speed: float) -> float:
        A = state_family(aircraft, np.array([speed]), density).A[0]
        return float(np.sort(np.real(np.linalg.eigvals(A)))[::-1][place])

    low, high = float(V[k]), float(V[k + 1])
    if growth(low) * growth(high) > 0.0:  # one root comes as another goes
        return 0.5 * (low + high)
    return float(brentq(growth, low, high, xtol=1e-10 * high, rtol=1e-14))


def _on_the_axis(there: Modal) -> int:
    """The root nearest the imaginary axis; of a pair, the one above the real axis."""
    values = there.values[0]
    below = np.imag(values) < -_STILL
    return int(np.argmin(np.where(below, np.inf, np.abs(np.real(values)))))
