"""Matrices of structural files: their terms, and the degrees of freedom of rows and columns."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int, Num
from scipy import sparse

from flexsid.errors import BadInput
from flexsid.importers.source import Field, SourceFile, Sources

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
