"""Mode shapes printed or punched node by node, separated by subcase and analysis."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from flexsid.errors import UnreadableFile
from flexsid.importers.nastran.modal_cases import NastranCase

_SAME_EIGENVALUE = 1e-5  # relative; printed to six digits


@dataclass(slots=True)
class _ModalAnalysis:
    """Shapes of one analysis: per mode the eigenvalue and six components at each node."""

    subcase: int
    is_complex: bool
    label: str
    eigenvalues: dict[int, complex] = field(default_factory=dict)
    vectors: dict[int, dict[int, list[complex]]] = field(default_factory=dict)


@dataclass(slots=True)
class Vectors:
    """Mode shapes by analysis; a mode with another eigenvalue belongs to another analysis."""

    _analyses: list[_ModalAnalysis] = field(default_factory=list)

    def begin(
        self,
        subcase: int,
        mode: int,
        eigenvalue: complex,
        *,
        is_complex: bool = False,
        label: str = "",
    ) -> dict[int, list[complex]]:
        """Return the rows of a new or continued mode, to be filled."""
        for analysis in self._analyses:
            known = analysis.eigenvalues.get(mode)
            if (analysis.subcase, analysis.is_complex) == (subcase, is_complex) and (
                known is None or _same(known, eigenvalue)
            ):
                break
        else:
            analysis = _ModalAnalysis(subcase, is_complex, label)
            self._analyses.append(analysis)
        analysis.eigenvalues.setdefault(mode, eigenvalue)
        return analysis.vectors.setdefault(mode, {})

    def cases(self) -> list[NastranCase]:
        """Return the shapes of every analysis with their numbers, frequencies and nodes.

        Raises
        ------
        UnreadableFile
            If a node has not six components.
        """
        return [_build_case(one) for one in self._analyses if any(one.vectors.values())]


@dataclass(slots=True)
class VectorsByNode:
    """Real mode shapes of one analysis that are sorted by node (SORT2): eigenvalue and row each."""

    subcase: int = 0
    label: str = ""
    rows: dict[int, list[tuple[float, list[complex]]]] = field(default_factory=dict)

    def add_to(self, vectors: Vectors) -> None:
        """Add the shapes to others, numbered in the order in which every node lists them.

        Raises
        ------
        UnreadableFile
            If nodes list other eigenvalues, or one twice.
        """
        expected: list[float] = []
        for node, rows in self.rows.items():
            eigenvalues = [value for value, _ in rows]
            expected = expected or eigenvalues
            if eigenvalues != expected:
                raise UnreadableFile(
                    f"node {node} has {len(eigenvalues)} mode shapes sorted by node (SORT2), other "
                    f"than the {len(expected)} of node {next(iter(self.rows))}."
                )
        if len(set(expected)) < len(expected):
            raise UnreadableFile(
                "the mode shapes sorted by node (SORT2) have one eigenvalue twice; request SORT1."
            )
        for mode, eigenvalue in enumerate(expected, start=1):
            table = vectors.begin(self.subcase, mode, eigenvalue, label=self.label)
            table |= {node: rows[mode - 1][1] for node, rows in self.rows.items()}


def _build_case(analysis: _ModalAnalysis) -> NastranCase:
    vectors = analysis.vectors
    modes = sorted(mode for mode, rows in vectors.items() if rows)
    nodes = sorted({node for mode in modes for node in vectors[mode]})
    for mode in modes:
        for node, row in vectors[mode].items():
            if len(row) != 6:
                raise UnreadableFile(
                    f"mode {mode}, node {node} has {len(row)} components, 6 expected."
                )
    short = [mode for mode in modes if len(vectors[mode]) < len(nodes)]
    notes = ()
    if short:
        notes = (
            f"mode {short[0]} is not given at node {min(set(nodes) - set(vectors[short[0]]))} "
            f"({len(short)} modes lack nodes); its values there are set to zero",
        )
    zero = [0.0] * 6
    values = [[vectors[mode].get(node, zero) for node in nodes] for mode in modes]
    return NastranCase(
        subcase=analysis.subcase,
        is_complex=analysis.is_complex,
        label=analysis.label,
        numbers=np.array(modes),
        eigenvalues=np.array([analysis.eigenvalues[mode] for mode in modes]),
        nodes=np.array(nodes),
        values=np.array(values).reshape(len(modes), -1, 6),
        notes=notes,
    )


def _same(one: complex, other: complex) -> bool:
    # Eigenvalues of rigid-body modes are round-off, equal in every printout.
    return abs(one - other) <= _SAME_EIGENVALUE * max(abs(one), abs(other))
