"""Interpolation of mode shapes from structural nodes to boxes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from flexsid.errors import BadInput
from flexsid.sysid.aerodynamics.boxes import Boxes
from flexsid.sysid.aerodynamics.normal_washes import BoxShapes
from flexsid.sysid.interpolation import interpolate

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
