"""Mode tracking over fuel: modes and their signs, through crossings."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import numpy as np
from jaxtyping import Bool, Float, Int, Num
from scipy.optimize import linear_sum_assignment

from flexsid.sysid.modes.assurance import compute_mac

LOW_MAC = 0.7
"""Below this MAC from one fuel weight to the next the identity of a mode is not certain."""

_SAME_MAC = 0.8  # least MAC of a shape that becomes the reference for the next fuel weight
_MIXED_SHARE = 0.95  # of a shape, in the span of several shapes of the next row: mixed


@dataclass(frozen=True, slots=True, eq=False)
class Tracking:
    """Place of each mode of the first fuel weight at the others.

    ``order[k, i]`` is the place of mode i in row k of the table, ``sign[k, i]`` what
    its shape is to be multiplied by; ``assurance[k, i]`` is its MAC with the same mode
    at the fuel weight before (1 in the first row). ``mixed[k, i]`` marks a shape that the
    solver has mixed with another at a crossing: its neighbours give the mode better.
    """

    order: Int[np.ndarray, "n_fuel n_modes"]
    sign: Float[np.ndarray, "n_fuel n_modes"]
    assurance: Float[np.ndarray, "n_fuel n_modes"]
    mixed: Bool[np.ndarray, "n_fuel n_modes"]

    def sort(self, values: Num[np.ndarray, "n_fuel n_modes *rest"]) -> np.ndarray:
        """Bring rows of a table into the order of the first fuel weight."""
        return np.stack([row[order] for row, order in zip(values, self.order, strict=True)])

    def align(self, shapes: Num[np.ndarray, "n_fuel n_modes *rest"]) -> np.ndarray:
        """Bring shapes into the order and the signs of the first fuel weight."""
        sign = self.sign.reshape(*self.sign.shape, *(1,) * (shapes.ndim - 2))
        return self.sort(shapes) * sign.astype(shapes.dtype)

    @property
    def low_mac(self) -> tuple[tuple[int, int], ...]:
        """Row and mode with a MAC below ``LOW_MAC``: the next row may be another mode."""
        low = (self.assurance < LOW_MAC) & ~self.mixed
        return tuple((int(k), int(i)) for k, i in np.argwhere(low))


@dataclass(frozen=True, slots=True)
class ModeCrossing:
    """Two modes, by their place in the first row, with one frequency at one fuel. [rad/s]"""

    fuel: float
    modes: tuple[int, int]
    omega: float


def make_identity_tracking(n_fuel: int, n_modes: int) -> Tracking:
    """Tracking in the order of the table itself, for tables without shapes."""
    order = np.tile(np.arange(n_modes), (n_fuel, 1))
    ones = np.ones(order.shape)
    return Tracking(order, ones.copy(), ones, np.zeros(order.shape, dtype=bool))


def track_modes(
    shapes: Float[np.ndarray, "n_fuel n_modes n_dof"], omega: Float[np.ndarray, "n_fuel n_modes"]
) -> Tracking:
    """Track modes from each fuel weight to the next by their shapes.

    Modes may cross in frequency and a solver is free to flip any sign, so neighbouring
    fuel weights are matched by the modal assurance criterion before anything is
    interpolated. Where a crossing falls on a fuel weight of the table the solver may have
    mixed the two shapes there; such a row is matched with those before it, and the next
    row with the last one that was tracked with certainty.

    Parameters
    ----------
    shapes
        Translations (and what else is comparable) of each mode, one row per fuel weight.
    omega
        Frequencies; they decide between shapes that are equally alike. [rad/s]

    Notes
    -----
    The assignment is the optimal one (Hungarian method) rather than the greedy maximum.
    """
    n_fuel, n_modes = omega.shape
    tracking = make_identity_tracking(n_fuel, n_modes)
    reference = shapes[0].copy()  # each mode as last tracked with certainty
    last = omega[0].copy()
    for row in range(1, n_fuel):
        alike = compute_mac(reference, shapes[row])
        distance = np.abs(np.log((omega[row] + 1e-9) / (last[:, None] + 1e-9)))
        order = linear_sum_assignment(-alike + 0.05 * np.minimum(distance, 1.0))[1]
        followed = shapes[row, order]
        assurance = alike[np.arange(n_modes), order]
        sign = np.where(np.sum(reference * followed, axis=1) < 0, -1.0, 1.0)
        tracking.order[row], tracking.sign[row] = order, sign
        tracking.assurance[row] = assurance
        clear = assurance >= _SAME_MAC
        if not clear.all():
            mixed = _find_mixed(reference, followed, clear)
            tracking.mixed[row] = mixed
            clear |= ~mixed
        reference[clear] = (sign[:, None] * followed)[clear]
        last = omega[row, order]
    return tracking


def _find_mixed(
    reference: Float[np.ndarray, "n_modes n_dof"],
    followed: Float[np.ndarray, "n_modes n_dof"],
    clear: Bool[np.ndarray, " n_modes"],
) -> Bool[np.ndarray, " n_modes"]:
    """Modes whose shape stands, in parts, in several shapes of the next row."""
    basis = np.linalg.svd(followed[~clear], full_matrices=False)[2]
    size = np.sum(reference**2, axis=1)
    inside = np.sum((reference @ basis.T) ** 2, axis=1)
    return ~clear & (inside >= _MIXED_SHARE * size) & (size > 0)


def find_mode_crossings(
    fuel: Float[np.ndarray, " n_fuel"], omega: Float[np.ndarray, "n_fuel n_modes"]
) -> tuple[ModeCrossing, ...]:
    """Where tracked frequencies cross, by straight lines between fuel weights. [rad/s]"""
    found: list[ModeCrossing] = []
    for i, j in combinations(range(omega.shape[1]), 2):
        gap = omega[:, j] - omega[:, i]
        above = gap >= 0
        for row in np.flatnonzero(above[:-1] != above[1:]):
            share = gap[row] / (gap[row] - gap[row + 1])
            at = float(fuel[row] + share * (fuel[row + 1] - fuel[row]))
            height = float(omega[row, i] + share * (omega[row + 1, i] - omega[row, i]))
            found.append(ModeCrossing(at, (i, j), height))
    return tuple(sorted(found, key=lambda crossing: crossing.fuel))
