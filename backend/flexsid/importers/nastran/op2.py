"""Nastran output files (.op2): nodes, coordinate systems, edges, eigenvalues, mode shapes."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from flexsid.errors import UnreadableFile
from flexsid.importers.nastran.modal_cases import (
    EigenvalueTable,
    NastranCase,
    list_cases,
    list_notes,
)
from flexsid.importers.source import Field

_GRID = (4501, 45)
_FRAMES = {(2101, 21): 1, (2001, 20): 2, (2201, 22): 3}
_FRAMES_BY_GRID = {(1801, 18): 1, (1701, 17): 2, (1901, 19): 3}
_REAL_EIGENVALUES, _COMPLEX_EIGENVALUES = 2, 9
_BUCKLING = (7, 8)  # before and after
_POLAR = 3  # format code of magnitude and phase [deg]
_SUBTITLE, _LABEL, _TITLE_WORDS = 82, 114, 32  # words of an identification record
_TABLES = (1, 7)  # displacements and eigenvectors
_BY_NODE = (2001, 2007)  # the same, sorted by node
_GEOMETRY = re.compile(r"GEOM1[SN]?(OLD)?")
_ELEMENTS = re.compile(r"GEOM[24][SN]?(OLD)?")
_CORNERS = {
    (2958, 51): ((14, 15), slice(2, 6)),  # CQUAD4
    (8009, 80): ((14, 15), slice(2, 6)),  # CQUADR
    (3101, 31): ((6,), slice(2, 6)),  # CSHEAR
    (5959, 59): ((13, 14), slice(2, 5)),  # CTRIA3
    (9200, 92): ((13, 14), slice(2, 5)),  # CTRIAR
    (2408, 24): ((16,), slice(2, 4)),  # CBAR
    (5408, 54): ((18,), slice(2, 4)),  # CBEAM
    (3001, 30): ((4,), slice(2, 4)),  # CROD
    (3701, 37): ((4,), slice(2, 4)),  # CTUBE
    (1601, 16): ((8,), slice(1, 3)),  # CONROD
    (5201, 52): ((3,), slice(1, 3)),  # PLOTEL
}
"""Words of an element, by version, and those with the nodes at its corners."""

_RBE2 = (6901, 69)
_LARGEST_NODE = 99_999_999
_GROUPS = {
    "grid": {1: ("id", "cp", "xyz", "cd")},
    "frame": {1: ("id", "kind", "reference", "points"), 5: ("by_grid",)},
}
"""Fields of nodes and coordinate systems with a row each, by the columns of the first of them."""

_FLUTTER = "OVG"  # table of the flutter summary
_EIGENVALUES = re.compile(r"LAMA[SF1]?")
_SHAPES = re.compile(r"B?(OUG(V?[12])?|OPHIG|OUGV1PAT)")
_IN_BASIC = ("B", "OUGV1PAT")  # beginnings of tables whose shapes are in basic directions
_NOT_READ = {
    "ROUG": "displacements relative to an enforced motion",
    "BLAMA": "buckling factors",
    "CLAMA": "eigenvalues of complex modes",
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
    edges: list[np.ndarray] = []
    tables: dict[int, EigenvalueTable] = {}
    cases: list[NastranCase] = []
    by_node: dict[int, _NodeShapes] = {}
    others: list[str] = []
    is_flutter = False
    for block in words.blocks():
        name = block[0][: 2 * words.size].decode("ascii", "replace")
        name = "".join(c for c in name if c.isalnum() or c == "_").strip()
        records = [record[words.size :] for record in block[2:]]  # each begins with its type
        is_flutter = is_flutter or name.startswith(_FLUTTER)
        if _GEOMETRY.fullmatch(name):
            taken = {one.path: one for one in _geometry(records, words)}
            for group in ("grid", "frame"):
                if not _add_group(found, taken, group):
                    refused.append(f"table {name}: a table with other content is read")
        elif _ELEMENTS.fullmatch(name):
            edges.append(_edges(records, words))
        elif _EIGENVALUES.fullmatch(name):
            try:
                for subcase, table in _eigenvalues(records, words).items():
                    tables.setdefault(subcase, table)
            except _NotModes as error:
                refused.append(str(error))
        elif _SHAPES.fullmatch(name):
            added, notes = _shapes(records, words, name, by_node)
            refused += notes
            refused += [
                f"table {name}: a table with other content is read"
                for case in added
                if not _add_case(cases, case)
            ]
        else:
            what = next((what for head, what in _NOT_READ.items() if name.startswith(head)), None)
            if what is not None:
                refused.append(f"table {name} holds {what}, not the shapes of modes")
            elif "OUG" in name or "PHIG" in name:
                refused.append(f"table {name} is of a kind that is not read")
            elif name:  # the first block has the date of the file
                others.append(f"{name} (a matrix)" if _is_matrix(block, words) else name)
    if is_flutter and any(case.is_complex for case in cases):
        refused.append("complex modes of a flutter analysis, which are not in vacuo")
        cases = [case for case in cases if not case.is_complex]
    for shapes in by_node.values():
        case = shapes.build_case(tables)
        if case is None:
            refused.append(
                f"shapes sorted by node (SORT2) of subcase {shapes.subcase}, without the "
                "eigenvalues (LAMA) of these modes"
            )
        elif not _add_case(cases, case):
            refused.append(f"shapes sorted by node of subcase {shapes.subcase}: others are read")
    refused += list_notes(cases)
    if others:
        refused.append(f"tables of other content: {', '.join(dict.fromkeys(others))}")
    found |= {one.path: one for one in list_cases(cases, _match_subcases(tables, cases))}
    if not found:
        raise UnreadableFile(
            "it holds neither nodes (GEOM1) nor eigenvectors (OUG) nor eigenvalues (LAMA)"
            + (f", but {'; '.join(refused)}" if refused else "")
            + "; run with PARAM,POST,-1 and VECTOR=ALL.",
            code="nothing-usable",
        )
    yield from found.values()
    if any(part.size for part in edges):
        yield Field("line/nodes", np.unique(np.concatenate(edges), axis=0))
    if refused:
        yield Field("refused", np.array(list(dict.fromkeys(refused)), dtype=np.str_))


def _is_matrix(block: list[bytes], words: _Words) -> bool:
    """Return whether records of a block are columns: their type is 1, that of tables 0."""
    column = np.array(1, words.integer).tobytes()
    return any(record[: words.size] == column for record in block[2:])


def _add_group(found: dict[str, Field], taken: dict[str, Field], group: str) -> bool:
    """Add the rows of a group, such as the nodes of a further superelement.

    Returns False if another table has a row of the same number with other values.
    """
    agrees = True
    for key, names in _GROUPS[group].items():
        columns = [f"{group}/{name}" for name in names]
        if columns[0] not in taken:
            continue
        part = [taken[path].samples for path in columns]
        if columns[0] in found:
            known = [found[path].samples for path in columns]
            one, other = (samples[0].reshape(-1, key)[:, 0] for samples in (known, part))
            _, rows, again = np.intersect1d(one, other, return_indices=True)
            if any(not np.array_equal(a[rows], b[again]) for a, b in zip(known, part, strict=True)):
                agrees = False
                continue
            new = ~np.isin(other, one)
            part = [np.concatenate([a, b[new]]) for a, b in zip(known, part, strict=True)]
        found |= {path: Field(path, rows) for path, rows in zip(columns, part, strict=True)}
    return agrees


def _add_case(cases: list[NastranCase], case: NastranCase) -> bool:
    """Add the modes of a subcase, or their shapes at the nodes of a further superelement.

    Returns False if another table has other modes of the subcase, or other values at a node.
    """
    for place, known in enumerate(cases):
        if (known.subcase, known.is_complex) != (case.subcase, case.is_complex):
            continue
        if any(
            not np.array_equal(getattr(known, name), getattr(case, name))
            for name in ("numbers", "eigenvalues", "in_basic")
        ):
            return False
        _, rows, again = np.intersect1d(known.nodes, case.nodes, return_indices=True)
        if not np.array_equal(known.values[:, rows], case.values[:, again]):
            return False
        new = ~np.isin(case.nodes, known.nodes)
        if new.any():
            nodes = np.concatenate([known.nodes, case.nodes[new]])
            values = np.concatenate([known.values, case.values[:, new]], axis=1)
            order = np.argsort(nodes)
            cases[place] = replace(known, nodes=nodes[order], values=values[:, order])
        return True
    cases.append(case)
    return True


def _match_subcases(
    tables: dict[int, EigenvalueTable], cases: list[NastranCase]
) -> dict[int, EigenvalueTable]:
    """Return eigenvalues by the subcases of the shapes; one table alone is that of all shapes."""
    real = {case.subcase for case in cases if not case.is_complex}
    if len(tables) == 1 and len(real) == 1:
        return dict.fromkeys(real, next(iter(tables.values())))
    return tables


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


def _edges(records: list[bytes], words: _Words) -> np.ndarray:
    """Return the edges of the elements of a table as pairs of nodes, for drawing.

    Elements of a layout that is not known are omitted.
    """
    pairs = [np.empty((0, 2), dtype=np.int64)]
    for record in records:
        numbers = np.frombuffer(
            record[: len(record) // words.size * words.size], words.integer
        ).astype(np.int64)
        if numbers.size < 4:
            continue
        head, body = (int(numbers[0]), int(numbers[1])), numbers[3:]
        if head == _RBE2:
            pairs.append(_spokes(body))
        for length, at in (
            (length, at) for lengths, at in (_CORNERS.get(head, ((), None)),) for length in lengths
        ):
            if body.size % length:
                continue
            corners = body.reshape(-1, length)[:, at]
            if ((corners > 0) & (corners <= _LARGEST_NODE)).all():
                following = np.roll(corners, -1, axis=1)
                pairs += [np.stack([corners, following], axis=2).reshape(-1, 2)]
                break
    joined = np.sort(np.concatenate(pairs), axis=1)
    return joined[joined[:, 0] != joined[:, 1]]


def _spokes(body: np.ndarray) -> np.ndarray:
    """Return pairs of independent and dependent nodes of RBE2, whose lists end with -1."""
    pairs: list[tuple[int, int]] = []
    begin = 0
    for end in np.flatnonzero(body == -1).tolist():
        part = body[begin:end]
        part = part[np.argmax(part != 0) :]  # thermal expansion of zero ends the one before
        pairs += [(int(part[1]), int(node)) for node in part[3:] if 0 < node <= _LARGEST_NODE]
        begin = end + 1
    return np.array(pairs, dtype=np.int64).reshape(-1, 2)


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


def _eigenvalues(records: list[bytes], words: _Words) -> dict[int, EigenvalueTable]:
    """Return the eigenvalues of each subcase.

    Raises
    ------
    _NotModes
        If they are buckling factors.
    """
    row = np.dtype([("i", words.integer, 2), ("x", words.real, 5)])
    tables: dict[int, EigenvalueTable] = {}
    subcase = 0
    for record in records[1:]:  # identification and data records alternate
        head = np.frombuffer(record[: 10 * words.size], words.integer)
        if len(record) % row.itemsize == 0 and record:
            rows = np.frombuffer(record, row)
            if (rows["i"][:, 0] == np.arange(1, rows.size + 1)).all():
                tables.setdefault(
                    subcase,
                    (
                        rows["i"][:, 0].astype(np.int64),
                        rows["x"][:, 1].astype(float),
                        rows["x"][:, 3].astype(float),
                    ),
                )
                continue
        if head.size == 10:
            if int(head[0]) // 10 in _BUCKLING:
                raise _NotModes("table LAMA holds buckling factors (SOL 105)")
            subcase = int(head[3])
    return tables


class _NotModes(Exception):
    """A table holds other results than those of modes."""


@dataclass(slots=True)
class _Modes:
    """Modes of one subcase of a table."""

    label: str
    nodes: np.ndarray
    grids: np.ndarray
    numbers: list[int] = field(default_factory=list)
    eigenvalues: list[complex] = field(default_factory=list)
    shapes: list[np.ndarray] = field(default_factory=list)


@dataclass(slots=True)
class _NodeShapes:
    """Real modes of one subcase that are sorted by node (SORT2), of which rows have the number."""

    subcase: int
    label: str
    in_basic: bool
    numbers: np.ndarray
    nodes: list[int] = field(default_factory=list)
    shapes: list[np.ndarray] = field(default_factory=list)

    def build_case(self, tables: dict[int, EigenvalueTable]) -> NastranCase | None:
        """Return the modes with their eigenvalues; None if there is no table that has them."""
        table = tables.get(self.subcase)
        if table is None or not np.isin(self.numbers, table[0]).all():
            return None
        radians = dict(zip(table[0].tolist(), table[1].tolist(), strict=True))
        return NastranCase(
            subcase=self.subcase,
            is_complex=False,
            label=self.label,
            numbers=self.numbers,
            eigenvalues=np.array([radians[number] ** 2 for number in self.numbers.tolist()]),
            nodes=np.array(self.nodes),
            values=np.stack(self.shapes, axis=1),
            in_basic=self.in_basic,
        )


def _take_node(
    ident: bytes, data: bytes, words: _Words, name: str, by_node: dict[int, _NodeShapes]
) -> bool:
    """Add the rows of one node, one for each mode: number, type of point and six components.

    Returns False if the table names no node.
    """
    head = np.frombuffer(ident[: 10 * words.size], words.integer)
    layout = np.dtype([("i", words.integer, 2), ("x", words.real, 6)])
    subcase, node = int(head[3]), int(head[4]) // 10
    if node <= 0:
        return False
    if int(head[9]) != 8 or len(data) % layout.itemsize:
        raise UnreadableFile(f"table {name} has rows of an unknown length for node {node}.")
    rows = np.frombuffer(data, layout)
    if (rows["i"][:, 1] != 1).any():
        return True  # a scalar point
    numbers = rows["i"][:, 0].astype(np.int64)
    shapes = by_node.setdefault(
        subcase,
        _NodeShapes(subcase, _read_label(ident, words), name.startswith(_IN_BASIC), numbers),
    )
    if not np.array_equal(numbers, shapes.numbers) or node in shapes.nodes:
        raise UnreadableFile(f"table {name} has other modes for node {node}, or has it twice.")
    shapes.nodes.append(node)
    shapes.shapes.append(rows["x"].astype(float))
    return True


def _shapes(
    records: list[bytes], words: _Words, name: str, by_node: dict[int, _NodeShapes]
) -> tuple[list[NastranCase], list[str]]:
    """Return the modes of each subcase of a table, and descriptions of what is not read.

    Real modes that are sorted by node are added to ``by_node``.
    """
    found: dict[tuple[int, bool], _Modes] = {}
    refused: list[str] = []
    # After the name of the sub-table, identification and data records alternate.
    for ident, data in zip(records[1::2], records[2::2], strict=False):
        head = np.frombuffer(ident[: 10 * words.size], words.integer)
        if head.size < 10:
            break
        approach, code, subcase, mode = (int(head[k]) for k in (0, 1, 3, 4))
        if approach // 10 == _REAL_EIGENVALUES and code in _BY_NODE:
            if not _take_node(ident, data, words, name, by_node):
                refused.append(f"table {name} holds shapes sorted by node that names no node")
            continue
        what = _describe_other_content(approach // 10, code)
        if what is not None:
            refused.append(f"table {name} holds {what}")
            continue
        is_complex = approach // 10 == _COMPLEX_EIGENVALUES
        n_values = 12 if is_complex else 6
        layout = np.dtype([("i", words.integer, 2), ("x", words.real, n_values)])
        if int(head[9]) != 2 + n_values or len(data) % layout.itemsize:
            raise UnreadableFile(
                f"table {name} is not sorted by mode with numbers of its kind (SORT1)."
            )
        rows = np.frombuffer(data, layout)
        given = rows["i"][:, 0].astype(np.int64) // 10
        modes = found.get((subcase, is_complex))
        if modes is None:
            modes = _Modes(_read_label(ident, words), given, rows["i"][:, 1] == 1)
            found[subcase, is_complex] = modes
        elif not np.array_equal(given, modes.nodes):
            raise UnreadableFile(f"table {name} has other nodes for mode {mode}.")
        if mode in modes.numbers:
            raise UnreadableFile(f"table {name} has mode {mode} twice in subcase {subcase}.")
        numbers = np.frombuffer(ident, words.real, count=7)
        values = rows["x"][modes.grids].astype(float)
        modes.numbers.append(mode)
        if is_complex:
            modes.eigenvalues.append(complex(numbers[5], numbers[6]))
            if int(head[8]) == _POLAR:
                modes.shapes.append(values[:, :6] * np.exp(1j * np.radians(values[:, 6:])))
            else:
                modes.shapes.append(values[:, :6] + 1j * values[:, 6:])
        else:
            modes.eigenvalues.append(float(numbers[5]))
            modes.shapes.append(values)
    cases = [
        NastranCase(
            subcase=subcase,
            is_complex=is_complex,
            label=modes.label,
            numbers=np.array(modes.numbers, dtype=np.int64),
            eigenvalues=np.array(modes.eigenvalues),
            nodes=modes.nodes[modes.grids],
            values=np.stack(modes.shapes),
            in_basic=name.startswith(_IN_BASIC),
        )
        for (subcase, is_complex), modes in found.items()
    ]
    return cases, refused


def _read_label(ident: bytes, words: _Words) -> str:
    """Return the label of a subcase, or else its subtitle; blank if there is none."""
    if len(ident) < (_LABEL + _TITLE_WORDS) * words.size:
        return ""
    for begin in (_LABEL, _SUBTITLE):
        part = ident[begin * words.size : (begin + _TITLE_WORDS) * words.size]
        letters = np.frombuffer(part, np.uint8).reshape(-1, words.size)[:, :4]  # four in a word
        text = letters.tobytes().decode("latin-1").replace("\0", " ").strip()
        if text.isprintable() and text:
            return " ".join(text.split())
    return ""


def _describe_other_content(approach: int, code: int) -> str | None:
    """Return a description of the content of a table; None for real modes."""
    if code % 1000 not in _TABLES:
        return f"results of kind {code % 1000}, not displacements"
    if approach == _COMPLEX_EIGENVALUES:
        return None if code // 1000 == 1 else "complex modes that are sorted by node"
    if approach in _BUCKLING:
        return "buckling shapes (SOL 105)"
    if approach != _REAL_EIGENVALUES:
        return f"displacements of another solution (approach {approach}), not modes"
    if code // 1000:
        return "shapes that are sorted by node or not real (SORT1, REAL is read)"
    return None
