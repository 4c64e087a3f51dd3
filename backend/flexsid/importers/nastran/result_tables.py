"""Result files of MSC Nastran in HDF5: nodes, coordinate systems, eigenvalues, eigenvectors.

Source: MSC Nastran, HDF5 schema: ``NASTRAN/INPUT`` and ``NASTRAN/RESULT`` hold one table for each
kind of entry or result; ``RESULT/DOMAINS`` gives subcase, analysis and mode of their rows.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from flexsid.errors import UnreadableFile
from flexsid.importers.nastran.bulk import list_geometry
from flexsid.importers.nastran.modal_cases import EigenvalueTable, Vectors, list_cases, list_notes
from flexsid.importers.source import Field

_INPUT, _RESULT = "NASTRAN.INPUT.", "NASTRAN.RESULT."
_GRID = f"{_INPUT}NODE.GRID"
_SYSTEMS = {f"{_INPUT}COORDINATE_SYSTEM.CORD2{kind}": k for k, kind in enumerate("RCS", start=1)}
_POINTS = tuple(f"{point}{axis}" for point in "ABC" for axis in (1, 2, 3))
_VECTORS = f"{_RESULT}NODAL.EIGENVECTOR"
_EIGENVALUES = f"{_RESULT}SUMMARY.EIGENVALUE"
_DOMAINS = f"{_RESULT}DOMAINS"
_READ = {_GRID, *_SYSTEMS, _VECTORS, _EIGENVALUES, _DOMAINS}
_COMPONENTS = ("X", "Y", "Z", "RX", "RY", "RZ")
_MODES = 2
_ANALYSES = {
    1: "static loads",
    5: "frequency response",
    6: "transient",
    7: "buckling",
    8: "buckling",
}
"""Codes of analyses (approach codes of OUTPUT2 data blocks)."""

Columns = Mapping[str, np.ndarray]


@dataclass(frozen=True, slots=True)
class _Domain:
    """Analysis to which rows of a result belong."""

    subcase: int
    analysis: int
    eigenvalue: float
    mode: int


def is_result(names: Iterator[str]) -> bool:
    """Return whether the columns of a file, by name, are those of a result file."""
    return any(name.startswith((f"{_VECTORS}.", f"{_GRID}.")) for name in names)


def read_tables(columns: Columns) -> Iterator[Field]:
    """Yield the fields common to all readers of modal data.

    Parameters
    ----------
    columns
        Columns of all tables of the file by path, such as ``NASTRAN.INPUT.NODE.GRID.ID``.

    Raises
    ------
    UnreadableFile
        If a column of a table that is read is missing.
    """
    left = {name.rpartition(".")[0] for name in columns if name.startswith("NASTRAN.")}
    refused = [
        f"table {name.removeprefix('NASTRAN.').replace('.', '/')}" for name in sorted(left - _READ)
    ]
    if _GRID in left:
        yield from _list_geometry(columns, refused)
    yield from _list_modes(columns, left, refused)
    if refused:
        yield Field("refused", np.array(refused))


def _get(columns: Columns, table: str, *names: str) -> list[np.ndarray]:
    missing = [name for name in names if f"{table}.{name}" not in columns]
    if missing:
        raise UnreadableFile(f"table {table.replace('.', '/')} has no column '{missing[0]}'.")
    return [columns[f"{table}.{name}"] for name in names]


def _list_geometry(columns: Columns, refused: list[str]) -> Iterator[Field]:
    rows = zip(*_get(columns, _GRID, "ID", "CP", "X", "CD", "SEID"), strict=True)
    grids, n_other = {}, 0
    for number, cp, place, cd, superelement in rows:
        if int(superelement):
            n_other += 1
            continue
        grids[int(number)] = (int(cp), tuple(place.tolist()), int(cd))
    if n_other:
        refused.append(f"{n_other} nodes of superelements")
    frames = {}
    for table, kind in _SYSTEMS.items():
        if f"{table}.CID" in columns:
            numbers, references, *points = _get(columns, table, "CID", "RID", *_POINTS)
            for number, reference, point in zip(
                numbers.tolist(), references.tolist(), np.stack(points, axis=1), strict=True
            ):
                frames[number] = (kind, reference, tuple(point.tolist()))
    yield from list_geometry(grids, frames)


def _list_modes(columns: Columns, tables: set[str], refused: list[str]) -> Iterator[Field]:
    if _DOMAINS not in tables:
        return
    names = ("ID", "SUBCASE", "ANALYSIS", "TIME_FREQ_EIGR", "MODE", "SE")
    domains = {
        int(number): _Domain(int(subcase), int(analysis), float(value), int(mode))
        for number, subcase, analysis, value, mode, se in zip(
            *_get(columns, _DOMAINS, *names), strict=True
        )
        if int(se) == 0
    }
    vectors = Vectors()
    others: set[int] = set()
    if _VECTORS in tables:
        nodes, owners = _get(columns, _VECTORS, "ID", "DOMAIN_ID")
        values = np.stack(_get(columns, _VECTORS, *_COMPONENTS), axis=1)
        for owner in np.unique(owners).tolist():
            domain = domains.get(owner)
            if domain is None or domain.analysis != _MODES:
                others.add(-1 if domain is None else domain.analysis)
                continue
            rows = owners == owner
            shape = vectors.begin(domain.subcase, domain.mode, domain.eigenvalue)
            shape |= dict(zip(nodes[rows].tolist(), values[rows].tolist(), strict=True))
    refused += [
        f"eigenvectors of {_ANALYSES.get(kind, 'another analysis')}, which are no modes"
        for kind in sorted(others)
    ]
    cases = vectors.cases()
    subcases = {case.subcase for case in cases}
    found: dict[int, EigenvalueTable] = {}
    if _EIGENVALUES in tables and not others:
        modes, radians, masses, owners = _get(
            columns, _EIGENVALUES, "MODE", "OMEGA", "MASS", "DOMAIN_ID"
        )
        for owner in np.unique(owners).tolist():
            subcase = domains[owner].subcase if owner in domains else 0
            if subcase not in subcases and len(subcases) == 1:
                (subcase,) = subcases
            rows = (owners == owner) & (masses > 0.0)
            found.setdefault(subcase, (modes[rows], radians[rows], masses[rows]))
    yield from list_cases(cases, found)
    refused += list_notes(cases)
