"""Nastran matrices (.op4), text and binary, dense and sparse: read and written."""

from __future__ import annotations

import re
import struct
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from flexsid.errors import UnreadableFile
from flexsid.importers.matrices import MatrixTerms
from flexsid.importers.source import Field

_HEADER = re.compile(
    rb"\s*\d+\s*-?\d+\s+\d{1,2}\s+[1-4][A-Z_][A-Z0-9_ ]{0,7}\s*(1P,)?\s*\d*[ED]\d+", re.IGNORECASE
)
_NUMBERS = re.compile(r"(\d+)\s*[ED](\d+)\.")
_PER_LINE, _WIDTH = 5, 16  # of a text file that states no format
_SINGLE, _DOUBLE = (1, 3), (2, 4)  # types; 3 and 4 are complex
_BIG = 65536
"""Rows from which the strings of sparse columns have two words of length and row."""

_MOST_TERMS = 50_000_000


def recognises(head: bytes) -> bool:
    """Return whether a file begins with the record of a matrix, as text or Fortran record."""
    if 0 not in head[:4]:
        return _HEADER.match(head) is not None
    return any(head[:4] == struct.pack(f"{order}i", size) for order in "<>" for size in (24, 48))


def read(path: Path) -> Iterator[Field]:
    """Read the terms of all matrices of a file.

    Raises
    ------
    UnreadableFile
        If a record contradicts the size of its matrix, or the file ends within one.
    """
    data = path.read_bytes()
    matrices = _read_text(data) if 0 not in data[:4] else _read_records(data)
    names: set[str] = set()
    for name, terms in matrices:
        unique, again = name, 1
        while unique in names:
            again += 1
            unique = f"{name} ({again})"
        names.add(unique)
        yield from terms.fields(unique)
    if not names:
        raise UnreadableFile("it holds no matrix.", code="nothing-usable")


@dataclass(slots=True)
class _Terms:
    """Terms of a matrix while it is read; parts of complex terms alternate."""

    name: str
    n_rows: int
    n_columns: int
    kind: int
    rows: list[np.ndarray] = field(default_factory=list)
    columns: list[np.ndarray] = field(default_factory=list)
    values: list[np.ndarray] = field(default_factory=list)
    size: int = 0

    def add(self, column: int, row: int, values: np.ndarray) -> None:
        """Add consecutive terms of a column, from a row on (both from 1)."""
        if self.kind > 2:
            values = values[0::2] + 1j * values[1::2]
        self.size += values.size
        if not (1 <= column <= self.n_columns and 1 <= row <= self.n_rows - values.size + 1):
            raise UnreadableFile(
                f"matrix {self.name}: column {column} has {values.size} terms from row {row} on; "
                f"the matrix has {self.n_rows} rows and {self.n_columns} columns.",
            )
        if self.size > _MOST_TERMS:
            raise UnreadableFile(f"matrix {self.name} has more than {_MOST_TERMS} terms.")
        present = np.flatnonzero(values)
        self.rows.append(present + row - 1)
        self.columns.append(np.full(present.size, column - 1))
        self.values.append(values[present])

    def finish(self) -> MatrixTerms:
        """Return the terms of the whole matrix."""
        empty = np.empty(0, dtype=np.int64)
        return MatrixTerms(
            size=(self.n_rows, self.n_columns),
            rows=np.concatenate([empty, *self.rows]),
            columns=np.concatenate([empty, *self.columns]),
            values=np.concatenate([np.empty(0), *self.values]),
        )


def _begin(name: str, columns: int, rows: int, kind: int) -> tuple[_Terms, bool]:
    """Return an empty matrix, and whether strings of sparse columns have two words."""
    if columns < 1 or rows == 0 or kind not in (*_SINGLE, *_DOUBLE):
        raise UnreadableFile(
            f"a matrix of {columns} columns, {rows} rows and type {kind} was found where the "
            "record of a matrix is expected; the file is damaged or of another version."
        )
    return _Terms(name.strip(), abs(rows), columns, kind), rows < 0 or rows >= _BIG


