"""Normal washes of motions and surfaces, forces of a pressure, and mode shapes at boxes.

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
from flexsid.sysid.aerodynamics.doublet_lattice import Symmetry
from flexsid.sysid.signals import interpolate

# --- Normal washes of the motions and surfaces, and the forces of a pressure, on half the aircraft


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


# --- Interpolation of mode shapes from structural nodes to boxes ----------------------------------

LINE_RATIO = 0.02  # smaller over larger extent of the nodes: below, they lie in a line
PLANE_TOLERANCE = 0.02  # of the planform: distance of nodes from the plane of their boxes
ARM_RATIO = 0.5  # length of a rigid arm over the mean chord of the surface


@dataclass(frozen=True, slots=True, eq=False)
class SplinedSurface:
    """Boxes of one plane that follow some nodes of the structure.

    ``places`` are the nodes (X aft, Y right, Z up); ``translation`` and ``rotation`` their motion
    in each mode, per unit eta, in the same axes [length, rad].
    """

    boxes: Bool[np.ndarray, " n"]
    places: Float[np.ndarray, "n_nodes 3"]
    translation: Float[np.ndarray, "n_modes n_nodes 3"]
    rotation: Float[np.ndarray, "n_modes n_nodes 3"] | None = None


@dataclass(frozen=True, slots=True, eq=False)
class BeamSurface:
    """Boxes on rigid ribs of a beam, whose nodes are given in order along ``axis``.

    Fields are those of ``SplinedSurface``; ``axis`` is X, Y or Z (0, 1, 2), along which motion is
    interpolated linearly.
    """

    boxes: Bool[np.ndarray, " n"]
    places: Float[np.ndarray, "n_nodes 3"]
    translation: Float[np.ndarray, "n_modes n_nodes 3"]
    rotation: Float[np.ndarray, "n_modes n_nodes 3"]
    axis: int

    def motion(
        self, at: Float[np.ndarray, "n 3"]
    ) -> tuple[Float[np.ndarray, "n_modes n 3"], Float[np.ndarray, "n_modes n 3"]]:
        """Displacement and rotation of points on the ribs; the ends of the beam are rigid."""
        place = interpolate(self.places[:, self.axis], self.places, at[:, self.axis])
        d, turn = (
            np.moveaxis(
                interpolate(self.places[:, self.axis], np.moveaxis(v, 1, 0), at[:, self.axis]), 0, 1
            )
            for v in (self.translation, self.rotation)
        )
        arm = at - place
        return d + np.cross(turn, np.broadcast_to(arm, turn.shape)), turn


def select_nodes(
    boxes: Boxes, nodes: Float[np.ndarray, "n_nodes 3"]
) -> list[tuple[Bool[np.ndarray, " n"], np.ndarray]]:
    """Select the nodes that the boxes of each plane follow.

    Parameters
    ----------
    boxes
        Of the right half; boxes of one plane are splined together.
    nodes
        Of the structure (X aft, Y right, Z up); those of the left side are not used.

    Returns
    -------
    list
        Boxes and indices of nodes of each plane: nodes within ``PLANE_TOLERANCE`` of the largest
        extent of the planform from the plane, and from the span of its boxes.

    Raises
    ------
    BadInput
        If a plane has fewer than three nodes.
    """
    tolerance = PLANE_TOLERANCE * float(np.ptp(boxes.corners.reshape(-1, 3), axis=0).max())
    left = np.ones(len(boxes), dtype=bool)
    found: list[tuple[Bool[np.ndarray, " n"], np.ndarray]] = []
    while left.any():
        first = int(np.argmax(left))
        normal, place = boxes.normal[first], boxes.control[first]
        along = np.array([0.0, normal[2], -normal[1]])
        inside = left & (np.abs(boxes.normal @ normal) > 1.0 - 1e-9)
        inside &= np.abs((boxes.control - place) @ normal) <= 1e-6 + 0.1 * tolerance
        ends = boxes.corners[inside].reshape(-1, 3) @ along
        spread = nodes @ along
        near = np.abs((nodes - place) @ normal) <= tolerance
        near &= (spread >= ends.min() - tolerance) & (spread <= ends.max() + tolerance)
        near &= nodes[:, 1] >= -1e-6
        own = np.flatnonzero(near)
        if own.size < 3:
            panel = int(boxes.panel[first]) + 1
            raise BadInput(
                f"the plane of panel {panel} has {own.size} nodes of the modal table near it; "
                "expected at least three, in the axes of the table (X aft, Y right, Z up)",
                code="no-nodes",
                panel=panel,
            )
        found.append((inside, own))
        left &= ~inside
    return found


def interpolate_shapes(boxes: Boxes, surfaces: Sequence[SplinedSurface | BeamSurface]) -> BoxShapes:
    """Interpolate mode shapes to all boxes, surface by surface.

    Parameters
    ----------
    boxes
        Boxes, each of which belongs to one of the surfaces.
    surfaces
        Boxes and nodes of each plane. Nodes in a line need rotations: rigid arms along X are
        added to them. Beams with rigid ribs are interpolated along their nodes.

    Raises
    ------
    BadInput
        If a box belongs to no surface or to several, boxes of a surface do not lie in one plane,
        nodes determine no plane, or their places or motion are not numbers.
    """
    for number, surface in enumerate(surfaces, start=1):
        _check_nodes(surface, number)
    count = np.sum([surface.boxes for surface in surfaces], axis=0)
    if not (np.asarray(count) == 1).all() or np.shape(count) != (len(boxes),):
        raise BadInput("every box must belong to exactly one splined surface", code="bad-splines")
    n_modes = surfaces[0].translation.shape[0]
    control, slope, load = (np.empty((n_modes, len(boxes))) for _ in range(3))
    for surface in surfaces:
        index = np.flatnonzero(surface.boxes)
        normals = boxes.normal[index]
        if isinstance(surface, BeamSurface):
            d, turn = surface.motion(boxes.control[index])
            control[:, index] = (d * normals).sum(axis=2)
            # turn x e_x = (0, turn_z, -turn_y)
            slope[:, index] = turn[..., 2] * normals[:, 1] - turn[..., 1] * normals[:, 2]
            load[:, index] = (surface.motion(boxes.load[index])[0] * normals).sum(axis=2)
            continue
        normal = normals[0]
        side = normals @ normal  # panels of one plane may have opposite normals
        if np.abs(np.abs(side) - 1.0).max() > 1e-9:
            raise BadInput("boxes of a splined surface must lie in one plane", code="bad-splines")
        chord = boxes.corners[index, :, 0]
        arm = ARM_RATIO * _mean_chord(boxes, index, chord)
        places, values = _add_rigid_arms(surface, normal, arm)
        plane = np.array([[1.0, 0.0, 0.0], [0.0, normal[2], -normal[1]]])
        weights = _fit_thin_plate(places @ plane.T, values.T)
        nodes = places @ plane.T
        at, along = _evaluate_thin_plate(nodes, weights, boxes.control[index] @ plane.T)
        control[:, index], slope[:, index] = side * at.T, side * along.T
        at = _evaluate_thin_plate(nodes, weights, boxes.load[index] @ plane.T)[0]
        load[:, index] = side * at.T
    return BoxShapes(control, slope, load)


def _check_nodes(surface: SplinedSurface | BeamSurface, number: int) -> None:
    parts = {"place": surface.places, "translation": surface.translation}
    if surface.rotation is not None:
        parts["rotation"] = surface.rotation
    for what, values in parts.items():
        wrong = np.argwhere(~np.isfinite(values))
        if wrong.size:
            raise BadInput(
                f"the {what} of node {wrong[0][-2] + 1} of splined surface {number} is not a "
                "number",
                code="bad-splines",
            )


def _mean_chord(boxes: Boxes, index: np.ndarray, x: Float[np.ndarray, "n 4"]) -> float:
    strips = boxes.strip[index]
    return float(np.mean([np.ptp(x[strips == strip].mean(axis=1)) for strip in np.unique(strips)]))


def _add_rigid_arms(
    surface: SplinedSurface, normal: Float[np.ndarray, "3"], arm: float
) -> tuple[Float[np.ndarray, "n 3"], Float[np.ndarray, "n_modes n"]]:
    """Nodes and normal displacements; with ends of arms along X if the nodes lie in a line."""
    places = surface.places
    values = surface.translation @ normal
    plane = places @ np.array([[1.0, 0.0, 0.0], [0.0, normal[2], -normal[1]]]).T
    extent = np.linalg.svd(plane - plane.mean(axis=0), compute_uv=False)
    if plane.shape[0] > 2 and extent[1] > LINE_RATIO * extent[0]:
        return places, values
    if surface.rotation is None:
        raise BadInput(
            "the nodes of a splined surface lie in a line, and their rotations are not given",
            code="nodes-in-line",
        )
    ends, moved = [places], [values]
    for length in (-arm, arm):
        reach = np.array([length, 0.0, 0.0])
        ends.append(places + reach)
        moved.append(values + np.cross(surface.rotation, reach) @ normal)
    return np.concatenate(ends), np.concatenate(moved, axis=1)


def _fit_thin_plate(
    nodes: Float[np.ndarray, "n 2"], values: Float[np.ndarray, "n n_modes"]
) -> Float[np.ndarray, "m n_modes"]:
    """Weights of the infinite plate through the values (Harder and Desmarais, 1972).

    Notes
    -----
    w = a_0 + a_1 x + a_2 y + sum_i F_i r_i^2 ln r_i^2, with sum F = sum F x = sum F y = 0:
    J. Aircraft 9 (1972) 189-191, doi:10.2514/3.44330.
    """
    n = nodes.shape[0]
    linear = np.column_stack([np.ones(n), nodes - nodes.mean(axis=0)])
    system = np.zeros((n + 3, n + 3))
    system[:n, :n] = _plate_kernel(nodes[:, None] - nodes)[0]
    scale = max(float(np.abs(system).max()), 1.0)
    system[:n, n:], system[n:, :n] = scale * linear, scale * linear.T
    right = np.concatenate([values, np.zeros((3, values.shape[1]))])
    try:
        weights = np.linalg.solve(system, right)
    except np.linalg.LinAlgError as error:
        raise BadInput(
            "nodes of a splined surface coincide or lie in a line", code="bad-splines"
        ) from error
    error = np.abs(system @ weights - right).max()
    if not np.isfinite(weights).all() or error > 1e-6 * max(np.abs(values).max(), 1e-300):
        raise BadInput("nodes of a splined surface coincide or lie in a line", code="bad-splines")
    weights[n:] *= scale
    return weights


def _evaluate_thin_plate(
    nodes: Float[np.ndarray, "n 2"],
    weights: Float[np.ndarray, "m n_modes"],
    at: Float[np.ndarray, "p 2"],
) -> tuple[Float[np.ndarray, "p n_modes"], Float[np.ndarray, "p n_modes"]]:
    """Displacement, and its derivative along the first coordinate."""
    n = nodes.shape[0]
    kernel, along = _plate_kernel(at[:, None] - nodes)
    linear = np.column_stack([np.ones(at.shape[0]), at - nodes.mean(axis=0)])
    return kernel @ weights[:n] + linear @ weights[n:], along @ weights[:n] + weights[n + 1]


def _plate_kernel(
    apart: Float[np.ndarray, "p n 2"],
) -> tuple[Float[np.ndarray, "p n"], Float[np.ndarray, "p n"]]:
    square = np.einsum("pni,pni->pn", apart, apart)
    log = np.log(np.where(square > 0.0, square, 1.0))
    return square * log, 2.0 * apart[..., 0] * (log + 1.0)
