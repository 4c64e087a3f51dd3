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

    Of complex pairs the root above the real axis is kept. ``names`` are the motions that
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
    by Brent's method on the root that continues the branch.
    """
    V = np.asarray(airspeed, dtype=float)
    modal = decompose(state_family(aircraft, V, density))
    order = _followed(modal)
    values = np.take_along_axis(modal.values, order, axis=1)
    upper = _upper_branches(values)
    names = _names(aircraft, modal, order[0, upper])
    crossings: list[Crossing] = []
    for branch, column in enumerate(upper):
        crossings += _crossings(aircraft, V, density, modal, order[:, column], branch)
    crossings.sort(key=lambda crossing: crossing.airspeed)
    return RootLocus(V, values[:, upper], names, tuple(crossings))


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


def _upper_branches(values: Complex[np.ndarray, "n_v n_x"]) -> np.ndarray:
    """One branch of every pair: those that lie above the real axis, and lone real ones."""
    height = np.imag(values).sum(axis=0)
    real = np.abs(np.imag(values)).max(axis=0) < _STILL
    return np.flatnonzero((height > 0.0) | real)


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
    for k in entries:
        column = int(columns[k])
        speed = _refined(aircraft, V, density, modal, int(k), column)
        there = decompose(state_family(aircraft, np.array([speed]), density))
        root = _continued(there, modal.left[k, :, column], modal.values[k, column])
        frequency = abs(float(np.imag(there.values[0, root])))
        later = exits[exits > k]
        recovery = None
        if later.size:
            m = int(later[0])
            recovery = _refined(aircraft, V, density, modal, m, int(columns[m]))
        mechanism = Mechanism.FLUTTER if frequency > _STILL else Mechanism.DIVERGENCE
        shares = participation(there, 0, root, aircraft.motions)
        found.append(Crossing(speed, frequency, mechanism, branch, shares, recovery))
    return found


def _refined(
    aircraft: Aeroelastic,
    V: Float[np.ndarray, " n_v"],
    density: float | None,
    modal: Modal,
    k: int,
    column: int,
) -> float:
    left, start = modal.left[k, :, column], modal.values[k, column]

    def growth(speed: float) -> float:
        there = decompose(state_family(aircraft, np.array([speed]), density))
        return float(np.real(there.values[0, _continued(there, left, start)]))

    low, high = float(V[k]), float(V[k + 1])
    if growth(low) * growth(high) > 0.0:  # the shape turns within the step: halve by value alone
        return 0.5 * (low + high)
    return float(brentq(growth, low, high, xtol=1e-10 * high, rtol=1e-14))


def _continued(there: Modal, left: np.ndarray, value: complex) -> int:
    """The root that continues a branch."""
    assurance = np.minimum(np.abs(left.conj() @ there.right[0]), 1.0)
    reach = np.abs(there.values[0] - value) / np.abs(there.values[0]).max()
    return int(np.argmin(reach - assurance))
