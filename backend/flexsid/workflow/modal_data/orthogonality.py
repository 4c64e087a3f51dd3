"""Orthogonality of mode shapes, and cross-orthogonality of two sources, over a mass matrix."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Annotated

import numpy as np
from scipy import sparse
from scipy.optimize import linear_sum_assignment
from scipy.spatial import cKDTree

from flexsid import units
from flexsid.allowed import Allowed, Axes, Id, LengthUnit, Share
from flexsid.errors import BadInput
from flexsid.importers.matrices import SymmetricMatrix, read_symmetric_matrix
from flexsid.importers.modal_data.nodes import join_frames
from flexsid.importers.modal_data.options import parse_axes
from flexsid.importers.source import Sources
from flexsid.records.modal_data import ModalKind, ModalTable, Orthogonality
from flexsid.records.run import Progress, ReportProgress
from flexsid.storage.store import Store
from flexsid.sysid.modes.assurance import compute_mass_orthogonality, reduce_statically
from flexsid.text import LONGEST_FIELD, check_line
from flexsid.workflow.modal_data.modal_tables import (
    TO_STRUCTURE,
    format_title,
    interpolate_shapes,
    list_mode_names,
    open_modes,
    read_nodes,
)

SAME_PLACE = 0.02
"""Largest distance of a measured point from its node, of the extent of the structure."""


Matrix = Annotated[str, Allowed(min_length=1, max_length=LONGEST_FIELD, check=check_line)]


@dataclass(frozen=True, slots=True, kw_only=True)
class OrthogonalityQuery:
    """Mass matrix of files, and the shapes that are compared over it.

    ``mass`` and ``stiffness`` are names of matrices in the files; the stiffness reduces the mass to
    the measured degrees of freedom. ``other_id`` is a second modal table, such as that of a test;
    by default the first is compared with itself. ``length_unit`` is that of the matrices, needed
    for rotations; ``axes`` as of ``ModalDataOptions``.
    """

    modal_table_id: Id
    mass: Matrix
    fuel: Share = 0.5
    other_id: Id | None = None
    other_fuel: Share | None = None
    stiffness: Matrix | None = None
    length_unit: LengthUnit | None = None
    axes: Axes = "aft right up"


@dataclass(slots=True, eq=False)
class _SourceShapes:
    """Shapes (n, K, 6) of a table in the axes and unit of the matrices; ``ids`` of the nodes."""

    table: ModalTable
    names: tuple[str, ...]
    ids: np.ndarray
    nodes: np.ndarray
    values: np.ndarray
    notes: list[str] = field(default_factory=list)


@dataclass(frozen=True, slots=True)
class OrthogonalityTask:
    """Contents of the files, and the shapes of one or two tables."""

    sources: Sources
    query: OrthogonalityQuery
    one: _SourceShapes
    other: _SourceShapes | None


@dataclass(frozen=True, slots=True, kw_only=True)
class OrthogonalityComputation:
    """Upload of the matrices, and what is compared over them."""

    upload_id: str
    query: OrthogonalityQuery


def list_compared_tables(store: Store, query: OrthogonalityQuery) -> tuple[ModalTable, ...]:
    """Check a query, and return the tables whose shapes are compared.

    Raises
    ------
    BadInput
        If the axes are no right-handed system.
    UnknownRecord
        If there is no such table.
    """
    parse_axes(query.axes)
    ids = (query.modal_table_id, *(() if query.other_id is None else (query.other_id,)))
    return tuple(map(store.modal_tables.get, ids))


def prepare_orthogonality(
    store: Store, sources: Sources, query: OrthogonalityQuery
) -> OrthogonalityTask:
    """Return a query with the shapes that are compared; ``sources`` are files of matrices."""
    other = None
    if query.other_id is not None:
        at = query.fuel if query.other_fuel is None else query.other_fuel
        other = _read_shapes(store, query.other_id, at)
    one = _read_shapes(store, query.modal_table_id, query.fuel)
    return OrthogonalityTask(sources, query, one, other)


def compute_orthogonality(
    task: OrthogonalityTask, report: ReportProgress = lambda progress: None
) -> Orthogonality:
    """Compute the orthogonality of shapes over a mass matrix of files.

    Parameters
    ----------
    task
        Files with the matrices, and what is compared. Degrees of freedom of the matrices
        are those of DMIG, or columns ``node`` and ``component`` of a table among the files; else
        three or six of every node of the table, node by node.
    report
        Receives the progress.

    Raises
    ------
    BadInput
        If a matrix is not real and symmetric, its degrees of freedom are not those of the shapes,
        degrees of freedom with mass are not measured and no stiffness is given, or a required
        unit is missing.
    """
    sources, query, one = task.sources, task.query, task.one
    report(Progress(fraction=0.1, message="Reading the matrices"))
    mass = read_symmetric_matrix(sources, query.mass)
    dofs = _find_dofs(mass, sources, one)
    if (dofs[:, 1] > 3).any() and query.length_unit is None:
        raise BadInput(
            "the unit of length of the matrices is not given; expected m, mm, in or ft, since they "
            "have rotations",
            code="unit-needed",
            field="length_unit",
        )
    compared = [one]
    if task.other is not None:
        compared.append(_locate(one, task.other))
    length = 1.0 if query.length_unit is None else units.factor(query.length_unit, "length")
    for shapes in compared:
        _transform(shapes, sources, length, query.axes)
    a, b = (_select(shapes, dofs) for shapes in (compared[0], compared[-1]))
    notes = [note for shapes in compared for note in shapes.notes]
    moving = np.abs(a).max(axis=0) > 0
    if task.other is not None:
        moving &= np.abs(b).max(axis=0) > 0
    retained = np.flatnonzero(moving)
    if not retained.size:
        raise BadInput(
            f"matrix {mass.name} has no degree of freedom at which {one.table.name} has a shape; "
            "check the numbers of the nodes",
            code="nothing-common",
        )
    report(Progress(fraction=0.4, message="Reducing the mass"))
    reduced, note = _reduce(sources, query, mass, retained, compared[-1].table)
    a, b = a[:, retained], b[:, retained]
    values = compute_mass_orthogonality(a, b, reduced)
    pairs = linear_sum_assignment(-np.abs(values))
    paired = np.zeros(values.shape, dtype=bool)
    paired[pairs] = True
    return Orthogonality(
        modal_table_id=query.modal_table_id,
        fuel=query.fuel,
        other_id=query.other_id,
        names=one.names,
        other_names=compared[-1].names,
        values=[list(map(float, row)) for row in values],
        worst=float(np.abs(values[~paired]).max(initial=0.0)),
        least_pair=float(np.abs(values[paired]).min()),
        n_dofs=int(retained.size),
        notes=(*notes, note),
    )


def _read_shapes(store: Store, modal_table_id: int, fuel: float) -> _SourceShapes:
    modes = open_modes(store, store.modal_tables.get(modal_table_id))
    table = modes.table
    nodes = read_nodes(store, table)
    ids = table.arrays.get("node_ids")
    return _SourceShapes(
        table,
        list_mode_names(table),
        np.arange(1, len(nodes) + 1) if ids is None else np.asarray(store.arrays.get(ids)),
        nodes,
        interpolate_shapes(store, modes, fuel) * TO_STRUCTURE,
    )


def _find_dofs(matrix: SymmetricMatrix, sources: Sources, one: _SourceShapes) -> np.ndarray:
    """Return node and component of each row of a matrix."""
    n = matrix.values.shape[0]
    if matrix.dofs is not None:
        return matrix.dofs
    if sources.has("node") and sources.has("component"):
        listed = np.stack([sources.numbers("node"), sources.numbers("component")], axis=-1)
        dofs = np.atleast_2d(listed).astype(np.int64)
        if dofs.shape[0] != n:
            raise BadInput(
                f"{dofs.shape[0]} degrees of freedom are listed, matrix {matrix.name} has {n} rows",
                code="unequal-lengths",
            )
        if ((dofs[:, 1] < 0) | (dofs[:, 1] > 6)).any() or np.unique(dofs, axis=0).shape[0] < n:
            raise BadInput(
                "degrees of freedom are listed twice or have components other than 1 to 6",
                code="bad-component",
            )
        return dofs
    n_nodes = one.ids.size
    if n not in (3 * n_nodes, 6 * n_nodes):
        raise BadInput(
            f"the matrix {matrix.name} is {n} x {n}; the table has {n_nodes} nodes, "
            f"{3 * n_nodes} or {6 * n_nodes} rows and columns are expected. Add a table with the "
            "columns node and component of its rows, or import it as DMIG",
            code="unequal-lengths",
        )
    n_each = n // n_nodes
    return np.stack(
        [np.repeat(one.ids, n_each), np.tile(np.arange(1, n_each + 1), n_nodes)], axis=1
    )


def _locate(one: _SourceShapes, other: _SourceShapes) -> _SourceShapes:
    """Give the nodes of the second source the numbers of the nearest nodes of the first."""
    extent = float(np.linalg.norm(np.ptp(one.nodes, axis=0)))
    found = cKDTree(one.nodes).query(other.nodes)
    distance, near = np.asarray(found[0]), np.asarray(found[1])
    close = distance <= SAME_PLACE * extent
    if not close.any():
        raise BadInput(
            "the sources have no common node; check units and axes of the nodes",
            code="nothing-common",
        )
    ids = one.ids[near[close]]
    if np.unique(ids).size < ids.size:
        raise BadInput(
            f"several points of {other.table.name} are nearest to one node of {one.table.name}; "
            "the model has too few nodes there",
            code="nothing-common",
        )
    if not close.all():
        other.notes.append(
            f"{int((~close).sum())} points of {other.table.name} are not at a node of "
            f"{one.table.name}, and are not used."
        )
    other.ids, other.nodes, other.values = ids, other.nodes[close], other.values[:, close]
    return other


def _transform(shapes: _SourceShapes, sources: Sources, length: float, axes: str) -> None:
    """Transform shapes to the unit and the displacement systems of the matrices."""
    turn = parse_axes(axes)
    for half in (slice(0, 3), slice(3, 6)):
        shapes.values[..., half] = shapes.values[..., half] @ turn
    shapes.values[..., :3] /= length
    decks = sources.list_holders("grid/id")
    if decks:
        frames, _, _ = join_frames(decks)
        shapes.values = frames.turn(shapes.ids, shapes.values, to_basic=False)
        return
    shapes.notes.append(
        "Degrees of freedom are taken in basic axes, as no deck gives the displacement systems."
    )


def _select(shapes: _SourceShapes, dofs: np.ndarray) -> np.ndarray:
    """Return shapes at the degrees of freedom of a matrix, zero where there is none."""
    row_of = {int(node): row for row, node in enumerate(shapes.ids)}
    rows = np.array([row_of.get(int(node), -1) for node in dofs[:, 0]])
    known = (rows >= 0) & (dofs[:, 1] >= 1)
    values = np.zeros((shapes.values.shape[0], dofs.shape[0]))
    values[:, known] = shapes.values[:, rows[known], dofs[known, 1] - 1]
    return values


def _reduce(
    sources: Sources,
    query: OrthogonalityQuery,
    mass: SymmetricMatrix,
    retained: np.ndarray,
    last: ModalTable,
) -> tuple[np.ndarray | sparse.csr_array, str]:
    """Return the mass at the degrees of freedom that are retained, and a note on its reduction."""
    n = mass.values.shape[0]
    if query.stiffness is not None:
        stiffness = read_symmetric_matrix(sources, query.stiffness)
        if stiffness.values.shape[0] != n or not _has_same_dofs(mass, stiffness):
            raise BadInput(
                f"the matrices {mass.name} and {stiffness.name} have other degrees of freedom",
                code="unequal-lengths",
            )
        return reduce_statically(mass.values, stiffness.values, retained), (
            f"The mass of {n} degrees of freedom is reduced to {retained.size} by "
            "static condensation (Guyan)."
        )
    own = mass.values[retained][:, retained]
    left = np.setdiff1d(np.arange(n), retained)
    has_mass = bool(abs(mass.values[left]).sum() > 0.0)
    is_measured = query.other_id is not None or last.kind is ModalKind.GVT
    if has_mass and is_measured:
        raise BadInput(
            f"matrix {mass.name} has mass at {left.size} degrees of freedom that "
            f"{format_title(last)} does not measure; give the stiffness matrix for a static "
            f"condensation (Guyan), or the mass of a test-analysis model at the {retained.size} "
            "measured ones",
            code="not-reduced",
        )
    return own, f"The mass is used at {retained.size} of its {n} degrees of freedom, as given."


def _has_same_dofs(one: SymmetricMatrix, other: SymmetricMatrix) -> bool:
    return one.dofs is None or other.dofs is None or np.array_equal(one.dofs, other.dofs)
