"""Mode shapes printed or punched node by node, separated by subcase and analysis."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from flexsid.errors import UnreadableFile
from flexsid.importers.source import Field

_SAME_EIGENVALUE = 1e-5  # relative; printed to six digits


@dataclass(slots=True)
class _ModalAnalysis:
    """Shapes of one analysis: per mode the eigenvalue and six components at each node."""

    subcase: int
    eigenvalues: dict[int, float] = field(default_factory=dict)
    vectors: dict[int, dict[int, list[float]]] = field(default_factory=dict)


@dataclass(slots=True)
class Vectors:
    """Mode shapes by analysis; a mode with another eigenvalue belongs to another analysis."""

    _analyses: list[_ModalAnalysis] = field(default_factory=list)

    def begin(self, subcase: int, mode: int, eigenvalue: float) -> dict[int, list[float]]:
        """Return the rows of a new or continued mode, to be filled."""
        for analysis in self._analyses:
            known = analysis.eigenvalues.get(mode)
            if analysis.subcase == subcase and (known is None or _same(known, eigenvalue)):
                break
        else:
            analysis = _ModalAnalysis(subcase)
            self._analyses.append(analysis)
        analysis.eigenvalues.setdefault(mode, eigenvalue)
        return analysis.vectors.setdefault(mode, {})

    @property
    def subcase(self) -> int | None:
        """Subcase of the analysis that is read; None if there is none."""
        found = self._with_rows()
        return found[0].subcase if found else None

    def notes(self) -> list[str]:
        """Return notes on content that is omitted or set to zero."""
        found = self._with_rows()
        notes = []
        for other in found[1:]:
            same = "a further analysis in " if other.subcase == found[0].subcase else ""
            notes.append(
                f"it also holds {len(other.vectors)} mode shapes of {same}subcase {other.subcase}; "
                f"those of subcase {found[0].subcase} that come first are read"
            )
        vectors = found[0].vectors if found else {}
        nodes = {node for rows in vectors.values() for node in rows}
        short = [mode for mode, rows in sorted(vectors.items()) if len(rows) < len(nodes)]
        if short:
            notes.append(
                f"mode {short[0]} is not given at node {min(nodes - set(vectors[short[0]]))} "
                f"({len(short)} modes lack nodes); its values there are set to zero"
            )
        return notes

    def fields(self) -> Iterator[Field]:
        """Yield numbers, frequencies, nodes and shapes (n, K, 6) of the first analysis.

        Raises
        ------
        UnreadableFile
            If a node has not six components.
        """
        found = self._with_rows()
        if not found:
            return
        vectors, eigenvalues = found[0].vectors, found[0].eigenvalues
        modes = sorted(mode for mode, rows in vectors.items() if rows)
        nodes = sorted({node for mode in modes for node in vectors[mode]})
        for mode in modes:
            for node, row in vectors[mode].items():
                if len(row) != 6:
                    raise UnreadableFile(
                        f"mode {mode}, node {node} has {len(row)} components, 6 expected."
                    )
        zero = [0.0] * 6
        values = [[vectors[mode].get(node, zero) for node in nodes] for mode in modes]
        yield Field("shape/number", np.array(modes))
        radians = [max(eigenvalues[mode], 0.0) ** 0.5 for mode in modes]
        yield Field("shape/radians", np.array(radians))
        yield Field("shape/node", np.array(nodes))
        yield Field("shape/values", np.array(values, dtype=float).reshape(len(modes), -1, 6))

    def _with_rows(self) -> list[_ModalAnalysis]:
        return [one for one in self._analyses if any(one.vectors.values())]


def _same(one: float, other: float) -> bool:
    # Eigenvalues of rigid-body modes are round-off, equal in every printout.
    return abs(one - other) <= _SAME_EIGENVALUE * max(abs(one), abs(other))
