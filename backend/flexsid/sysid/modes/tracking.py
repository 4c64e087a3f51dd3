"""Follow modes and their signs over fuel, through crossings."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import numpy as np
from jaxtyping import Bool, Float, Int, Num
from scipy.optimize import linear_sum_assignment

from flexsid.sysid.modes.assurance import modal_assurance

DOUBTFUL = 0.7
"""Below this MAC from one fuel weight to the next a mode is not the same beyond doubt."""

_ALIKE, _WHOLE = 0.8, 0.95


@dataclass(frozen=True, slots=True, eq=False)
class Tracking:
    """Where each mode of the first fuel weight stands at the others.

    ``order[k, i]`` is the place of mode i in row k of the table, ``sign[k, i]`` what
    its shape is to be multiplied by; ``assurance[k, i]`` is its MAC with the same mode
    at the fuel weight before (1 in the first row). ``mixed[k, i]`` marks a shape that the
    solver has mixed with another at a crossing: its neighbours tell the mode better.
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
    def doubtful(self) -> tuple[tuple[int, int], ...]:
        """Row and mode where what follows may be another mode."""
        lost = (self.assurance < DOUBTFUL) & ~self.mixed
        return tuple((int(k), int(i)) for k, i in np.argwhere(lost))


@dataclass(frozen=True, slots=True)
class ModeCrossing:
    """Two modes, by their place in the first row, with one frequency at one fuel. [rad/s]"""

    fuel: float
    modes: tuple[int, int]
    omega: float


def untracked(n_fuel: int, n_modes: int) -> Tracking:
    """The order of the table itself, where there are no shapes to follow."""
    order = np.tile(np.arange(n_modes), (n_fuel, 1))
    ones = np.ones(order.shape)
    return Tracking(order, ones.copy(), ones, np.zeros(order.shape, dtype=bool))


def track(
    shapes: Float[np.ndarray, "n_fuel n_modes n_dof"], omega: Float[np.ndarray, "n_fuel n_modes"]
) -> Tracking:
    """Follow modes from each fuel weight to the next by their shapes.

    Modes may cross in frequency and a solver is free to flip any sign, so neighbouring
    fuel weights are matched by the modal assurance criterion before anything is
    interpolated. Where a crossing falls on a fuel weight of the table the solver may have
    mixed the two shapes there; such a row is matched with those before it, and the next
    row with the last one that was followed beyond doubt.

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
    tracking = untracked(n_fuel, n_modes)
    sure = shapes[0].copy()  # each mode as last seen beyond doubt
    last = omega[0].copy()
    for row in range(1, n_fuel):
        alike = modal_assurance(sure, shapes[row])
        distance = np.abs(np.log((omega[row] + 1e-9) / (last[:, None] + 1e-9)))
        order = linear_sum_assignment(-alike + 0.05 * np.minimum(distance, 1.0))[1]
        followed = shapes[row, order]
        assurance = alike[np.arange(n_modes), order]
        sign = np.where(np.sum(sure * followed, axis=1) < 0, -1.0, 1.0)
        tracking.order[row], tracking.sign[row] = order, sign
        tracking.assurance[row] = assurance
        clear = assurance >= _ALIKE
        if not clear.all():
            mixed = _mixed(sure, followed, clear)
            tracking.mixed[row] = mixed
            clear |= ~mixed
        sure[clear] = (sign[:, None] * followed)[clear]
        last = omega[row, order]
    return tracking


def _mixed(
    sure: Float[np.ndarray, "n_modes n_dof"],
    followed: Float[np.ndarray, "n_modes n_dof"],
    clear: Bool[np.ndarray, " n_modes"],
) -> Bool[np.ndarray, " n_modes"]:
    """Modes whose shape stands, in parts, in several shapes of the next row."""
    basis = np.linalg.svd(followed[~clear], full_matrices=False)[2]
    size = np.sum(sure**2, axis=1)
    inside = np.sum((sure @ basis.T) ** 2, axis=1)
    return ~clear & (inside >= _WHOLE * size) & (size > 0)


def crossings(
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
