"""Aerodynamic coefficients as functions of reduced frequency."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float
from scipy.interpolate import CubicSpline

from flexsid.errors import BadInput
from flexsid.sysid.aerodynamics.boxes import Boxes
from flexsid.sysid.aerodynamics.doublet_lattice import Symmetry, compute_influence
from flexsid.sysid.aerodynamics.splines import (
    BoxShapes,
    ControlSurface,
    Reference,
    define_forces,
    define_washes,
)

REDUCED_FREQUENCIES = np.array(
    [
        *(0.0, 0.01, 0.03, 0.06, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4),
        *(0.5, 0.65, 0.8, 1.0, 1.25, 1.5, 1.75, 2.0),
    ]
)
"""k at which coefficients are computed unless others are given; splines between."""


@dataclass(frozen=True, slots=True, eq=False)
class UnsteadyCoefficients:
    """Complex derivatives C_rv(k): row r is a force, column v a motion or surface.

    C_r = sum_v C_rv(k) x_v with x = [alpha, q cbar/2V, eta, etadot cbar/2V, delta] (rates p and
    r: b/2V); ``k`` rises from 0, k = omega cbar/2V.
    """

    k: Float[np.ndarray, " n_k"]
    rows: tuple[str, ...]
    columns: tuple[str, ...]
    values: Complex[np.ndarray, "n_k n_rows n_columns"]

    def at(self, k: float | Float[np.ndarray, " n"]) -> Complex[np.ndarray, "*n n_rows n_columns"]:
        """Interpolate by cubic splines over k.

        Raises
        ------
        BadInput
            Beyond the highest k computed.
        """
        highest = float(np.max(k))
        if highest > self.k[-1] * (1.0 + 1e-12):
            raise BadInput(
                f"k = {highest:.3g} is beyond {self.k[-1]:.3g}, the highest k computed",
                code="frequency-out-of-range",
            )
        return np.asarray(CubicSpline(self.k, self.values, axis=0)(k))

    def column(self, name: str) -> int:
        """Index of a column."""
        return self.columns.index(name)


NOT_PREDICTED = {
    ("Cl", "beta"): "sweep and wing position at the trim lift",
    ("Cl", "r"): "trim lift",
    ("Cn", "p"): "trim lift and leading-edge suction",
    ("CY", "p"): "trim lift and leading-edge suction",
}
"""Derivatives of which a flat lattice lacks the main part, and what it lacks.

