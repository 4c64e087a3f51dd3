"""A free beam along the span with its matrices, modes and files."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import linalg
from structural_files import Structure, print_eigenvalues, print_shapes, write_deck

_MODES = 4


@dataclass(frozen=True, slots=True, eq=False)
class Beam:
    """Matrices of a free beam by node and component 3 (up) and 4 (slope), and its elastic modes."""

    structure: Structure
    dofs: np.ndarray
    mass: np.ndarray
    stiffness: np.ndarray


def make_beam(n_nodes: int = 13) -> Beam:
    """Make a beam of 12 m with unit generalised masses of its modes."""
    y = np.linspace(-6.0, 6.0, n_nodes)
    step = float(y[1] - y[0])
    n = 2 * n_nodes
    K, M = np.zeros((n, n)), np.zeros((n, n))
    k = (
        4e4
        / step**3
        * np.array(
            [
                [12.0, 6 * step, -12.0, 6 * step],
                [6 * step, 4 * step**2, -6 * step, 2 * step**2],
                [-12.0, -6 * step, 12.0, -6 * step],
                [6 * step, 2 * step**2, -6 * step, 4 * step**2],
            ]
        )
    )
    m = (
        5.0
        * step
        / 420.0
        * np.array(
            [
                [156.0, 22 * step, 54.0, -13 * step],
                [22 * step, 4 * step**2, 13 * step, -3 * step**2],
                [54.0, 13 * step, 156.0, -22 * step],
                [-13 * step, -3 * step**2, -22 * step, 4 * step**2],
            ]
        )
    )
    for element in range(n_nodes - 1):
        own = slice(2 * element, 2 * element + 4)
        K[own, own] += k
        M[own, own] += m
    values, vectors = linalg.eigh(K, M)
    shape = np.zeros((_MODES, n_nodes, 6))
    for mode in range(_MODES):
        vector = vectors[:, mode + 2].reshape(n_nodes, 2)
        shape[mode, :, 2], shape[mode, :, 3] = vector.T
    ids = np.arange(1, n_nodes + 1) * 10
    return Beam(
        Structure(
            ids=ids,
            xyz=np.stack([np.zeros(n_nodes), y, np.zeros(n_nodes)], axis=1),
            omega=np.sqrt(values[2 : 2 + _MODES]),
            damping=np.full(_MODES, 0.01),
            mass=np.ones(_MODES),
            shape=shape,
        ),
        np.stack([np.repeat(ids, 2), np.tile([3, 4], n_nodes)], axis=1),
        M,
        K,
    )


def write_results(structure: Structure) -> tuple[bytes, bytes]:
    """Return deck and printout of a structure."""
    printed = print_eigenvalues(structure) + print_shapes(structure)
    return write_deck(structure).encode(), printed.encode()


def write_matrix_entries(
    name: str, matrix: np.ndarray, dofs: np.ndarray, *, form: int = 6, large: bool = True
) -> str:
    """Write a symmetric matrix as DMIG, one half of it."""
    text = f"DMIG    {name:8}{0:8d}{form:8d}{2:8d}{0:8d}\n"
    for column, (node, component) in enumerate(dofs.tolist()):
        rows = [row for row in range(column + 1) if matrix[row, column] != 0.0]
        if not rows:
            continue
        text += f"DMIG*   {name:16}{node:16d}{component:16d}\n" if large else ""
        terms = [(*dofs[row].tolist(), matrix[row, column]) for row in rows]
        if large:
            for to, part, value in terms:
                number = f"{value:.9E}".replace("E", "D")
                text += f"*       {to:16d}{part:16d}{number:>16}\n"
            continue
        groups = [f"{to},{part},{value:.16E}," for to, part, value in terms]
        text += f"DMIG,{name},{node},{component},,{groups[0]}\n"
        text += "".join(f",{','.join(groups[k : k + 2])}\n" for k in range(1, len(groups), 2))
    return text
