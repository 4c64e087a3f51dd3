"""ModeTable: structural modes against fuel, aligned so that they can be interpolated."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool, Float

from flexsid.sysid.modes.shapes import StructuralModes
from flexsid.sysid.modes.tracking import Tracking, make_identity_tracking, track_modes


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


def track_table_modes(table: ModeTable) -> Tracking:
    """Track the modes of a table by their shapes at its sensor points."""
    n_fuel, n_modes = table.omega.shape
    if not table.points:
        return make_identity_tracking(n_fuel, n_modes)
    return track_modes(table.shape[..., :3].reshape(n_fuel, n_modes, -1), table.omega)


def align_modes(table: ModeTable, tracking: Tracking | None = None) -> ModeTable:
    """Sort modes and their signs into the order of the first fuel weight, which names them.

    Parameters
    ----------
    table
        In the order of its source, usually by frequency.
    tracking
        Found from more points than the table has; by default from its own.
    """
    tracking = track_table_modes(table) if tracking is None else tracking
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

    A cubic in each interval whose slopes are those of the parabolas through three
    neighbouring rows: at most four rows count, which lets large tables be read in part.
    Two rows make a straight line; beyond the ends the end rows hold.

    Parameters
    ----------
    fuel
        Increasing.
    at
        Where to read. [1]
    without
        Rows to pass over; all count where all are marked.
    """
    if without is not None and without.any() and not without.all():
        rows = np.flatnonzero(~without)
        return {int(rows[k]): weight for k, weight in compute_fuel_weights(fuel[rows], at).items()}
    n = fuel.size
    if n == 1 or at <= fuel[0]:
        return {0: 1.0}
    if at >= fuel[-1]:
        return {n - 1: 1.0}
    upper = int(np.searchsorted(fuel, at, side="right"))
    low = upper - 1
    step = float(fuel[upper] - fuel[low])
    t = (at - float(fuel[low])) / step
    weights = {low: (1 + 2 * t) * (1 - t) ** 2, upper: t * t * (3 - 2 * t)}
    for row, factor in ((low, t * (1 - t) ** 2), (upper, t * t * (t - 1))):
        for place, slope in _slope(fuel, row).items():
            weights[place] = weights.get(place, 0.0) + step * factor * slope
    return {row: float(weight) for row, weight in weights.items() if weight != 0.0}


def sum_weighted_rows(
    weights: dict[int, float], values: Float[np.ndarray, "n_fuel *shape"]
) -> Float[np.ndarray, "*shape"]:
    """Sum the rows of a table with the weights of ``compute_fuel_weights``."""
    rows = list(weights)
    return np.tensordot(np.array([weights[row] for row in rows]), values[rows], axes=1)


def _slope(fuel: Float[np.ndarray, " n_fuel"], row: int) -> dict[int, float]:
    """Weights of neighbouring rows in the slope of the parabola through three of them."""
    first = int(np.clip(row - 1, 0, max(0, fuel.size - 3)))
    places = range(first, min(first + 3, fuel.size))
    slope: dict[int, float] = {}
    for i in places:  # derivative of each Lagrange polynomial at the row
        others = [j for j in places if j != i]
        divisor = np.prod([fuel[i] - fuel[j] for j in others])
        total = sum(np.prod([fuel[row] - fuel[j] for j in others if j != left]) for left in others)
        slope[i] = float(total / divisor)
    return slope


def interpolate(
    fuel: Float[np.ndarray, " n_fuel"], values: Float[np.ndarray, "n_fuel *shape"], at: float
) -> Float[np.ndarray, "*shape"]:
    """Interpolate the rows of a table linearly; beyond its ends the end rows hold."""
    if fuel.size == 1:
        return values[0]
    upper = int(np.clip(np.searchsorted(fuel, at), 1, fuel.size - 1))
    low, high = fuel[upper - 1], fuel[upper]
    weight = float(np.clip((at - low) / (high - low), 0.0, 1.0))
    return (1.0 - weight) * values[upper - 1] + weight * values[upper]
