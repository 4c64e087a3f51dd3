"""Symmetry of modes from their shapes."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float, Int
from scipy.spatial import cKDTree

_MIRROR = np.array([1.0, -1.0, 1.0])
_CLAMPED = 1e-3  # of the largest motion: less in the plane is none
_PLANE_RATIO = 25.0  # least ratio of mean squares of the motions within and across the plane
_LEAST_DEGREE = 0.6  # of symmetry, 1 is perfect: least of a symmetric or antisymmetric mode


def find_symmetry(
    nodes: Float[np.ndarray, "n_nodes 3"],
    translation: Float[np.ndarray, "n_modes n_nodes 3"],
) -> tuple[bool | None, ...]:
    """Compare each shape with its own mirror image about the plane of symmetry.

    True for each symmetric mode, False for antisymmetric ones; None where the shape is
    neither, or no node that moves has a counterpart. Of a half model, which begins at the plane
    y = 0, it is the motion of the nodes in that plane: within it, or across it; None if they are
    clamped.

    Parameters
    ----------
    nodes
        With y to the right or to the left; the plane is y = const, zero where that has
        most counterparts. [m]
    translation
        Per unit eta. [m]
    """
    pairs = _find_pairs(nodes)
    n_modes = translation.shape[0]
    if not pairs.size:
        return _find_half_symmetry(nodes, translation)
    shape, mirrored = (
        np.take(translation, pairs[:, side], axis=1).reshape(n_modes, -1) for side in (0, 1)
    )
    # Of two sides one may move alone: the mean of both makes that neither, not symmetric.
    squares = (np.einsum("ij,ij->i", one, one) for one in (shape, mirrored))
    norms = 0.5 * np.add(*squares)
    mirrored *= np.tile(_MIRROR, pairs.shape[0])
    product = np.einsum("ij,ij->i", shape, mirrored)
    degree = np.divide(product, norms, out=np.full(norms.shape, np.nan), where=norms > 0)
    known = np.abs(degree) >= _LEAST_DEGREE
    return tuple(bool(one > 0) if sure else None for one, sure in zip(degree, known, strict=True))


def _find_half_symmetry(
    nodes: Float[np.ndarray, "n_nodes 3"],
    translation: Float[np.ndarray, "n_modes n_nodes 3"],
) -> tuple[bool | None, ...]:
    """Compare the motion in the plane y = 0 of a half model with that across it."""
    n_modes = translation.shape[0]
    size = float(np.linalg.norm(np.ptp(nodes, axis=0))) if nodes.size else 0.0
    root = np.abs(nodes[:, 1]) <= 0.01 * size
    if not root.any():
        return (None,) * n_modes
    squares = np.square(translation[:, root]).sum(axis=1)
    across, within = squares[:, 1], squares[:, 0] + squares[:, 2]
    least = _CLAMPED**2 * int(root.sum()) * np.square(translation).sum(axis=2).max(axis=1)
    return tuple(
        None if max(a, b) <= c or _PLANE_RATIO * min(a, b) > max(a, b) else bool(b > a)
        for a, b, c in zip(across, within, least, strict=True)
    )


def _find_pairs(nodes: Float[np.ndarray, "n_nodes 3"]) -> Int[np.ndarray, "n_pairs 2"]:
    """Nodes and their counterparts; a node in the plane is its own."""
    empty = np.empty((0, 2), dtype=np.intp)
    if nodes.shape[0] == 0:
        return empty
    low, high = nodes[:, 1].min(), nodes[:, 1].max()
    tolerance = 0.01 * float(np.linalg.norm(np.ptp(nodes, axis=0)))
    best = empty
    if max(low, -high) >= -tolerance:  # a half model, though a wing may mirror itself
        return empty
    for plane in (0.0, 0.5 * (low + high)):
        image = nodes * _MIRROR + np.array([0.0, 2.0 * plane, 0.0])
        found = cKDTree(nodes).query(image)
        distance, place = np.asarray(found[0]), np.asarray(found[1])
        near = np.flatnonzero(distance <= tolerance)
        apart = np.abs(nodes[near, 1] - plane) > tolerance
        if not apart.any():  # a half model mirrors nothing but its own root
            continue
        if near.size > best.shape[0]:
            best = np.column_stack([near, place[near]]).astype(np.intp)
    return best
