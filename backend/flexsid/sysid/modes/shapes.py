"""StructuralModes: the modes of one structure at one fuel weight, their symmetry and nodes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
import scipy
from jaxtyping import Bool, Float, Int

from flexsid.errors import BadInput

# --- StructuralModes: the modes of one structure at one fuel weight -------------------------------


@dataclass(frozen=True, slots=True)
class StructuralModes:
    """Frequency, damping, generalised mass and shapes at the sensor points.

    Translations [m] and rotations [rad] are per unit eta in body axes, strain
    is per unit eta; eta itself is nondimensional. Mode numbers are the FEM's.
    """

    numbers: tuple[int, ...]
    omega: Float[np.ndarray, " n_modes"]
    zeta: Float[np.ndarray, " n_modes"]
    mass: Float[np.ndarray, " n_modes"]
    points: tuple[str, ...]
    translation: Float[np.ndarray, "n_points 3 n_modes"]
    rotation: Float[np.ndarray, "n_points 3 n_modes"]
    gauges: tuple[str, ...]
    strain: Float[np.ndarray, "n_gauges n_modes"]

    def select(self, numbers: tuple[int, ...]) -> StructuralModes:
        """Return the modes with these numbers, in this order.

        Raises
        ------
        BadInput
            If a number is not in the table.
        """
        unknown = [number for number in numbers if number not in self.numbers]
        if unknown:
            raise BadInput(
                f"mode {unknown[0]} is not in the modal table, which has modes "
                f"{', '.join(map(str, self.numbers))}",
                code="unknown-mode",
                mode=unknown[0],
            )
        index = [self.numbers.index(number) for number in numbers]
        return replace(
            self,
            numbers=tuple(numbers),
            omega=self.omega[index],
            zeta=self.zeta[index],
            mass=self.mass[index],
            translation=self.translation[:, :, index],
            rotation=self.rotation[:, :, index],
            strain=self.strain[:, index],
        )

    def tuned(self, factors: Mapping[str, float]) -> StructuralModes:
        """The same modes with factors on frequency and damping, as ``omega_7`` and ``zeta_7``."""
        frequency = np.array([factors.get(f"omega_{number}", 1.0) for number in self.numbers])
        damping = np.array([factors.get(f"zeta_{number}", 1.0) for number in self.numbers])
        return replace(self, omega=self.omega * frequency, zeta=self.zeta * damping)


# --- Symmetry of modes from their shapes ----------------------------------------------------------

_MIRROR = np.array([1.0, -1.0, 1.0])
_CLAMPED = 1e-3  # of the largest motion: less in the plane is none
_PLANE_RATIO = 25.0  # least ratio of mean squares of the motions within and across the plane
_LEAST_DEGREE = 0.6  # of symmetry, 1 is perfect: least of a symmetric or antisymmetric mode
_SAME_PLACE = 0.01  # of the extent of the structure
_ODD_RATIO = 0.25  # most residual square of an odd motion over that of a clamped one
_ROOT_STATIONS = 4  # beside the plane of symmetry, that determine the slope


def may_be(known: bool | None, symmetric: bool) -> bool:
    """Whether a mode belongs to symmetric (else antisymmetric) motion; to both if not known."""
    return known is None or known == symmetric


def find_symmetry(
    nodes: Float[np.ndarray, "n_nodes 3"],
    translation: Float[np.ndarray, "n_modes n_nodes 3"],
) -> tuple[bool | None, ...]:
    """Compare each shape with its own mirror image about the plane of symmetry.

    True for each symmetric mode, False for antisymmetric ones; None where the shape is
    neither, or no node that moves has a counterpart. Of a half model, which begins at the plane
    y = 0, it is the motion of the nodes in that plane: within it, or across it, or a wing that
    turns about it; None if they are clamped.

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


def has_one_side(nodes: Float[np.ndarray, "n_nodes 3"]) -> bool:
    """Return whether all nodes are on one side of the plane y = 0, as those of a half model."""
    y = nodes[:, 1]
    extent = float(np.linalg.norm(np.ptp(nodes, axis=0)))
    return bool(max(y.min(), -y.max()) >= -_SAME_PLACE * extent)


