"""Nastran punch files (.pch): eigenvectors and bulk data."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

import numpy as np

from flexsid.errors import UnreadableFile
from flexsid.importers.nastran import bulk
from flexsid.importers.nastran.modal_cases import (
    NastranCase,
    Vectors,
    VectorsByNode,
    list_cases,
    list_notes,
)
from flexsid.importers.source import Field, read_integer, read_real

_MODE = re.compile(r"\$EIGENVALUE\s*=\s*(\S+)\s+MODE\s*=\s*(\d+)", re.IGNORECASE)
_COMPLEX_MODE = re.compile(
    r"\$EIGENVALUE\s*=\s*\(\s*(\S+?)\s*,\s*(\S+?)\s*\)\s+MODE\s*=\s*(\d+)", re.IGNORECASE
)
_ROW = re.compile(r"^\s*([^\sA-Za-z$]\S*?|NaN)\s*([GSLHM]|(?<=\s)E)(?![A-Za-z])(.*)$")
_POINT = re.compile(r"\$POINT ID\s*=\s*(\d+)", re.IGNORECASE)
_SUBCASE = re.compile(r"\$SUBCASE ID\s*=\s*(\d+)", re.IGNORECASE)
_LABEL = re.compile(r"\$(SUBTITLE|LABEL)\s*=\s*(.*\S)", re.IGNORECASE)
_SHAPES = ("$EIGENVECTOR", "$DISPLACEMENTS")
_DESCRIPTIONS = (
    *("$SUBTITLE", "$LABEL", "$REAL OUTPUT", "$SUBCASE ID", "$SUBCOM", "$SEID"),
    *("$REAL-IMAGINARY OUTPUT", "$MAGNITUDE-PHASE OUTPUT"),
)
_COMPLEX = ("$REAL-IMAGINARY", "$MAGNITUDE-PHASE")
_COMPONENTS = 6


def recognises(head: bytes) -> bool:
    """Return whether a file begins with the titles of punched results, or is a deck."""
    return head[:1] == b"$" or bulk.recognises(head)


def read(path: Path) -> Iterator[Field]:
    """Read punched eigenvectors and bulk data."""
    text = bulk.read_latin(path)
    punched = _Punched()
    for number, line in enumerate(text.splitlines(), start=1):
        try:
            punched.take(line)
        except ValueError as error:
            raise UnreadableFile(
                f"line {number}: '{line[:72].strip()[:60]}' cannot be read ({error}).", row=number
            ) from error
    cases = punched.cases()
    yield from list_cases(cases, {})
    refused = [*punched.refused, *list_notes(cases)]
    if refused:
        yield Field("refused", np.array(refused, dtype=np.str_))
    if bulk.has_entries(text):
        yield from bulk.read_text(text)


class _Punched:
    """Eigenvectors of a punch file, read line by line."""

    def __init__(self) -> None:
        self.refused: list[str] = []
        self._shapes = Vectors()
        self._by_node: dict[int, VectorsByNode] = {}
        self._is_read = False
        self._is_complex = self._is_polar = False
        self._subcase, self._label = 0, ""
        self._table: dict[int, list[complex]] | None = None
        self._point: int | None = None  # node of shapes sorted by node
        self._row: list[float] = []
        self._put: Callable[[list[complex]], None] | None = None

    def take(self, line: str) -> None:
        """Read a title, or a part of a row."""
        if line.startswith("$"):
            self._end_row()
            self._take_title(line[:72])
            return
        line, sequence = line[:72], line[72:].strip()
        parts = line.split()
        found = _ROW.match(line)
        if (found or line.startswith("-CONT-")) and sequence and not sequence.isdigit():
            raise ValueError(f"'{sequence[:20]}' in columns 73 to 80 is not a number of a row")
        if parts and parts[0] == "-CONT-":
            if self._put is not None:
                self._row += _read_three(parts[1:])
        elif found is not None:
            self._end_row()
            if found[2] == "G":
                self._begin_row(found[1], found[3].split())
            elif self._is_read:
                self._note("values at scalar points")

    def cases(self) -> list[NastranCase]:
        """Return the shapes of every analysis."""
        self._end_row()
        for shapes in self._by_node.values():
            shapes.add_to(self._shapes)
        return self._shapes.cases()

    def _take_title(self, line: str) -> None:
        title = line.split("=")[0].rstrip()
        if title in _SHAPES:
            self._is_read, self._table, self._point = True, None, None
            self._is_complex = self._is_polar = False
        elif title.startswith(_COMPLEX):
            self._is_complex = True
            self._is_polar = title.startswith(_COMPLEX[1])
        elif title == "$POINT ID":
            self._begin_point(line)
        elif title not in _DESCRIPTIONS and not title.startswith(("$EIGENVALUE", "$ ")):
            self._is_read = False  # other results
            if not title.startswith(("$TITLE", "$ELEMENT TYPE")):
                self._note(f"{title.removeprefix('$').lower()}")
        if (case := _SUBCASE.search(line)) is not None:
            self._subcase = int(case[1])
        if (named := _LABEL.match(line)) is not None:
            self._label = named[2]
        if not self._is_read:
            self._table = self._point = None
        elif (found := _COMPLEX_MODE.search(line)) is not None and self._is_complex:
            root = complex(read_real(found[1]), read_real(found[2]))
            self._table = self._shapes.begin(
                self._subcase, int(found[3]), root, is_complex=True, label=self._label
            )
        elif (found := _MODE.search(line)) is not None and not self._is_complex:
            self._table = self._shapes.begin(
                self._subcase, int(found[2]), read_real(found[1]), label=self._label
            )
        elif title.startswith("$EIGENVALUE"):
            raise ValueError("the eigenvalue is not one of this kind of shapes")

    def _begin_point(self, line: str) -> None:
        """Begin the shapes at a node, if they are those of real modes."""
        identified = line.upper().partition("IDENTIFIED BY")[2].split()
        node = _POINT.search(line)
        is_mode = not identified or identified[0] in ("MODE", "EIGENVALUE", "EIGENVALUES")
        if self._is_read and (self._is_complex or not is_mode or node is None):
            what = "complex mode shapes" if self._is_complex else "results"
            self._note(f"{what} sorted by node (SORT2); those sorted by mode are read")
            self._is_read = False
        elif self._is_read and node is not None:
            self._point = int(node[1])

    def _note(self, text: str) -> None:
        if text not in self.refused:
            self.refused.append(text)

    def _begin_row(self, head: str, parts: list[str]) -> None:
        if self._table is None and self._point is None:
            if self._is_read:
                self._note("displacements without the eigenvalue of a mode")
            return
        first = _read_three(parts)
        if self._table is not None:
            node, table = read_integer(head), self._table
            if node in table:
                raise ValueError(f"node {node} is repeated in this mode")
            self._row, self._put = first, partial(table.__setitem__, node)
        elif self._point is not None:
            if "." not in head:
                self._note("mode shapes sorted by node (SORT2) without eigenvalues")
                self._is_read, self._point = False, None
                return
            shapes = self._by_node.setdefault(
                self._subcase, VectorsByNode(self._subcase, self._label)
            )
            rows, eigenvalue = shapes.rows.setdefault(self._point, []), read_real(head)
            self._row = first
            self._put = lambda row: rows.append((eigenvalue, row))

    def _end_row(self) -> None:
        """Store the row that was read: real parts of six components, then imaginary ones."""
        if self._put is None:
            return
        n = _COMPONENTS * (2 if self._is_complex else 1)
        if len(self._row) != n:
            raise ValueError(f"the row before has {len(self._row)} components, {n} expected")
        row: list[complex] = list(self._row[:_COMPONENTS])
        pairs = list(zip(self._row[:_COMPONENTS], self._row[_COMPONENTS:], strict=False))
        if self._is_polar:
            row = [size * np.exp(1j * np.radians(phase)) for size, phase in pairs]
        elif self._is_complex:
            row = [complex(real, imaginary) for real, imaginary in pairs]
        self._put(row)
        self._row, self._put = [], None


def _read_three(parts: list[str]) -> list[float]:
    """Read the three components of a line."""
    if len(parts) != _COMPONENTS // 2:
        raise ValueError(f"it has {len(parts)} numbers, {_COMPONENTS // 2} are expected")
    return [read_real(part) for part in parts]
