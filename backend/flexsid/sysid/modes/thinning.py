"""Nodes that are enough to see a shape by, and lines between them."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float, Int
from scipy.spatial import cKDTree

_NEIGHBOURS = 4
_FAR = 2.5


def spread_nodes(nodes: Float[np.ndarray, "n_nodes 3"], count: int) -> Int[np.ndarray, " n_shown"]:
    """Choose nodes that lie as far apart from each other as possible.

    Parameters
    ----------
    nodes
        All of them. [m]
    count
        How many to keep at most.

    Returns
    -------
    array
        Rows, increasing. The first is the one farthest from the middle, each further one the
        farthest from all chosen, so that tips and edges come first.
    """
    n = nodes.shape[0]
    if n <= count:
        return np.arange(n)
    x, y, z = np.ascontiguousarray((nodes - nodes.mean(axis=0)).T.astype(np.float32))
    gap = x * x + y * y + z * z
    chosen = np.empty(count, dtype=np.intp)
    for place in range(count):
        farthest = chosen[place] = np.argmax(gap)
        distance = (x - x[farthest]) ** 2 + (y - y[farthest]) ** 2 + (z - z[farthest]) ** 2
        gap = distance if place == 0 else np.minimum(gap, distance)
    return np.sort(chosen)


def neighbour_lines(nodes: Float[np.ndarray, "n_nodes 3"]) -> Int[np.ndarray, "n_lines 2"]:
    """Join each node with its nearest neighbours, where a source has no lines of its own.

    Returns
    -------
    array
        Pairs of rows, each once; lines much longer than is usual are left out.
    """
    n = nodes.shape[0]
    k = min(_NEIGHBOURS, n - 1)
    if k < 1:
        return np.empty((0, 2), dtype=np.intp)
    found = cKDTree(nodes).query(nodes, k=k + 1)
    distance, near = np.asarray(found[0])[:, 1:], np.asarray(found[1])[:, 1:]
    usual = float(np.median(distance[:, 0]))
    close = distance <= max(_FAR * usual, float(np.median(distance)) * _FAR)
    start = np.repeat(np.arange(n), k).reshape(n, k)[close]
    pairs = np.sort(np.stack([start, near[close]], axis=1), axis=1)
    return np.unique(pairs[pairs[:, 0] != pairs[:, 1]], axis=0).astype(np.intp)
