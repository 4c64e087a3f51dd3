"""Nastran output files (.op2): nodes, coordinate systems, eigenvalues and mode shapes."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from flexsid.errors import UnreadableFile
from flexsid.importers.source import Field

_GRID = (4501, 45)
_FRAMES = {(2101, 21): 1, (2001, 20): 2, (2201, 22): 3}
_FRAMES_BY_GRID = {(1801, 18): 1, (1701, 17): 2, (1901, 19): 3}
_REAL_EIGENVALUES, _COMPLEX_EIGENVALUES = 2, 9
_BUCKLING = (7, 8)  # before and after
_TABLES = (1, 7)  # displacements and eigenvectors
_GEOMETRY = re.compile(r"GEOM1[SN]?(OLD)?")
_EIGENVALUES = re.compile(r"LAMA[SF1]?")
_SHAPES = re.compile(r"B?(OUG(V?1)?|OPHIG|OUGV1PAT)")
_IN_BASIC = ("B", "OUGV1PAT")  # beginnings of tables whose shapes are in basic directions
_NOT_READ = {
    "ROUG": "displacements relative to an enforced motion",
    "BLAMA": "buckling factors",
    "CLAMA": "eigenvalues of complex modes",
    "OUGV2": "shapes sorted by node (SORT2)",
    "OUG2": "shapes sorted by node (SORT2)",
    "OUGPSD": "power spectra", "OUGRMS": "rms values", "OUGATO": "autocorrelations",
    "OUGCRM": "cumulative rms values", "OUGNO": "zero crossings",
    "OUXY": "shapes of the solution set", "TOUG": "temperatures",
}  # fmt: skip
"""Name prefixes of tables that are not read, and their content."""


def recognises(head: bytes) -> bool:
    """Return whether a file starts with the Fortran record of a one-word key."""
    return head[:4] in (b"\4\0\0\0", b"\0\0\0\4", b"\10\0\0\0", b"\0\0\0\10")


def read(path: Path) -> Iterator[Field]:
    """Read the tables of a file with modes and geometry.

    Raises
    ------
    UnreadableFile
        If the file ends within a record or has none of these tables.
    """
    words = _Words(path.read_bytes())
    found: dict[str, Field] = {}
    refused: list[str] = []
    for block in words.blocks():
        name = block[0][: 2 * words.size].decode("ascii", "replace")
        name = "".join(c for c in name if c.isalnum() or c == "_").strip()
        records = [record[words.size :] for record in block[2:]]  # each begins with its type
        if _GEOMETRY.fullmatch(name):
            fields = _geometry(records, words)
        elif _EIGENVALUES.fullmatch(name):
            fields = _eigenvalues(records, words)
        elif _SHAPES.fullmatch(name):
            fields = _shapes(records, words, name)
        else:
            what = next((what for head, what in _NOT_READ.items() if name.startswith(head)), None)
            if what is not None:
                refused.append(f"table {name} holds {what}, not the shapes of modes")
            elif "OUG" in name or "PHIG" in name:
                refused.append(f"table {name} is of a kind that is not read")
            continue
        taken = {field.path: field for field in fields}
        if "refused" in taken:
            refused += [str(text) for text in taken.pop("refused").samples]
        for group in ("grid", "frame", "mode", "shape"):
            part = {path: one for path, one in taken.items() if path.startswith(f"{group}/")}
            if not any(path.startswith(f"{group}/") for path in found):
                found |= part
            elif any(
                path not in found or not np.array_equal(one.samples, found[path].samples)
                for path, one in part.items()
            ):
                refused.append(f"table {name}: a table with other content is read")
    if not found:
        raise UnreadableFile(
            "it holds neither nodes (GEOM1) nor eigenvectors (OUG) nor eigenvalues (LAMA)"
            + (f", but {'; '.join(refused)}" if refused else "")
            + "; run with PARAM,POST,-1 and VECTOR=ALL.",
            code="nothing-usable",
        )
    yield from found.values()
    if refused:
        yield Field("refused", np.array(list(dict.fromkeys(refused)), dtype=np.str_))


class _Words:
    """Fortran records of a file: keys and data."""

    def __init__(self, data: bytes) -> None:
        self._data = data
        self.order = "<" if data[:4] in (b"\4\0\0\0", b"\10\0\0\0") else ">"
        self.size = max(data[:4])
        self.integer = np.dtype(f"{self.order}i{self.size}")
        self.real = np.dtype(f"{self.order}f{self.size}")
        self.reals = (self.real, np.dtype(f"{self.order}f8"))

    def _records(self) -> Iterator[bytes]:
        data, at = self._data, 0
        while at < len(data):
            length = int(np.frombuffer(data[at : at + 4], f"{self.order}i4")[0])
            end = at + 4 + length
            if length < 0 or end + 4 > len(data):
                raise UnreadableFile(
                    f"byte {at}: the file ends within a record of {length} bytes; "
                    "copy it again, as binary.",
                    code="cut-off",
                )
            if data[end : end + 4] != data[at : at + 4]:
                raise UnreadableFile(
                    f"byte {at}: a record does not end with its own length; the file was "
                    "copied as text or is damaged."
                )
            yield data[at + 4 : end]
            at = end + 4

    def blocks(self) -> Iterator[list[bytes]]:
        """Yield the logical records of each data block."""
        block: list[bytes] = []
        parts: list[bytes] = []
        records = self._records()
        for record in records:
            if len(record) != self.size:
                raise UnreadableFile(
                    f"a key of one word is expected, a record of {len(record)} bytes was found."
                )
            key = int(np.frombuffer(record, self.integer)[0])
            if key > 0:
                part = next(records, None)
                if part is None:
                    raise UnreadableFile("the file ends before a record.", code="cut-off")
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
            frames.append(_frames(body, words, _FRAMES[head]))
        elif head in _FRAMES_BY_GRID:
            part = np.frombuffer(body, words.integer).reshape(-1, 6)
            kind = np.full((part.shape[0], 1), _FRAMES_BY_GRID[head])
            by_grid.append(np.hstack([part[:, [0]], kind, part[:, 3:]]))
    if frames:
        rows = np.vstack(frames)
        for column, name in enumerate(("id", "kind", "reference")):
            yield Field(f"frame/{name}", rows[:, column].astype(np.int64))
        yield Field("frame/points", rows[:, 3:])
    if by_grid:
        yield Field("frame/by_grid", np.vstack(by_grid).astype(np.int64))


def _frames(body: bytes, words: _Words, kind: int) -> np.ndarray:
    """Return rows of id, kind, reference and three points, in single or double precision."""
    for real in words.reals:
        row = np.dtype([("i", words.integer, 4), ("x", real, 9)])
        if len(body) % row.itemsize:
            continue
        part = np.frombuffer(body, row)
        ids, kinds = part["i"][:, 0], part["i"][:, 1]
        if (kinds == kind).all() and (ids > 0).all() and np.isfinite(part["x"]).all():
            return np.hstack([part["i"][:, [0, 1, 3]], part["x"]]).astype(float)
    raise UnreadableFile(f"the table GEOM1 has CORD2{' RCS'[kind]} entries of an unknown layout.")


def _grids(body: bytes, words: _Words) -> Iterator[Field]:
    for real in words.reals:  # coordinates are in double precision in newer versions
        row = np.dtype([("i", words.integer, 2), ("x", real, 3), ("j", words.integer, 3)])
        if len(body) % row.itemsize:
            continue
        rows = np.frombuffer(body, row)
        (ids, cp), cd = rows["i"].T.astype(np.int64), rows["j"][:, 0].astype(np.int64)
        if (ids > 0).all() and (cd >= -1).all() and np.isfinite(rows["x"]).all():
            yield Field("grid/id", ids)
            yield Field("grid/cp", cp)
            yield Field("grid/xyz", rows["x"].astype(float))
            yield Field("grid/cd", cd)
            return
    raise UnreadableFile("the table GEOM1 has GRID entries of an unknown length.")


def _eigenvalues(records: list[bytes], words: _Words) -> Iterator[Field]:
    row = np.dtype([("i", words.integer, 2), ("x", words.real, 5)])
    if len(records) > 1 and len(records[1]) >= 10 * words.size:
        approach = int(np.frombuffer(records[1], words.integer, count=1)[0]) // 10
        if approach in _BUCKLING:
            yield Field("refused", np.array(["table LAMA holds buckling factors (SOL 105)"]))
            return
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
    refused: list[str] = []
    nodes = np.empty(0, dtype=np.int64)
    grids = np.empty(0, dtype=bool)
    subcase: int | None = None
    # After the name of the sub-table, identification and data records alternate.
    for ident, data in zip(records[1::2], records[2::2], strict=False):
        head = np.frombuffer(ident[: 10 * words.size], words.integer)
        if head.size < 10:
            break
        what = _describe_other_content(int(head[0]) // 10, int(head[1]))
        if what is None and subcase not in (None, int(head[3])):
            what = f"the modes of subcase {int(head[3])}; those of subcase {subcase} are read"
        if what is not None:
            refused.append(f"table {name} holds {what}")
            continue
        subcase, mode = int(head[3]), int(head[4])
        if int(head[9]) != 8 or len(data) % layout.itemsize:
            raise UnreadableFile(
                f"table {name} is not sorted by mode with real numbers (SORT1, REAL)."
            )
        rows = np.frombuffer(data, layout)
        given = rows["i"][:, 0].astype(np.int64) // 10
        if not shapes:
            nodes, grids = given, rows["i"][:, 1] == 1
        elif not np.array_equal(given, nodes):
            raise UnreadableFile(f"table {name} has other nodes for mode {mode}.")
        if mode in numbers:
            raise UnreadableFile(f"table {name} has mode {mode} twice in subcase {subcase}.")
        numbers.append(mode)
        eigenvalue = float(np.frombuffer(ident, words.real, count=6)[5])
        radians.append(float(np.sqrt(max(eigenvalue, 0.0))))
        shapes.append(rows["x"][grids].astype(float))
    if refused:
        yield Field("refused", np.array(refused, dtype=np.str_))
    if shapes:
        yield Field("shape/number", np.array(numbers, dtype=np.int64))
        yield Field("shape/radians", np.array(radians))
        yield Field("shape/node", nodes[grids])
        yield Field("shape/values", np.stack(shapes))
        if name.startswith(_IN_BASIC):
            yield Field("shape/basic", np.array([1]))


def _describe_other_content(approach: int, code: int) -> str | None:
    """Return a description of the content of a table; None for real modes."""
    if code % 1000 not in _TABLES:
        return f"results of kind {code % 1000}, not displacements"
    if approach == _COMPLEX_EIGENVALUES:
        return "complex modes; real ones (SOL 103) are read"
    if approach in _BUCKLING:
        return "buckling shapes (SOL 105)"
    if approach != _REAL_EIGENVALUES:
        return f"displacements of another solution (approach {approach}), not modes"
    if code // 1000:
        return "shapes that are sorted by node or not real (SORT1, REAL is read)"
    return None
