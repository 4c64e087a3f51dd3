"""ModeTable: structural modes against fuel, tracked and aligned, to be interpolated."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
import scipy
from jaxtyping import Bool, Float, Int, Num

from flexsid.sysid.modes.assurance import compute_mac
from flexsid.sysid.modes.shapes import StructuralModes
from flexsid.sysid.signals import interpolate

# --- Mode tracking over fuel: modes and their signs, through crossings ----------------------------

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
        order = scipy.optimize.linear_sum_assignment(-alike + 0.05 * np.minimum(distance, 1.0))[1]
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


# --- ModeTable: structural modes against fuel, aligned so that they can be interpolated -----------


@dataclass(frozen=True, slots=True)
class ModeTable:
    """Modes at several fuel fractions; axis 0 is fuel, axis 1 the mode.

    ``shape`` holds translation and rotation of each point, (F, n, P, 6).
    """

    fuel: Float[np.ndarray, " n_fuel"]
    numbers: tuple[int, ...]
    omega: Float[np.ndarray, "n_fuel n_modes"]
    zeta: Float[np.ndarray, "n_fuel n_modes"]
    mass: Float[np.ndarray, "n_fuel n_modes"]
    points: tuple[str, ...]
    shape: Float[np.ndarray, "n_fuel n_modes n_points 6"]
    gauges: tuple[str, ...]
    strain: Float[np.ndarray, "n_fuel n_modes n_gauges"]

    def at(self, fuel: float) -> StructuralModes:
        """Interpolate in fuel, once modes are aligned; outside the table the end values apply."""
        weights = compute_fuel_weights(self.fuel, fuel)
        shape = sum_weighted_rows(weights, self.shape)
        return StructuralModes(
            numbers=self.numbers,
            omega=sum_weighted_rows(weights, self.omega),
            # Damping is measured, at few fuel weights and with scatter: straight lines.
            zeta=interpolate(self.fuel, self.zeta, fuel),
            mass=interpolate(self.fuel, self.mass, fuel),
            points=self.points,
            translation=np.moveaxis(shape[..., :3], 0, -1),
            rotation=np.moveaxis(shape[..., 3:], 0, -1),
            gauges=self.gauges,
            strain=sum_weighted_rows(weights, self.strain).T,
        )


def align_modes(table: ModeTable, tracking: Tracking | None = None) -> ModeTable:
    """Sort modes and their signs into the order of the first fuel weight, which names them.

    The tracking may be of more points than the table has; by default it is of its own.
    """
    if tracking is None:
        n_fuel, n_modes = table.omega.shape
        tracking = make_identity_tracking(n_fuel, n_modes)
        if table.points:
            shapes = table.shape[..., :3].reshape(n_fuel, n_modes, -1)
            tracking = track_modes(shapes, table.omega)
    return replace(
        table,
        omega=tracking.sort(table.omega),
        zeta=tracking.sort(table.zeta),
        mass=tracking.sort(table.mass),
        shape=_interpolate_mixed(table.fuel, tracking, tracking.align(table.shape)),
        strain=_interpolate_mixed(table.fuel, tracking, tracking.align(table.strain)),
    )


def _interpolate_mixed(
    fuel: Float[np.ndarray, " n_fuel"],
    tracking: Tracking,
    aligned: Float[np.ndarray, "n_fuel n_modes *rest"],
) -> Float[np.ndarray, "n_fuel n_modes *rest"]:
    """Replace shapes that the solver has mixed by interpolation between the neighbours."""
    for row, mode in np.argwhere(tracking.mixed):
        weights = compute_fuel_weights(fuel, float(fuel[row]), tracking.mixed[:, mode])
        aligned[row, mode] = sum(weight * aligned[k, mode] for k, weight in weights.items())
    return aligned


def compute_fuel_weights(
    fuel: Float[np.ndarray, " n_fuel"],
    at: float,
    without: Bool[np.ndarray, " n_fuel"] | None = None,
) -> dict[int, float]:
    """Rows of a table, and their weights, that make up its values at a fuel fraction.

    A cubic Hermite spline whose slopes are those of the parabolas through three
    neighbouring rows: at most four rows count, which lets large tables be read in part.
    Two rows make a straight line; beyond the ends the end rows hold.

    ``fuel`` is increasing; rows ``without`` are passed over, unless all are.
    """
    if without is not None and without.any() and not without.all():
        rows = np.flatnonzero(~without)
        return {int(rows[k]): weight for k, weight in compute_fuel_weights(fuel[rows], at).items()}
    n = fuel.size
    if n == 1 or at <= fuel[0]:
        return {0: 1.0}
    if at >= fuel[-1]:
        return {n - 1: 1.0}
    unit = np.eye(n)
    slopes = np.gradient(unit, fuel, axis=0, edge_order=2 if n > 2 else 1)
    weights = scipy.interpolate.CubicHermiteSpline(fuel, unit, slopes)(at)
    return {row: float(weight) for row, weight in enumerate(weights) if weight != 0.0}


def sum_weighted_rows(
    weights: dict[int, float], values: Float[np.ndarray, "n_fuel *shape"]
) -> Float[np.ndarray, "*shape"]:
    """Sum the rows of a table with the weights of ``compute_fuel_weights``."""
    rows = list(weights)
    return np.tensordot(np.array([weights[row] for row in rows]), values[rows], axes=1)
