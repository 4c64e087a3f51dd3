"""Nastran printouts (.f06): eigenvalues, eigenvectors, flutter summaries of SOL 145."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from flexsid.errors import UnreadableFile
from flexsid.importers.source import Content, Field

_NUMBER = re.compile(r"[-+]?\d*\.\d+(?:[EeDd]?[-+]\d+)?|[-+]?\d+\.?")
_VECTOR = re.compile(r"E I G E N V E C T O R\s+N O \.\s+(\d+)")
_EIGENVALUE = re.compile(r"^\s*EIGENVALUE\s*=\s*([-+.\dEeDd]+)\s*$")
_POINT = re.compile(r"POINT\s*=\s*(\d+)")
_COLUMNS = (
    ("1./KFREQ", "inverse"),
    ("KFREQ", "reduced_frequency"),
    ("DENSITY", "density"),
    ("MACH NO", "mach"),
    ("VELOCITY", "velocity"),
    ("DAMPING", "damping"),
    ("FREQUENCY", "frequency"),
)


def recognises(head: bytes) -> bool:
    """Tell whether a file is plain text (printouts begin in many ways)."""
    return b"\0" not in head


def read(path: Path) -> Content:
    """Read what a printout tells of modes and of flutter."""
    return Content(_fields(path.read_text(encoding="latin-1").splitlines()))


def _fields(lines: list[str]) -> Iterator[Field]:
    printed = _Printout()
    take = printed.nothing
    for number, line in enumerate(lines, start=1):
        if "R E A L   E I G E N V A L U E S" in line:
            take = printed.eigenvalue
        elif (vector := _VECTOR.search(line)) is not None:
            printed.begin_vector(int(vector[1]))
            take = printed.vector
        elif "FLUTTER  SUMMARY" in line:
            take = printed.flutter
        elif "MAXIMUM  DISPLACEMENTS" in line:
            take = printed.largest
        elif line[:1] == "1":  # a new page
            take = printed.nothing
        else:
            if (value := _EIGENVALUE.search(line)) is not None:
                printed.next_eigenvalue = _number(value[1])
            try:
                take(line)
            except ValueError as error:
                raise UnreadableFile(
                    f"line {number}: '{line.strip()[:60]}' cannot be read.", row=number
                ) from error
    found = list(printed.fields())
    if not found:
        raise UnreadableFile(
            "it prints neither eigenvalues nor eigenvectors nor a flutter summary.",
            code="nothing-usable",
        )
    yield from found


class _Printout:
    """What has been read so far, page by page."""

    def __init__(self) -> None:
        self.next_eigenvalue = 0.0
        self._values: dict[int, tuple[float, float]] = {}
        self._closed = False
        self._vectors: dict[int, dict[int, list[float]]] = {}
        self._eigenvalues: dict[int, float] = {}
        self._vector: dict[int, list[float]] = {}
        self._largest: list[list[float]] = []
        self._point = 0
        self._columns: list[str] = []
        self._flutter: list[dict[str, float]] = []

    def nothing(self, line: str) -> None:
        """Pass over what is of no use here."""

    def eigenvalue(self, line: str) -> None:
        """Read a row: mode, order, eigenvalue, radians, cycles, mass, stiffness."""
        parts = line.split()
        if len(parts) != 7 or not (parts[0].isdigit() and parts[1].isdigit()):
            return
        mode = int(parts[0])
        if mode == 1 and self._values:
            self._closed = True  # a further subcase
        if not self._closed:
            self._values[mode] = (_number(parts[3]), _number(parts[5]))

    def begin_vector(self, mode: int) -> None:
        """Begin with a mode, or go on with it on a new page."""
        self._vector = self._vectors.setdefault(mode, {})
        self._eigenvalues.setdefault(mode, self.next_eigenvalue)

    def vector(self, line: str) -> None:
        """Read a row: node, type, six components."""
        parts = line.split()
        if len(parts) == 8 and parts[0].isdigit() and parts[1] == "G":
            self._vector.setdefault(int(parts[0]), [_number(part) for part in parts[2:]])

    def largest(self, line: str) -> None:
        """Read a row: largest component of one mode in each direction."""
        parts = line[1:].split()
        if len(parts) == 7 and parts[0].isdigit() and int(parts[0]) == len(self._largest) + 1:
            self._largest.append([_number(part) for part in parts[1:]])

    def flutter(self, line: str) -> None:
        """Read the point, the heading or a row of a flutter summary."""
        if (point := _POINT.search(line)) is not None:
            self._point = int(point[1])
        elif "KFREQ" in line:
            at = {name: line.replace("1./KFREQ", " " * 8).find(key) for key, name in _COLUMNS[1:]}
            at["inverse"] = line.find("1./KFREQ")
            self._columns = sorted((n for n in at if at[n] >= 0), key=at.__getitem__)
            self._columns += ["real", "imaginary"]
        else:
            numbers = _NUMBER.findall(line)
            if self._columns and len(numbers) == len(self._columns):
                row = dict(zip(self._columns, map(_number, numbers), strict=True))
                self._flutter.append({"point": float(self._point), **row})

    def fields(self) -> Iterator[Field]:
        """Everything that was found."""
        computed = [mode for mode, (_, mass) in self._values.items() if mass > 0.0]
        if computed:
            yield Field("mode/number", np.array(computed, dtype=np.int64))
            yield Field("mode/radians", np.array([self._values[m][0] for m in computed]))
            yield Field("mode/mass", np.array([self._values[m][1] for m in computed]))
        if self._largest:
            yield Field("shape/largest", np.array(self._largest))
        yield from shape_fields(self._vectors, self._eigenvalues)
        names = ("point", "velocity", "damping", "frequency", "real", "imaginary")
        for name in (*names, "density", "mach"):
            values = [row[name] for row in self._flutter if name in row]
            if values:
                yield Field(f"flutter/{name}", np.array(values))


def shape_fields(
    vectors: dict[int, dict[int, list[float]]], eigenvalues: dict[int, float]
) -> Iterator[Field]:
    """Shapes printed or punched node by node; what was left out as zero is zero."""
    if not vectors:
        return
    modes = sorted(vectors)
    nodes = sorted({node for rows in vectors.values() for node in rows})
    zero = [0.0] * 6
    values = [[vectors[mode].get(node, zero) for node in nodes] for mode in modes]
    yield Field("shape/number", np.array(modes, dtype=np.int64))
    radians = [max(eigenvalues.get(mode, 0.0), 0.0) ** 0.5 for mode in modes]
    yield Field("shape/radians", np.array(radians))
    yield Field("shape/node", np.array(nodes, dtype=np.int64))
    yield Field("shape/values", np.array(values, dtype=float).reshape(len(modes), -1, 6))


def _number(text: str) -> float:
    return float(text.upper().replace("D", "E"))
