"""Normal washes of the motions and surfaces, and the forces of a pressure, on half the aircraft.

Notes
-----
A box that moves with velocity v sees the wash w/V = -(v . N)/V; a slope of the surface adds its
own. Every column is the response to a *real* wash (of surfaces with a rate: 1 + ik times a
real one), so that a column at k = 0 is the steady derivative, and has no 1/k at alpha. The
complex modal column of other codes is C_eta + i k C_etadot; heave (up) -(i k/b) C_alpha, pitch
C_alpha + i k C_q, with b = cbar/2.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Complex, Float

from flexsid.errors import BadInput
from flexsid.sysid.aerodynamics.boxes import Boxes
from flexsid.sysid.aerodynamics.influence import Symmetry


@dataclass(frozen=True, slots=True, eq=False)
class Reference:
    """Reference area, chord cbar and span of the coefficients, and the c.g. (X aft, Y, Z up)."""

    area: float
    chord: float
    span: float
    cg: Float[np.ndarray, "3"]

    def __post_init__(self) -> None:
        """Refuse sizes that are not positive, and a c.g. that is not a place."""
        if not all(np.isfinite(v) and v > 0 for v in (self.area, self.chord, self.span)):
            raise BadInput("reference area, chord and span must be positive", code="bad-reference")
        if not np.isfinite(self.cg).all():
            raise BadInput("the c.g. of the reference is not a number", code="bad-reference")


@dataclass(frozen=True, slots=True, eq=False)
class BoxShapes:
    """Mode shapes on the boxes, along the normal of each box, per unit eta.

    ``control`` is the displacement at control points, ``slope`` its derivative along X there, and
    ``load`` the displacement at load points [length, 1, length].
    """

    control: Float[np.ndarray, "n_modes n"]
    slope: Float[np.ndarray, "n_modes n"]
    load: Float[np.ndarray, "n_modes n"]

    def __post_init__(self) -> None:
        """Refuse shapes that are not numbers."""
        for name in ("control", "slope", "load"):
            wrong = np.argwhere(~np.isfinite(getattr(self, name)))
            if wrong.size:
                mode, box = wrong[0] + 1
                raise BadInput(
                    f"the shape of mode {mode} at box {box} is not a number", code="bad-shapes"
                )

    def select(self, modes: Sequence[int]) -> BoxShapes:
        """Return the modes at these indices."""
        index = list(modes)
        return BoxShapes(self.control[index], self.slope[index], self.load[index])


@dataclass(frozen=True, slots=True, eq=False)
class ControlSurface:
    """Boxes that turn about a hinge, trailing edge down +.

    ``boxes`` are those behind the hinge; ``hinge`` is X of the hinge line at mid-span of each
    strip. ``hinge_fraction`` and ``span_range`` are the geometry after snapping to edges of boxes.
    """

    name: str
    boxes: Bool[np.ndarray, " n"]
    hinge: Float[np.ndarray, " n"]
    hinge_fraction: float
    span_range: tuple[float, float]


def place_surface(
    boxes: Boxes, name: str, span_range: tuple[float, float], hinge_fraction: float
) -> ControlSurface:
    """Select the boxes of a control surface from its range of Y and its hinge line.

    Parameters
    ----------
    boxes
        Of half the aircraft.
    name
        Of the surface.
    span_range
        Y of its inboard and outboard end; the strips with mid-span between them [length].
    hinge_fraction
        Hinge line as fraction of the local chord; the nearest edge of boxes is used.

    Raises
    ------
    BadInput
        If no strip lies in the range, no box behind the hinge, or a number is missing.
    """
    if not np.isfinite([*span_range, hinge_fraction]).all():
        raise BadInput(
            f"the span or the hinge of surface {name} is not a number",
            code="bad-surface",
            surface=name,
        )
    y = boxes.control[:, 1]
    # Winglets stand in one Y: their boxes do not belong to surfaces of the wing.
    inside = (y > span_range[0]) & (y < span_range[1]) & (np.abs(boxes.normal[:, 2]) > 0.5)
    behind = np.zeros(len(boxes), dtype=bool)
    hinge = np.zeros(len(boxes))
    fractions, ends = [], []
    for strip in np.unique(boxes.strip[inside]):
        index = np.flatnonzero(boxes.strip == strip)
        leading = boxes.corners[index][:, [0, 3], 0].mean(axis=1)
        trailing = leading + boxes.chord[index]
        chord = trailing[-1] - leading[0]
        edges = (leading - leading[0]) / chord
        first = int(np.argmin(np.abs(np.append(edges, 1.0) - hinge_fraction)))
        if first == edges.size:
            continue
        behind[index[first:]] = True
        hinge[index[first:]] = leading[first]
        fractions.append(edges[first])
        ends += [boxes.corners[index, 0, 1].min(), boxes.corners[index, 3, 1].max()]
    if not fractions:
        raise BadInput(
            f"surface {name} contains no box: its span {span_range} or hinge {hinge_fraction} "
            "lies outside the planform, or is smaller than a box",
            code="empty-surface",
            surface=name,
        )
    snapped = (float(min(ends)), float(max(ends)))
    return ControlSurface(name, behind, hinge, float(np.mean(fractions)), snapped)


@dataclass(frozen=True, slots=True, eq=False)
class Washes:
    """Columns of w/V: ``steady + i k rate``; names in the order of the columns."""

    names: tuple[str, ...]
    steady: Float[np.ndarray, "n n_columns"]
    rate: Float[np.ndarray, "n n_columns"]

    def at(self, k: float) -> Complex[np.ndarray, "n n_columns"]:
        """Return the washes at a reduced frequency."""
        return self.steady + 1j * k * self.rate


RIGID_MOTIONS = {
    Symmetry.SYMMETRIC: ("alpha", "q"),
    Symmetry.ANTISYMMETRIC: ("beta", "p", "r"),
}
RIGID_FORCES = {
    Symmetry.SYMMETRIC: ("CZ", "Cm"),
    Symmetry.ANTISYMMETRIC: ("CY", "Cl", "Cn"),
}


def define_washes(
    boxes: Boxes,
    shapes: BoxShapes,
    surfaces: Sequence[ControlSurface],
    reference: Reference,
    symmetry: Symmetry,
) -> Washes:
    """Define the normal washes of rigid motion, modes and surfaces.

    Columns: alpha, q cbar/2V (or beta, p b/2V, r b/2V), eta, etadot cbar/2V, delta. Rates p, q
    and r are those of body axes (x forward, z down) at the c.g.
    """
    N = boxes.normal
    x, y, z = (boxes.control - reference.cg).T
    b = 0.5 * reference.chord
    if symmetry is Symmetry.ANTISYMMETRIC:
        half = 0.5 * reference.span
        rigid = [-N[:, 1], (y * N[:, 2] - z * N[:, 1]) / half, x * N[:, 1] / half]
    else:
        rigid = [N[:, 2], x * N[:, 2] / b]
    count = range(1, shapes.control.shape[0] + 1)
    names = [
        *RIGID_MOTIONS.get(symmetry, RIGID_MOTIONS[Symmetry.SYMMETRIC]),
        *(f"eta{i}" for i in count),
        *(f"etadot{i}" for i in count),
        *(surface.name for surface in surfaces),
    ]
    steady = np.stack(
        [
            *rigid,
            *-shapes.slope,
            *-shapes.control / b,
            *(surface.boxes.astype(float) for surface in surfaces),
        ],
        axis=1,
    )
    rate = np.zeros_like(steady)
    for column, surface in enumerate(surfaces, start=len(names) - len(surfaces)):
        rate[:, column] = np.where(surface.boxes, (boxes.control[:, 0] - surface.hinge) / b, 0.0)
    return Washes(tuple(names), steady, rate)


def define_forces(
    boxes: Boxes, shapes: BoxShapes, reference: Reference, symmetry: Symmetry
) -> tuple[tuple[str, ...], Float[np.ndarray, "n_rows n"]]:
    """Define the rows which give C_Z, C_m (or C_Y, C_l, C_n) and C_Q from c_p of the boxes.

    Notes
    -----
    Body axes: C_Z down +, C_m nose up +, C_Y right +, C_l right wing down +, C_n nose right +,
    moments about the c.g. divided by S cbar (C_m) or S b (C_l, C_n); Q_i = qbar S cbar C_Qi.
    """
    N = boxes.normal
    x, y, z = (boxes.load - reference.cg).T
    if symmetry is Symmetry.ANTISYMMETRIC:
        b = reference.span
        rigid = [N[:, 1], (z * N[:, 1] - y * N[:, 2]) / b, -x * N[:, 1] / b]
    else:
        rigid = [-N[:, 2], -x * N[:, 2] / reference.chord]
    names = [
        *RIGID_FORCES.get(symmetry, RIGID_FORCES[Symmetry.SYMMETRIC]),
        *(f"CQ{i}" for i in range(1, shapes.load.shape[0] + 1)),
    ]
    rows = np.stack([*rigid, *shapes.load / reference.chord])
    return tuple(names), symmetry.sides / reference.area * rows * boxes.area