def _split_string(word: int) -> tuple[int, int]:
    """Return length in words and first row of a string of a sparse column."""
    length = word // _BIG - 1
    return length, word - _BIG * (length + 1)


class _Lines:
    """Lines of a text file, with the place for messages."""

    def __init__(self, text: str) -> None:
        self._lines = text.splitlines()
        self.number = 0

    def take(self) -> str:
        """Return the next line."""
        if self.number == len(self._lines):
            raise UnreadableFile("the file ends within a matrix; copy it again.", code="cut-off")
        self.number += 1
        return self._lines[self.number - 1]

    def is_at_end(self) -> bool:
        """Return whether only empty lines follow."""
        return not any(line.strip() for line in self._lines[self.number : self.number + 3])

    def take_integers(self, count: int) -> list[int]:
        """Return the integers of a line, in fields of eight characters or separated."""
        line = self.take()
        parts = line.split()
        if len(parts) != count:
            parts = [line[8 * k : 8 * k + 8] for k in range(count)]
        try:
            return [int(part) for part in parts]
        except ValueError as error:
            raise UnreadableFile(
                f"line {self.number}: '{line.strip()[:60]}' is not the begin of a column.",
                row=self.number,
            ) from error

    def take_numbers(self, count: int, per_line: int, width: int) -> np.ndarray:
        """Return real numbers in fields of equal width."""
        numbers: list[float] = []
        while len(numbers) < count:
            line = self.take()
            expected = min(per_line, count - len(numbers))
            parts = [line[width * k : width * k + width] for k in range(expected)]
            try:
                numbers += [float(part.upper().replace("D", "E")) for part in parts]
            except ValueError as error:
                raise UnreadableFile(
                    f"line {self.number}: '{line.strip()[:60]}' does not hold {expected} numbers.",
                    row=self.number,
                ) from error
        return np.array(numbers)


