"""Nodes that show a shape, and connections between them."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float, Int
from scipy.spatial import cKDTree

_NEIGHBOURS = 4  # of a node, that it is joined with
_FAR = 2.5  # times the usual distance: a longer connection is omitted


def select_spread_nodes(
    nodes: Float[np.ndarray, "n_nodes 3"], count: int
) -> Int[np.ndarray, " n_shown"]:
    """Select at most ``count`` nodes [m] that lie as far apart as possible; rows, increasing.

    The first is the one farthest from the middle, each further one the farthest from all
    selected, so that tips and edges come first.
    """
    n = nodes.shape[0]
    if n <= count:
        return np.arange(n)
    x, y, z = np.ascontiguousarray((nodes - nodes.mean(axis=0)).T.astype(np.float32))
    gap = x * x + y * y + z * z
    selected = np.empty(count, dtype=np.intp)
    for index in range(count):
        farthest = selected[index] = np.argmax(gap)
        distance = (x - x[farthest]) ** 2 + (y - y[farthest]) ** 2 + (z - z[farthest]) ** 2
        gap = distance if index == 0 else np.minimum(gap, distance)
    return np.sort(selected)


def connect_neighbours(nodes: Float[np.ndarray, "n_nodes 3"]) -> Int[np.ndarray, "n_lines 2"]:
    """Join each node with its nearest neighbours, where a source has no connections of its own.

    Returns
    -------
    array
        Pairs of rows, each once; connections much longer than is usual are omitted.
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


def contract_lines(
    nodes: Float[np.ndarray, "n_nodes 3"],
    lines: Int[np.ndarray, "n_lines 2"],
    shown: Int[np.ndarray, " n_shown"],
) -> Int[np.ndarray, "n_contracted 2"]:
    """Contract lines between nodes to the nodes that are shown.

    Every node is moved to the nearest one shown, so that a coarse mesh has the outline of the
    fine one.

    Returns
    -------
    array
        Pairs of rows of ``shown``, each once.
    """
    nearest = np.asarray(cKDTree(nodes[shown]).query(nodes)[1])
    pairs = np.sort(nearest[lines], axis=1)
    return np.unique(pairs[pairs[:, 0] != pairs[:, 1]], axis=0).astype(np.intp)
