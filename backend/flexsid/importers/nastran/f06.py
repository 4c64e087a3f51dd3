"""Nastran printouts (.f06): eigenvalues, eigenvectors, flutter summaries of SOL 145."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np

from flexsid.errors import UnreadableFile
from flexsid.importers.nastran.bulk import read_real
from flexsid.importers.nastran.flutter import FlutterPages
from flexsid.importers.nastran.vectors import Vectors
from flexsid.importers.source import Field

_VECTOR = re.compile(r"E I G E N V E C T O R(?:\s+N O \.\s+(\d+))?")
_EIGENVALUE = re.compile(r"^\s*EIGENVALUE\s*=\s*([-+.\dEeDd]+)\s*$")
_SUBCASE = re.compile(r"^0.*\bSUBCASE\s+(\d+)")
_SUPERELEMENT = re.compile(r"^0.*\bSUPERELEMENT\s+(\d+)")
_BUCKLING = re.compile(
    r"^\s*(?:\d+\s+)?SOL\s*=?\s*(?:105|SEBUCKL)\b|B U C K L I N G|\(BUCKLING", re.IGNORECASE
)
_REPEATED_SHAPE = 1e-6


def recognises(head: bytes) -> bool:
    """Return whether a file is plain text (printouts have no common beginning)."""
    return b"\0" not in head


def read(path: Path) -> Iterator[Field]:
    """Read the modes and flutter summaries of a printout."""
    lines = path.read_text(encoding="latin-1").splitlines()
    printed = _Printout(buckling=any(_BUCKLING.search(line) for line in lines))
    for number, line in enumerate(lines, start=1):
        try:
            printed.take(line)
        except ValueError as error:
            raise UnreadableFile(
                f"line {number}: '{line.strip()[:60]}' cannot be read ({error}).", row=number
            ) from error
    found = list(printed.fields())
    refused = printed.refused()
    if not found:
        raise UnreadableFile(
            f"it has no usable content: {'; '.join(refused)}."
            if refused
            else "it has no eigenvalues, eigenvectors or flutter summary.",
            code="nothing-usable",
        )
    yield from found
    if refused:
        yield Field("refused", np.array(refused, dtype=np.str_))


class _Table:
    """One table of real eigenvalues, over its pages."""

    def __init__(self, subcase: int, superelement: int) -> None:
        self.subcase, self.superelement = subcase, superelement
        self.augmented = False
        self.rows: dict[int, tuple[float, float]] = {}


class _Printout:
    """Content of a printout, read page by page."""

    def __init__(self, buckling: bool) -> None:
        self._buckling = buckling
        self._take: Callable[[str], None] = self._nothing
        self._eigenvalue = 0.0
        self._subcase = self._superelement = self._mode = 0
        self._tables: list[_Table] = []
        self._vectors = Vectors()
        self._vector: dict[int, list[float]] | None = None
        self._largest: list[list[float]] = []
        self._flutter = FlutterPages()
        self._refused: list[str] = []

    def take(self, line: str) -> None:
        """Read a line: a heading, or a row of a table."""
        if (subcase := _SUBCASE.search(line)) is not None:
            self._subcase = int(subcase[1])
        if (element := _SUPERELEMENT.search(line)) is not None:
            self._superelement = int(element[1])
        if "R E A L   E I G E N V A L U E S" in line:
            self._tables.append(_Table(self._subcase, self._superelement))
            self._take = self._row_of_eigenvalues
        elif (vector := _VECTOR.search(line)) is not None:
            self._begin_vector(line, vector[1])
        elif "FLUTTER  SUMMARY" in line:
            self._flutter.begin(self._subcase)
            self._take = self._flutter.take
        elif "MAXIMUM  DISPLACEMENTS" in line:
            self._take = self._row_of_largest
        elif line[:1] == "1":  # a new page
            self._take = self._nothing
            self._superelement = 0
        else:
            if (value := _EIGENVALUE.search(line)) is not None:
                self._eigenvalue = read_real(value[1])
            self._take(line)

    def _nothing(self, line: str) -> None:
        """Skip a line that is not used."""

    def _row_of_eigenvalues(self, line: str) -> None:
        """Read a row: mode, order, eigenvalue, radians, cycles, mass, stiffness."""
        if "AUGMENTATION OF RESIDUAL VECTORS" in line:
            self._tables[-1].augmented = "AFTER" in line
        parts = line.split()
        if len(parts) != 7 or not (parts[0].isdigit() and parts[1].isdigit()):
            return
        mode = int(parts[0])
        if not self._tables[-1].rows and self._continues_table(mode):
            self._tables.pop()
        if mode in self._tables[-1].rows:
            raise ValueError(f"mode {mode} is repeated")
        self._tables[-1].rows[mode] = (read_real(parts[3]), read_real(parts[5]))

    def _continues_table(self, mode: int) -> bool:
        """Return whether the table of a new page continues that of the page before."""
        if len(self._tables) < 2:
            return False
        before, now = self._tables[-2:]
        return (before.subcase, before.superelement) == (now.subcase, now.superelement) and (
            max(before.rows, default=0) + 1 == mode > 1
        )

    def _begin_vector(self, line: str, mode: str | None) -> None:
        """Begin a mode, or continue it on a new page."""
        self._take, self._vector = self._row_of_vector, None
        if "C O M P L E X" in line:
            self._skip("complex mode shapes; real ones (SOL 103) are read")
        elif mode is None:
            self._skip("mode shapes sorted by node (SORT2); those sorted by mode are read")
        elif self._buckling:
            self._skip("buckling shapes (SOL 105)")
        else:
            self._mode = int(mode)

    def _row_of_vector(self, line: str) -> None:
        """Read a row: node, type, six components."""
        if "RELATIVE TO" in line or "SOLUTION SET" in line:
            self._skip(f"shapes '{line.strip().strip('()').lower()}'")
            return
        parts = line.split()
        if len(parts) != 8 or not parts[0].isdigit() or parts[1] != "G":
            return
        if self._vector is None:
            self._vector = self._vectors.begin(self._subcase, self._mode, self._eigenvalue)
        row = [read_real(part) for part in parts[2:]]
        known = self._vector.setdefault(int(parts[0]), row)
        if not np.allclose(known, row, rtol=_REPEATED_SHAPE, atol=0.0):
            raise ValueError(f"mode {self._mode} has two different values at node {parts[0]}")

    def _skip(self, what: str) -> None:
        self._take = self._nothing
        self._refused.append(what)

    def _row_of_largest(self, line: str) -> None:
        """Read a row: largest component of one mode in each direction."""
        parts = line[1:].split()
        if len(parts) == 7 and parts[0].isdigit() and int(parts[0]) == len(self._largest) + 1:
            self._largest.append([read_real(part) for part in parts[1:]])

    def _table(self) -> _Table | None:
        """Return the eigenvalue table of the subcase of the shapes, without superelements."""
        subcase = self._vectors.subcase
        usable = [
            table
            for table in self._tables
            if not self._buckling
            and table.superelement == 0
            and any(mass > 0.0 for _, mass in table.rows.values())
            and subcase in (None, table.subcase)
        ]
        if not usable:
            return None
        same = [table for table in usable if table.subcase == usable[0].subcase]
        return next((table for table in same if table.augmented), same[0])

    def refused(self) -> list[str]:
        """Return descriptions of the content that is not used."""
        notes = [*self._refused, *self._vectors.notes()]
        read = self._table()
        for table in self._tables:
            if table is read or not table.rows:
                continue
            if self._buckling:
                notes.append(f"{len(table.rows)} buckling factors (SOL 105)")
            elif table.superelement:
                notes.append(f"the eigenvalues of superelement {table.superelement}")
            elif read is not None and table.subcase != read.subcase:
                notes.append(
                    f"{len(table.rows)} eigenvalues of subcase {table.subcase}; those of subcase "
                    f"{read.subcase} are read"
                )
            elif read is not None and read.augmented:
                added = sorted(set(read.rows) - set(table.rows))
                if added:
                    notes.append(f"modes {added[0]} to {added[-1]} are residual vectors, not modes")
            else:
                notes.append(f"a further table of {len(table.rows)} eigenvalues")
        return list(dict.fromkeys(notes))

    def fields(self) -> Iterator[Field]:
        """Yield all fields of the printout."""
        table = self._table()
        if table is not None:
            computed = [mode for mode, (_, mass) in table.rows.items() if mass > 0.0]
            yield Field("mode/number", np.array(computed))
            yield Field("mode/radians", np.array([table.rows[m][0] for m in computed]))
            yield Field("mode/mass", np.array([table.rows[m][1] for m in computed]))
        if self._largest:
            yield Field("shape/largest", np.array(self._largest))
        yield from self._vectors.fields()
        yield from self._flutter.fields()
