"""Degrees of freedom and nodes in columns and matrices of structural files."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Int, Num
from scipy import sparse

from flexsid import units
from flexsid.errors import BadInput
from flexsid.importers.source import Field, SourceFile, Sources

# --- Matrices of structural files: their terms, and the degrees of freedom of rows and columns

PREFIX = "matrix/"
_SAME_TERM = 1e-6
"""Of the largest term: differences of a symmetric matrix above the round-off of eight digits."""


@dataclass(frozen=True, slots=True, eq=False)
class MatrixTerms:
    """Terms of a sparse matrix that are not zero.

    ``dofs`` are node and component (1 to 6; 0 of a scalar point) of each row of a square matrix,
    where the file states them.
    """

    size: tuple[int, int]
    rows: Int[np.ndarray, " n_terms"]
    columns: Int[np.ndarray, " n_terms"]
    values: Num[np.ndarray, " n_terms"]
    dofs: Int[np.ndarray, "n_rows 2"] | None = None

    def fields(self, name: str) -> Iterator[Field]:
        """Yield the fields of a matrix."""
        own = f"{PREFIX}{name}/"
        yield Field(f"{own}size", np.array(self.size))
        yield Field(f"{own}row", self.rows)
        yield Field(f"{own}column", self.columns)
        yield Field(f"{own}value", np.ascontiguousarray(np.real(self.values), dtype=float))
        if np.iscomplexobj(self.values):
            yield Field(f"{own}imaginary", np.ascontiguousarray(np.imag(self.values)))
        if self.dofs is not None:
            yield Field(f"{own}dof", self.dofs)


@dataclass(frozen=True, slots=True, eq=False)
class SymmetricMatrix:
    """A symmetric matrix of a structure; ``dofs`` as in ``MatrixTerms``."""

    name: str
    values: sparse.csr_array
    dofs: Int[np.ndarray, "n 2"] | None


def list_matrices(source: SourceFile) -> tuple[str, ...]:
    """List the matrices of a file by name."""
    return tuple(
        path.removeprefix(PREFIX).removesuffix("/size")
        for path in source.arrays
        if path.startswith(PREFIX) and path.endswith("/size")
    )


def describe_matrix(source: SourceFile, name: str) -> str:
    """Return name, size and degrees of freedom of a matrix as text."""
    own = f"{PREFIX}{name}/"
    rows, columns = (int(n) for n in source.arrays[f"{own}size"])
    text = f"matrix {name}, {rows} x {columns}"
    if f"{own}imaginary" in source.arrays:
        text += ", complex"
    if f"{own}dof" in source.arrays:
        n_nodes = np.unique(source.arrays[f"{own}dof"][:, 0]).size
        text += f" at {n_nodes} nodes"
    return text


def read_symmetric_matrix(sources: Sources, name: str) -> SymmetricMatrix:
    """Return a real symmetric matrix of the files.

    Parameters
    ----------
    sources, name
        Files, and name of a matrix (DMIG, ``.op4``) or of a square field of a MATLAB, NumPy or HDF5
        file. ``file.op4:MAAX`` selects the file where several hold it.

    Raises
    ------
    BadInput
        If no file has it, several have, or it is not square, real, finite and symmetric.
    """
    file, _, inside = name.rpartition(":")
    holders = [
        (source, requested)
        for source in sources.items
        for requested in {name, inside}
        if requested in list_matrices(source) and (requested == name or source.name == file)
    ]
    if len(holders) > 1:
        raise BadInput(
            f"matrix {name} is in {' and '.join(source.name for source, _ in holders)}; write "
            f"'{holders[0][0].name}:{name}' to select one",
            code="ambiguous-field",
        )
    if holders:
        matrix = _assemble(holders[0][0], name, holders[0][1])
    else:
        matrix = SymmetricMatrix(name, _read_field(sources, name), None)
    values = matrix.values
    if values.shape[0] != values.shape[1]:
        raise BadInput(
            f"matrix {name} has {values.shape[0]} rows and {values.shape[1]} columns; expected a "
            "square matrix",
            code="unequal-lengths",
        )
    largest = float(np.abs(values.data).max(initial=0.0))
    if not np.isfinite(largest):
        raise BadInput(f"matrix {name} is not finite; the file is damaged", code="not-finite")
    difference = (values - values.T).tocsr()
    if float(np.abs(difference.data).max(initial=0.0)) > _SAME_TERM * largest:
        raise BadInput(f"matrix {name} is not symmetric", code="not-symmetric")
    return matrix


def _assemble(source: SourceFile, label: str, name: str) -> SymmetricMatrix:
    own = f"{PREFIX}{name}/"
    found = source.arrays
    if f"{own}imaginary" in found and np.any(found[f"{own}imaginary"]):
        raise BadInput(
            f"matrix {label} of {source.name} is complex; expected a real one",
            code="not-numeric",
            file=source.name,
        )
    terms = (found[f"{own}value"], (found[f"{own}row"], found[f"{own}column"]))
    rows, columns = (int(n) for n in found[f"{own}size"])
    values = sparse.csr_array(sparse.coo_array(terms, shape=(rows, columns)))
    return SymmetricMatrix(label, values, found.get(f"{own}dof"))


def _read_field(sources: Sources, name: str) -> sparse.csr_array:
    known = [one for source in sources.items for one in list_matrices(source)]
    if known and not sources.has(name) and not sources.has(name.rpartition(":")[2]):
        raise BadInput(
            f"no file has a matrix '{name}'; expected one of {', '.join(known)}",
            code="missing-column",
            column=name,
        )
    values: Float[np.ndarray, "n n"] = np.atleast_2d(np.asarray(sources.numbers(name), dtype=float))
    if values.ndim != 2:
        raise BadInput(f"field '{name}' is not a matrix", code="unequal-lengths")
    return sparse.csr_array(values)


# --- Degrees of freedom of a test in the names of channels: ``12+z``, ``12:-Y``, ``12X`` ----------

DOF = r"\d{1,9}\s*:?\s*(?:[+-]\s*[xyz]|[xyz]\s*[+-]?)"
"""Pattern of a node with a direction, any case."""

_PARTS = re.compile(r"(\d+)\s*:?\s*([+-]?)\s*([xyz])\s*([+-]?)", re.IGNORECASE)
_IN_NAME = re.compile(r"^(?P<name>.*?)\s*\[(?P<unit>[^\]]*)\]$")
_RATIO = re.compile(r"\(?(?P<response>[^()]+?)\)?\s*/\s*\(?(?P<force>N|lbf)\)?")


class DegreeOfFreedom(NamedTuple):
    """A node, and its direction: 1, 2, 3 for x, y, z, negative if opposite."""

    node: int
    direction: int


def parse_degree_of_freedom(text: str) -> DegreeOfFreedom | None:
    """Return the degree of freedom that a text names; None if it names none."""
    found = _PARTS.fullmatch(text.strip())
    if found is None or (found[2] and found[4]):
        return None
    axis = "xyz".index(found[3].lower()) + 1
    return DegreeOfFreedom(int(found[1]), -axis if "-" in (found[2], found[4]) else axis)


def split_unit(name: str) -> tuple[str, str]:
    """Split ``force 61+z [N]`` into the name and the unit."""
    found = _IN_NAME.match(name.strip())
    return (name.strip(), "") if found is None else (found["name"], found["unit"].strip())


def split_ratio(unit: str) -> tuple[str, str] | None:
    """Split ``(m/s2)/N`` into the units of response and force; None if it is none of a force."""
    found = _RATIO.fullmatch(unit.strip())
    return None if found is None else (found["response"].strip(), found["force"])


# --- Coordinates of nodes in columns, as fields common to all readers of modal data ---------------

_AXES = ("x", "y", "z")


def convert_node_table(source: SourceFile) -> SourceFile:
    """Convert columns ``node``, ``x``, ``y`` and ``z``; the unit as ``x [mm]`` or of the field.

    Raises
    ------
    BadInput
        If a node is repeated or is not a number, or the columns have different units.
    """
    columns, stated = {}, {}
    for path, values in source.arrays.items():
        name, unit = split_unit(path)
        bare, _, suffix = name.rpartition(".")[2].lower().partition("_")
        columns[bare] = values
        stated[bare] = unit or source.units.get(path, "") or suffix
    if not {"node", *_AXES} <= set(columns) or "mode" in columns or "grid/id" in source.arrays:
        return source
    ids = np.asarray(columns["node"], dtype=float).ravel()
    if np.unique(ids).size != ids.size or not (ids == np.round(ids)).all() or (ids < 0).any():
        raise BadInput(
            f"{source.name}: the column node must be whole numbers without repetition",
            code="bad-nodes",
        )
    places = [np.asarray(columns[axis], dtype=float).ravel() for axis in _AXES]
    if any(place.size != ids.size for place in places):
        raise BadInput(
            f"{source.name}: node, x, y and z have different lengths", code="unequal-lengths"
        )
    given = {stated[axis] for axis in _AXES}
    if len(given) > 1:
        raise BadInput(
            f"{source.name}: x, y and z have the units {', '.join(sorted(given))}; expected one",
            code="other-unit",
        )
    zero = np.zeros(ids.size, dtype=np.int64)
    found = {
        "grid/id": ids.astype(np.int64),
        "grid/cp": zero,
        "grid/cd": zero,
        "grid/xyz": np.stack(places, axis=1),
    }
    if unit := given.pop():
        found["unit/length"] = np.array([units.factor(unit, "length")])
    return replace(source, arrays={**source.arrays, **found})