def _find_half_symmetry(
    nodes: Float[np.ndarray, "n_nodes 3"],
    translation: Float[np.ndarray, "n_modes n_nodes 3"],
) -> tuple[bool | None, ...]:
    """Compare the motion in the plane y = 0 of a half model with that across it."""
    n_modes = translation.shape[0]
    size = float(np.linalg.norm(np.ptp(nodes, axis=0))) if nodes.size else 0.0
    root = np.abs(nodes[:, 1]) <= _SAME_PLACE * size
    if not root.any():
        return (None,) * n_modes
    squares = np.square(translation[:, root]).sum(axis=1)
    across, within = squares[:, 1], squares[:, 0] + squares[:, 2]
    least = _CLAMPED**2 * int(root.sum()) * np.square(translation).sum(axis=2).max(axis=1)
    turns = _turns_about_root(nodes, translation, root, size)
    return tuple(
        (False if turn else None)
        if max(a, b) <= c
        else (None if _PLANE_RATIO * min(a, b) > max(a, b) else bool(b > a))
        for a, b, c, turn in zip(across, within, least, turns, strict=True)
    )


def _turns_about_root(
    nodes: Float[np.ndarray, "n_nodes 3"],
    translation: Float[np.ndarray, "n_modes n_nodes 3"],
    root: Bool[np.ndarray, " n_nodes"],
    size: float,
) -> Bool[np.ndarray, " n_modes"]:
    """Return of which modes the motion x and z begins with a slope at the plane y = 0.

    Notes
    -----
    The bending of an antisymmetric mode is odd in y, that of a clamped wing has no slope: the
    motion of the nearest stations is fitted by ``a y + b y^3`` and by ``a y^2 + b y^3``, where a
    and b are linear in x. Twist begins with a slope in both; it is that of a turning root where
    another mode shows it.
    """
    none = np.zeros(translation.shape[0], dtype=bool)
    out = np.abs(nodes[:, 1])
    stations = np.unique(np.round(out[~root] / (0.001 * size)))[:_ROOT_STATIONS]
    if stations.size < _ROOT_STATIONS:
        return none
    near = ~root & (out <= (stations[-1] + 0.5) * 0.001 * size)
    y, x = out[near] / out[near].max(), (nodes[near, 0] - nodes[near, 0].mean()) / size
    motion = translation[:, near][:, :, [0, 2]].transpose(1, 0, 2).reshape(y.size, -1)

    def fit(*powers: int, chord: bool = True) -> np.ndarray:
        terms = np.stack([y**power for power in powers], axis=1)
        basis = np.concatenate([terms, terms * x[:, None]], axis=1) if chord else terms
        return basis @ np.linalg.lstsq(basis, motion, rcond=None)[0]

    odd, clamped, moved, bent = (
        np.square(part).reshape(y.size, -1, 2).sum(axis=(0, 2))
        for part in (
            *(motion - fit(1, 3), motion - fit(2, 3), motion),
            fit(1, 2, 3, chord=False),
        )
    )
    turns = (bent > 0.5 * moved) & (odd < _ODD_RATIO * clamped) & (clamped > _CLAMPED**2 * moved)
    return turns | (turns.any() & (bent <= 0.5 * moved))


def _find_pairs(nodes: Float[np.ndarray, "n_nodes 3"]) -> Int[np.ndarray, "n_pairs 2"]:
    """Nodes and their counterparts; a node in the plane is its own."""
    empty = np.empty((0, 2), dtype=np.intp)
    if nodes.shape[0] == 0:
        return empty
    low, high = nodes[:, 1].min(), nodes[:, 1].max()
    tolerance = _SAME_PLACE * float(np.linalg.norm(np.ptp(nodes, axis=0)))
    best = empty
    if has_one_side(nodes):  # though a wing may mirror itself
        return empty
    for plane in (0.0, 0.5 * (low + high)):
        image = nodes * _MIRROR + np.array([0.0, 2.0 * plane, 0.0])
        found = scipy.spatial.cKDTree(nodes).query(image)
        distance, place = np.asarray(found[0]), np.asarray(found[1])
        near = np.flatnonzero(distance <= tolerance)
        apart = np.abs(nodes[near, 1] - plane) > tolerance
        if not apart.any():  # a half model mirrors nothing but its own root
            continue
        if near.size > best.shape[0]:
            best = np.column_stack([near, place[near]]).astype(np.intp)
    return best


# --- Nodes that show a shape, and connections between them ----------------------------------------

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
    found = scipy.spatial.cKDTree(nodes).query(nodes, k=k + 1)
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
    nearest = np.asarray(scipy.spatial.cKDTree(nodes[shown]).query(nodes)[1])
    pairs = np.sort(nearest[lines], axis=1)
    return np.unique(pairs[pairs[:, 0] != pairs[:, 1]], axis=0).astype(np.intp)
