"""Nastran printouts (.f06): eigenvalues, eigenvectors, mass properties, flutter summaries.

A printout may hold several analyses: of subcases, configurations, symmetries, Mach numbers and
densities. A root ("POINT") belongs to one analysis, so rows are separated by the heading of their
page.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from flexsid.errors import UnreadableFile
from flexsid.importers.nastran.modal_cases import (
    BUCKLING,
    FLUTTER,
    ROW_OF_NUMBERS,
    EigenvalueTable,
    NastranCase,
    Vectors,
    VectorsByNode,
    find_solution,
    list_cases,
    list_notes,
)
from flexsid.importers.source import Field, read_integer, read_real
from flexsid.records.flutter import FlutterHeading

# --- Flutter summaries of a Nastran printout (SOL 145), with the analysis of every row ------------

_VALUE = re.compile(r"[-+]?\d*\.\d+(?:[EeDd]?[-+]\d+)?|[-+]?\d+\.?|\*{3,}|NaN|[-+]?Inf\w*", re.I)
_NUMBER = r"([-+]?[\d.]+(?:[EeDd][-+]?\d+)?)"
_POINT_HEADING = re.compile(r"POINT\s*=\s*(\d+)")
_MACH = re.compile(rf"MACH NUMBER\s*=\s*{_NUMBER}")
_DENSITY = re.compile(rf"DENSITY RATIO\s*=\s*{_NUMBER}")
_METHOD = re.compile(r"METHOD\s*=\s*([A-Z]+)")
_CONFIGURATION = re.compile(r"CONFIGURATION\s*=\s*(\S+)")
_SYMMETRY = re.compile(r"(X[YZ])-SYMMETRY\s*=\s*([A-Z]+)")
_COLUMNS = (
    ("1./KFREQ", "inverse"),
    ("KFREQ", "reduced_frequency"),
    ("DENSITY", "density"),
    ("MACH NO", "mach"),
    ("VELOCITY", "velocity"),
    ("DAMPING", "damping"),
    ("FREQUENCY", "frequency"),
)
_NEEDED = ("velocity", "damping", "frequency")


@dataclass(frozen=True, slots=True, kw_only=True)
class _Page(FlutterHeading):
    """Analysis parameters from the heading of a page."""

    mach: float
    density: float


@dataclass(slots=True)
class _FlutterAnalysis:
    """One analysis: its roots, and the rows of each."""

    page: _Page
    last: int = 0
    seen: dict[int, set[tuple[float, ...]]] = field(default_factory=dict)


@dataclass(slots=True)
class FlutterPages:
    """The flutter summaries of a printout, read line by line."""

    _analyses: list[_FlutterAnalysis] = field(default_factory=list)
    _rows: list[dict[str, float]] = field(default_factory=list)
    _current: int = -1
    _subcase: int = 0
    _symmetry: str = ""
    _configuration: str = ""
    _columns: list[str] = field(default_factory=list)

    def begin(self, subcase: int) -> None:
        """Begin a page."""
        self._subcase, self._symmetry, self._configuration = subcase, "", ""
        self._columns, self._current = [], -1

    def take(self, line: str) -> None:
        """Read the symmetry, the point, the heading or a row of a summary.

        Raises
        ------
        ValueError
            If the columns of a row differ from its heading, or a required number is missing.
        """
        if (configuration := _CONFIGURATION.search(line)) is not None:
            self._configuration = configuration[1]
        if symmetry := _SYMMETRY.findall(line):
            stated = [f"{plane} {how.lower()}" for plane, how in symmetry if how != "ASYMMETRIC"]
            self._symmetry = ", ".join(stated)
        elif (point := _POINT_HEADING.search(line)) is not None:
            self._open(int(point[1]), line)
        elif "KFREQ" in line:
            at = {name: line.replace("1./KFREQ", " " * 8).find(key) for key, name in _COLUMNS[1:]}
            at["inverse"] = line.find("1./KFREQ")
            self._columns = sorted((n for n in at if at[n] >= 0), key=at.__getitem__)
            self._columns += ["real", "imaginary"]
        elif self._columns and self._current >= 0:
            self._row(line)

    def _open(self, point: int, line: str) -> None:
        method, mach, density = (found.search(line) for found in (_METHOD, _MACH, _DENSITY))
        page = _Page(
            subcase=self._subcase,
            configuration=self._configuration,
            symmetry=self._symmetry,
            method="" if method is None else method[1],
            mach=np.nan if mach is None else float(mach[1]),
            density=np.nan if density is None else read_real(density[1]),
        )
        same = [k for k, one in enumerate(self._analyses) if repr(one.page) == repr(page)]
        # A root repeated after another root belongs to a new analysis.
        if not same or (
            point in self._analyses[same[-1]].seen and self._analyses[same[-1]].last != point
        ):
            self._analyses.append(_FlutterAnalysis(page))
            same.append(len(self._analyses) - 1)
        self._current = same[-1]
        self._analyses[self._current].last = point
        self._analyses[self._current].seen.setdefault(point, set())

    def _row(self, line: str) -> None:
        parts = _VALUE.findall(line)
        if len(parts) < len(_NEEDED) or _VALUE.sub("", line).strip():
            return  # not a row: text, or empty
        if not all("." in part or not part[-1].isdigit() for part in parts):
            return  # whole numbers, of another table
        if len(parts) != len(self._columns):
            raise ValueError(f"{len(self._columns)} numbers are expected, {len(parts)} were found")
        numbers = [np.nan if part.startswith("*") else read_real(part) for part in parts]
        row = dict(zip(self._columns, numbers, strict=True))  # asterisks: wider than the column
        if not all(np.isfinite(row[name]) for name in _NEEDED):
            raise ValueError("velocity, damping or frequency is not a number")
        analysis = self._analyses[self._current]
        place = (row["velocity"], row.get("density", 0.0), row.get("mach", 0.0))
        if place in analysis.seen[analysis.last] and analysis.page.method not in ("K", "KE"):
            point = analysis.last  # the sweep restarts under the same heading
            analysis = _FlutterAnalysis(analysis.page, point, {point: set()})
            self._analyses.append(analysis)
            self._current = len(self._analyses) - 1
        analysis.seen[analysis.last].add(place)
        page = analysis.page
        row.setdefault("mach", page.mach)
        row.setdefault("density", page.density)
        self._rows.append({"analysis": self._current, "point": analysis.last, **row})

    @property
    def is_empty(self) -> bool:
        """Whether no summary was found."""
        return not self._rows

    def fields(self) -> Iterator[Field]:
        """Yield rows in printed order, and the heading of each analysis."""
        if not self._rows:
            return
        for name in (
            *("analysis", "point", "velocity", "damping", "frequency", "real", "imaginary"),
            *("density", "mach"),
        ):
            yield Field(f"flutter/{name}", np.array([row[name] for row in self._rows], dtype=float))
        pages = [analysis.page for analysis in self._analyses]
        yield Field("flutter/subcase", np.array([page.subcase for page in pages]))
        for name in ("configuration", "symmetry", "method"):
            text = np.array([getattr(page, name) for page in pages], dtype=np.str_)
            yield Field(f"flutter/{name}", text)


# --- Nastran printouts (.f06): eigenvalues, eigenvectors, mass properties, flutter summaries ------

_ROW = re.compile(r"^(?:0(?=\s))?\s*([^\sA-Za-z]\S*?|NaN)\s*G(?![A-Za-z])(.*)$")
_VECTOR = re.compile(r"E I G E N V E C T O R(?:\s+N O \.\s+(\d+))?")
_POINT = re.compile(r"^0?\s*POINT-ID\s*=\s*(\d+)\s*$")
_IS_EIGENVALUE = re.compile(r"^\s*(?:COMPLEX\s+)?EIGENVALUE\s*=")
_EIGENVALUE = re.compile(
    r"^\s*EIGENVALUE\s*=\s*(\S+)\s*(?:\(CYCLIC FREQUENCY\s*=\s*\S+\s*HZ\s*\))?\s*$"
)
_COMPLEX_EIGENVALUE = re.compile(r"^\s*COMPLEX\s+EIGENVALUE\s*=\s*([^\s,]+)\s*,\s*(\S+)\s*$")
_MYSTRAN_SUBCASE = re.compile(r"^\s*OUTPUT FOR SUBCASE\s+(\d+)\s*$")
_MYSTRAN_MODE = re.compile(r"^\s*OUTPUT FOR EIGENVECTOR\s+(\d+)\s*$")
_SUBCASE = re.compile(r"^0(.*)\bSUBCASE\s+(\d+)")
_SUPERELEMENT = re.compile(r"^0.*\bSUPERELEMENT\s+(\d+)")
_REPEATED_SHAPE = 1e-6
_MASS = "O U T P U T   F R O M   G R I D   P O I N T   W E I G H T   G E N E R A T O R"
_REFERENCE = re.compile(r"REFERENCE POINT =\s*(\d+)")
_SPACED = re.compile(r"^.?\s*((?:\S )+\S(?!\S)(?:\s{2,}(?:\S )+\S(?!\S))*)")
_LETTERS = re.compile(r"(?:[A-Z] ){4}[A-Z]")
_COMPLEX_TABLE = "COMPLEX EIGENVALUE SUMMARY"
_OTHER_RESULTS = re.compile(
    r"(?<!EIGEN)VECTOR|DISPLACEMENT|FORCE|STRESS|STRAIN|ENERG|LOAD|MOMENT|RESULTANT|DERIVATIVE"
    rf"|EFFECTIVE|PARTICIPATION|FLUX|PRESSURE|{_COMPLEX_TABLE}"
)
"""Words in the headings of results that are not read; echoes and messages have none of them."""
_LABEL = 64  # characters of a subtitle; the page number may follow
_SIZE = 6  # of the mass matrix of a rigid body


def recognises(head: bytes) -> bool:
    """Return whether a file is plain text (printouts have no common beginning)."""
    return b"\0" not in head


def read(path: Path) -> Iterator[Field]:
    """Read the modes and flutter summaries of a printout."""
    lines = path.read_text(encoding="latin-1").splitlines()
    solution = find_solution(lines)
    printed = _Printout(solution)
    for number, line in enumerate(lines, start=1):
        try:
            printed.take(line)
        except ValueError as error:
            raise UnreadableFile(
                f"line {number}: '{line.strip()[:60]}' cannot be read ({error}).", row=number
            ) from error
    printed.finish()
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
    if solution:
        yield Field("solution", np.array([solution]))
    if refused:
        yield Field("refused", np.array(refused, dtype=np.str_))


class _Table:
    """One table of real eigenvalues, over its pages."""

    def __init__(self, subcase: int, superelement: int) -> None:
        self.subcase, self.superelement = subcase, superelement
        self.augmented = False
        self.highest = 0
        self.rows: dict[int, tuple[float, float]] = {}


@dataclass(slots=True)
class _MassMatrix:
    """Mass matrix of the rigid structure about a node (0: the origin), in basic directions."""

    reference: int = 0
    rows: list[list[float]] = field(default_factory=list)


class _Printout:
    """Content of a printout, read page by page."""

    def __init__(self, solution: str) -> None:
        self._buckling = solution == BUCKLING
        self._is_flutter = solution == FLUTTER
        self._take: Callable[[str], None] = self._nothing
        self._eigenvalue: complex | None = None
        self._subcase = self._superelement = self._mode = 0
        self._announced: int | None = None  # mode of MYSTRAN, before the heading of its shape
        self._label = self._subtitle = ""
        self._second_line: str | None = None  # of a page, None after the third
        self._is_polar = False
        self._tables: list[_Table] = []
        self._vectors = Vectors()
        self._by_node: dict[int, VectorsByNode] = {}
        self._point: int | None = None  # node of shapes sorted by node
        self._lacks_heading = False
        self._vector: dict[int, list[complex]] | None = None
        self._real: tuple[int, list[float]] | None = None  # first line of a complex row
        self._masses: list[_MassMatrix] = []
        self._largest: list[list[float]] = []
        self._flutter = FlutterPages()
        self._refused: list[str] = []
        self._others: Counter[str] = Counter()  # pages of other results

    def take(self, line: str) -> None:
        """Read a line: a heading, or a row of a table."""
        if self._second_line is None and ROW_OF_NUMBERS.fullmatch(line):
            self._take(line)
            return
        if self._second_line == "":
            self._second_line = line
        elif self._second_line is not None:  # the label follows the subtitle
            subtitle = self._second_line if line.startswith("0") else ""
            self._subtitle, self._second_line = subtitle.strip()[:_LABEL].strip(), None
        if (subcase := _SUBCASE.search(line)) is not None:
            self._label, self._subcase = subcase[1].strip(), int(subcase[2])
        if (point := _POINT.match(line)) is not None:
            self._point = int(point[1])
        if (subcase := _MYSTRAN_SUBCASE.match(line)) is not None:
            self._subcase = int(subcase[1])
            if self._tables and not self._tables[-1].subcase:
                self._tables[-1].subcase = self._subcase  # the table has no heading
        if (mode := _MYSTRAN_MODE.match(line)) is not None:
            self._announced = int(mode[1])
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
        elif _MASS in line:
            self._masses.append(_MassMatrix())
            self._take = self._row_of_mass
        elif "MAXIMUM  DISPLACEMENTS" in line:
            self._take = self._row_of_largest
        elif (other := _find_other_results(line)) != "":
            self._others[other] += 1
            self._take = self._nothing
        elif line[:1] == "1":  # a new page
            self._end_page()
            self._take = self._nothing
            self._superelement, self._second_line, self._point = 0, "", None
            self._eigenvalue = None
        else:
            if _IS_EIGENVALUE.match(line):
                self._eigenvalue = _read_eigenvalue(line)
            self._take(line)

    def _nothing(self, line: str) -> None:
        """Skip a line that is not used."""

    def _row_of_eigenvalues(self, line: str) -> None:
        """Read a row: mode, order, eigenvalue, radians, cycles, mass, stiffness."""
        if "AUGMENTATION OF RESIDUAL VECTORS" in line:
            self._tables[-1].augmented = "AFTER" in line
        parts = line.split()
        if len(parts) < 2 or not (parts[0].isdigit() and parts[1].isdigit()):
            return
        if len(parts) != 7:
            raise ValueError(f"it has {len(parts)} columns, 7 are expected")
        mode = read_integer(parts[0])
        if not self._tables[-1].rows and self._continues_table(mode):
            self._tables.pop()
        if mode in self._tables[-1].rows:
            raise ValueError(f"mode {mode} is repeated")
        self._tables[-1].rows[mode] = (read_real(parts[3]), read_real(parts[5]))
        self._tables[-1].highest = max(self._tables[-1].highest, mode)

    def _continues_table(self, mode: int) -> bool:
        """Return whether the table of a new page continues that of the page before."""
        if len(self._tables) < 2:
            return False
        before, now = self._tables[-2:]
        return (before.subcase, before.superelement) == (now.subcase, now.superelement) and (
            before.highest + 1 == mode > 1
        )

    def _begin_vector(self, line: str, mode: str | None) -> None:
        """Begin a mode, or continue it on a new page."""
        self._take, self._vector = self._row_of_vector, None
        if self._buckling:
            self._skip("buckling shapes (SOL 105), whose eigenvalues are load factors")
        elif mode is None and self._announced is not None:
            self._take, self._mode = self._row_of_mystran, self._announced
            self._eigenvalue, self._announced = self._find_eigenvalue(self._mode), None
        elif mode is None:
            self._take, self._lacks_heading = self._heading_by_node, True
        else:
            self._mode = int(mode)
            if "C O M P L E X" in line:
                self._take, self._real, self._is_polar = self._row_of_complex_vector, None, False

    def _find_eigenvalue(self, mode: int) -> float | None:
        """Return the eigenvalue of a mode in the table before it."""
        row = self._tables[-1].rows.get(mode) if self._tables else None
        return None if row is None else row[0] ** 2

    def _row_of_mystran(self, line: str) -> None:
        """Read a row: node, coordinate system, six components."""
        parts = line.split()
        if len(parts) < 2 or not (parts[0].isdigit() and parts[1].isdigit()):
            return
        self._add_row(read_integer(parts[0]), [*_read_components(parts[2:])])

    def _heading_by_node(self, line: str) -> None:
        """Read the heading of shapes sorted by node (SORT2), whose first column is to be known."""
        words = line.split()
        if "T1" in words and words[0] == "EIGENVALUE" and self._point is not None:
            self._take, self._lacks_heading = self._row_by_node, False

    def _end_page(self) -> None:
        """Note shapes sorted by node whose columns are not known."""
        if self._lacks_heading:
            self._skip(
                "mode shapes sorted by node (SORT2) without eigenvalues; those sorted by mode are "
                "read"
            )
            self._lacks_heading = False

    def _row_by_node(self, line: str) -> None:
        """Read a row of shapes sorted by node: eigenvalue, type, six components."""
        found = _ROW.match(line)
        if found is None or self._point is None:
            return
        shapes = self._by_node.setdefault(
            self._subcase, VectorsByNode(self._subcase, self._label or self._subtitle)
        )
        row: list[complex] = [*_read_components(found[2].split())]
        shapes.rows.setdefault(self._point, []).append((read_real(found[1]), row))

    def _row_of_complex_vector(self, line: str) -> None:
        """Read a row of two lines: node, type and real parts, then imaginary parts or phases."""
        if "RELATIVE TO" in line or "SOLUTION SET" in line:
            self._skip(f"shapes '{line.strip().strip('()').lower()}'")
        elif "MAGNITUDE" in line:
            self._is_polar = True
        if (found := _ROW.match(line)) is not None:
            if self._real is not None:
                raise ValueError(f"node {self._real[0]} has no second line")
            self._real = read_integer(found[1]), _read_components(found[2].split())
        elif self._real is not None and (parts := line[1:].split()):
            node, first = self._real
            second, self._real = _read_components(parts), None
            if self._is_polar:
                row = [a * np.exp(1j * np.radians(b)) for a, b in zip(first, second, strict=True)]
            else:
                row = [complex(a, b) for a, b in zip(first, second, strict=True)]
            self._add_row(node, row, is_complex=True)

    def _row_of_vector(self, line: str) -> None:
        """Read a row: node, type, six components."""
        if "RELATIVE TO" in line or "SOLUTION SET" in line:
            self._skip(f"shapes '{line.strip().strip('()').lower()}'")
            return
        if (found := _ROW.match(line)) is not None:
            self._add_row(read_integer(found[1]), [*_read_components(found[2].split())])

    def _add_row(self, node: int, row: list[complex], *, is_complex: bool = False) -> None:
        """Add the components of a mode at a node.

        Raises
        ------
        ValueError
            If the mode has no eigenvalue, or other components at this node.
        """
        if self._eigenvalue is None:
            raise ValueError(f"mode {self._mode} has no eigenvalue")
        if self._vector is None:
            self._vector = self._vectors.begin(
                self._subcase,
                self._mode,
                self._eigenvalue,
                is_complex=is_complex,
                label=self._label or self._subtitle,
            )
        known = self._vector.setdefault(node, row)
        if known is not row and not np.allclose(known, row, rtol=_REPEATED_SHAPE, atol=0.0):
            raise ValueError(f"mode {self._mode} has two different values at node {node}")

    def _row_of_mass(self, line: str) -> None:
        """Read the reference point or a row of the 6 x 6 mass matrix between asterisks."""
        found = self._masses[-1]
        if (point := _REFERENCE.search(line)) is not None:
            found.reference = int(point[1])
        inside = line.strip()
        if inside[:1] == inside[-1:] == "*" and len(found.rows) < _SIZE:
            parts = inside[1:-1].split()
            if len(parts) == _SIZE or found.rows:
                found.rows.append(_read_components(parts))

    def _skip(self, what: str) -> None:
        self._take = self._nothing
        self._refused.append(what)

    def _row_of_largest(self, line: str) -> None:
        """Read a row: largest component of one mode in each direction."""
        parts = line[1:].split()
        if len(parts) == 7 and parts[0].isdigit() and int(parts[0]) == len(self._largest) + 1:
            self._largest.append([read_real(part) for part in parts[1:]])

    def _tables_by_subcase(self) -> dict[int, _Table]:
        """Return the eigenvalue table of every subcase, without superelements."""
        found: dict[int, _Table] = {}
        for table in self._tables:
            usable = not self._buckling and table.superelement == 0
            if not usable or not any(mass > 0.0 for _, mass in table.rows.values()):
                continue
            known = found.setdefault(table.subcase, table)
            if table.augmented and not known.augmented:
                found[table.subcase] = table
        return found

    def finish(self) -> None:
        """Add the shapes that are sorted by node to those sorted by mode."""
        self._end_page()
        for shapes in self._by_node.values():
            shapes.add_to(self._vectors)

    def refused(self) -> list[str]:
        """Return descriptions of the content that is not used."""
        cases = self._cases()
        notes = [*self._refused, *list_notes(cases)]
        by_subcase = self._tables_by_subcase()
        shown = {case.subcase for case in cases} or set(list(by_subcase)[:1])
        for table in self._tables:
            read = by_subcase.get(table.subcase)
            if not table.rows or (table is read and table.subcase in shown):
                continue
            if self._buckling:
                notes.append(f"{len(table.rows)} buckling factors (SOL 105)")
            elif table.superelement:
                notes.append(f"the eigenvalues of superelement {table.superelement}")
            elif table.subcase not in shown:
                notes.append(
                    f"{len(table.rows)} eigenvalues of subcase {table.subcase}; those of subcase "
                    f"{min(shown)} are read"
                )
            elif read is not None and read.augmented:
                added = sorted(set(read.rows) - set(table.rows))
                if added:
                    notes.append(f"modes {added[0]} to {added[-1]} are residual vectors, not modes")
            else:
                notes.append(f"a further table of {len(table.rows)} eigenvalues")
        if any(case.is_complex for case in cases) or not self._flutter.is_empty:
            self._others.pop(_COMPLEX_TABLE, None)  # its roots are those of the shapes
        for title, count in self._others.items():
            pages = "a page" if count == 1 else f"{count} pages"
            notes.append(f"{pages} of other results: {title.lower()}")
        masses = self._complete_masses()
        if any(other != masses[0] for other in masses[1:]):
            notes.append(
                f"{len(masses) - 1} further mass matrices (GPWG), of other subcases or "
                "superelements; the first is read"
            )
        return list(dict.fromkeys(notes))

    def _cases(self) -> list[NastranCase]:
        """Return the shapes of all analyses; those of a flutter analysis are not in vacuo."""
        cases = self._vectors.cases()
        if self._flutter.is_empty and not self._is_flutter:
            return cases
        if any(case.is_complex for case in cases):
            self._refused.append(
                "complex modes: roots of a flutter analysis (SOL 145), which are not in vacuo"
            )
        return [case for case in cases if not case.is_complex]

    def _complete_masses(self) -> list[_MassMatrix]:
        return [found for found in self._masses if len(found.rows) == _SIZE]

    def fields(self) -> Iterator[Field]:
        """Yield all fields of the printout."""
        tables: dict[int, EigenvalueTable] = {}
        for subcase, table in self._tables_by_subcase().items():
            modes = [mode for mode, (_, mass) in table.rows.items() if mass > 0.0]
            radians, masses = (np.array([table.rows[m][k] for m in modes]) for k in (0, 1))
            tables[subcase] = (np.array(modes), radians, masses)
        yield from list_cases(self._cases(), tables)
        if self._largest:
            yield Field("shape/largest", np.array(self._largest))
        for found in self._complete_masses()[:1]:
            yield Field("rigid/mass", np.array(found.rows))
            yield Field("rigid/reference", np.array([found.reference]))
        yield from self._flutter.fields()


def _find_other_results(line: str) -> str:
    """Return the title of results that are not read, of letters with blanks; empty if none."""
    if _LETTERS.search(line) is None or (spaced := _SPACED.match(line)) is None:
        return ""
    words = re.split(r"\s{2,}", spaced[1])
    title = " ".join(word.replace(" ", "") for word in words)
    return title if _OTHER_RESULTS.search(title) else ""


def _read_eigenvalue(line: str) -> complex | None:
    """Read the eigenvalue in the heading of a shape; None if it is not one of a mode."""
    if (value := _EIGENVALUE.match(line)) is not None:
        return read_real(value[1])
    if (value := _COMPLEX_EIGENVALUE.match(line)) is not None:
        return complex(read_real(value[1]), read_real(value[2]))
    return None


def _read_components(parts: list[str]) -> list[float]:
    """Read the six components of a row."""
    if len(parts) != _SIZE:
        raise ValueError(f"it has {len(parts)} numbers, {_SIZE} are expected")
    return [read_real(part) for part in parts]
