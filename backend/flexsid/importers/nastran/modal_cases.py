"""Modal analyses of one file: subcases with their boundary conditions, real or complex."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Int, Num

from flexsid.importers.source import Field

EigenvalueTable = tuple[np.ndarray, np.ndarray, np.ndarray]
"""Numbers, frequencies [rad/s] and generalised masses of the modes of a subcase."""


@dataclass(frozen=True, slots=True, eq=False)
class NastranCase:
    """Modes of one analysis of a file, in the units and displacement systems of the file.

    ``eigenvalues`` are squares of frequencies [rad2/s2] of real modes, roots [rad/s] of complex
    ones. ``label`` is that of the analyst in the case control section.
    """

    subcase: int
    is_complex: bool
    label: str
    numbers: Int[np.ndarray, " n_modes"]
    eigenvalues: Num[np.ndarray, " n_modes"]
    nodes: Int[np.ndarray, " n_nodes"]
    values: Num[np.ndarray, "n_modes n_nodes 6"]
    in_basic: bool = False
    notes: tuple[str, ...] = ()


def list_cases(
    cases: Sequence[NastranCase], tables: Mapping[int, EigenvalueTable]
) -> Iterator[Field]:
    """Yield the fields of all analyses: ``shape/...`` of the first, ``case/1/shape/...`` of others.

    Real analyses come before complex ones. The eigenvalues of ``tables``, by subcase, are added as
    ``mode/...``; those of the first subcase where no shapes are given. ``case/label`` names
    several analyses.
    """
    usable = sorted(filter(None, map(_retain_oscillations, cases)), key=lambda one: one.is_complex)
    if not usable and tables:
        yield from _list_table(tables[min(tables)], "")
    for place, case in enumerate(usable):
        prefix = f"case/{place}/" if place else ""
        if not case.is_complex and (table := tables.get(case.subcase)) is not None:
            yield from _list_table(table, prefix)
        yield from _list_shapes(case, prefix)
    if len(usable) > 1:
        yield Field("case/label", np.array(_name_cases(usable), dtype=np.str_))


def list_notes(cases: Sequence[NastranCase]) -> list[str]:
    """Return notes on modes that are omitted or incomplete."""
    notes = [note for case in cases for note in case.notes]
    for roots in (case.eigenvalues for case in cases if case.is_complex):
        oscillates = np.imag(roots) > 0.0
        unstable, left = (oscillates & (np.real(roots) > 0.0)).sum(), (~oscillates).sum()
        if unstable:
            notes.append(f"{unstable} complex modes have negative damping")
        if left:
            notes.append(
                f"{left} complex modes without oscillation, or conjugates of others, are not used"
            )
    return notes


def _retain_oscillations(case: NastranCase) -> NastranCase | None:
    """Return a case without real and conjugate roots; None if nothing remains."""
    if not case.is_complex:
        return case
    rows = np.flatnonzero(np.imag(case.eigenvalues) > 0.0)
    if not rows.size:
        return None
    return replace(
        case,
        numbers=case.numbers[rows],
        eigenvalues=case.eigenvalues[rows],
        values=case.values[rows],
    )


def _list_table(table: EigenvalueTable, prefix: str) -> Iterator[Field]:
    for name, values in zip(("number", "radians", "mass"), table, strict=True):
        yield Field(f"{prefix}mode/{name}", values)


def _list_shapes(case: NastranCase, prefix: str) -> Iterator[Field]:
    yield Field(f"{prefix}shape/number", case.numbers)
    size = np.abs(case.eigenvalues)
    if case.is_complex:
        yield Field(f"{prefix}shape/radians", size)
        yield Field(f"{prefix}shape/damping", -np.real(case.eigenvalues) / size)
        yield Field(f"{prefix}shape/imaginary", np.ascontiguousarray(np.imag(case.values)))
    else:
        yield Field(f"{prefix}shape/radians", np.sqrt(np.maximum(np.real(case.eigenvalues), 0.0)))
    yield Field(f"{prefix}shape/node", case.nodes)
    yield Field(f"{prefix}shape/values", np.ascontiguousarray(np.real(case.values), dtype=float))
    if case.in_basic:
        yield Field(f"{prefix}shape/basic", np.array([1]))


def _name_cases(cases: Sequence[NastranCase]) -> list[str]:
    """Name analyses by subcase and label; those of one name are numbered."""
    names: list[str] = []
    counts: Counter[str] = Counter()
    for case in cases:
        name = f"subcase {case.subcase}" + (f": {case.label}" if case.label else "")
        name += ", complex modes" if case.is_complex else ""
        counts[name] += 1
        names.append(f"{name} ({counts[name]})" if counts[name] > 1 else name)
    return names
