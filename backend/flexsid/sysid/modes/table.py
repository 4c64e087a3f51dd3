"""ModeTable: structural modes against fuel, aligned so that they can be interpolated."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy.optimize import linear_sum_assignment

from flexsid.sysid.modes.shapes import StructuralModes


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
        """Interpolate linearly in fuel; beyond the table the end values hold."""
        shape = interpolate(self.fuel, self.shape, fuel)
        return StructuralModes(
            numbers=self.numbers,
            omega=interpolate(self.fuel, self.omega, fuel),
            zeta=interpolate(self.fuel, self.zeta, fuel),
            mass=interpolate(self.fuel, self.mass, fuel),
            points=self.points,
            translation=np.moveaxis(shape[..., :3], 0, -1),
            rotation=np.moveaxis(shape[..., 3:], 0, -1),
            gauges=self.gauges,
            strain=interpolate(self.fuel, self.strain, fuel).T,
        )


def align_modes(table: ModeTable) -> ModeTable:
    """Track modes and their signs from one fuel weight to the next.

    Modes may cross in frequency and a solver is free to flip any sign, so
    neighbouring fuel weights are matched by the modal assurance criterion of
    their translations before anything is interpolated. The first fuel weight
    names the modes.

    Notes
    -----
    Source: design notes on tables against fuel; the assignment is the optimal
    one (Hungarian method) rather than the greedy maximum.
    """
    n_fuel, n_modes = table.omega.shape
    if not table.points:
        return table
    arrays = {name: getattr(table, name).copy() for name in ("omega", "zeta", "mass", "shape")}
    strain = table.strain.copy()
    vectors = arrays["shape"][..., :3].reshape(n_fuel, n_modes, -1)
    for row in range(1, n_fuel):
        before = vectors[row - 1]
        product = before @ vectors[row].T
        norms = np.outer((before**2).sum(1), (vectors[row] ** 2).sum(1))
        assurance = np.divide(product**2, norms, out=np.zeros_like(norms), where=norms > 0)
        order = linear_sum_assignment(-assurance)[1]
        sign = np.where(product[np.arange(n_modes), order] < 0, -1.0, 1.0)
        for array in arrays.values():
            array[row] = array[row, order]
        arrays["shape"][row] *= sign[:, None, None]
        strain[row] = strain[row, order] * sign[:, None]
        vectors[row] = arrays["shape"][row, ..., :3].reshape(n_modes, -1)
    return ModeTable(
        fuel=table.fuel,
        numbers=table.numbers,
        points=table.points,
        gauges=table.gauges,
        strain=strain,
        **arrays,
    )


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