Nor does it have a drag: C_X is no row at all. The lattice's own part of these, from dihedral,
winglets and fins alone, is not small by chance but incomplete."""


def compute_coefficients(
    boxes: Boxes,
    shapes: BoxShapes,
    surfaces: Sequence[ControlSurface],
    reference: Reference,
    *,
    mach: float,
    symmetry: Symmetry,
    k: Float[np.ndarray, " n_k"] = REDUCED_FREQUENCIES,
    report_progress: Callable[[float], None] = lambda fraction: None,
) -> UnsteadyCoefficients:
    """Compute C(k) = R A(k)^-1 W of half the aircraft; one influence matrix at a time.

    Parameters
    ----------
    boxes, shapes, surfaces
        The right half (whole aircraft for ``Symmetry.NONE``).
    reference
        Sizes that make the coefficients nondimensional, and the c.g.
    mach
        Of the whole table.
    symmetry
        Of the motion.
    k
        Reduced frequencies omega cbar/2V, rising from 0.
    report_progress
        Receives the fraction that is done.

    Raises
    ------
    BadInput
        If the frequencies do not rise from 0, or shapes and boxes differ in number.
    """
    return compute_loadings(
        boxes,
        [(shapes, reference)],
        surfaces,
        mach=mach,
        symmetry=symmetry,
        k=k,
        report_progress=report_progress,
    )[0]


def compute_loadings(
    boxes: Boxes,
    loadings: Sequence[tuple[BoxShapes, Reference]],
    surfaces: Sequence[ControlSurface],
    *,
    mach: float,
    symmetry: Symmetry,
    k: Float[np.ndarray, " n_k"] = REDUCED_FREQUENCIES,
    report_progress: Callable[[float], None] = lambda fraction: None,
) -> list[UnsteadyCoefficients]:
    """Compute C(k) of several loadings with the influence matrices of one mesh.

    Mode shapes and c.g. differ with the fuel weight, the reference chord does not; parameters
    and errors otherwise as ``compute_coefficients``.
    """
    if k.size == 0 or k[0] != 0.0 or not (np.diff(k) > 0.0).all():
        raise BadInput("reduced frequencies must rise from 0", code="bad-frequency")
    if any(shapes.control.shape[1] != len(boxes) for shapes, _ in loadings):
        raise BadInput("mode shapes and boxes differ in number", code="bad-shapes")
    chord = loadings[0][1].chord
    if any(reference.chord != chord for _, reference in loadings):
        raise BadInput("loadings must have one reference chord", code="bad-reference")
    every = [
        (
            define_washes(boxes, shapes, surfaces, reference, symmetry),
            define_forces(boxes, shapes, reference, symmetry),
        )
        for shapes, reference in loadings
    ]
    values = [
        np.empty((k.size, len(rows), len(washes.names)), dtype=complex)
        for washes, (rows, _) in every
    ]
    for index, one in enumerate(k):
        A = compute_influence(boxes, mach, one / (0.5 * chord), symmetry)
        columns = np.concatenate([washes.at(one) for washes, _ in every], axis=1)
        pressure = np.split(np.linalg.solve(A, columns), len(every), axis=1)
        for own, (_, (_, forces)), p in zip(values, every, pressure, strict=True):
            own[index] = forces @ p
        report_progress((index + 1) / k.size)
    return [
        UnsteadyCoefficients(k, rows, washes.names, own)
        for own, (washes, (rows, _)) in zip(values, every, strict=True)
    ]


def compute_pressures(
    boxes: Boxes,
    shapes: BoxShapes,
    surfaces: Sequence[ControlSurface],
    reference: Reference,
    *,
    mach: float,
    symmetry: Symmetry,
    k: float,
) -> Complex[np.ndarray, "n_columns n"]:
    """Compute the pressure differences c_p = A(k)^-1 W of each column on the boxes.

    Columns are those of ``define_washes``, each per unit of its variable; parameters as in
    ``compute_coefficients``.
    """
    washes = define_washes(boxes, shapes, surfaces, reference, symmetry)
    A = compute_influence(boxes, mach, k / (0.5 * reference.chord), symmetry)
    return np.linalg.solve(A, washes.at(k)).T.astype(complex)


def tabulate_derivatives(
    coefficients: UnsteadyCoefficients, k: float
) -> tuple[tuple[str, ...], Float[np.ndarray, "n_rows n_columns"]]:
    """Tabulate the derivatives of a quasi-steady model at a reduced frequency.

    Returns
    -------
    names
        Of the columns: those of the coefficients, then ``alphadot`` (of antisymmetric motion
        ``betadot``), per alphadot cbar/2V.
    derivatives
        Rigid motions and surfaces: Re C; eta: Re(C_eta + i k C_etadot); etadot: Im of that over
        k; alphadot: Im C_alpha/k. At k = 0 the limits: of alphadot, and of the part of
        etadot from C_eta, the slope of the spline. NaN marks what is ``NOT_PREDICTED``.
    """
    at = coefficients.at(k)
    slope = CubicSpline(coefficients.k, coefficients.values, axis=0)(0.0, 1)
    lag = np.imag(at) / k if k > 0.0 else np.imag(slope)
    table = np.real(at).copy()
    for column, name in enumerate(coefficients.columns):
        if name.startswith("etadot"):
            eta = coefficients.column(f"eta{name.removeprefix('etadot')}")
            table[:, column] += lag[:, eta]
            table[:, eta] -= k * np.imag(at[:, column])
    for row, column in NOT_PREDICTED:
        if row in coefficients.rows and column in coefficients.columns:
            table[coefficients.rows.index(row), coefficients.column(column)] = np.nan
    first = coefficients.columns[0]
    return (*coefficients.columns, f"{first}dot"), np.column_stack([table, lag[:, 0]])
