"""DMIG entries of decks and punch files: matrices by node and component."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from flexsid.importers.matrices import MatrixTerms
from flexsid.importers.numbers import read_real

_SQUARE, _SYMMETRIC = 1, 6
_FORMS = {2: "rectangular", 9: "rectangular"}
_COMPLEX = (3, 4)

Dof = tuple[int, int]


@dataclass(slots=True)
class MatrixEntries:
    """A matrix of DMIG entries while it is read."""

    name: str
    form: int | None = None
    is_complex: bool = False
    is_polar: bool = False
    terms: dict[tuple[Dof, Dof], complex] = field(default_factory=dict)


def take_entry(known: dict[str, MatrixEntries], fields: Sequence[str]) -> None:
    """Add a DMIG entry: the header of a matrix, or terms of one of its columns.

    Raises
    ------
    ValueError
        If a field is no number, or a term has two values.
    """
    name = fields[0].upper()
    matrix = known.setdefault(name, MatrixEntries(name))
    if fields[1] == "0":  # a column begins with a node, which is not zero
        matrix.form = int(fields[2] or 0)
        matrix.is_complex = int(fields[3] or 1) in _COMPLEX
        matrix.is_polar = fields[5] not in ("", "0")
        return
    column = (int(fields[1]), int(fields[2] or 0))
    for begin in range(4, len(fields) - 3, 4):
        node, component, first, second = fields[begin : begin + 4]
        if not node:
            continue
        row = (int(node), int(component or 0))
        value: complex = read_real(first)
        if matrix.is_complex:
            other = read_real(second)
            value = (
                value * np.exp(1j * np.radians(other)) if matrix.is_polar else complex(value, other)
            )
        if matrix.terms.setdefault((row, column), value) != value:
            raise ValueError(f"the term {row}, {column} of matrix {name} has two values")


def build_matrix(matrix: MatrixEntries) -> tuple[MatrixTerms | None, str]:
    """Return the terms of a matrix, or None and the reason why it is not used.

    Of a symmetric matrix one half is given, and completed.
    """
    if matrix.form is None:
        return None, f"matrix {matrix.name} has no header (DMIG,{matrix.name},0,...)"
    if matrix.form not in (_SQUARE, _SYMMETRIC):
        kind = _FORMS.get(matrix.form, f"of form {matrix.form}")
        return None, f"matrix {matrix.name} is {kind}; square and symmetric ones are read"
    if not matrix.terms:
        return None, f"matrix {matrix.name} has no terms"
    terms = dict(matrix.terms)
    if matrix.form == _SYMMETRIC:
        for (row, column), value in matrix.terms.items():
            if terms.setdefault((column, row), value) != value:
                return None, (
                    f"matrix {matrix.name} is symmetric by its header, and the terms {row}, "
                    f"{column} and their transposes differ"
                )
    dofs = sorted({dof for pair in terms for dof in pair})
    place = {dof: index for index, dof in enumerate(dofs)}
    return MatrixTerms(
        size=(len(dofs), len(dofs)),
        rows=np.array([place[row] for row, _ in terms]),
        columns=np.array([place[column] for _, column in terms]),
        values=np.array(list(terms.values())),
        dofs=np.array(dofs),
    ), ""