def _read_text(data: bytes) -> Iterator[tuple[str, MatrixTerms]]:
    lines = _Lines(data.decode("latin-1"))
    while not lines.is_at_end():
        header = lines.take()
        is_wide = header.rstrip().endswith("|I16")
        width = 16 if is_wide else 8
        try:
            columns, rows = int(header[:width]), int(header[width : 2 * width])
            kind = int(header[2 * width + 8 : 2 * width + 16])
        except ValueError as error:
            raise UnreadableFile(
                f"line {lines.number}: '{header.strip()[:60]}' is not the record of a matrix.",
                row=lines.number,
            ) from error
        found, is_big = _begin(header[2 * width + 16 : 2 * width + 24], columns, rows, kind)
        stated = _NUMBERS.search(header[2 * width + 24 :].upper())
        form = (int(stated[1]), int(stated[2])) if stated else (_PER_LINE, _WIDTH)
        words = 1 if kind in _SINGLE else 2
        while True:
            column, row, count = lines.take_integers(3)
            if column > columns:
                lines.take()  # a number of no meaning ends the matrix
                break
            if row > 0:
                found.add(column, row, lines.take_numbers(count, *form))
                continue
            while count > 0:
                if is_big:
                    length, row = lines.take_integers(2)
                    length, count = length - 1, count - 1
                else:
                    length, row = _split_string(lines.take_integers(1)[0])
                count -= length + 1
                found.add(column, row, lines.take_numbers(length // words, *form))
        yield found.name, found.finish()


def _read_records(data: bytes) -> Iterator[tuple[str, MatrixTerms]]:
    order = "<" if data[:4] in (struct.pack("<i", 24), struct.pack("<i", 48)) else ">"
    size = 8 if struct.unpack(f"{order}i", data[:4])[0] == 48 else 4
    integer = np.dtype(f"{order}i{size}")
    records = _list_records(data, order)
    for head in records:
        if len(head) != 6 * size:
            raise UnreadableFile(
                f"a record of {len(head)} bytes was found, {6 * size} are expected of a matrix."
            )
        columns, rows, _, kind = (int(n) for n in np.frombuffer(head, integer, 4))
        name = head[4 * size :].decode("latin-1").replace("\0", " ")
        found, is_big = _begin("".join(name.split()), columns, rows, kind)
        real = np.dtype(f"{order}f{size if kind in _SINGLE else 8}")
        words = real.itemsize // size
        for record in records:
            column, row, count = (int(n) for n in np.frombuffer(record, integer, 3))
            if column > columns:
                break
            body = record[3 * size :]
            if len(body) < count * size:
                raise UnreadableFile(
                    f"matrix {found.name}: column {column} states {count} words and has "
                    f"{len(body) // size}."
                )
            if row > 0:
                found.add(column, row, np.frombuffer(body, real, count // words).astype(float))
                continue
            at = 0
            while at < count * size:
                if is_big:
                    length, row = (int(n) for n in np.frombuffer(body, integer, 2, at))
                    length, at = length - 1, at + 2 * size
                else:
                    length, row = _split_string(int(np.frombuffer(body, integer, 1, at)[0]))
                    at += size
                values = np.frombuffer(body, real, length // words, at).astype(float)
                at += length * size
                found.add(column, row, values)
        else:
            raise UnreadableFile("the file ends within a matrix; copy it again.", code="cut-off")
        yield found.name, found.finish()


def _list_records(data: bytes, order: str) -> Iterator[bytes]:
    """Yield the contents of Fortran records."""
    at = 0
    while at < len(data):
        length = struct.unpack(f"{order}i", data[at : at + 4].ljust(4, b"\0"))[0]
        end = at + 4 + length
        if length < 0 or end + 4 > len(data):
            raise UnreadableFile(
                f"byte {at}: the file ends within a record of {length} bytes; copy it again, as "
                "binary.",
                code="cut-off",
            )
        yield data[at + 4 : end]
        at = end + 4


def write_op4(matrices: Mapping[str, np.ndarray], *, binary: bool = False) -> bytes:
    """Write dense real matrices, in double precision and the dense form.

    Parameters
    ----------
    matrices
        Matrices by name, of at most eight letters and digits.
    binary
        As Fortran records (little-endian, words of four bytes) instead of text.

    Notes
    -----
    Columns are written from the first to the last term that is not zero.
    """
    parts = []
    for name, values in matrices.items():
        matrix = np.atleast_2d(np.asarray(values, dtype=float))
        write = _write_records if binary else _write_text
        parts.append(write(name.upper()[:8], matrix, 6 if _is_symmetric(matrix) else 2))
    return b"".join(parts)


def _is_symmetric(matrix: np.ndarray) -> bool:
    return matrix.shape[0] == matrix.shape[1] and np.array_equal(matrix, matrix.T)


def _list_columns(matrix: np.ndarray) -> Iterator[tuple[int, int, np.ndarray]]:
    """Yield number, first row and terms of each column that is not zero."""
    for column, values in enumerate(matrix.T, start=1):
        present = np.flatnonzero(values)
        if present.size:
            yield column, int(present[0]) + 1, values[present[0] : present[-1] + 1]


def _write_text(name: str, matrix: np.ndarray, form: int) -> bytes:
    rows, columns = matrix.shape
    lines = [f"{columns:8d}{rows:8d}{form:8d}{2:8d}{name:8s}1P,3E24.16"]
    for column, row, values in _list_columns(matrix):
        lines.append(f"{column:8d}{row:8d}{values.size:8d}")
        lines += [
            "".join(f"{x:24.16E}" for x in values[k : k + 3]) for k in range(0, values.size, 3)
        ]
    lines += [f"{columns + 1:8d}{1:8d}{1:8d}", f"{1.0:24.16E}", ""]
    return "\n".join(lines).encode()


def _write_records(name: str, matrix: np.ndarray, form: int) -> bytes:
    rows, columns = matrix.shape
    records = [struct.pack("<4i8s", columns, rows, form, 2, name.ljust(8).encode())]
    records += [
        struct.pack("<3i", column, row, 2 * values.size) + values.astype("<f8").tobytes()
        for column, row, values in _list_columns(matrix)
    ]
    records.append(struct.pack("<3id", columns + 1, 1, 2, 1.0))
    return b"".join(
        (length := struct.pack("<i", len(record))) + record + length for record in records
    )
