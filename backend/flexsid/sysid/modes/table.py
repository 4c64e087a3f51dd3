"""ModeTable: structural modes against fuel, aligned so that they can be interpolated."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool, Float
from scipy.interpolate import CubicHermiteSpline

from flexsid.sysid.interpolation import interpolate
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
    weights = CubicHermiteSpline(fuel, unit, slopes)(at)
    return {row: float(weight) for row, weight in enumerate(weights) if weight != 0.0}


def sum_weighted_rows(
    weights: dict[int, float], values: Float[np.ndarray, "n_fuel *shape"]
) -> Float[np.ndarray, "*shape"]:
    """Sum the rows of a table with the weights of ``compute_fuel_weights``."""
    rows = list(weights)
    return np.tensordot(np.array([weights[row] for row in rows]), values[rows], axes=1)
