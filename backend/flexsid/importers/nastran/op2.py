"""Nastran output files (.op2): nodes, coordinate systems, eigenvalues and mode shapes."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from flexsid.errors import UnreadableFile
from flexsid.importers.source import LARGEST_CONTENT, Content, Field

_GRID = (4501, 45)
_FRAMES = {(2101, 21): 1, (2001, 20): 2, (2201, 22): 3}
_FRAMES_BY_GRID = {(1801, 18): 1, (1701, 17): 2, (1901, 19): 3}
_REAL_EIGENVALUES, _COMPLEX_EIGENVALUES = 2, 9
_TABLES = (1, 7)  # displacements and eigenvectors
_TOLD = ("GEOM1", "OUG", "PHIG", "LAMA")
"""In the names of tables that are read: OUGV1, BOUGV1, OPHIG, GEOM1S, BLAMA ..."""


def recognises(head: bytes) -> bool:
    """Tell whether a file starts with the Fortran record of a one-word key."""
    return head[:4] in (b"\4\0\0\0", b"\0\0\0\4", b"\10\0\0\0", b"\0\0\0\10")


def read(path: Path) -> Content:
    """Read the tables of a file that tell of its modes.

    Raises
    ------
    UnreadableFile
        If the file ends within a record or holds no table of these.
    """
    return Content(_fields(path.read_bytes()))


class _Words:
    """The Fortran records of a file, as keys and what they announce."""

    def __init__(self, data: bytes) -> None:
        self._data = data
        self._at = 0
        self.order = "<" if data[:4] in (b"\4\0\0\0", b"\10\0\0\0") else ">"
        self.size = max(data[:4])
        self.integer = np.dtype(f"{self.order}i{self.size}")
        self.real = np.dtype(f"{self.order}f{self.size}")

    def _record(self) -> bytes | None:
        start = self._at + 4
        if self._at == len(self._data):
            return None
        length = int(np.frombuffer(self._data[self._at : start], f"{self.order}i4")[0])
        end = start + length
        if length < 0 or end + 4 > len(self._data):
            raise UnreadableFile(
                f"byte {self._at}: the file ends within a record of {length} bytes; "
                "copy it again, as binary.",
                code="cut-off",
            )
        if self._data[end : end + 4] != self._data[self._at : start]:
            raise UnreadableFile(
                f"byte {self._at}: a record does not end with its own length; the file was "
                "copied as text or is damaged."
            )
        self._at = end + 4
        return self._data[start:end]

    def _key(self) -> int | None:
        record = self._record()
        if record is None:
            return None
        if len(record) != self.size:
            raise UnreadableFile(
                f"byte {self._at}: a key of one word is expected, a record of {len(record)} "
                "bytes is there."
            )
        return int(np.frombuffer(record, self.integer)[0])

    def blocks(self) -> Iterator[list[bytes]]:
        """Logical records of one data block after the other."""
        block: list[bytes] = []
        parts: list[bytes] = []
        while (key := self._key()) is not None:
            if key > 0:
                part = self._record()
                if part is None:
                    raise UnreadableFile("the file ends where a record is announced.")
                parts.append(part)
                continue
            if parts:
                block.append(b"".join(parts))
                parts = []
            if key == 0:
                if block:
                    yield block
                block = []
        if block:
            yield block


def _fields(data: bytes) -> Iterator[Field]:
    words = _Words(data)
    found: dict[str, Field] = {}
    for block in words.blocks():
        name = block[0][: 2 * words.size].decode("ascii", "replace")
        name = "".join(c for c in name if c.isalnum() or c == "_").strip()
        if not any(part in name for part in _TOLD) or name.startswith("CLAMA"):
            continue
        records = [record[words.size :] for record in block[2:]]  # each begins with its type
        if "GEOM1" in name:
            fields = _geometry(records, words)
        elif "LAMA" in name:
            fields = _eigenvalues(records, words)
        else:
            fields = _shapes(records, words, name)
        for field in fields:
            found.setdefault(field.path, field)  # the first of several subcases
    if not found:
        raise UnreadableFile(
            "it holds neither nodes (GEOM1) nor eigenvectors (OUG) nor eigenvalues (LAMA); "
            "run with PARAM,POST,-1 and VECTOR=ALL.",
            code="nothing-usable",
        )
    yield from found.values()


def _geometry(records: list[bytes], words: _Words) -> Iterator[Field]:
    frames: list[np.ndarray] = []
    by_grid: list[np.ndarray] = []
    for record in records:
        numbers = np.frombuffer(record[: 2 * words.size], words.integer)
        head = (int(numbers[0]), int(numbers[1])) if numbers.size == 2 else (0, 0)
        body = record[3 * words.size :]
        if head == _GRID:
            yield from _grids(body, words)
        elif head in _FRAMES:
            row = np.dtype([("i", words.integer, 4), ("x", words.real, 9)])
            part = np.frombuffer(body, row)
            kind = np.full((part.size, 1), _FRAMES[head])
            frames.append(np.hstack([part["i"][:, [0]], kind, part["i"][:, [3]], part["x"]]))
        elif head in _FRAMES_BY_GRID:
            part = np.frombuffer(body, words.integer).reshape(-1, 6)
            kind = np.full((part.shape[0], 1), _FRAMES_BY_GRID[head])
            by_grid.append(np.hstack([part[:, [0]], kind, part[:, 3:]]))
    if frames:
        rows = np.vstack(frames).astype(float)
        for column, name in enumerate(("id", "kind", "reference")):
            yield Field(f"frame/{name}", rows[:, column].astype(np.int64))
        yield Field("frame/points", rows[:, 3:])
    if by_grid:
        yield Field("frame/by_grid", np.vstack(by_grid).astype(np.int64))


def _grids(body: bytes, words: _Words) -> Iterator[Field]:
    double = f"{words.order}f8"
    layouts = [
        np.dtype([("i", words.integer, 2), ("x", words.real, 3), ("j", words.integer, 3)]),
        np.dtype([("i", words.integer, 2), ("x", double, 3), ("j", words.integer, 3)]),
    ]
    for layout in layouts:  # newer versions write coordinates in double precision
        if len(body) % layout.itemsize:
            continue
        rows = np.frombuffer(body, layout)
        ids = rows["i"][:, 0]
        if (ids > 0).all() and (rows["j"][:, 0] >= -1).all() and np.isfinite(rows["x"]).all():
            yield Field("grid/id", ids.astype(np.int64))
            yield Field("grid/cp", rows["i"][:, 1].astype(np.int64))
            yield Field("grid/xyz", rows["x"].astype(float))
            yield Field("grid/cd", rows["j"][:, 0].astype(np.int64))
            return
    raise UnreadableFile("the table GEOM1 has GRID entries of an unknown length.")


def _eigenvalues(records: list[bytes], words: _Words) -> Iterator[Field]:
    row = np.dtype([("i", words.integer, 2), ("x", words.real, 5)])
    for record in records:
        if record and len(record) % row.itemsize == 0:
            rows = np.frombuffer(record, row)
            if (rows["i"][:, 0] == np.arange(1, rows.size + 1)).all():
                yield Field("mode/number", rows["i"][:, 0].astype(np.int64))
                yield Field("mode/radians", rows["x"][:, 1].astype(float))
                yield Field("mode/mass", rows["x"][:, 3].astype(float))
                return


def _shapes(records: list[bytes], words: _Words, name: str) -> Iterator[Field]:
    layout = np.dtype([("i", words.integer, 2), ("x", words.real, 6)])
    numbers: list[int] = []
    radians: list[float] = []
    shapes: list[np.ndarray] = []
    nodes = np.empty(0, dtype=np.int64)
    grids = np.empty(0, dtype=bool)
    # The sub-table's name comes first, then a table of identification before each of data.
    for ident, data in zip(records[1::2], records[2::2], strict=False):
        head = np.frombuffer(ident[: 10 * words.size], words.integer)
        if head.size < 10 or int(head[1]) % 1000 not in _TABLES:
            return
        approach, per_entry = int(head[0]) // 10, int(head[9])
        if approach != _REAL_EIGENVALUES:
            if approach == _COMPLEX_EIGENVALUES:
                text = f"table {name} holds complex modes; real ones (SOL 103) are read"
                yield Field("refused", np.array([text]))
            return
        if per_entry != 8 or len(data) % layout.itemsize:
            raise UnreadableFile(
                f"table {name} is not sorted by mode with real numbers (SORT1, REAL)."
            )
        rows = np.frombuffer(data, layout)
        if not shapes:
            nodes = rows["i"][:, 0].astype(np.int64) // 10
            grids = rows["i"][:, 1] == 1
        elif rows.size != nodes.size:
            raise UnreadableFile(f"table {name} has other nodes for mode {int(head[4])}.")
        if (len(shapes) + 1) * rows.size * 48 > LARGEST_CONTENT:
            raise UnreadableFile(f"table {name} holds more than {LARGEST_CONTENT} bytes.")
        numbers.append(int(head[4]))
        eigenvalue = float(np.frombuffer(ident, words.real, count=6)[5])
        radians.append(float(np.sqrt(max(eigenvalue, 0.0))))
        shapes.append(rows["x"][grids].astype(float))
    if shapes:
        yield Field("shape/number", np.array(numbers, dtype=np.int64))
        yield Field("shape/radians", np.array(radians))
        yield Field("shape/node", nodes[grids])
        yield Field("shape/values", np.stack(shapes))
