"""Mode shapes printed or punched node by node, separated by subcase and analysis."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

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

    def first(self) -> tuple[int, dict[int, float]] | None:
        """Return subcase and eigenvalues of the analysis that is read; None if there is none."""
        found = self._with_rows()
        return (found[0].subcase, found[0].eigenvalues) if found else None

    def short(self) -> tuple[int, int, int] | None:
        """Return the first mode and node without six components, and their number."""
        for analysis in self._analyses:
            for mode, rows in analysis.vectors.items():
                for node, values in rows.items():
                    if len(values) != 6:
                        return mode, node, len(values)
        return None

    def notes(self) -> list[str]:
        """Return notes on content that is omitted or set to zero."""
        found = self._with_rows()
        notes = [
            f"it also holds {len(other.vectors)} mode shapes of {_named(other, found[0])}; those "
            f"of subcase {found[0].subcase} that come first are read"
            for other in found[1:]
        ]
        if found:
            nodes = {node for rows in found[0].vectors.values() for node in rows}
            short = [m for m, rows in sorted(found[0].vectors.items()) if len(rows) < len(nodes)]
            if short:
                lacking = min(nodes - set(found[0].vectors[short[0]]))
                notes.append(
                    f"mode {short[0]} is not given at node {lacking} ({len(short)} modes lack "
                    "nodes); its values there are set to zero"
                )
        return notes

    def fields(self) -> Iterator[Field]:
        """Yield numbers, frequencies, nodes and shapes (n, K, 6) of the first analysis."""
        found = self._with_rows()
        if not found:
            return
        vectors, eigenvalues = found[0].vectors, found[0].eigenvalues
        modes = sorted(mode for mode, rows in vectors.items() if rows)
        nodes = sorted({node for mode in modes for node in vectors[mode]})
        zero = [0.0] * 6
        values = [[vectors[mode].get(node, zero) for node in nodes] for mode in modes]
        yield Field("shape/number", np.array(modes, dtype=np.int64))
        radians = [max(eigenvalues[mode], 0.0) ** 0.5 for mode in modes]
        yield Field("shape/radians", np.array(radians))
        yield Field("shape/node", np.array(nodes, dtype=np.int64))
        yield Field("shape/values", np.array(values, dtype=float).reshape(len(modes), -1, 6))

    def _with_rows(self) -> list[_ModalAnalysis]:
        return [one for one in self._analyses if any(one.vectors.values())]


def _same(one: float, other: float) -> bool:
    # Eigenvalues of rigid-body modes are round-off, equal in every printout.
    return abs(one - other) <= _SAME_EIGENVALUE * max(abs(one), abs(other))


def _named(other: _ModalAnalysis, first: _ModalAnalysis) -> str:
    if other.subcase != first.subcase:
        return f"subcase {other.subcase}"
    return f"a further analysis in subcase {other.subcase}"
